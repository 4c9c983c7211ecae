//! The scenes, one a file: a description as short for 10,000 bodies as for two.

pub(crate) mod chain;
mod four_bar;
mod net;
mod ring;
mod tree;

use crate::specimen::Row;

/// Every scene by every method, the largest last.
pub(crate) fn rows() -> Vec<Row> {
    let chains = [
        chain::links_2::specimen().rows(),
        chain::links_5::specimen().rows(),
        chain::links_20::specimen().rows(),
        chain::links_100::specimen().rows(),
        chain::links_1_000::specimen().rows(),
    ];
    let others = [
        four_bar::specimen().rows(),
        ring::specimen().rows(),
        tree::specimen().rows(),
        net::specimen().rows(),
        chain::links_10_000::specimen().rows(),
    ];
    chains.into_iter().chain(others).flatten().collect()
}
