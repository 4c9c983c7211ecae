//! Who wins: for each scene and each accuracy the fastest method, and by what factor.

use serde::Serialize;

use crate::results::{Method, Row};

/// Accuracies at which methods are compared: distances from the reference at the horizon.
pub(crate) const ERRORS: [f64; 6] = [1e-2, 1e-3, 1e-4, 1e-6, 1e-9, 1e-12];
/// Which of them the sentence speaks of.
const SPOKEN_OF: [usize; 4] = [1, 3, 4, 5];

/// The times of a scene, and what they mean.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Verdict {
    pub(crate) scene: String,
    /// For each method that has reached the horizon: its name, and the seconds of its fastest run that is at least as exact as
    /// each of [`ERRORS`].
    pub(crate) seconds: Vec<(String, [Option<f64>; ERRORS.len()])>,
    /// One sentence.
    pub(crate) sentence: String,
}

/// The verdict on a scene from its rows.
pub(crate) fn on(scene: &str, rows: &[Row], methods: &[Method]) -> Verdict {
    let seconds: Vec<(&Method, [Option<f64>; ERRORS.len()])> = methods
        .iter()
        .map(|method| (method, ERRORS.map(|error| fastest(scene, method.name, error, rows))))
        .collect();
    let clauses: Vec<String> = SPOKEN_OF.map(|level| clause(level, &seconds)).into();
    Verdict {
        scene: scene.into(),
        seconds: seconds
            .iter()
            .filter(|(_, times)| times.iter().any(Option::is_some))
            .map(|(method, times)| (method.name.into(), *times))
            .collect(),
        sentence: format!("{scene}: {}.", clauses.join("; ")),
    }
}

fn fastest(scene: &str, method: &str, error: f64, rows: &[Row]) -> Option<f64> {
    rows.iter()
        .filter(|row| row.scene == scene && row.method == method)
        .filter(|row| row.position_error.is_some_and(|reached| reached <= error))
        .filter_map(|row| row.seconds)
        .min_by(f64::total_cmp)
}

/// Who wins at one accuracy, against the best of the other camp: members of this project on one side, everything else on the other.
fn clause(level: usize, seconds: &[(&Method, [Option<f64>; ERRORS.len()])]) -> String {
    let best = |is_member: bool| {
        seconds
            .iter()
            .filter(|(method, _)| method.is_member == is_member)
            .filter_map(|(method, times)| Some((method.name, times[level]?)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
    };
    let to = format!("to {:.0e}", ERRORS[level]);
    let wins = |(winner, time): (&str, f64), (other, other_time): (&str, f64)| {
        format!("{to} {winner} wins in {}, {:.1} times as fast as {other}", duration(time), other_time / time)
    };
    match (best(true), best(false)) {
        (Some(member), Some(baseline)) if member.1 <= baseline.1 => wins(member, baseline),
        (Some(member), Some(baseline)) => wins(baseline, member),
        (Some((name, time)), None) | (None, Some((name, time))) => {
            format!("{to} {name} wins in {}, the other side does not reach it", duration(time))
        }
        (None, None) => format!("{to} no method reaches it"),
    }
}

/// Seconds in a unit that suits them.
pub(crate) fn duration(seconds: f64) -> String {
    let (value, unit) = match seconds {
        s if s < 1e-3 => (s * 1e6, "µs"),
        s if s < 1.0 => (s * 1e3, "ms"),
        s => (s, "s"),
    };
    if value < 10.0 { format!("{value:.1} {unit}") } else { format!("{value:.0} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::{Verdict, duration, on};
    use crate::results::{Method, Row};

    fn row(method: &str, position_error: f64, seconds: f64) -> Row {
        let (position_error, seconds) = (Some(position_error), Some(seconds));
        Row { position_error, seconds, ..Row::empty("top", method) }
    }

    fn verdict(rows: &[Row]) -> Verdict {
        on("top", rows, &[Method::named("ours", true), Method::named("theirs", false)])
    }

    #[test]
    fn the_fastest_run_that_is_exact_enough_counts() {
        let verdict = verdict(&[
            row("ours", 1e-4, 3e-6),
            row("ours", 1e-7, 2e-6),
            row("ours", 2e-2, 1e-6),
            row("theirs", 1e-4, 8e-6),
        ]);
        assert_eq!(verdict.seconds[0].1, [Some(2e-6), Some(2e-6), Some(2e-6), Some(2e-6), None, None]);
        assert_eq!(
            verdict.sentence,
            "top: to 1e-3 ours wins in 2.0 µs, 4.0 times as fast as theirs; to 1e-6 ours wins in 2.0 µs, the other \
             side does not reach it; to 1e-9 no method reaches it; to 1e-12 no method reaches it."
        );
    }

    #[test]
    fn a_baseline_may_win() {
        let verdict = verdict(&[row("ours", 1e-13, 2.0), row("theirs", 1e-13, 0.5)]);
        assert!(verdict.sentence.contains("to 1e-12 theirs wins in 500 ms, 4.0 times as fast as ours"));
    }

    #[test]
    fn durations_have_the_unit_that_suits_them() {
        let texts: Vec<String> = [2.3e-6, 4.56e-4, 0.012, 3.0, 70.0].map(duration).into();
        assert_eq!(texts, ["2.3 µs", "456 µs", "12 ms", "3.0 s", "70 s"]);
    }
}
