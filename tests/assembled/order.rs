//! Orders on certified digits.

use evi_core::assembled::{AssembledScheme, AssembledSimulation};
use evi_core::prelude::*;
use evi_examples::{Chain5, Chain20, Scene};

use evi_tests::trusses::{Placed, chain};

/// The error of positions at the end of steps of `end / steps`, the largest one.
fn error<F: AssembledScheme>(scheme: F, links: usize, end: f64, exact: &[f64]) -> f64 {
    let Placed { truss, q } = chain(links);
    let mut run = AssembledSimulation::new(truss, scheme).start(q, vec![0.0; 2 * links]).expect("a start");
    let state = run.advance_to(end).expect("every step");
    assert!(state.q().len() == exact.len() && (state.t() - end).abs() < 1e-9);
    state.q().iter().zip(exact).map(|(q, exact)| (q - exact).abs()).fold(0.0, f64::max)
}

/// Errors shrink by `2^order` as steps are halved, and end below `bound`.
#[track_caller]
fn check<F: AssembledScheme>(
    scheme: impl Fn(f64) -> F,
    (links, end, exact): (usize, f64, &[f64]),
    (order, steps, bound): (f64, u32, f64),
) {
    let errors: Vec<f64> =
        (0..4).map(|k| error(scheme(end / f64::from(steps << k)), links, end, exact)).collect();
    let slopes: Vec<f64> = errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
    println!("{links} links: {errors:?} slopes {slopes:?}");
    assert!(slopes.iter().skip(1).all(|slope| (slope - order).abs() < 0.2), "{slopes:?}");
    assert!(errors[3] < bound, "{errors:?}");
}

/// The member of order 16 ends on the certified digits: to 1.1e-15 measured, of numbers that are rounded to 16 digits.
#[track_caller]
fn check_certified((links, end, exact): (usize, f64, &[f64]), steps: u32) {
    let error = error(Galerkin::<8>::new(end / f64::from(steps)), links, end, exact);
    println!("{links} links: {error:e}");
    assert!(error < 2e-15, "{error:e}");
}

#[test]
fn five_links_end_where_they_should() {
    let exact = Chain5::reference().q;
    let case = (5, Chain5::HORIZON, &exact[..]);
    check(Evi::midpoint, case, (2.0, 400, 2e-6));
    check(|h| Evi::midpoint(h).composed(Composition::suzuki_4()), case, (4.0, 200, 2e-10));
    check(|h| Evi::midpoint(h).composed(Composition::kahan_li_6()), case, (6.0, 100, 3e-12));
    check(Galerkin::<2>::new, case, (4.0, 200, 7e-11));
    check_certified(case, 80);
}

#[test]
fn twenty_links_end_where_they_should() {
    let exact = Chain20::reference().q;
    let case = (20, Chain20::HORIZON, &exact[..]);
    check(Evi::midpoint, case, (2.0, 800, 7e-7));
    check(|h| Evi::midpoint(h).composed(Composition::suzuki_4()), case, (4.0, 400, 3e-11));
    check(|h| Evi::midpoint(h).composed(Composition::kahan_li_6()), case, (6.0, 200, 5e-13));
    check(Galerkin::<3>::new, case, (6.0, 200, 1e-14));
    check_certified(case, 160);
}
