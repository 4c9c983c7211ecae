//! What does the compiler know about a scene, and what code does it write for it?
//!
//! In: the name of a scene of the gallery. Out: its report, its equations as LaTeX, or its generated code.

use std::error::Error;

use clap::Parser;

use evi_core::assembled::{Family, FamilyVisitor};
use evi_core::system::MechanicalSystem;
use evi_examples::{LoopScene, LoopVisitor, Scene, Visitor, visit_all, visit_loops};

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
struct Entry {
    name: &'static str,
    summary: &'static str,
    report: String,
    latex: String,
    /// The generated code; of a scene of many bodies that of its elements.
    sources: Vec<&'static str>,
}

/// The scenes of the gallery.
#[derive(Default)]
struct Entries(Vec<Entry>);

impl Visitor for Entries {
    fn visit<S: Scene>(&mut self) {
        self.0.push(Entry {
            name: S::NAME,
            summary: S::SUMMARY,
            report: S::REPORT.to_string(),
            latex: S::REPORT.latex().to_string(),
            sources: S::SOURCE.into_iter().collect(),
        });
    }
}

impl LoopVisitor for Entries {
    fn visit<S: LoopScene>(&mut self) {
        let mut elements = Elements::default();
        S::standard().0.visit_families(&mut elements);
        self.0.push(Entry {
            name: S::NAME,
            summary: S::SUMMARY,
            report: S::REPORT.to_string(),
            latex: S::REPORT.latex().to_string(),
            sources: elements.0,
        });
    }
}

/// The generated code of the elements of a scene, each once.
#[derive(Default)]
struct Elements(Vec<&'static str>);

impl<S> FamilyVisitor<S> for Elements {
    fn family<F: Family<S>>(&mut self) {
        self.0.extend(F::Element::SOURCE.filter(|source| !self.0.contains(source)));
    }
}

impl Entry {
    /// The generated code, formatted, without the path that every name of evi-core has in it.
    fn code(&self) -> Result<String, Box<dyn Error>> {
        if self.sources.is_empty() {
            return Err("the generated code is kept with the feature `source` of evi-core".into());
        }
        let source = &self.sources.concat();
        let formatted = prettyplease::unparse(&syn::parse_file(source)?);
        // Again, for lines that are shorter now.
        Ok(prettyplease::unparse(&syn::parse_file(&formatted.replace(PATH_OF_NAMES, ""))?))
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = Options::parse();
    let mut entries = Entries::default();
    visit_all(&mut entries);
    visit_loops(&mut entries);
    let Entries(mut entries) = entries;
    entries.sort_by_key(|entry| entry.name);
    if options.list {
        for Entry { name, summary, .. } in &entries {
            println!("{name:<24}{summary}");
        }
        return Ok(());
    }
    let wanted = options.scene.unwrap_or_default();
    let Some(scene) = entries.iter().find(|entry| entry.name == wanted) else {
        let names: Vec<&str> = entries.iter().map(|entry| entry.name).collect();
        eprintln!("error: the gallery has no scene `{wanted}`\n       scenes: {}", names.join(", "));
        std::process::exit(2);
    };
    if options.code {
        print!("{}", scene.code()?);
    } else if options.latex {
        print!("{}", scene.latex);
    } else {
        print!("{}", scene.report);
    }
    Ok(())
}
