//! Assembled scenes of point masses on rods and springs: chains, rings, trees, nets.

use evi_core::assembled::{AssembledSystem, Family, FamilyVisitor};
use evi_core::prelude::*;

/// A point mass in the plane.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = m * g * y,
)]
pub struct Mass {
    m: f64,
    g: f64,
}

/// A rod from the origin. What it gives of inertia is nothing: the derive asks for some.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * none * (der(x).powi(2) + der(y).powi(2)),
    potential = 0.0,
    constraint(length: x.powi(2) + y.powi(2) == l.powi(2)),
)]
pub struct Hanger {
    none: f64,
    l: f64,
}

/// A rod between two masses.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(xa, ya, xb, yb),
    kinetic = 0.5 * none * (der(xa).powi(2) + der(ya).powi(2) + der(xb).powi(2) + der(yb).powi(2)),
    potential = 0.0,
    constraint(length: (xb - xa).powi(2) + (yb - ya).powi(2) == l.powi(2)),
)]
pub struct Rod {
    none: f64,
    l: f64,
}

/// A spring between two masses, of a force that is not linear in its length.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(xa, ya, xb, yb),
    kinetic = 0.5 * none * (der(xa).powi(2) + der(ya).powi(2) + der(xb).powi(2) + der(yb).powi(2)),
    potential = 0.25 * k * ((xb - xa).powi(2) + (yb - ya).powi(2) - l.powi(2)).powi(2),
)]
pub struct Spring {
    none: f64,
    k: f64,
    l: f64,
}

/// Point masses, joined by rods and springs. Mass `i` has the coordinates `2 i` and `2 i + 1`.
#[derive(Clone, Debug, Default)]
pub struct Truss {
    /// One per mass.
    pub masses: Vec<f64>,
    /// Gravitational acceleration.
    pub gravity: f64,
    /// Mass and length.
    pub hangers: Vec<(usize, f64)>,
    /// Two masses and a length.
    pub rods: Vec<([usize; 2], f64)>,
    /// Two masses, a stiffness and a length.
    pub springs: Vec<([usize; 2], f64, f64)>,
}

fn at([a, b]: [usize; 2]) -> [usize; 4] {
    [2 * a, 2 * a + 1, 2 * b, 2 * b + 1]
}

impl Family<Truss> for Mass {
    type Element = Self;

    fn count(truss: &Truss) -> usize {
        truss.masses.len()
    }

    fn element(truss: &Truss, i: usize) -> Self {
        Self { m: truss.masses[i], g: truss.gravity }
    }

    fn coordinates(_: &Truss, i: usize) -> [usize; 2] {
        [2 * i, 2 * i + 1]
    }
}

impl Family<Truss> for Hanger {
    type Element = Self;

    fn count(truss: &Truss) -> usize {
        truss.hangers.len()
    }

    fn element(truss: &Truss, i: usize) -> Self {
        Self { none: 0.0, l: truss.hangers[i].1 }
    }

    fn coordinates(truss: &Truss, i: usize) -> [usize; 2] {
        let (mass, _) = truss.hangers[i];
        [2 * mass, 2 * mass + 1]
    }
}

impl Family<Truss> for Rod {
    type Element = Self;

    fn count(truss: &Truss) -> usize {
        truss.rods.len()
    }

    fn element(truss: &Truss, i: usize) -> Self {
        Self { none: 0.0, l: truss.rods[i].1 }
    }

    fn coordinates(truss: &Truss, i: usize) -> [usize; 4] {
        at(truss.rods[i].0)
    }
}

impl Family<Truss> for Spring {
    type Element = Self;

    fn count(truss: &Truss) -> usize {
        truss.springs.len()
    }

    fn element(truss: &Truss, i: usize) -> Self {
        let (_, k, l) = truss.springs[i];
        Self { none: 0.0, k, l }
    }

    fn coordinates(truss: &Truss, i: usize) -> [usize; 4] {
        at(truss.springs[i].0)
    }
}

impl AssembledSystem for Truss {
    fn n_coordinates(&self) -> usize {
        2 * self.masses.len()
    }

    fn coordinate_name(&self, index: usize) -> String {
        format!("p[{}, {}]", index / 2, index % 2)
    }

    fn constraint_name(&self, index: usize) -> String {
        let hangers = self.hangers.len();
        if index < hangers { format!("hanger[{index}]") } else { format!("rod[{}]", index - hangers) }
    }

    fn visit_families<V: FamilyVisitor<Self>>(&self, visitor: &mut V) {
        visitor.family::<Mass>();
        visitor.family::<Hanger>();
        visitor.family::<Rod>();
        visitor.family::<Spring>();
    }
}

/// A truss and where it starts, at rest.
pub struct Placed {
    /// The truss.
    pub truss: Truss,
    /// Where it starts.
    pub q: Vec<f64>,
}

impl Truss {
    /// The truss whose rods are as long as the masses are apart at `q`.
    fn placed(mut self, q: Vec<f64>) -> Placed {
        let length = |[a, b]: [usize; 2]| (q[2 * b] - q[2 * a]).hypot(q[2 * b + 1] - q[2 * a + 1]);
        self.hangers.iter_mut().for_each(|(i, l)| *l = q[2 * *i].hypot(q[2 * *i + 1]));
        self.rods.iter_mut().for_each(|(ends, l)| *l = length(*ends));
        Placed { truss: self, q }
    }
}

/// Masses that are not alike.
fn unequal(n: usize) -> Vec<f64> {
    (0..n).map(|i| (1.0 + 0.5 * (1.7 * i as f64).sin()) / n as f64).collect()
}

/// The chain of the gallery: `n` equal links, length and mass 1 in all, horizontal.
pub fn chain(n: usize) -> Placed {
    let share = 1.0 / n as f64;
    Placed {
        truss: Truss {
            masses: vec![share; n],
            gravity: 9.81,
            hangers: vec![(0, share)],
            rods: (1..n).map(|i| ([i - 1, i], share)).collect(),
            springs: Vec::new(),
        },
        q: (0..n).flat_map(|i| [(i + 1) as f64 * share, 0.0]).collect(),
    }
}

/// A closed chain, hung up at its first mass.
pub fn ring(n: usize) -> Placed {
    let angle = |i: usize| 2.0 * std::f64::consts::PI * i as f64 / n as f64;
    let truss = Truss {
        masses: unequal(n),
        gravity: 9.81,
        hangers: vec![(0, 0.0)],
        rods: (0..n).map(|i| ([i, (i + 1) % n], 0.0)).collect(),
        springs: Vec::new(),
    };
    truss.placed((0..n).flat_map(|i| [0.3 + angle(i).cos(), 0.1 + angle(i).sin()]).collect())
}

/// A binary tree, from the root down.
pub fn tree(n: usize) -> Placed {
    let truss = Truss {
        masses: unequal(n),
        gravity: 9.81,
        hangers: vec![(0, 0.0)],
        rods: (1..n).map(|i| ([(i - 1) / 2, i], 0.0)).collect(),
        springs: Vec::new(),
    };
    let mut q = vec![0.2, -0.9];
    for i in 1..n {
        let parent = (i - 1) / 2;
        let turn = if i % 2 == 0 { 0.7 } else { -0.9 } - 0.1 * (i as f64).cos();
        q.extend([q[2 * parent] + turn, q[2 * parent + 1] - 0.5]);
    }
    truss.placed(q)
}

/// A net of `n` times `n` masses: rods along its rows, springs along its columns, its corner hung up.
pub fn net(n: usize) -> Placed {
    let index = |row: usize, col: usize| row * n + col;
    let cells = || (0..n).flat_map(|row| (1..n).map(move |col| (row, col)));
    let truss = Truss {
        masses: unequal(n * n),
        gravity: 9.81,
        hangers: vec![(0, 0.0)],
        rods: cells().map(|(row, col)| ([index(row, col - 1), index(row, col)], 0.0)).collect(),
        springs: cells().map(|(col, row)| ([index(row - 1, col), index(row, col)], 5.0, 0.2)).collect(),
    };
    let place = |row: usize, col: usize| {
        let (row, col) = (row as f64, col as f64);
        [0.3 + 0.25 * col + 0.02 * row, 0.05 * (col + row).sin() - 0.2 * row]
    };
    truss.placed((0..n * n).flat_map(|i| place(i / n, i % n)).collect())
}
