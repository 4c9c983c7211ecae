//! Motions to look at: an SVG file each, which a browser plays.
//!
//! `cargo run --release --example animation -- --out DIR`.

mod rope;
mod svg;
mod top;

use std::error::Error;
use std::path::PathBuf;

use clap::Parser;

/// A rope of 1,000 links and a cone that spins on its tip, as SVGs that move.
#[derive(Parser)]
struct Options {
    /// Folder for the files, made if it is missing.
    #[arg(long, value_name = "DIR", default_value = "target/animation")]
    out: PathBuf,
}

fn main() -> Result<(), Box<dyn Error>> {
    let Options { out } = Options::parse();
    std::fs::create_dir_all(&out).map_err(|error| format!("cannot create {}: {error}", out.display()))?;
    for (name, svg) in [("rope.svg", rope::animated()?), ("top.svg", top::animated()?)] {
        let path = out.join(name);
        std::fs::write(&path, svg).map_err(|error| format!("cannot write {}: {error}", path.display()))?;
        println!("wrote {}", path.display());
    }
    Ok(())
}
