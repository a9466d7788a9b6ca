//! The corpus of the fuzz targets through the same functions, without libFuzzer: what once went wrong stays mended.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use crate::common::alone::alone;

#[allow(
    dead_code,
    unreachable_pub,
    unused_imports,
    reason = "a library of its own to the fuzz targets, which use the rest"
)]
#[path = "../fuzz/src/targets/mod.rs"]
mod targets;

/// The longest that one input may take: most take a few milliseconds.
const LIMIT: Duration = Duration::from_secs(20);

/// Alone, and one after the other, so that the memory that one takes can be told.
#[test]
fn every_input_of_the_corpus_ends_well_in_its_time_and_memory() {
    alone(
        "fuzz_corpus::every_input_of_the_corpus_ends_well_in_its_time_and_memory",
        run_the_corpus,
    );
}

fn run_the_corpus() {
    let mut wrong = vec![];
    for (name, target) in targets::TARGETS {
        let files = corpus(name);
        assert!(files.len() >= 10, "{name}: the corpus is not all there");
        for file in files {
            let bytes = fs::read(&file).expect("the corpus can be read");
            // The peak starts anew (proc(5)), where the system lets it.
            let _ = fs::write("/proc/self/clear_refs", "5");
            let before = peak_memory();
            let (done, ended) = mpsc::channel();
            thread::spawn(move || {
                let result = catch_unwind(AssertUnwindSafe(|| target(&bytes)));
                // Nobody waits any more where it took too long.
                let _ = done.send(result.is_ok());
            });
            let file = file.display();
            match ended.recv_timeout(LIMIT) {
                Ok(true) => {}
                Ok(false) => wrong.push(format!("{file} panics")),
                // It goes on in the background: nothing more can be told of others.
                Err(_) => panic!("{file} takes more than {LIMIT:?}; {wrong:?} before"),
            }
            let taken = peak_memory().zip(before);
            let taken = taken.map_or(0, |(after, before)| after.saturating_sub(before));
            if taken > targets::MEMORY {
                wrong.push(format!("{file} takes {taken} bytes"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

fn corpus(target: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus");
    let mut files: Vec<_> = fs::read_dir(folder.join(target))
        .expect("each target has a corpus")
        .map(|entry| entry.expect("the corpus can be listed").path())
        .collect();
    files.sort();
    files
}

/// The most memory that the process has had so far, in bytes, where the system tells.
fn peak_memory() -> Option<usize> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let peak = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: usize = peak.split_whitespace().next()?.parse().ok()?;
    Some(1024 * kibibytes)
}
