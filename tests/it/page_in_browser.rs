//! The page in a browser: its sources pass their own checks, and its tests in `tests/page` pass, with Chromium and Firefox.
//!
//! The packages that these need are installed below `target/page`, once for each set of pins. As that needs the network, `cargo
//! test` leaves these tests out and `cargo test -- --include-ignored` runs them.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::crosscheck::{home, install_once, must_succeed, run, transcript};

const BROWSERS: &str = "On Debian: apt-get install chromium firefox-esr xvfb libgl1-mesa-dri.";

#[test]
#[ignore = "installs Node packages from the network: cargo test -- --include-ignored"]
fn sources_are_typed_formatted_and_bundled() {
    // A copy: what is installed stays out of the sources.
    let copy = home("page").join("sources");
    copy_files(&root().join("src/page"), &copy);
    install(&copy);
    let output = run(Command::new("npm")
        .args(["run", "--silent", "check"])
        .current_dir(&copy))
    .expect("npm is there: it installed the packages");
    assert!(
        output.status.success(),
        "`npm run check` in src/page failed\n{}",
        transcript(&output)
    );
}

#[test]
#[ignore = "installs Node packages from the network, needs Chromium and Firefox: cargo test -- --include-ignored"]
fn tests_of_the_page_pass() {
    for browser in ["chromium", "firefox-esr"] {
        let found = run(Command::new(browser).arg("--version"));
        assert!(
            found.is_ok_and(|output| output.status.success()),
            "the tests of the page need `{browser}`. {BROWSERS}"
        );
    }
    let tests = root().join("tests/page");
    let packages = home("page").join("tests");
    fs::create_dir_all(&packages).expect("the target directory is writable");
    for name in ["package.json", "package-lock.json"] {
        fs::copy(tests.join(name), packages.join(name)).expect("the target directory is writable");
    }
    install(&packages);
    let mut files = files_in(&tests);
    files.retain(|path| path.to_string_lossy().ends_with(".test.mjs"));
    files.sort();
    assert!(!files.is_empty(), "no tests in {}", tests.display());
    let output = run(Command::new("node")
        .args(["--test", "--test-concurrency=1"])
        .args(&files)
        .env("PHOTOSURFACE_BINARY", env!("CARGO_BIN_EXE_photosurface"))
        .env("PHOTOSURFACE_PAGE_TESTS", &packages))
    .expect("node is there: npm is a program of it");
    let transcript = transcript(&output);
    assert!(
        output.status.success(),
        "tests of the page failed\n{transcript}"
    );
    assert!(
        transcript.contains("# skipped 0") || transcript.contains("skipped 0"),
        "skipped\n{transcript}"
    );
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Installs what the lock file in `folder` pins.
fn install(folder: &Path) {
    let pins = ["package.json", "package-lock.json"]
        .map(|name| fs::read_to_string(folder.join(name)).expect("the pins are there"));
    install_once(
        &folder.join("node_modules.installed"),
        &pins.concat(),
        || {
            // esbuild and biome bring their programs as packages of their own: no script has to run.
            must_succeed(
                Command::new("npm")
                    .args(["ci", "--ignore-scripts", "--no-audit", "--no-fund"])
                    .current_dir(folder),
                "It needs Node.js from version 20 with npm, and the network, for registry.npmjs.org.",
            );
        },
    );
}

/// The files and folders of a folder.
fn files_in(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(folder)
        .expect("the folder is there")
        .map(|entry| entry.expect("the folder can be listed").path())
        .collect()
}

/// Copies the sources; files of an earlier copy that are no sources any more are removed, what was installed stays.
fn copy_files(from: &Path, to: &Path) {
    const INSTALLED: [&str; 2] = ["node_modules", "node_modules.installed"];
    fs::create_dir_all(to).expect("the target directory is writable");
    for old in files_in(to) {
        let name = old.file_name().expect("an entry of a folder has a name");
        if INSTALLED.iter().all(|installed| name != *installed) {
            let removed = if old.is_dir() {
                fs::remove_dir_all(&old)
            } else {
                fs::remove_file(&old)
            };
            removed.expect("a copy can be removed");
        }
    }
    for source in files_in(from) {
        let name = source.file_name().expect("an entry of a folder has a name");
        if name == "node_modules" {
            continue;
        }
        if source.is_dir() {
            copy_files(&source, &to.join(name));
        } else {
            fs::copy(&source, to.join(name)).expect("the target directory is writable");
        }
    }
}
