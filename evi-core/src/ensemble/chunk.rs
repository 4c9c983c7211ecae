//! The motion of some consecutive members: what one thread does at a time.
//!
//! Members that can move in lanes do so eight at a time, several groups in turn, since a step of one group waits for its own results while that of
//! another is computed. All others are moved one by one. Neither changes what a member does.

use core::ops::ControlFlow;

use super::failure::{Failure, Failures, MemberError};
use super::gather::{Gather, Sight};
use super::lane_map::{LaneMap, LaneScheme};
use super::lane_state::LaneState;
use super::mask::LaneMask;
use super::members::Members;
use super::section::{Section, crossing};
use crate::integrator::{OneStep, StartError, StepError, consistent_start};
use crate::mechanics::{Mechanics, State};
use crate::scalar::{InstructionSet, LANES, LaneOperation};
use crate::system::MechanicalSystem;

/// Groups of eight members whose steps are taken in turn.
const IN_TURN: usize = 4;

/// When members are seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Schedule {
    /// Time of the start.
    pub(super) t: f64,
    /// Number of steps between samples.
    pub(super) stride: u64,
    /// Number of samples after that of the start.
    pub(super) samples: usize,
}

impl Schedule {
    /// Time after so many steps, with the one rounding that a [`Run`](crate::integrator::Run) has.
    fn time(&self, h: f64, steps: u64) -> f64 {
        self.t + h * steps as f64
    }
}

/// How members move, and what is gathered of them.
pub(super) struct Motion<'a, F, X, G> {
    pub(super) scheme: &'a F,
    pub(super) schedule: Schedule,
    pub(super) section: &'a X,
    pub(super) gather: &'a G,
}

/// A member under way.
struct Moving<S: MechanicalSystem> {
    member: usize,
    mechanics: Mechanics<S>,
    state: State<S>,
}

/// A member that moves in a lane.
struct InLane<S: MechanicalSystem, P> {
    moving: Moving<S>,
    part: P,
}

/// Eight members that move side by side.
struct Group<S: MechanicalSystem, L> {
    lanes: L,
    state: LaneState<S>,
    active: LaneMask,
    /// The member of every lane, by its place among those in lanes.
    places: [usize; LANES],
}

/// What a chunk leaves.
pub(super) struct Gathered<P> {
    pub(super) part: P,
    pub(super) failures: Failures,
}

impl<F, X, G> Motion<'_, F, X, G> {
    /// Moves the `members` in this range.
    pub(super) fn integrate<S>(
        &self,
        members: &impl Members<S>,
        range: core::ops::Range<usize>,
    ) -> Gathered<G::Part>
    where
        S: MechanicalSystem,
        F: LaneScheme<S>,
        X: Section<S>,
        G: Gather<S>,
    {
        let mut gathered = Gathered { part: self.gather.blank(), failures: Failures::default() };
        let (mut in_lanes, mut alone) = (Vec::new(), Vec::new());
        for index in range {
            match self.start(members, index) {
                Ok((moving, Some(part))) => in_lanes.push(InLane { moving, part }),
                Ok((moving, None)) => alone.push(moving),
                Err(error) => {
                    let error = MemberError::Start(error);
                    self.fail(&mut gathered, Failure { member: index, steps: 0, t: self.schedule.t, error });
                }
            }
        }
        for block in in_lanes.chunks_mut(IN_TURN * LANES) {
            self.move_in_lanes(block, &mut gathered);
        }
        for moving in alone {
            self.move_alone(moving, &mut gathered);
        }
        gathered.failures.0.sort_by_key(|failure| failure.member);
        gathered
    }

    /// A start, and what it brings into lanes.
    fn start<S: MechanicalSystem>(
        &self,
        members: &impl Members<S>,
        index: usize,
    ) -> Result<(Moving<S>, Option<F::Member>), StartError>
    where
        F: LaneScheme<S>,
    {
        let member = members.member(index);
        let (mechanics, state) =
            consistent_start::<S>(&member.parameters, self.scheme.h(), self.schedule.t, member.q, member.v)?;
        let part = self.scheme.member(&mechanics, &state)?;
        Ok((Moving { member: index, mechanics, state }, part))
    }

    /// Records a failure.
    #[cold]
    fn fail<S: MechanicalSystem>(&self, gathered: &mut Gathered<G::Part>, failure: Failure)
    where
        G: Gather<S>,
    {
        self.gather.end(&mut gathered.part, Err(&failure));
        gathered.failures.0.push(failure);
    }

    fn move_in_lanes<S>(&self, block: &mut [InLane<S, F::Member>], gathered: &mut Gathered<G::Part>)
    where
        S: MechanicalSystem,
        F: LaneScheme<S>,
        X: Section<S>,
        G: Gather<S>,
    {
        let count = block.len();
        let mut groups: Vec<_> = (0..count.div_ceil(LANES))
            .map(|group| {
                // Lanes that are left over repeat the last member, and are not active.
                let places = core::array::from_fn(|lane| (group * LANES + lane).min(count - 1));
                let mechanics = places.map(|place: usize| &block[place].moving.mechanics);
                let state = LaneState::of(self.schedule.t, places.map(|place| &block[place].moving.state));
                let lanes = self.scheme.join(mechanics, places.map(|place| &block[place].part));
                let active = LaneMask::first(count - group * LANES);
                Group { lanes, state, active, places }
            })
            .collect();
        let instructions = InstructionSet::detect();
        for sample in 0..=self.schedule.samples {
            if sample > 0 {
                let (block, gathered) = (&mut *block, &mut *gathered);
                instructions.run(Steps {
                    schedule: self.schedule,
                    h: self.scheme.h(),
                    section: self.section,
                    groups: &mut groups,
                    taken: (sample as u64 - 1) * self.schedule.stride,
                    attendant: &mut Attendant { motion: self, block, sample: sample - 1, gathered },
                });
            }
            let is_last = sample == self.schedule.samples;
            for group in &groups {
                for lane in group.active.lanes() {
                    let Moving { member, mechanics, state } = &mut block[group.places[lane]].moving;
                    group.state.write(lane, state);
                    let sight = Sight { member: *member, sample, mechanics, state };
                    self.gather.see(&mut gathered.part, &sight);
                    if is_last {
                        self.gather.end(&mut gathered.part, Ok(&sight));
                    }
                }
            }
        }
    }

    /// Shows a crossing between two states; whether the motion ends there.
    #[cold]
    fn show_crossing<S: MechanicalSystem>(
        &self,
        (member, mechanics, sample): (usize, &Mechanics<S>, usize),
        ends: [&State<S>; 2],
        gathered: &mut Gathered<G::Part>,
    ) -> ControlFlow<()>
    where
        X: Section<S>,
        G: Gather<S>,
    {
        let Some(state) = crossing(self.section, mechanics, ends) else { return ControlFlow::Continue(()) };
        let sight = Sight { member, sample, mechanics, state: &state };
        let flow = self.gather.cross(&mut gathered.part, &sight);
        if flow.is_break() {
            self.gather.end(&mut gathered.part, Ok(&sight));
        }
        flow
    }

    fn move_alone<S>(&self, moving: Moving<S>, gathered: &mut Gathered<G::Part>)
    where
        S: MechanicalSystem,
        F: LaneScheme<S>,
        X: Section<S>,
        G: Gather<S>,
    {
        let Moving { member, mechanics, mut state } = moving;
        let mut map = match self.scheme.prepare(mechanics.clone()) {
            Ok(map) => map,
            Err(error) => {
                let error = MemberError::Start(error.into());
                return self.fail(gathered, Failure { member, steps: 0, t: state.t, error });
            }
        };
        for sample in 0..=self.schedule.samples {
            if sample > 0 {
                for step in 0..self.schedule.stride {
                    let start = X::EXISTS.then(|| state.clone());
                    let steps = (sample as u64 - 1) * self.schedule.stride + step;
                    if let Err(error) = map.advance(&mut state, &mut ()) {
                        let error = MemberError::Step(error);
                        return self.fail(gathered, Failure { member, steps, t: state.t, error });
                    }
                    state.t = self.schedule.time(self.scheme.h(), steps + 1);
                    let Some(start) = start else { continue };
                    let [before, after] =
                        [&start, &state].map(|state| LaneState::of(state.t, [state; LANES]));
                    if self.section.crossed(&before, &after).has(0) {
                        let who = (member, &mechanics, sample - 1);
                        if self.show_crossing(who, [&start, &state], gathered).is_break() {
                            return;
                        }
                    }
                }
            }
            let sight = Sight { member, sample, mechanics: &mechanics, state: &state };
            self.gather.see(&mut gathered.part, &sight);
            if sample == self.schedule.samples {
                self.gather.end(&mut gathered.part, Ok(&sight));
            }
        }
    }
}

/// The steps between two samples, as an operation on lanes. What is gathered does not enter its type: it is compiled once per scene, scheme and
/// section, for every set of instructions.
struct Steps<'a, S: MechanicalSystem, L, X> {
    schedule: Schedule,
    h: f64,
    section: &'a X,
    groups: &'a mut [Group<S, L>],
    /// Number of steps taken before.
    taken: u64,
    attendant: &'a mut dyn Attend<S, L>,
}

/// Who looks after lanes apart from the others: what happens rarely.
trait Attend<S: MechanicalSystem, L> {
    /// Takes the step of lanes that were not found together, each by itself and without its past; records those that have no step.
    fn rescue(&mut self, group: &mut Group<S, L>, failed: LaneMask, steps: u64);

    /// Shows the crossings of lanes in a step from `before`.
    fn cross(&mut self, group: &mut Group<S, L>, crossed: LaneMask, before: &LaneState<S>);
}

impl<S: MechanicalSystem, L: LaneMap<S>, X: Section<S>> LaneOperation for Steps<'_, S, L, X> {
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        for steps in self.taken..self.taken + self.schedule.stride {
            for group in self.groups.iter_mut() {
                if !group.active.is_any() {
                    continue;
                }
                let before = if X::EXISTS { Some(group.state.clone()) } else { None };
                let failed = group.lanes.advance::<FUSED>(&mut group.state, group.active);
                if failed.is_any() {
                    self.attendant.rescue(group, failed, steps);
                }
                group.state.t = self.schedule.time(self.h, steps + 1);
                if let Some(before) = before {
                    let crossed = self.section.crossed(&before, &group.state).and(group.active);
                    if crossed.is_any() {
                        self.attendant.cross(group, crossed, &before);
                    }
                }
            }
        }
    }
}

/// Looks after the lanes of a block of members.
struct Attendant<'a, 'm, S: MechanicalSystem, F: LaneScheme<S>, X, G: Gather<S>> {
    motion: &'a Motion<'m, F, X, G>,
    block: &'a mut [InLane<S, F::Member>],
    sample: usize,
    gathered: &'a mut Gathered<G::Part>,
}

impl<S, F, X, G> Attend<S, F::Lanes> for Attendant<'_, '_, S, F, X, G>
where
    S: MechanicalSystem,
    F: LaneScheme<S>,
    X: Section<S>,
    G: Gather<S>,
{
    #[cold]
    fn rescue(&mut self, group: &mut Group<S, F::Lanes>, failed: LaneMask, steps: u64) {
        for lane in failed.lanes() {
            let Moving { member, mechanics, state } = &mut self.block[group.places[lane]].moving;
            group.state.write(lane, state);
            match stepped_alone(self.motion.scheme, mechanics, state) {
                Ok(()) => {
                    group.state.read(lane, state);
                    group.lanes.forget(lane, mechanics, state);
                }
                Err(error) => {
                    group.active = group.active.with(lane, false);
                    let error = MemberError::Step(error);
                    self.motion.fail(self.gathered, Failure { member: *member, steps, t: state.t, error });
                }
            }
        }
    }

    #[cold]
    fn cross(&mut self, group: &mut Group<S, F::Lanes>, crossed: LaneMask, before: &LaneState<S>) {
        for lane in crossed.lanes() {
            let Moving { member, mechanics, state } = &mut self.block[group.places[lane]].moving;
            let mut start = state.clone();
            before.write(lane, &mut start);
            group.state.write(lane, state);
            let who = (*member, &*mechanics, self.sample);
            if self.motion.show_crossing(who, [&start, &*state], self.gathered).is_break() {
                group.active = group.active.with(lane, false);
            }
        }
    }
}

/// Overwrites `state` with the next one, by a map that has no past.
fn stepped_alone<S: MechanicalSystem>(
    scheme: &impl LaneScheme<S>,
    mechanics: &Mechanics<S>,
    state: &mut State<S>,
) -> Result<(), StepError> {
    // A member that could start has a map.
    let Ok(mut map) = scheme.prepare(mechanics.clone()) else {
        return Err(StepError::NotFinite { t: state.t });
    };
    map.advance(state, &mut ())
}
