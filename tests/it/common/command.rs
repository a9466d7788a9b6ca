//! Runs the binary as users do, in a directory of its own; a failure tells everything.

use std::fmt;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

use super::glb::Glb;

/// A square of two triangles.
pub(crate) const SQUARE: &str = "o square\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";

/// A scene with one sphere that takes no time.
pub(crate) const BALL: &str = r#"{ "observer": { "velocity": { "beta": 0.6, "direction": [1, 0, 0] } },
  "objects": [ { "name": "ball", "shape": { "sphere": { "radius": 1, "resolution": 8 } }, "position": [0, 3, 0] } ],
  "tolerance": { "relative": 0.1 } }"#;

/// A directory of its own to run the binary in.
pub(crate) struct Workplace {
    directory: tempfile::TempDir,
}

/// What a run of the binary gave.
pub(crate) struct Run {
    command: String,
    pub(crate) status: i32,
    pub(crate) stdout: Vec<u8>,
    pub(crate) stderr: String,
}

impl Workplace {
    pub(crate) fn new() -> Self {
        let directory = tempfile::tempdir().expect("a temporary directory can be made");
        Self { directory }
    }

    /// With [`BALL`] in `ball.json` and [`SQUARE`] in `square.obj`.
    pub(crate) fn with_ball() -> Self {
        let workplace = Self::new();
        workplace.write("ball.json", BALL);
        workplace.write("square.obj", SQUARE);
        workplace
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).expect("a temporary file can be written");
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name))
            .unwrap_or_else(|error| panic!("{name}: {error}; there are {:?}", self.files()))
    }

    pub(crate) fn read_json(&self, name: &str) -> Value {
        serde_json::from_slice(&self.read(name)).expect("JSON")
    }

    /// Names of all files, hidden ones too, in order.
    pub(crate) fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.directory.path()).expect("the directory can be read");
        let name = |entry: std::io::Result<fs::DirEntry>| entry.expect("an entry").file_name();
        let mut names: Vec<_> = entries
            .map(|e| name(e).to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }

    /// Runs `photosurface` with these arguments, separated by spaces.
    pub(crate) fn run(&self, arguments: &str) -> Run {
        self.run_with(arguments, b"", &[])
    }

    /// The same with something on stdin and in the environment.
    pub(crate) fn run_with(
        &self,
        arguments: &str,
        stdin: &[u8],
        environment: &[(&str, &str)],
    ) -> Run {
        let binary = Path::new(env!("CARGO_BIN_EXE_photosurface"));
        let mut command = Command::new(binary);
        command
            .args(arguments.split_whitespace())
            .envs(environment.iter().copied());
        self.finish(command, format!("photosurface {arguments}"), stdin)
    }

    /// Starts `photosurface` with these arguments and sends it a signal as soon as `is_time`, told the names of all
    /// files, says so; its exit status.
    pub(crate) fn interrupt(
        &self,
        arguments: &str,
        signal: &str,
        is_time: impl Fn(&[String]) -> bool,
    ) -> Option<i32> {
        let mut child = Command::new(env!("CARGO_BIN_EXE_photosurface"))
            .args(arguments.split_whitespace())
            .current_dir(self.directory.path())
            // What waits among the system's temporary files is seen here, too.
            .env("TMPDIR", self.directory.path())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program starts");
        while !is_time(&self.files()) {
            let status = child.try_wait().expect("it can be asked");
            assert_eq!(status, None, "it ended before the signal");
            std::thread::yield_now();
        }
        let pid = child.id().to_string();
        let sent = Command::new("kill").args(["-s", signal, &pid]).status();
        assert!(sent.expect("kill is there").success());
        child.wait().expect("the program ends").code()
    }

    /// Runs a line of shell in which `photosurface` is the binary.
    pub(crate) fn run_shell(&self, line: &str) -> Run {
        let binary = Path::new(env!("CARGO_BIN_EXE_photosurface"));
        let directory = binary.parent().expect("a binary is in a directory");
        let path = std::env::var("PATH").expect("PATH");
        let mut command = Command::new("sh");
        command
            .args(["-c", line])
            .env("PATH", format!("{}:{path}", directory.display()));
        self.finish(command, line.to_owned(), b"")
    }

    fn finish(&self, mut command: Command, text: String, stdin: &[u8]) -> Run {
        command.current_dir(self.directory.path());
        command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        let mut child = command.spawn().expect("the program starts");
        // A program that stops early closes its stdin: not our concern here.
        let _ = child.stdin.take().expect("a pipe").write_all(stdin);
        let Output {
            status,
            stdout,
            stderr,
        } = child.wait_with_output().expect("the program ends");
        Run {
            command: text,
            status: status.code().unwrap_or(-1),
            stdout,
            stderr: String::from_utf8_lossy(&stderr).into_owned(),
        }
    }
}

impl Run {
    /// It went well.
    #[track_caller]
    pub(crate) fn success(self) -> Self {
        assert_eq!(self.status, 0, "{self}");
        self
    }

    /// It was an error with these words in its one message, and gave nothing else.
    #[track_caller]
    pub(crate) fn error(self, words: &[&str]) -> Self {
        assert_eq!(self.status, 2, "{self}");
        assert!(self.stdout.is_empty(), "{self}");
        for word in words {
            assert!(self.stderr.contains(word), "expected \"{word}\"\n{self}");
        }
        self
    }

    /// What `check` predicts, without the table of places behind it.
    #[track_caller]
    pub(crate) fn prediction(&self) -> &str {
        let tables = self.stdout_text().split_once("\n\n");
        let (prediction, places) = tables.expect("two tables");
        assert!(places.trim_start().starts_with("object"), "{self}");
        prediction
    }

    pub(crate) fn stdout_text(&self) -> &str {
        std::str::from_utf8(&self.stdout).expect("text")
    }
}

impl fmt::Display for Run {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let stdout = String::from_utf8_lossy(&self.stdout[..self.stdout.len().min(2000)]);
        write!(
            f,
            "$ {}\nexit status {}\nstdout ({} bytes): {stdout}\nstderr: {}",
            self.command,
            self.status,
            self.stdout.len(),
            self.stderr
        )
    }
}

/// The JSON of a GLB.
pub(crate) fn glb_json(bytes: &[u8]) -> Value {
    Glb::new(bytes).json
}

/// The names of all nodes of a GLB that have a mesh, in order.
pub(crate) fn node_names(bytes: &[u8]) -> Vec<String> {
    let json = glb_json(bytes);
    let nodes = json["nodes"].as_array().expect("nodes");
    let with_mesh = nodes.iter().filter(|node| node.get("mesh").is_some());
    with_mesh
        .map(|node| node["name"].as_str().expect("a name").to_owned())
        .collect()
}
