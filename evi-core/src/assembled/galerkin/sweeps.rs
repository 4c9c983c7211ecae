//! In which order a pass goes over a scene of many bodies, so that what one stage writes is still near when the next one reads it.
//!
//! A pass has stages: constraints, both halves of a solve, displacements, forces, new positions. Taken one after the other, each reads and writes vectors of the
//! whole scene, which no cache holds. Taken together, in steps over [`COLUMNS`] pivots, a stage goes as far as the one before it allows: every number is
//! fetched once on the way up the elimination and once on the way back. What allows what follows from the places of elements, once for all
//! steps; where they are scattered, a stage waits and goes over more at once, at worst over all in the last step.

use std::ops::Range;

use super::super::assembly::{Assembly, PlacedFamily};
use super::super::gram::GramPattern;
use super::super::mass::ConstantMass;
use crate::linear::largest_magnitude;

/// Pivots of a step, and coordinates of a scene without constraints: what a step touches is some tens of kilobytes.
const COLUMNS: usize = 64;

/// Steps hold back others where their points are moved by more than this share of the largest displacement,
const SLOW: f64 = 1.0 / 16.0;
/// and where no more than one step out of so many does.
const FEW: usize = 6;

/// The parts of a stage, step by step, which follow each other without a gap.
pub(super) struct Spans {
    /// Where steps begin, and where the last one ends.
    marks: Vec<u32>,
}

impl Spans {
    /// What a step goes over.
    #[inline(always)]
    pub(super) fn of(&self, step: usize) -> Range<usize> {
        let (mark, next) = (self.marks[step] as usize, self.marks[step + 1] as usize);
        mark.min(next)..mark.max(next)
    }

    /// What some steps on the way down go over.
    pub(super) fn down_over(&self, steps: Range<usize>) -> Range<usize> {
        self.marks[steps.end] as usize..self.marks[steps.start] as usize
    }

    /// Upwards, index by index no later than in its step.
    fn up_before(mut steps: Vec<u32>, n_steps: usize) -> Self {
        gather_behind(&mut steps, u32::min);
        Self { marks: (0..=n_steps).map(|step| first(&steps, |of| of < step as u32)).collect() }
    }

    /// Downwards, the index `i` in the step `steps[i]`; these do not grow with the index.
    fn down(steps: &[u32], n_steps: usize) -> Self {
        Self { marks: (0..=n_steps).map(|step| first(steps, |of| of >= step as u32)).collect() }
    }
}

/// The first index that has left what holds of all before it.
fn first(steps: &[u32], holds: impl Fn(u32) -> bool) -> u32 {
    steps.partition_point(|&step| holds(step)) as u32
}

/// Overwrites every number with the extreme of it and of all behind it.
fn gather_behind(steps: &mut [u32], extreme: impl Fn(u32, u32) -> u32) {
    for i in (1..steps.len()).rev() {
        steps[i - 1] = extreme(steps[i - 1], steps[i]);
    }
}

/// The stages of a family.
pub(super) struct FamilySpans {
    /// Constraints, on the way up.
    pub(super) evaluated: Spans,
    /// `Gᵀ η`, on the way down.
    pub(super) pulled: Spans,
    /// Forces and `Gᵀ λ`, on the way down.
    pub(super) acting: Spans,
}

/// The stages of a pass.
pub(super) struct Sweeps {
    n_steps: usize,
    /// Columns of the elimination, upwards and downwards.
    pub(super) forward: Spans,
    pub(super) backward: Spans,
    /// Coordinates on the way down: those that `Gᵀ η` is about to reach, those that it has moved, those that are placed anew.
    pub(super) reached: Spans,
    pub(super) moved: Spans,
    pub(super) placed: Spans,
    pub(super) families: Vec<FamilySpans>,
    /// For every coordinate the first step in which a force may act on it.
    first_acted: Vec<u32>,
    /// For every step the coordinates on which its forces may act, and some between them.
    touched: Vec<Range<usize>>,
}

impl Sweeps {
    pub(super) fn new(assembly: &Assembly, mass: &ConstantMass, pattern: &GramPattern) -> Self {
        let (n, n_columns) = (assembly.n_coordinates, assembly.n_constraints);
        let per_step = |count: usize| count.div_ceil(COLUMNS).max(1);
        let n_steps = per_step(if n_columns > 0 { n_columns } else { n });
        let last = n_steps as u32 - 1;
        // The step of the first column that needs a constraint, and the one that solves for its share.
        let (mut needed, mut solved) = (vec![last; n_columns], vec![0; n_columns]);
        for column in (0..n_columns).rev() {
            let step = (column / COLUMNS) as u32;
            pattern.elimination.for_each_unknown(column, |unknown| needed[unknown] = step);
            solved[pattern.elimination.pivot(column)] = last - step;
        }
        let pulled = by_elements(assembly, |rows, _| rows.map(|row| solved[row]).max().unwrap_or(0));
        let mut moved = if n_columns > 0 {
            by_coordinates(assembly, &pulled)
        } else {
            (0..n).map(|i| ((n - 1 - i) / COLUMNS) as u32).collect()
        };
        keep_blocks_whole(mass, &mut moved);
        let mut reached = moved.clone();
        for_each_place(assembly, |family, element, place| {
            reached[place] = reached[place].min(pulled[family][element]);
        });
        for i in 1..n {
            reached[i] = reached[i].min(reached[i - 1]);
        }
        let acting = by_elements(assembly, |_, places| places.map(|place| moved[place]).max().unwrap_or(0));
        let mut placed = by_coordinates(assembly, &acting);
        placed.iter_mut().zip(&moved).for_each(|(placed, &moved)| *placed = moved.max(*placed));
        keep_blocks_whole(mass, &mut placed);
        let evaluated = assembly.families.iter().map(|family| {
            let of_element = |element| family.rows_of(element..element + 1).map(|row| needed[row]).min();
            (0..family.elements.count()).map(|element| of_element(element).unwrap_or(last)).collect()
        });
        let mut first_acted = vec![last; n];
        let mut touched = vec![n..0; n_steps];
        for_each_place(assembly, |family, element, place| {
            let step = acting[family][element];
            first_acted[place] = first_acted[place].min(step);
            let touched = &mut touched[step as usize];
            *touched = touched.start.min(place)..touched.end.max(place + 1);
        });
        mass.for_each_entry(|row, col, _| first_acted[row] = first_acted[row].min(first_acted[col]));
        let families = evaluated.zip(&pulled).zip(&acting);
        Self {
            n_steps,
            forward: Spans { marks: marks(n_columns, n_steps).collect() },
            backward: Spans { marks: marks(n_columns, n_steps).rev().collect() },
            reached: Spans::down(&reached, n_steps),
            moved: Spans::down(&moved, n_steps),
            placed: Spans::down(&placed, n_steps),
            families: families
                .map(|((evaluated, pulled), acting)| FamilySpans {
                    evaluated: Spans::up_before(evaluated, n_steps),
                    pulled: Spans::down(pulled, n_steps),
                    acting: Spans::down(acting, n_steps),
                })
                .collect(),
            first_acted,
            touched,
        }
    }

    /// The steps that hold back all others: those of which `lengths` are nearly the largest, with their neighbours, if these are few.
    pub(super) fn slowest(&self, lengths: &[f64]) -> Option<Range<usize>> {
        let largest = largest_magnitude(lengths.iter().copied());
        let is_slow = |length: &f64| *length > SLOW * largest;
        let first = lengths.iter().position(is_slow)?.saturating_sub(1);
        let last = lengths.iter().rposition(is_slow)? + 2;
        let steps = first..last.min(self.n_steps);
        (steps.len() * FEW <= self.n_steps).then_some(steps)
    }

    /// The coordinates on which forces of some steps may act, and some between them, if these are few.
    pub(super) fn touched_by(&self, steps: &Range<usize>) -> Option<Range<usize>> {
        let n = self.first_acted.len();
        let touched = self.touched.get(steps.clone())?;
        let start = touched.iter().map(|touched| touched.start).min()?;
        let end = touched.iter().map(|touched| touched.end).max()?;
        (end.saturating_sub(start) * FEW <= n).then_some(start..end)
    }

    /// Whether all forces on a coordinate that some steps have placed act in these steps.
    #[inline(always)]
    pub(super) fn is_within(&self, steps: &Range<usize>, coordinate: usize) -> bool {
        steps.start <= self.first_acted[coordinate] as usize
            && self.placed.down_over(steps.clone()).contains(&coordinate)
    }

    pub(super) fn steps(&self) -> Range<usize> {
        0..self.n_steps
    }
}

/// Where the steps over the columns of an elimination begin, and where the last one ends.
fn marks(n_columns: usize, n_steps: usize) -> impl DoubleEndedIterator<Item = u32> {
    (0..=n_steps).map(move |step| (step * COLUMNS).min(n_columns) as u32)
}

/// For every family the steps of its elements on the way down: one is ready in the step `ready(rows, places)`, and taken when all behind it are ready.
fn by_elements(
    assembly: &Assembly,
    ready: impl Fn(Range<usize>, &mut dyn Iterator<Item = usize>) -> u32,
) -> Vec<Vec<u32>> {
    let of_family = |family: &PlacedFamily| {
        let elements = &*family.elements;
        let of_element = |element: usize| {
            let mut places =
                (0..elements.n_coordinates()).map(|coordinate| elements.place(element, coordinate));
            ready(family.rows_of(element..element + 1), &mut places)
        };
        let mut steps: Vec<u32> = (0..elements.count()).map(of_element).collect();
        gather_behind(&mut steps, u32::max);
        steps
    };
    assembly.families.iter().map(of_family).collect()
}

/// The steps of coordinates on the way down: one is ready after all elements that have it, and taken when all behind it are ready.
fn by_coordinates(assembly: &Assembly, elements: &[Vec<u32>]) -> Vec<u32> {
    let mut steps = vec![0; assembly.n_coordinates];
    for_each_place(assembly, |family, element, place| {
        steps[place] = elements[family][element].max(steps[place]);
    });
    gather_behind(&mut steps, u32::max);
    steps
}

fn for_each_place(assembly: &Assembly, mut visit: impl FnMut(usize, usize, usize)) {
    for (family, PlacedFamily { elements, .. }) in assembly.families.iter().enumerate() {
        for element in 0..elements.count() {
            for coordinate in 0..elements.n_coordinates() {
                visit(family, element, elements.place(element, coordinate));
            }
        }
    }
}

/// Takes coordinates that the mass couples in one step: their displacements are made of the same forces.
fn keep_blocks_whole(mass: &ConstantMass, steps: &mut [u32]) {
    loop {
        let mut is_whole = true;
        mass.for_each_entry(|row, col, _| {
            is_whole &= steps[row] >= steps[col];
            steps[row] = steps[row].max(steps[col]);
        });
        if is_whole {
            return;
        }
        gather_behind(steps, u32::max);
    }
}
