//! One row after the other, each on a thread of its own: none brings the program down, none keeps it for ever.

use std::panic;
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use evi_benches::program::STACK_BYTES;
use evi_benches::program::progress::{self, Ending, Interruption};

use crate::rows::{Finding, Planned, Row};

/// A row that takes longer has a step that does not end. All else is bounded by steps; on an idle machine the longest row takes 25 s, so that no load
/// makes it a hang.
const HANG: Duration = Duration::from_secs(3600);

/// The rows that are finished, and whether these are all.
pub(crate) fn run(planned: Vec<Planned>) -> Result<(Vec<Row>, Ending), ctrlc::Error> {
    let interruption = Interruption::listen()?;
    let bar = progress::bar(planned.len() as u64);
    // A panic is a fault of its row, and told there.
    panic::set_hook(Box::new(|_| ()));
    let mut rows = Vec::with_capacity(planned.len());
    for Planned { case, parameter, method, work } in planned {
        bar.set_message(format!("{case}: {parameter}, {method}"));
        let clock = Instant::now();
        let finding = guarded(work);
        if interruption.is_wanted() {
            bar.abandon_with_message("interrupted; what is finished is kept");
            drop(panic::take_hook());
            return Ok((rows, Ending::Interrupted));
        }
        rows.push(Row { case, parameter, method, finding, seconds: clock.elapsed().as_secs_f64() });
        bar.inc(1);
    }
    bar.finish_and_clear();
    drop(panic::take_hook());
    Ok((rows, Ending::Complete))
}

fn guarded(work: Box<dyn FnOnce() -> Finding + Send>) -> Finding {
    let (sender, receiver) = mpsc::channel();
    let worker = move || {
        // Without a receiver the row has been given up.
        let _ = sender.send(work());
    };
    let thread = match thread::Builder::new().stack_size(STACK_BYTES).spawn(worker) {
        Ok(thread) => thread,
        Err(error) => return Finding::broken(format!("no thread: {error}")),
    };
    match receiver.recv_timeout(HANG) {
        Ok(finding) => finding,
        Err(RecvTimeoutError::Timeout) => {
            Finding::broken(format!("hangs: no end after {} s", HANG.as_secs()))
        }
        Err(RecvTimeoutError::Disconnected) => {
            let payload = thread.join().err();
            let text = payload.as_ref().and_then(|payload| {
                payload
                    .downcast_ref::<&str>()
                    .copied()
                    .or(payload.downcast_ref::<String>().map(String::as_str))
            });
            Finding::broken(format!("panics: {}", text.unwrap_or("without a message")))
        }
    }
}
