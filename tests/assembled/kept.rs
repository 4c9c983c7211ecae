//! What steps keep on chains, rings, trees and nets of unequal masses: constraints, reversal, the symplectic form.

use evi_core::assembled::{AssembledScheme, AssembledSimulation};
use evi_core::prelude::*;
use evi_examples::{LoopScene, LoopVisitor, visit_loops};
use evi_tests::largest_difference;
use evi_tests::trusses::{Placed, Truss, net, ring, tree};

/// What 80 steps round off: 5.3e-15 measured, of coordinates of size 1.
const BACK: f64 = 1e-14;
/// Squares of differences of coordinates up to 4: 4 ε measured.
const ON_CONSTRAINTS: f64 = 6.0 * f64::EPSILON;

/// Steps there and back end where they began; on the way constraints and hidden ones hold.
#[track_caller]
fn check<F: AssembledScheme>(placed: Placed, scheme: impl Fn(f64) -> F, (h, steps): (f64, u32)) {
    let Placed { truss, q } = placed;
    let rest = vec![0.0; q.len()];
    let forth = AssembledSimulation::new(truss.clone(), scheme(h));
    let mut run = forth.start(q.clone(), rest.clone()).expect("a start");
    let energy = run.energy();
    let mut errors = [0.0_f64; 3];
    for _ in 0..steps {
        run.advance().expect("a step");
        let error = [run.constraint_error(), run.hidden_constraint_error(), (run.energy() - energy).abs()];
        errors.iter_mut().zip(error).for_each(|(largest, error)| *largest = largest.max(error));
    }
    let end = run.state().clone();
    let moved = largest_difference(end.q(), &q);
    assert!(moved > 0.05, "it has moved by {moved} only");
    let mut run =
        AssembledSimulation::new(truss, scheme(-h)).start_at(end.t(), end.q(), end.v()).expect("a start");
    for _ in 0..steps {
        run.advance().expect("a step back");
    }
    let difference = largest_difference(run.state().q(), &q).max(largest_difference(run.state().v(), &rest));
    println!(
        "{}: moved {moved:.2}, back to {difference:e}, φ {:e}, G v {:e}, H {:e}",
        core::panic::Location::caller(),
        errors[0],
        errors[1],
        errors[2]
    );
    assert!(difference < BACK, "{difference:e}");
    assert!(errors[0].max(errors[1]) <= ON_CONSTRAINTS, "{errors:?}");
}

#[test]
fn rings_trees_and_nets_go_there_and_back_on_their_constraints() {
    check(ring(10), Evi::midpoint, (0.01, 40));
    check(tree(15), Evi::midpoint, (0.01, 40));
    check(tree(15), |h| Evi::midpoint(h).composed(Composition::suzuki_4()), (0.02, 20));
    check(ring(10), Galerkin::<8>::new, (0.05, 8));
    // Springs: positions and multipliers together, and multipliers alone on the trapezoidal rule.
    check(net(4), Evi::midpoint, (0.01, 40));
    check(net(4), Evi::trapezoid, (0.01, 40));
    check(net(4), Evi::simpson, (0.01, 40));
    check(net(4), Galerkin::<4>::new, (0.04, 10));
}

/// A tree with springs across: its configurations are given by an angle per rod.
fn at_angles(angles: &[f64], rates: &[f64]) -> (Truss, Vec<f64>, Vec<f64>) {
    let Placed { mut truss, .. } = tree(angles.len());
    truss.springs = vec![([1, 2], 3.0, 0.4), ([3, 4], 2.0, 0.3)];
    let (mut q, mut v) = (Vec::new(), Vec::new());
    for (i, (angle, rate)) in angles.iter().zip(rates).enumerate() {
        let (l, [x, y], [u, w]) = match i {
            0 => (truss.hangers[0].1, [0.0; 2], [0.0; 2]),
            _ => {
                let parent = 2 * ((i - 1) / 2);
                (truss.rods[i - 1].1, [q[parent], q[parent + 1]], [v[parent], v[parent + 1]])
            }
        };
        q.extend([x + l * angle.sin(), y - l * angle.cos()]);
        v.extend([u + l * rate * angle.cos(), w + l * rate * angle.sin()]);
    }
    (truss, q, v)
}

/// `Σ ∂ₐq ∂_b p − ∂_b q ∂ₐp` of all pairs of angles and rates, by central differences, before the steps and after.
#[test]
fn the_symplectic_form_is_kept() {
    const BODIES: usize = 5;
    const STEP: f64 = 1e-4;
    let at: [f64; 2 * BODIES] = core::array::from_fn(|i| 0.4 * (1.3 * i as f64 + 0.5).sin());
    let moved = |parameters: [f64; 2 * BODIES], steps: u32| {
        let (truss, q, v) = at_angles(&parameters[..BODIES], &parameters[BODIES..]);
        let mut run = AssembledSimulation::new(truss, Evi::midpoint(0.1)).start(q, v).expect("a start");
        for _ in 0..steps {
            run.advance().expect("a step");
        }
        (run.state().q().to_vec(), run.state().p().to_vec())
    };
    let forms = |steps: u32| -> Vec<f64> {
        let derivatives: Vec<(Vec<f64>, Vec<f64>)> = (0..2 * BODIES)
            .map(|a| {
                let shifted = |by: f64| {
                    let mut parameters = at;
                    parameters[a] += by;
                    moved(parameters, steps)
                };
                // Of fourth order.
                let [far_below, below, above, far_above] = [-2.0, -1.0, 1.0, 2.0].map(|k| shifted(k * STEP));
                let slope = |far_below: &[f64], below: &[f64], above: &[f64], far_above: &[f64]| {
                    (0..below.len())
                        .map(|i| {
                            (8.0 * (above[i] - below[i]) - (far_above[i] - far_below[i])) / (12.0 * STEP)
                        })
                        .collect::<Vec<_>>()
                };
                (
                    slope(&far_below.0, &below.0, &above.0, &far_above.0),
                    slope(&far_below.1, &below.1, &above.1, &far_above.1),
                )
            })
            .collect();
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let pairs = (0..2 * BODIES).flat_map(|a| (0..a).map(move |b| (a, b)));
        let form = |(a, b): (usize, usize)| {
            let ((qa, pa), (qb, pb)) = (&derivatives[a], &derivatives[b]);
            product(qa, pb) - product(qb, pa)
        };
        pairs.map(form).collect()
    };
    let (before, after) = (forms(0), forms(5));
    let size = largest_difference(&before, &vec![0.0; before.len()]);
    let difference = largest_difference(&before, &after);
    println!("of {size}: {difference:e}");
    // Round-off over the step of the difference quotients: 4.6e-12 measured.
    assert!(size > 0.1 && difference < 1e-11, "{difference:e} of {size}");
}

/// Takes steps of every scene of many bodies of the gallery.
struct Steps;

impl LoopVisitor for Steps {
    fn visit<S: LoopScene>(&mut self) {
        let (system, q) = S::standard();
        let rest = vec![0.0; q.len()];
        let simulation = AssembledSimulation::new(system, Evi::midpoint(2e-4));
        let mut run = simulation.start(q.clone(), rest).expect("a start");
        let energy = run.energy();
        run.advance_to(0.02).expect("every step");
        let (moved, gained) = (largest_difference(run.state().q(), &q), run.energy() - energy);
        println!("{}: moved {moved:e}, energy gained {gained:e} of {energy:e}", S::NAME);
        assert!(moved > 1e-3 && run.constraint_error() < 1e-15);
        assert!(gained.abs() < 1e-5, "{gained:e}");
    }
}

#[test]
fn scenes_of_the_gallery_take_their_steps() {
    visit_loops(&mut Steps);
}
