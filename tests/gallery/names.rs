//! The names of scenes are those of their files, and no scene is forgotten.

use std::collections::BTreeSet;

use evi_examples::{LoopScene, LoopVisitor, Scene, Visitor, visit_all, visit_loops};

/// Files of the gallery that are no scene: what scenes have in common.
const SHARED: [&str; 4] = ["chain", "lib", "loops", "scene"];

struct Names(Vec<(&'static str, &'static str)>);

impl Visitor for Names {
    fn visit<S: Scene>(&mut self) {
        self.0.push((S::NAME, S::REPORT.name));
        for text in [S::SUMMARY, S::ORIGIN] {
            assert!(text.len() > 20, "{} has something to say: {text}", S::NAME);
        }
    }
}

impl LoopVisitor for Names {
    fn visit<S: LoopScene>(&mut self) {
        self.0.push((S::NAME, S::REPORT.name));
        assert!(S::SUMMARY.len() > 20, "{} has something to say: {}", S::NAME, S::SUMMARY);
    }
}

fn names() -> Vec<(&'static str, &'static str)> {
    let mut names = Names(Vec::new());
    visit_all(&mut names);
    names.0
}

fn names_of_loops() -> Vec<(&'static str, &'static str)> {
    let mut names = Names(Vec::new());
    visit_loops(&mut names);
    names.0
}

#[test]
fn are_those_of_the_files() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/gallery");
    let files: BTreeSet<String> = std::fs::read_dir(folder)
        .expect("the gallery")
        .map(|entry| entry.expect("a file").path())
        .map(|path| path.file_stem().expect("a name").to_string_lossy().into_owned())
        .filter(|name| !SHARED.contains(&name.as_str()))
        .collect();
    let visited: BTreeSet<String> =
        names().iter().chain(&names_of_loops()).map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!(visited, files);
}

#[test]
fn are_sorted_and_those_of_the_structs_in_snake_case() {
    for names in [names(), names_of_loops()] {
        assert!(names.windows(2).all(|pair| pair[0].0 < pair[1].0), "{names:?}");
        for (name, of_struct) in names {
            assert!(name.chars().all(|letter| matches!(letter, 'a'..='z' | '0'..='9' | '_')), "{name}");
            assert_eq!(name.replace('_', ""), of_struct.to_lowercase());
        }
    }
}
