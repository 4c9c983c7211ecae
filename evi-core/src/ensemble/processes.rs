//! Ensembles on several processes, by the Message Passing Interface.
//!
//! Process `r` of `n` moves the chunks `r, r + n, r + 2n, ..`; the first process puts all of them together, by the same tree as threads do: sums are
//! the same to the last bit on any number of processes.

use core::ops::ControlFlow;
use std::sync::Mutex;

use ::mpi::traits::{Communicator, Destination, Source};

use super::chunk::Gathered;
use super::failure::Failures;
use super::gather::Gather;
use super::lane_map::LaneScheme;
use super::members::Members;
use super::run::{Ensemble, EnsembleError, Outcome, for_each};
use super::section::Section;
use super::tree::Tree;
use crate::memory::{Memory, Recall, Record};
use crate::system::MechanicalSystem;

impl<F, X> Ensemble<F, X> {
    /// Moves all members to their ends on all processes of `world`; every process makes this call. The first process gets the outcome, the
    /// others `None`. Failures of members of other processes are [`Noted`](super::MemberError::Noted).
    ///
    /// # Errors
    /// [`EnsembleError::Threads`].
    pub fn run_on_processes<S, G>(
        &self,
        world: &impl Communicator,
        members: &impl Members<S>,
        gather: &G,
    ) -> Result<Option<Outcome<G::Part>>, EnsembleError>
    where
        S: MechanicalSystem,
        F: LaneScheme<S> + Sync,
        X: Section<S>,
        G: Gather<S>,
    {
        let count = members.count();
        let chunks = self.chunks(count);
        let (rank, size) = (world.rank() as usize, world.size() as usize);
        let own: Vec<usize> = (rank..chunks).step_by(size).collect();
        let motion = self.motion(gather);
        let moved = Mutex::new(Vec::new());
        for_each(&own, self.wanted_threads(), &|chunk| {
            let gathered = motion.integrate(members, self.range(chunk, count));
            moved.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((chunk, gathered));
            ControlFlow::Continue(())
        })?;
        let mut moved = moved.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        moved.sort_by_key(|(chunk, _)| *chunk);
        if rank > 0 {
            for (_, gathered) in &moved {
                let mut words: Vec<u64> = Vec::new();
                gathered.record(&mut Record::to(&mut |word| words.push(word)));
                world.process_at_rank(0).send(&words[..]);
            }
            return Ok(None);
        }
        let blank = || Gathered { part: gather.blank(), failures: Failures::default() };
        let mut tree = Tree::new(chunks);
        for (chunk, gathered) in moved {
            tree.put(chunk, gathered);
        }
        for sender in 1..size {
            // Messages of one process arrive in the order in which they were sent.
            for chunk in (sender..chunks).step_by(size) {
                let (words, _) = world.process_at_rank(sender as i32).receive_vec::<u64>();
                let mut words = words.into_iter();
                let mut gathered = blank();
                gathered.recall(&mut Recall::from(&mut || words.next().unwrap_or_default()));
                tree.put(chunk, gathered);
            }
        }
        let Gathered { part, failures } = tree.total().unwrap_or_else(blank);
        Ok(Some(Outcome { gathered: part, failures: failures.0, finished: count, members: count }))
    }
}

#[cfg(test)]
mod tests {
    use crate::ensemble::{ByIndex, Ensemble, Member, Quantity, Summaries};
    use crate::memory::{Digest, Memory, Record};
    use crate::prelude::*;

    #[derive(MechanicalSystem)]
    #[evi(
        coordinates(x, y),
        kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
        potential = m * g * y,
        constraint(rod: x.powi(2) + y.powi(2) == 1.0),
    )]
    struct Pendulum {
        m: f64,
        g: f64,
    }

    /// Each number of processes compares with one by itself, and prints the same digest: `mpirun -n 4` before the test program.
    #[test]
    fn every_number_of_processes_has_one_digest() {
        let universe = mpi::initialize().expect("MPI");
        let members = ByIndex::new(500, |index| {
            let angle = 0.002 * index as f64;
            Member::of(&Pendulum { m: 1.0 + angle, g: 9.81 }, [angle.sin(), -angle.cos()], [0.0; 2])
        });
        let height = Quantity::<Pendulum>::new("height", |sight| sight.state.q()[1]).histogram(-1.0, 0.0, 7);
        let gather = Summaries::new(3, vec![height]);
        let ensemble = Ensemble::new(Evi::midpoint(0.05)).sampled(3, 20).chunks_of(32).threads(1);
        let alone = ensemble.run(&members, &gather).expect("a run").gathered;
        let outcome = ensemble.run_on_processes(&universe.world(), &members, &gather).expect("a run");
        let Some(outcome) = outcome else { return };
        assert!(outcome.is_complete() && outcome.failures.is_empty());
        assert_eq!(outcome.gathered, alone);
        let mut digest = Digest::default();
        outcome.gathered.record(&mut Record::to(&mut |word| digest.add(word)));
        println!("{:x}", digest.value());
    }
}
