//! The names of scenes are those of their files, and no scene is forgotten.

use std::collections::BTreeSet;

use evi_examples::{Scene, Visitor, visit_all};

/// Files of the gallery that are no scene: what scenes have in common.
const SHARED: [&str; 3] = ["chain", "lib", "scene"];

struct Names(Vec<(&'static str, &'static str)>);

impl Visitor for Names {
    fn visit<S: Scene>(&mut self) {
        self.0.push((S::NAME, S::REPORT.name));
        for text in [S::SUMMARY, S::ORIGIN] {
            assert!(text.len() > 20, "{} has something to say: {text}", S::NAME);
        }
    }
}

fn names() -> Vec<(&'static str, &'static str)> {
    let mut names = Names(Vec::new());
    visit_all(&mut names);
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
    let visited: BTreeSet<String> = names().iter().map(|(name, _)| (*name).to_owned()).collect();
    assert_eq!(visited, files);
}

#[test]
fn are_sorted_and_those_of_the_structs_in_snake_case() {
    let names = names();
    assert!(names.windows(2).all(|pair| pair[0].0 < pair[1].0), "{names:?}");
    for (name, of_struct) in names {
        assert!(name.chars().all(|letter| matches!(letter, 'a'..='z' | '0'..='9' | '_')), "{name}");
        assert_eq!(name.replace('_', ""), of_struct.to_lowercase());
    }
}
