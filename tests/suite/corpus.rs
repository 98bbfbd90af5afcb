//! What the fuzzers kept: every input of the corpus, and every one that once broke something.

use std::path::Path;

#[path = "../../fuzz/src/lib.rs"]
#[expect(unreachable_pub, reason = "a library of its own, for the fuzzers")]
mod checks;

fn replay(name: &str, check: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(name);
    let mut paths: Vec<_> =
        std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    assert!(!paths.is_empty(), "{} is empty", folder.display());
    for path in paths {
        let bytes = std::fs::read(&path).unwrap();
        let held = std::panic::catch_unwind(|| check(&bytes));
        assert!(held.is_ok(), "{}: see the panic above", path.display());
    }
}

#[test]
fn scene_files_of_the_corpus_hold() {
    replay("scene_file", checks::scene_file);
}

#[test]
fn meshes_of_the_corpus_hold() {
    replay("mesh", checks::mesh);
}

#[test]
fn snapshots_of_the_corpus_hold() {
    replay("snapshot", checks::snapshot);
}

#[test]
fn pictures_of_the_corpus_hold() {
    replay("scene_render", checks::scene_render);
}

#[test]
fn accelerators_hold_on_the_corpus() {
    replay("accelerators", checks::accelerators);
}
