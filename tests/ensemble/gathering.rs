//! What is gathered: statistics and sections, the same to the last bit on any number of threads.

use evi_core::ensemble::{
    Crossings, Ends, Ensemble, Family, Outcome, Quantity, States, Summaries, SummaryPart, Surface,
};
use evi_core::prelude::*;
use evi_core::scalar::Lanes;
use evi_examples::{DoublePendulum, HarmonicOscillator};

use crate::members::{ends, pendulums};

const MEMBERS: usize = 600;

fn quantities() -> Vec<Quantity<DoublePendulum>> {
    vec![
        Quantity::<DoublePendulum>::new("height", |sight| sight.state.q()[3]).histogram(-2.5, 0.0, 20),
        Quantity::<DoublePendulum>::new("energy", |sight| sight.mechanics.energy(sight.state)),
    ]
}

fn summarized(threads: usize) -> Outcome<(SummaryPart, evi_core::columns::Table)> {
    let gather =
        (Summaries::new(3, quantities()), States::of(|member, sample| member % 100 == 7 && sample > 1));
    let ensemble = Ensemble::new(Evi::midpoint(0.05)).sampled(3, 10).chunks_of(64).threads(threads);
    ensemble.run(&pendulums(MEMBERS), &gather).expect("a run")
}

#[test]
fn threads_change_no_bit() {
    let one = summarized(1);
    assert!(one.is_complete() && one.failures.is_empty());
    for threads in [2, 4] {
        let many = summarized(threads);
        assert_eq!(one.gathered, many.gathered, "{threads} threads");
    }
}

#[test]
fn statistics_are_those_of_all_members() {
    let (summaries, states) = summarized(2).gathered;
    let all = ends(Evi::midpoint(0.05), &pendulums(MEMBERS), 30);
    let heights: Vec<f64> = all.iter().map(|row| row[6]).collect();
    let count = MEMBERS as f64;
    let mean = heights.iter().sum::<f64>() / count;
    let variance = heights.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let summary = summaries.at(3, 0);
    assert_eq!(summary.count(), MEMBERS as u64);
    // Round-off of 600 terms.
    assert!((summary.mean() - mean).abs() < 1e-14, "{:e}", summary.mean() - mean);
    assert!((summary.variance() - variance).abs() < 1e-14);
    let mut sorted = heights.clone();
    sorted.sort_by(f64::total_cmp);
    let largest = summary.largest().expect("values");
    assert_eq!((largest.value, heights[largest.member]), (sorted[MEMBERS - 1], sorted[MEMBERS - 1]));
    let median = summary.quantile(0.5).expect("values");
    assert!((median / sorted[MEMBERS / 2 - 1] - 1.0).abs() <= 1.0 / 256.0);
    let histogram = summary.histogram();
    assert_eq!(histogram.bins.iter().sum::<u64>() + histogram.below + histogram.above, MEMBERS as u64);
    let third = heights.iter().filter(|y| (-2.25..-2.125).contains(*y)).count();
    assert_eq!(histogram.bins[2], third as u64);
    assert_eq!(states.rows().len(), 2 * MEMBERS / 100);
    assert!(states.rows().all(|row| row[0] as usize % 100 == 7));
}

/// An oscillator crosses `x = 0` upwards once a period: of the midpoint rule, `h ω̃ = 2 arctan(h ω / 2)`.
#[test]
fn crossings_are_found_between_steps() {
    let h = 0.02;
    let rates: Vec<f64> = (0..20).map(|k| 1.0 + 0.1 * f64::from(k)).collect();
    let system = HarmonicOscillator { m: 1.0, k: 1.0 };
    let family = Family::new(&system, 20, [0.7], [0.0])
        .parameter("k", rates.iter().map(|rate| rate * rate).collect())
        .expect("one stiffness each");
    let ensemble = Ensemble::new(Evi::midpoint(h)).section(Surface(|q: &[Lanes; 1], _: &[Lanes; 1]| q[0]));
    let outcome = ensemble.sampled(1, 500).run(&family, &Crossings::all()).expect("a run");
    let mut largest = 0.0_f64;
    let mut count = 0;
    for (member, rate) in rates.iter().enumerate() {
        let numerical = 2.0 / h * (h * rate / 2.0).atan();
        let found = outcome.gathered.rows().filter(|row| row[0] as usize == member);
        for (turn, row) in found.enumerate() {
            let expected = (turn as f64 + 0.75) * std::f64::consts::TAU / numerical;
            largest = largest.max((row[2] - expected).abs());
            count += 1;
        }
    }
    assert_eq!(
        count,
        rates.iter().map(|rate| (10.0 * rate / std::f64::consts::TAU + 0.25) as usize).sum::<usize>()
    );
    // Velocities of the midpoint rule are off by (hω)²/12 of themselves, of which a tenth bends the curve between positions that are not:
    // 8e-7 at ω = 2.9.
    assert!(largest < 1e-6, "{largest:e}");
}

#[test]
fn the_first_crossing_may_end_a_member() {
    let ensemble = Ensemble::new(Evi::midpoint(0.05))
        .section(Surface(|q: &[Lanes; 4], _: &[Lanes; 4]| q[0]))
        .sampled(1, 400);
    let (all, ends) = ensemble.run(&pendulums(50), &(Crossings::all(), Ends)).expect("a run").gathered;
    let (first, last) = ensemble.run(&pendulums(50), &(Crossings::first(), Ends)).expect("a run").gathered;
    assert_eq!((ends.rows().len(), last.rows().len(), first.rows().len()), (50, 50, 50));
    for row in first.rows() {
        let same = all.rows().find(|other| other[0] == row[0]).expect("a crossing");
        assert_eq!(row, same);
        assert!(row[3].abs() < 1e-13 && last.rows().any(|end| end == row));
    }
}
