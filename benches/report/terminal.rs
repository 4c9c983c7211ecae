//! The results on the terminal.

use crate::results::Results;
use crate::verdicts::{ERRORS, duration};

/// For each scene the time of every method to each accuracy, its order, and the verdict.
pub(crate) fn print(results: &Results) {
    println!("{}", results.machine.line());
    for scene in &results.scenes {
        println!("\n{}\n{:<20}", "─".repeat(72), scene.name);
        print!("{:<18} {:>6}", "time to error", "order");
        ERRORS.iter().for_each(|error| print!(" {error:>8.0e}"));
        println!();
        let verdict = results.verdicts.iter().find(|verdict| verdict.scene == scene.name);
        for method in &results.methods {
            let rows =
                || results.rows.iter().filter(|row| row.scene == scene.name && row.method == method.name);
            let order =
                results.orders.iter().find(|fit| fit.scene == scene.name && fit.method == method.name);
            print!(
                "{:<18} {:>6}",
                method.name,
                order.map_or(String::new(), |fit| format!("{:.2}", fit.order))
            );
            let times =
                verdict.and_then(|verdict| verdict.seconds.iter().find(|times| times.0 == method.name));
            let smallest = rows().filter_map(|row| row.position_error).min_by(f64::total_cmp);
            match (times, smallest, rows().next()) {
                (Some((_, times)), ..) => {
                    times.iter().for_each(|time| print!(" {:>8}", time.map_or("–".into(), duration)));
                    println!();
                }
                (None, Some(smallest), _) => println!("  the smallest error is {smallest:.0e}"),
                (None, None, Some(row)) => println!("  {}", row.status),
                (None, None, None) => println!("  not measured yet"),
            }
        }
        for speedup in results.speedups.iter().filter(|speedup| speedup.scene == scene.name) {
            print!(
                "{} specialised against generic: {:.0} times as fast",
                speedup.method,
                speedup.generic_ns / speedup.specialised_ns
            );
            match speedup.generic_instructions.zip(speedup.specialised_instructions) {
                Some((generic, specialised)) => {
                    println!(", 1/{:.0} of the instructions", generic / specialised)
                }
                None => println!(" (instructions not counted)"),
            }
        }
        if let Some(verdict) = verdict {
            println!("{}", verdict.sentence);
        }
    }
}
