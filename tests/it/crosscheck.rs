//! The cross-check: programs that nobody here wrote judge the files that the binary writes.
//!
//! trimesh, pyvista and three.js read them, the Khronos validator validates them, and an oracle in mpmath
//! that shares no code with the crate says where every vertex has to be; the questions are in
//! `tests/crosscheck/*.py`. Blender and MeshLab, which are large and want certain system libraries, are
//! asked by `tests/crosscheck/full/*.py`.
//!
//! This file only makes the environments they run in, below `target/crosscheck` and
//! `target/crosscheck-full`, and runs them. Nothing is installed anywhere else, and nothing at all while the
//! pins stay the same. As installing needs the network, `cargo test` leaves these tests out and
//! `cargo test -- --include-ignored` runs them.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const PACKAGE: &str = include_str!("../crosscheck/package.json");
const PACKAGE_LOCK: &str = include_str!("../crosscheck/package-lock.json");

#[test]
#[ignore = "installs Python and Node packages from the network: cargo test -- --include-ignored"]
fn programs_nobody_here_wrote_agree() {
    let home = home("crosscheck");
    let python = virtual_environment(
        &home,
        &questions().join("requirements.txt"),
        "sys.version_info >= (3, 11)",
    );
    let node_modules = node_modules(&home);
    ask(
        &questions(),
        &home,
        Command::new(python).env("NODE_PATH", node_modules),
    );
}

#[test]
#[ignore = "installs Blender and MeshLab from the network: cargo test -- --include-ignored"]
fn blender_and_meshlab_agree() {
    let home = home("crosscheck-full");
    let questions = questions().join("full");
    let python = virtual_environment(
        &home,
        &questions.join("requirements.txt"),
        // Blender as a module exists for one version of Python.
        "sys.version_info[:2] == (3, 11)",
    );
    ask(
        &questions,
        &home,
        // No start-up file and no add-on of whoever runs this.
        Command::new(python).env("BLENDER_USER_RESOURCES", home.join("blender")),
    );
}

/// A directory of this name inside cargo's target directory.
pub(crate) fn home(name: &str) -> PathBuf {
    let home = Path::new(env!("CARGO_TARGET_TMPDIR"))
        .parent()
        .expect("cargo's directory for temporary files is inside its target directory")
        .join(name);
    fs::create_dir_all(&home).expect("the target directory is writable");
    home
}

/// The directory of the Python tests and the pins.
fn questions() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/crosscheck")
}

/// Runs the Python tests in `questions` with this interpreter; there have to be some, and all have to pass.
fn ask(questions: &Path, home: &Path, python: &mut Command) {
    let results = home.join("results.xml");
    let _ = fs::remove_file(&results); // absent on the first run
    let output = run(python
        .args(["-m", "pytest", "-ra", "--durations=10", "--color=no"])
        .args(["-p", "no:cacheprovider"])
        // What all questions share is in one conftest.py.
        .arg("--rootdir")
        .arg(self::questions())
        .arg("--junit-xml")
        .arg(&results)
        .arg(questions)
        .current_dir(questions)
        .env("PHOTOSURFACE_BINARY", env!("CARGO_BIN_EXE_photosurface"))
        .env("PYTHONDONTWRITEBYTECODE", "1"))
    .expect("the interpreter is there: it installed the packages");
    let transcript = transcript(&output);
    assert!(
        output.status.success(),
        "the cross-check failed\n{transcript}"
    );

    let results = fs::read_to_string(&results).expect("pytest writes its results");
    assert!(count(&results, "tests") > 0, "no test ran\n{transcript}");
    assert_eq!(count(&results, "skipped"), 0, "skipped\n{transcript}");
}

/// The Python interpreter of a virtual environment with everything that `requirements` pins.
///
/// It is made by a Python of which the expression `suitable` is true.
fn virtual_environment(home: &Path, requirements: &Path, suitable: &str) -> PathBuf {
    let directory = home.join("venv");
    let interpreter = directory.join("bin/python");
    let (python, version) = find_python(suitable);
    let pins = fs::read_to_string(requirements).expect("the pins are beside the questions");
    let pins = format!("{version}\n{pins}");
    install_once(&home.join("venv.installed"), &pins, || {
        remove_directory(&directory);
        must_succeed(
            Command::new(python).args(["-m", "venv"]).arg(&directory),
            "It needs Python's venv and ensurepip; on Debian and Ubuntu: apt-get install python3-venv.",
        );
        must_succeed(
            Command::new(&interpreter)
                .args(["-m", "pip", "install", "--disable-pip-version-check"])
                .args(["--only-binary", ":all:", "--requirement"])
                .arg(requirements),
            "It needs the network, for pypi.org, and a Python for which these packages have wheels (3.11).",
        );
    });
    interpreter
}

/// The first Python of which the expression `suitable` is true, and its version.
fn find_python(suitable: &str) -> (&'static str, String) {
    let question = format!("import sys; print(sys.version); sys.exit(not ({suitable}))");
    for python in ["python3.11", "python3"] {
        if let Ok(output) = Command::new(python).args(["-c", &question]).output()
            && output.status.success()
        {
            let version = String::from_utf8_lossy(&output.stdout).trim().to_owned();
            return (python, version);
        }
    }
    panic!("the cross-check needs Python, as `python3.11` or `python3`, with {suitable}");
}

/// A `node_modules` directory with everything in `package-lock.json`.
fn node_modules(home: &Path) -> PathBuf {
    let directory = home.join("node_modules");
    let pins = format!("{PACKAGE}\n{PACKAGE_LOCK}");
    install_once(&home.join("node_modules.installed"), &pins, || {
        fs::write(home.join("package.json"), PACKAGE).expect("the target directory is writable");
        fs::write(home.join("package-lock.json"), PACKAGE_LOCK)
            .expect("the target directory is writable");
        must_succeed(
            Command::new("npm")
                .args(["ci", "--ignore-scripts", "--no-audit", "--no-fund"])
                .current_dir(home),
            "It needs Node.js with npm, and the network, for registry.npmjs.org.",
        );
    });
    directory
}

/// Runs `install` unless it has succeeded before with the same pins.
pub(crate) fn install_once(stamp: &Path, pins: &str, install: impl FnOnce()) {
    if fs::read_to_string(stamp).is_ok_and(|installed| installed == pins) {
        return;
    }
    // Gone first: an installation that fails half way must not pass for the one before it.
    let _ = fs::remove_file(stamp); // absent on the first run
    install();
    fs::write(stamp, pins).expect("the target directory is writable");
}

fn remove_directory(directory: &Path) {
    if directory.exists() {
        fs::remove_dir_all(directory).expect("what an earlier run installed can be removed");
    }
}

pub(crate) fn must_succeed(command: &mut Command, needs: &str) {
    let failure = match run(command) {
        Ok(output) if output.status.success() => return,
        Ok(output) => transcript(&output),
        Err(error) => error.to_string(),
    };
    panic!("what the tests need could not be installed: {command:?} failed. {needs}\n{failure}");
}

/// Runs a command without what in the caller's environment would change the meaning of a test.
pub(crate) fn run(command: &mut Command) -> io::Result<Output> {
    command
        .env_remove("PYTHONPATH")
        .env_remove("PYTHONHOME")
        .env_remove("PYTEST_ADDOPTS")
        .env_remove("PYTEST_PLUGINS")
        .output()
}

pub(crate) fn transcript(output: &Output) -> String {
    format!(
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    )
}

/// The number in the attribute `name` of the test suite in pytest's JUnit file.
fn count(results: &str, name: &str) -> usize {
    results
        .split_once("<testsuite ")
        .and_then(|(_, suite)| suite.split_once(&format!(" {name}=\"")))
        .and_then(|(_, rest)| rest.split_once('"'))
        .and_then(|(number, _)| number.parse().ok())
        .unwrap_or_else(|| panic!("pytest's results have no number of {name}:\n{results}"))
}
