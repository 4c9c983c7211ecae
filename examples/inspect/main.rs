//! What does the compiler know about a scene, and what code does it write for it?
//!
//! In: the name of a scene of the gallery. Out: its report, its equations as LaTeX, or its generated code.

use std::error::Error;

use clap::Parser;

use evi_core::prelude::*;
use evi_core::report::SystemReport;
use evi_examples::{
    AndrewsSqueezer, CarAxis, DoublePendulum, DrivenPendulum, FermiPastaUlam, HarmonicOscillator,
    KapitzaPendulum, Pendulum, SphericalPendulum, StiffSpringPendulum,
};

/// Equations, structure and generated code of a scene of the gallery.
#[derive(Parser)]
struct Options {
    /// Name of the scene, such as double_pendulum.
    #[arg(required_unless_present = "list")]
    scene: Option<String>,
    /// Lists the scenes.
    #[arg(long)]
    list: bool,
    /// Prints the equations as LaTeX.
    #[arg(long, conflicts_with = "code")]
    latex: bool,
    /// Prints the generated code.
    #[arg(long)]
    code: bool,
}

/// What stands before every name of evi-core in generated code.
const PATH_OF_NAMES: &str = "::evi_core::__private::";

/// A scene to look into.
struct Scene {
    report: SystemReport,
    source: Option<&'static str>,
}

const SCENES: [Scene; 10] = [
    Scene::of::<AndrewsSqueezer>(),
    Scene::of::<CarAxis>(),
    Scene::of::<DoublePendulum>(),
    Scene::of::<DrivenPendulum>(),
    Scene::of::<FermiPastaUlam>(),
    Scene::of::<HarmonicOscillator>(),
    Scene::of::<KapitzaPendulum>(),
    Scene::of::<Pendulum>(),
    Scene::of::<SphericalPendulum>(),
    Scene::of::<StiffSpringPendulum>(),
];

impl Scene {
    const fn of<S: MechanicalSystem>() -> Self {
        Self { report: S::REPORT, source: S::SOURCE }
    }

    /// The struct's name in snake case.
    fn name(&self) -> String {
        let mut name = String::new();
        for letter in self.report.name.chars() {
            if letter.is_uppercase() && !name.is_empty() {
                name.push('_');
            }
            name.extend(letter.to_lowercase());
        }
        name
    }

    /// The generated code, formatted, without the path that every name of evi-core has in it.
    fn code(&self) -> Result<String, Box<dyn Error>> {
        let source = self.source.ok_or("the generated code is kept with the feature `source` of evi-core")?;
        let formatted = prettyplease::unparse(&syn::parse_file(source)?);
        // Again, for lines that are shorter now.
        Ok(prettyplease::unparse(&syn::parse_file(&formatted.replace(PATH_OF_NAMES, ""))?))
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse();
    if options.list {
        for scene in &SCENES {
            println!("{}", scene.name());
        }
        return Ok(());
    }
    let wanted = options.scene.unwrap_or_default();
    let Some(scene) = SCENES.iter().find(|scene| scene.name() == wanted) else {
        let names: Vec<String> = SCENES.iter().map(Scene::name).collect();
        eprintln!("error: the gallery has no scene `{wanted}`\n       scenes: {}", names.join(", "));
        std::process::exit(2);
    };
    if options.code {
        print!("{}", scene.code()?);
    } else if options.latex {
        print!("{}", scene.report.latex());
    } else {
        print!("{}", scene.report);
    }
    Ok(())
}
