//! The interpolants and their coefficients.

use super::*;

const PHASES: [f64; 8] = [1e-8, 1e-6, 1e-4, 1e-2, 0.1, 0.5, 1.0, 1.5];
const NODES: [f64; 7] = [0.0, 0.1, 0.25, 0.5, 0.7, 0.9375, 1.0];

/// Eight roundings at the scale of the largest of the functions compared.
fn near(measured: f64, expected: f64, scale: f64) -> bool {
    (measured - expected).abs() <= 8.0 * f64::EPSILON * scale
}

/// `g₁ = sin u(1−τ)/sin u`, `g₂ = sin uτ/sin u` and their derivatives times `h`, or the hyperbolic ones.
#[track_caller]
fn check_functions(kind: fn(f64) -> Frequency, sine: fn(f64) -> f64, cosine: fn(f64) -> f64) {
    for u in PHASES {
        for tau in NODES {
            let c = NodeCoefficients::new(kind(u), 1.0, tau - 0.5);
            let (start, end) = (u * (0.5 - (tau - 0.5)), u * tau);
            let scale = 1.0_f64.max(u * cosine(u) / sine(u));
            let pairs = [
                (c.start(), sine(start) / sine(u)),
                (c.end(), sine(end) / sine(u)),
                (c.start_rate(), -u * cosine(start) / sine(u)),
                (c.end_rate(), u * cosine(end) / sine(u)),
            ];
            for (measured, expected) in pairs {
                assert!(near(measured, expected, scale), "{measured} for {expected}, u = {u}, τ = {tau}");
            }
        }
    }
}

#[test]
fn trigonometric_ones_are_ratios_of_sines() {
    check_functions(Frequency::Trigonometric, f64::sin, f64::cos);
}

#[test]
fn hyperbolic_ones_are_ratios_of_hyperbolic_sines() {
    check_functions(Frequency::Hyperbolic, f64::sinh, f64::cosh);
}

/// What constants lose on a curve: `1 − g₁ − g₂ = −2 sin(½uτ) sin(½u(1−τ))/cos ½u` and
/// `h (g₁' + g₂') = −u sin uσ/cos ½u`, the latter to a relative rounding although it is of order `u²`.
#[test]
fn translation_defects_have_no_cancellation() {
    for u in PHASES {
        for tau in NODES {
            let offset = tau - 0.5;
            let (half, left, right) = (0.5 * u, 0.5 * u * tau, 0.5 * u * (1.0 - tau));
            let c = NodeCoefficients::new(Frequency::Trigonometric(u), 1.0, offset);
            let defect = -2.0 * left.sin() * right.sin() / half.cos();
            assert!(near(1.0 - c.start() - c.end(), defect, 1.0), "u = {u}, τ = {tau}");
            let rate = -u * (u * offset).sin() / half.cos();
            assert!(near(c.even_rate, rate, rate.abs()), "u = {u}, τ = {tau}");
            assert!((c.start_rate() + c.end_rate() - rate).abs() <= 4.0 * f64::EPSILON, "u = {u}, τ = {tau}");

            let c = NodeCoefficients::new(Frequency::Hyperbolic(u), 1.0, offset);
            let defect = 2.0 * left.sinh() * right.sinh() / half.cosh();
            assert!(near(1.0 - c.start() - c.end(), defect, 1.0), "u = {u}, τ = {tau}");
            let rate = u * (u * offset).sinh() / half.cosh();
            assert!(near(c.even_rate, rate, rate.abs()), "u = {u}, τ = {tau}");
        }
    }
}

#[test]
fn large_hyperbolic_rates_stay_finite_and_decay_from_the_ends() {
    for u in [40.0, 100.0, 300.0, 700.0] {
        for tau in NODES {
            let c = NodeCoefficients::new(Frequency::Hyperbolic(u), 1.0, tau - 0.5);
            // sinh uτ / sinh u → exp(−u(1−τ)) (1 − exp(−2uτ)); the exponent carries u roundings.
            let end = (-u * (1.0 - tau)).exp() * -(-2.0 * u * tau).exp_m1();
            let start = (-u * tau).exp() * -(-2.0 * u * (1.0 - tau)).exp_m1();
            let tolerance = 4.0 * u * f64::EPSILON;
            let numbers = [c.even, c.odd, c.even_rate, c.odd_rate];
            assert!(numbers.iter().all(|number| number.is_finite()), "{c:?}");
            // start and end are differences of even and odd: absolute at the scale of the larger one.
            let scale = start.max(end).max(f64::MIN_POSITIVE);
            assert!((c.end() - end).abs() <= tolerance * scale, "{} for {end}, u = {u}, τ = {tau}", c.end());
            assert!((c.start() - start).abs() <= tolerance * scale, "u = {u}, τ = {tau}");
        }
    }
}

#[test]
fn mirrored_nodes_have_mirrored_coefficients() {
    for frequency in [Frequency::Trigonometric(1.3), Frequency::Hyperbolic(1.3), Frequency::ZERO] {
        for offset in [0.0, 0.1, 0.3, 0.5] {
            let (left, right) = (
                NodeCoefficients::new(frequency, 0.7, -offset),
                NodeCoefficients::new(frequency, 0.7, offset),
            );
            // Equality of numbers, to the last bit: the action of a step must be its own mirror image.
            assert_eq!(
                (left.even, -left.odd, -left.even_rate, left.odd_rate),
                (right.even, right.odd, right.even_rate, right.odd_rate)
            );
            // A step back uses the same curve.
            assert_eq!(NodeCoefficients::new(frequency, -0.7, offset), right);
        }
    }
}

#[test]
fn small_phases_go_over_into_straight_lines() {
    for u in [1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 0.0] {
        for frequency in [Frequency::Trigonometric(u), Frequency::Hyperbolic(u)] {
            for offset in [-0.5, -0.2, 0.0, 0.4] {
                let curved = NodeCoefficients::new(frequency, 1.0, offset);
                let straight = NodeCoefficients::straight(offset);
                // The rate of the ends is u²/2 (1 + u²/12); everything else is nearer.
                let tolerance = 0.6 * u * u + 2.0 * f64::EPSILON;
                let differences = [
                    curved.even - straight.even,
                    curved.odd - straight.odd,
                    curved.even_rate - straight.even_rate,
                    curved.odd_rate - straight.odd_rate,
                ];
                assert!(differences.iter().all(|x| x.abs() <= tolerance), "{curved:?}, u = {u}");
            }
        }
    }
}
