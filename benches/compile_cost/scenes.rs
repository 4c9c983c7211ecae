//! Scenes of any size, as the source of a crate.

use std::fmt::Write;

/// A scene's struct, and a start.
pub(crate) struct Scene {
    pub(crate) name: &'static str,
    pub(crate) n_coordinates: usize,
    pub(crate) n_constraints: usize,
    /// What stands in `#[evi(..)]`.
    items: String,
    /// Fields with their values.
    fields: &'static [(&'static str, &'static str)],
    /// Positions of the start, at rest: an expression.
    start: String,
    /// Number of bodies, where it is the named constant `N`, and what is repeated is a loop.
    bodies: Option<usize>,
}

/// What a crate holds.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Content {
    /// The struct without the derive.
    Bare,
    /// The struct with it.
    Derive,
    /// A step of `Evi::midpoint`, too; prints the statements of the largest kernel.
    Run,
    /// A step of the generic path beside it; prints the statements, and by how much the momenta differ, relatively.
    Comparison,
}

impl Scene {
    /// The scene of the README.
    pub(crate) fn double_pendulum() -> Self {
        let items = "coordinates(x1, y1, x2, y2),
            kinetic = 0.5 * m1 * (der(x1).powi(2) + der(y1).powi(2)) + 0.5 * m2 * (der(x2).powi(2) + der(y2).powi(2)),
            potential = g * (m1 * y1 + m2 * y2),
            constraint(rod1: x1.powi(2) + y1.powi(2) == l1.powi(2)),
            constraint(rod2: (x2 - x1).powi(2) + (y2 - y1).powi(2) == l2.powi(2)),";
        Self {
            name: "double_pendulum",
            n_coordinates: 4,
            n_constraints: 2,
            items: items.to_owned(),
            fields: &[("m1", "1.0"), ("m2", "0.5"), ("l1", "1.0"), ("l2", "0.8"), ("g", "9.81")],
            start: "[1.0, 0.0, 1.8, 0.0]".to_owned(),
            bodies: None,
        }
    }

    /// `n` rotators, each coupled with every other by a cosine (M. Antoni, S. Ruffo, Phys. Rev. E 52 (1995) 2361, with unequal
    /// couplings): a dense matrix, all of it varying. The potential is one sum of `n (n − 1) / 2` terms.
    pub(crate) fn rotators(n: usize) -> Self {
        let pairs = (0..n).flat_map(|i| (0..i).map(move |j| (i, j)));
        let couplings: Vec<String> = pairs
            .map(|(i, j)| format!("{:.3} * k * (a{i} - a{j}).cos()", 0.5 + 0.001 * (7 * i + 13 * j) as f64))
            .collect();
        let kinetic: Vec<String> = (0..n).map(|i| format!("der(a{i}).powi(2)")).collect();
        let start: Vec<String> = (0..n).map(|i| format!("{:.2}", 0.37 * i as f64)).collect();
        let names: Vec<String> = (0..n).map(|i| format!("a{i}")).collect();
        let items = format!(
            "coordinates({}), kinetic = 0.5 * inertia * ({}), potential = {},",
            names.join(", "),
            kinetic.join(" + "),
            couplings.join(" + ")
        );
        let fields = &[("inertia", "1.5"), ("k", "0.8")];
        let start = format!("[{}]", start.join(", "));
        Self { name: "rotators", n_coordinates: n, n_constraints: 0, items, fields, start, bodies: None }
    }

    /// A hanging chain of point masses and rods in `n` coordinates, two a mass: sparse matrices, neighbours alone are coupled.
    pub(crate) fn chain(n: usize) -> Self {
        let masses = n / 2;
        let all = |item: &dyn Fn(usize) -> String, separator: &str| {
            (0..masses).map(item).collect::<Vec<_>>().join(separator)
        };
        let mut items = format!(
            "coordinates({}), kinetic = 0.5 * m * ({}), potential = m * g * ({}),",
            all(&|k| format!("x{k}, y{k}"), ", "),
            all(&|k| format!("der(x{k}).powi(2) + der(y{k}).powi(2)"), " + "),
            all(&|k| format!("y{k}"), " + "),
        );
        for k in 0..masses {
            let (x, y) = match k {
                0 => ("x0".to_owned(), "y0".to_owned()),
                _ => (format!("(x{k} - x{})", k - 1), format!("(y{k} - y{})", k - 1)),
            };
            write!(items, " constraint(rod{k}: {x}.powi(2) + {y}.powi(2) == l.powi(2)),")
                .expect("a string takes all text");
        }
        let fields = &[("m", "1.5"), ("g", "9.81"), ("l", "0.5")];
        let start = all(&|k| format!("{:.1}, 0.0", 0.5 * (k + 1) as f64), ", ");
        let start = format!("[{start}]");
        Self {
            name: "chain",
            n_coordinates: 2 * masses,
            n_constraints: masses,
            items,
            fields,
            start,
            bodies: None,
        }
    }

    /// The same chain with as many point masses as a named constant says.
    pub(crate) fn chain_in_loops(masses: usize) -> Self {
        let items = "coordinates(p: [N, 2]),
            kinetic = 0.5 * m * sum(0..N, |i| der(p[i]).norm_squared()),
            potential = m * g * sum(0..N, |i| p[i][1]),
            constraint(first: p[0].norm_squared() == l.powi(2)),
            constraint(rod[i in 1..N]: (p[i] - p[i - 1]).norm_squared() == l.powi(2)),";
        Self {
            name: "chain_in_loops",
            n_coordinates: 2 * masses,
            n_constraints: masses,
            items: items.to_owned(),
            fields: &[("m", "1.5"), ("g", "9.81"), ("l", "0.5")],
            start: "(1..=N).flat_map(|i| [0.5 * i as f64, 0.0]).collect::<Vec<f64>>()".to_owned(),
            bodies: Some(masses),
        }
    }

    /// The source of a crate.
    pub(crate) fn source(&self, content: Content) -> String {
        let join =
            |part: fn(&(&str, &str)) -> String| self.fields.iter().map(part).collect::<Vec<_>>().join(", ");
        let declared = join(|(name, _)| format!("{name}: f64"));
        let values = join(|(name, value)| format!("{name}: {value}"));
        let attribute = match content {
            Content::Bare => String::new(),
            _ => format!("#[derive(Clone, Copy, MechanicalSystem)]\n#[evi({})]\n", self.items),
        };
        let constant = self.bodies.map_or(String::new(), |bodies| format!("const N: usize = {bodies};\n\n"));
        let (first, ..) = self.fields[0];
        let main = match content {
            Content::Bare => format!("println!(\"{{}}\", scene.{first});"),
            Content::Derive => format!("println!(\"{{}}\", scene.{first});"),
            Content::Run | Content::Comparison => {
                let comparison = if content == Content::Run { "" } else { COMPARISON };
                let (n, start) = (self.n_coordinates, &self.start);
                match self.bodies {
                    None => format!("let (q, v) = ({start}, [0.0; {n}]);\n{RUN}\n{comparison}"),
                    Some(_) => format!("let (q, v) = ({start}, vec![0.0; {n}]);\n{RUN_IN_LOOPS}"),
                }
            }
        };
        // Without a run, fields and the prelude are unused: these crates are built, not kept.
        format!(
            "#![allow(unused)]\nuse evi_core::prelude::*;\n\n{constant}{attribute}struct Scene {{ {declared} }}\n\n\
             fn main() {{\nlet scene = Scene {{ {values} }};\n{main}\n}}\n"
        )
    }
}

/// A step of the specialised path, from `q` with velocities `v`.
const RUN: &str = r#"
    let statements = Scene::REPORT.kernels.iter().map(|kernel| kernel.statements).max();
    println!("{}", statements.unwrap_or(0));
    let mut run = Simulation::new(scene, Evi::midpoint(0.01)).start(q, v).expect("the start is consistent");
    let state = run.advance().expect("the step is small");
"#;

/// A step of a scene in loops, from `q` with velocities `v`.
const RUN_IN_LOOPS: &str = r#"
    use evi_core::assembled::{AssembledSimulation, AssembledSystem, Family, FamilyVisitor};
    struct Largest(usize);
    impl<S> FamilyVisitor<S> for Largest {
        fn family<F: Family<S>>(&mut self) {
            let statements = F::Element::REPORT.kernels.iter().map(|kernel| kernel.statements).max();
            self.0 = self.0.max(statements.unwrap_or(0));
        }
    }
    let mut largest = Largest(0);
    scene.visit_families(&mut largest);
    println!("{}", largest.0);
    let mut run = AssembledSimulation::new(scene, Evi::midpoint(0.01)).start(q, v).expect("the start is consistent");
    let state = run.advance().expect("the step is small");
"#;

/// A step of the generic path, compared with the other.
const COMPARISON: &str = r#"
    use evi_core::generic::{GenericEvi, GenericScheme};
    let mut other = GenericEvi::midpoint(0.01).start(scene, &q, &v).expect("the start is consistent");
    other.advance().expect("the step is small");
    // Momenta, for the step begins at rest: positions would agree in the digits that have not moved.
    let pairs = || std::iter::zip(state.p().iter(), other.p());
    let scale = pairs().map(|(a, _)| a.abs()).fold(0.0, f64::max);
    assert!(scale > 0.01, "a scene that stays where it is shows nothing");
    // As a sum, which a NaN spoils.
    println!("{:e}", pairs().map(|(a, b)| (a - b).abs()).sum::<f64>() / scale);
"#;
