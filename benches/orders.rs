//! What order does every member have? Fitted slopes of the errors in positions, velocities, energy and recovered multipliers, over
//! step sizes that shrink by 1.15, between 1e-4 and 2e-12: the finest two decades of errors.

use evi_core::baseline::Rattle;
use evi_core::prelude::*;
use evi_tests::convergence::{Orders, Slope, orders};
use evi_tests::motions::{
    Motion, gentle_double_pendulum, kapitza_pendulum, long_charged_spherical_pendulum,
    long_double_pendulum_in_angles,
};

/// One line of the table.
fn row<S, F>(
    scene: &str,
    motion: &Motion<S>,
    member: &str,
    order: u32,
    coarsest: u32,
    scheme: impl Fn(f64) -> F,
) where
    S: MechanicalSystem + Clone,
    F: Scheme<S>,
{
    let Orders { q, v, multipliers, energy } = orders(motion, coarsest, 1.15, scheme);
    let optional =
        |slope: Option<Slope>| slope.map_or("–".to_owned(), |slope| format!("{:.2}", slope.order));
    println!(
        "| {scene} | {member} | {order} | {:.2} | {:.2} | {} | {} | {} | {:.0e} to {:.0e} |",
        q.order,
        v.order,
        optional(energy),
        optional(multipliers),
        q.points,
        q.window[0],
        q.window[1]
    );
}

/// The members of all orders on one motion; `coarsest` is the number of steps in which order 4 is resolved.
fn members<S: MechanicalSystem + Clone>(scene: &str, motion: &Motion<S>, coarsest: u32) {
    let few = coarsest / 4;
    row(scene, motion, "Evi::midpoint", 2, 40 * coarsest, Evi::midpoint);
    row(scene, motion, "… triple_jump_4", 4, coarsest, |h| {
        Evi::midpoint(h).composed(Composition::triple_jump_4())
    });
    row(scene, motion, "… suzuki_4", 4, coarsest, |h| Evi::midpoint(h).composed(Composition::suzuki_4()));
    row(scene, motion, "… yoshida_6", 6, coarsest, |h| Evi::midpoint(h).composed(Composition::yoshida_6()));
    row(scene, motion, "… kahan_li_6", 6, few, |h| Evi::midpoint(h).composed(Composition::kahan_li_6()));
    row(scene, motion, "… kahan_li_8", 8, few, |h| Evi::midpoint(h).composed(Composition::kahan_li_8()));
    row(scene, motion, "Galerkin::<1>", 2, 40 * coarsest, Galerkin::<1>::new);
    row(scene, motion, "Galerkin::<2>", 4, few, Galerkin::<2>::new);
    row(scene, motion, "Galerkin::<3>", 6, few, Galerkin::<3>::new);
    row(scene, motion, "Galerkin::<4>", 8, few, Galerkin::<4>::new);
}

fn main() {
    println!("| scene | member | order | q | v | H | λ | points | errors in q |");
    println!("|---|---|---|---|---|---|---|---|---|");
    let double = gentle_double_pendulum();
    members("double pendulum, 2 constraints", &double, 20);
    row("", &double, "Rattle … kahan_li_8", 8, 5, |h| Rattle::new(h).composed(Composition::kahan_li_8()));
    row("", &double, "Galerkin::<2>, ω = 3.13", 4, 8, |h| Galerkin::<2>::new(h).frequency(3.13));
    row("", &double, "Galerkin::<3>, ω = 3.13", 6, 5, |h| Galerkin::<3>::new(h).frequency(3.13));
    let charged = long_charged_spherical_pendulum();
    row("charged spherical pendulum", &charged, "Galerkin::<5>", 10, 8, Galerkin::<5>::new);
    let moving = kapitza_pendulum();
    row("moving pivot", &moving, "… kahan_li_6", 6, 20, |h| {
        Evi::midpoint(h).composed(Composition::kahan_li_6())
    });
    row("moving pivot", &moving, "Galerkin::<3>", 6, 20, Galerkin::<3>::new);
    let angles = long_double_pendulum_in_angles();
    row("mass depends on q", &angles, "… kahan_li_6", 6, 10, |h| {
        Evi::midpoint(h).composed(Composition::kahan_li_6())
    });
    row("mass depends on q", &angles, "Galerkin::<3>", 6, 8, Galerkin::<3>::new);
}
