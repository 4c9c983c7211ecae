//! A derived pendulum, integrated without the standard library.
//!
//! A library on the host would compile even if evi-core linked `std`, since the host has it. This one brings
//! its own panic handler, which clashes with the one of `std`.

#![no_std]
#![forbid(unsafe_code)]

#[cfg(feature = "linked-std")]
extern crate std;

use evi_core::prelude::*;

/// Plane pendulum in Cartesian coordinates, y upwards.
#[derive(MechanicalSystem)]
#[evi(
    coordinates(x, y),
    kinetic = 0.5 * m * (der(x).powi(2) + der(y).powi(2)),
    potential = m * g * y,
    constraint(rod: x.powi(2) + y.powi(2) == l.powi(2)),
)]
struct Pendulum {
    m: f64,
    l: f64,
    g: f64,
}

/// Keeps the function in the library: exporting its name would take an unsafe attribute.
#[used]
static ENTRY: extern "C" fn(f64, f64) -> f64 = energy_after_100_steps;

/// Energy after 100 steps from the horizontal, where it is 0; NaN if a step failed.
extern "C" fn energy_after_100_steps(h: f64, frequency: f64) -> f64 {
    let scheme = Evi::simpson(h).frequency(frequency);
    let pendulum = Pendulum { m: 1.0, l: 1.0, g: 9.81 };
    let Ok(mut run) = Simulation::new(pendulum, scheme).start([1.0, 0.0], [0.0; 2]) else {
        return f64::NAN;
    };
    for _ in 0..100 {
        if run.advance().is_err() {
            return f64::NAN;
        }
    }
    run.energy()
}

#[panic_handler]
fn halt(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
