//! Estimates of a frequency, as plain functions of a state.

use crate::scalar::Scalar;

/// `|v × a| / |v|² = √(|v|²|a|² − (v·a)²) / |v|²`: the rate at which the direction of the velocity `v` turns under the
/// acceleration `a`, in any dimension; `None` where the body stands still or a number is not finite.
///
/// For a body that moves uniformly on a circle this is its angular velocity, whatever the centre; on a straight path it is zero.
/// One estimate per body, from the coordinates of that body alone, keeps rotations a symmetry (Kosmas & Leyendecker, Adv.
/// Comput. Math. 45 (2019) 1-21).
///
/// Make it once, before a run. A scheme takes frequencies that are constant over a run, and there is no way to renew them from the state
/// under way: the action of a step would then have to be varied by its frequency too. A step that follows the state
/// without that is not symplectic, its defect is of order `h³` per step, and energy drifts.
///
/// ```
/// use evi_core::scheme::curvature_frequency;
/// // A circle of radius 2 about any point, at 3 rad/s.
/// let frequency = curvature_frequency(&[6.0, 0.0], &[0.0, -18.0]);
/// assert_eq!(frequency, Some(3.0));
/// ```
pub fn curvature_frequency(v: &[f64], a: &[f64]) -> Option<f64> {
    let speed = largest(v);
    if !(speed > 0.0 && speed.is_finite()) {
        return None;
    }
    // The part of a across v, in units of the speed: no difference of nearly equal squares, no overflow.
    let direction = |i: usize| v[i] / speed;
    let squared: f64 = (0..v.len()).map(|i| direction(i) * direction(i)).sum();
    let along: f64 = v.iter().zip(a).enumerate().map(|(i, (_, a))| direction(i) * (a / speed)).sum();
    let across: f64 = a
        .iter()
        .enumerate()
        .map(|(i, a)| {
            let part = a / speed - along / squared * direction(i);
            part * part
        })
        .sum();
    let frequency = Scalar::sqrt(across / squared);
    frequency.is_finite().then_some(frequency)
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest, x| if x.abs() <= largest { largest } else { x.abs() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_circle_in_space_turns_at_its_rate_whatever_accelerates_along_it() {
        // A circle of radius 0.7 in the plane of e and f, rate 2.3, tangential acceleration 1.9.
        let (e, f) = ([0.6, 0.8, 0.0], [0.0, 0.0, 1.0]);
        let (sine, cosine) = 0.4_f64.sin_cos();
        let v: [f64; 3] = core::array::from_fn(|i| 0.7 * 2.3 * (-sine * e[i] + cosine * f[i]));
        let a: [f64; 3] = core::array::from_fn(|i| {
            -0.7 * 2.3 * 2.3 * (cosine * e[i] + sine * f[i]) + 1.9 * (-sine * e[i] + cosine * f[i])
        });
        let frequency = curvature_frequency(&v, &a).expect("it moves");
        assert!((frequency - 2.3).abs() < 1e-15, "{frequency}");
        let huge = curvature_frequency(&v.map(|x| x * 1e200), &a.map(|x| x * 1e200)).expect("it moves");
        assert!((huge - 2.3).abs() < 1e-15, "{huge}");
    }

    #[test]
    fn a_straight_path_does_not_turn_and_rest_has_no_direction() {
        assert_eq!(curvature_frequency(&[1.0, 2.0], &[-0.5, -1.0]), Some(0.0));
        assert_eq!(curvature_frequency(&[0.0, 0.0], &[1.0, 0.0]), None);
        assert_eq!(curvature_frequency(&[f64::NAN, 1.0], &[1.0, 0.0]), None);
        assert_eq!(curvature_frequency(&[1.0, 1.0], &[f64::INFINITY, 0.0]), None);
    }
}
