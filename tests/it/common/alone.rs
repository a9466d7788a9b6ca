//! A process of its own for a test that measures or changes the process it runs in.

use std::env;
use std::process::Command;

/// Set for the process that runs one test alone, to the name of that test.
const ALONE: &str = "PHOTOSURFACE_TEST_ALONE";

/// Runs `test`, the body of the test `name`, in a process in which no other test runs.
///
/// The first call starts this program again for that one test, where `alone` is called anew and runs the body.
/// `name` is the whole path of the test, as `cargo test` prints it.
#[track_caller]
pub(crate) fn alone(name: &str, test: impl FnOnce()) {
    if env::var_os(ALONE).is_some_and(|alone| alone == name) {
        return test();
    }
    let program = env::current_exe().expect("the system knows what it runs");
    let output = Command::new(program)
        .args(["--exact", name, "--include-ignored", "--nocapture"])
        .env(ALONE, name)
        .output()
        .expect("the program that runs can be started");
    let stdout = String::from_utf8_lossy(&output.stdout);
    let stderr = String::from_utf8_lossy(&output.stderr);
    // Where no test has the name, none fails.
    let passed = output.status.success() && stdout.contains("test result: ok. 1 passed");
    assert!(passed, "{name}, in a process of its own:\n{stdout}{stderr}");
}

/// The most memory that this process has had, in bytes.
#[cfg(target_os = "linux")]
pub(crate) fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("a system like Linux");
    let line = status.lines().find(|line| line.starts_with("VmHWM:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().nth(1));
    let kilobytes = kilobytes.and_then(|number| number.parse::<u64>().ok());
    1000 * kilobytes.expect("a number of kilobytes")
}
