//! Moments and exactness of quadratures.

use super::*;

/// Moments `Σ wⱼ cⱼᵏ = 1/(k+1)` up to `degree` and not beyond; nodes ascend.
#[track_caller]
fn check_moments<const S: usize>(rule: Quadrature<S>, degree: i32) {
    let absolute: f64 = rule.weights().iter().map(|weight| weight.abs()).sum();
    let error = |k: i32| {
        let moment: f64 =
            rule.weights().iter().zip(rule.nodes()).map(|(weight, node)| weight * node.powi(k)).sum();
        (moment - 1.0 / f64::from(k + 1)).abs()
    };
    let worst = (0..=degree).map(error).fold(0.0, f64::max);
    println!("{}: moments to {worst:e}, beyond {:e}", core::panic::Location::caller(), error(degree + 1));
    // Eight roundings per unit of weight.
    assert!(worst <= 8.0 * f64::EPSILON * absolute, "moments of degree ≤ {degree} are off by {worst:e}");
    // The first moment missed by the rules below is missed by at least 1e-8 (Gauss with 6 nodes).
    assert!(error(degree + 1) > 1e-9, "more exact than degree {degree}");
    assert!(rule.nodes().is_sorted(), "{:?}", rule.nodes());
}

#[track_caller]
fn check_symmetric<const S: usize>(rule: Quadrature<S>) {
    assert!(rule.is_symmetric());
    for j in 0..S {
        // Equality of bits, up to the sign of a middle zero.
        assert!(rule.offsets()[j] == -rule.offsets()[S - 1 - j], "offset {j}");
        assert!(rule.weights()[j].to_bits() == rule.weights()[S - 1 - j].to_bits(), "weight {j}");
    }
}

fn check_uniform<const S: usize>() {
    // An odd number of symmetric nodes gains a degree.
    check_moments(Quadrature::<S>::uniform(), if S % 2 == 1 { S as i32 } else { S as i32 - 1 });
    check_symmetric(Quadrature::<S>::uniform());
}

fn check_gauss<const S: usize>() {
    check_moments(Quadrature::<S>::gauss(), 2 * S as i32 - 1);
    check_symmetric(Quadrature::<S>::gauss());
}

fn check_lobatto<const S: usize>() {
    check_moments(Quadrature::<S>::lobatto(), 2 * S as i32 - 3);
    check_symmetric(Quadrature::<S>::lobatto());
    let nodes = Quadrature::<S>::lobatto().nodes();
    assert!(nodes[0] == 0.0 && nodes[S - 1] == 1.0, "ends, exactly");
}

#[test]
fn uniform_rules_have_the_degree_of_newton_cotes() {
    check_uniform::<1>();
    check_uniform::<2>();
    check_uniform::<3>();
    check_uniform::<4>();
    check_uniform::<5>();
    check_uniform::<6>();
    check_uniform::<7>();
    check_uniform::<8>();
    check_uniform::<9>();
}

#[test]
fn gauss_rules_have_twice_the_degree() {
    check_gauss::<1>();
    check_gauss::<2>();
    check_gauss::<3>();
    check_gauss::<4>();
    check_gauss::<5>();
    check_gauss::<6>();
}

#[test]
fn lobatto_rules_have_twice_the_degree_but_two() {
    check_lobatto::<2>();
    check_lobatto::<3>();
    check_lobatto::<4>();
    check_lobatto::<5>();
    check_lobatto::<6>();
    check_lobatto::<7>();
}

#[test]
fn user_nodes_integrate_their_interpolants() {
    let rule = |nodes| Quadrature::<3>::interpolatory(nodes).expect("a rule");
    check_moments(left_rectangle(), 0);
    check_moments(user_rule(), 1);
    check_symmetric(user_rule());
    check_moments(rule([0.0, 0.3, 1.0]), 2);
    check_moments(rule([0.1, 0.25, 0.9]), 2);
    assert!(!rule([0.0, 0.3, 1.0]).is_symmetric());
    // Their offsets from the middle differ in the last bit.
    check_symmetric(Quadrature::interpolatory([0.2, 0.8]).expect("a rule"));
    check_symmetric(Quadrature::interpolatory([0.7, 0.3]).expect("a rule"));
    check_symmetric(rule([0.05, 0.5, 0.95]));
}

#[track_caller]
fn check_values<const S: usize>(rule: Quadrature<S>, nodes: [f64; S], weights: [f64; S]) {
    for j in 0..S {
        let (node, weight) = (rule.nodes()[j], rule.weights()[j]);
        assert!((node - nodes[j]).abs() <= f64::EPSILON, "node {j}: {node}, not {}", nodes[j]);
        let tolerance = 4.0 * f64::EPSILON;
        assert!((weight - weights[j]).abs() <= tolerance, "weight {j}: {weight}, not {}", weights[j]);
    }
}

#[test]
fn have_the_known_nodes_and_weights() {
    let mirrored = |offset: f64| [0.5 - offset, 0.5 + offset];
    check_values(Quadrature::midpoint(), [0.5], [1.0]);
    check_values(Quadrature::<2>::uniform(), [0.0, 1.0], [0.5, 0.5]);
    check_values(Quadrature::<3>::uniform(), [0.0, 0.5, 1.0], [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0]);
    let boole = [7.0, 32.0, 12.0, 32.0, 7.0].map(|weight| weight / 90.0);
    check_values(Quadrature::<5>::uniform(), [0.0, 0.25, 0.5, 0.75, 1.0], boole);
    check_values(Quadrature::<2>::gauss(), mirrored(3.0_f64.sqrt() / 6.0), [0.5, 0.5]);
    let [a, b] = mirrored(15.0_f64.sqrt() / 10.0);
    check_values(Quadrature::<3>::gauss(), [a, 0.5, b], [5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0]);
    let [a, b] = mirrored(5.0_f64.sqrt() / 10.0);
    let weights = [1.0, 5.0, 5.0, 1.0].map(|weight| weight / 12.0);
    check_values(Quadrature::<4>::lobatto(), [0.0, a, b, 1.0], weights);
    let [a, b] = mirrored(21.0_f64.sqrt() / 14.0);
    let weights = [9.0, 49.0, 64.0, 49.0, 9.0].map(|weight| weight / 180.0);
    check_values(Quadrature::<5>::lobatto(), [0.0, a, 0.5, b, 1.0], weights);
}

#[test]
fn uniform_weights_turn_negative_at_nine_nodes() {
    assert!(Quadrature::<8>::uniform().weights().iter().all(|&weight| weight > 0.0));
    let weight = Quadrature::<9>::uniform().weights()[2];
    assert!((weight + 928.0 / 28350.0).abs() <= 8.0 * f64::EPSILON, "{weight}");
}
