//! Flags for work that is done in parts, is resumed, or is watched by another program.

use std::io::{Write, stderr};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use anyhow::{Context, ensure};
use photosurface::jobs::Finished;
use photosurface::write::{Fingerprint, Seal};
use photosurface::{Cancelled, Progress};
use schemars::JsonSchema;
use serde::Serialize;

use super::args::InputArgs;
use super::input::Input;
use super::messages::{Verbosity, print_if_open};
use super::output::{Bar, extension, is_stdout};
use super::planned::PlannedOverview;

#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Work")]
pub(super) struct WorkArgs {
    /// Leave each file as it is that an earlier run with --resume finished, if it is whole and was made of the same scene,
    /// files and flags by the same version; make all others. Files get a seal by which the next run knows them: in "extras" of
    /// a glTF, in a comment of a .ply or a .png. Films have none and are made anew
    #[arg(long)]
    pub(super) resume: bool,
    /// How progress is told on stderr: a bar on a terminal; or "json", a line with a JSON object for each file, and each step
    /// that goes into a file of several, as soon as it is finished: step (the first), steps (how many), of (how many in the
    /// whole), seconds, bytes, file, certified, resumed
    #[arg(long, value_enum, value_name = "HOW", default_value_t = Telling::Bar)]
    progress: Telling,
    /// Make nothing: print as JSON which files would be read and written, which steps are in each, and which of them are
    /// finished for --resume; for programs that share the work out with --only. The plan of pictures has an overview too, of
    /// what is found by looking at all steps, for --planned; --plan=files leaves it out, which takes no time
    #[arg(
        long,
        value_enum,
        value_name = "WHAT",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "all"
    )]
    plan: Option<PlanOf>,
}

/// What a plan is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum PlanOf {
    /// Files, and what pictures of all steps have in common
    All,
    /// Files alone
    Files,
}

/// How progress is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Telling {
    Bar,
    Json,
}

impl WorkArgs {
    /// Whether only a plan is asked for.
    pub(super) fn plans(&self) -> bool {
        self.plan.is_some()
    }

    /// Whether the plan has an overview, if there can be one.
    pub(super) fn plans_all(&self) -> bool {
        self.plan == Some(PlanOf::All)
    }

    /// What hears of the progress of so many things.
    pub(super) fn told(&self, length: usize, things: &str, verbosity: Verbosity) -> Told {
        Told::new(self.progress, length, things, verbosity)
    }

    /// The fingerprint of the files that were read, if files are resumed; `outputs` are those that may be.
    pub(super) fn fingerprint(
        &self,
        args: &InputArgs,
        input: &Input,
        outputs: &[PathBuf],
    ) -> anyhow::Result<Option<Fingerprint>> {
        if !self.resume {
            return Ok(None);
        }
        ensure!(
            !outputs.iter().any(|file| is_stdout(file)),
            "--resume looks for finished files, and stdout holds none; give a file name instead of -"
        );
        let found = fingerprint_of_inputs(args, input)?;
        found
            .context(
                "--resume compares files, and the mesh comes from stdin; give its file name instead of -",
            )
            .map(Some)
    }
}

/// The fingerprint of the files that were read; none if a mesh came from stdin.
pub(super) fn fingerprint_of_inputs(
    args: &InputArgs,
    input: &Input,
) -> anyhow::Result<Option<Fingerprint>> {
    let named = args.input.as_deref();
    if input.is_mesh && named.is_some_and(is_stdout) {
        return Ok(None);
    }
    // The scene is compared as it was read, not letter by letter.
    let is_scene = |file: &Path| named == Some(file) && extension(file).as_deref() == Some("json");
    let mut fingerprint = Fingerprint::default().with("access", &args.access().max_texture_pixels);
    for file in input.files.iter().filter(|file| !is_scene(file)) {
        let read = fingerprint.with_file(file);
        fingerprint = read.with_context(|| file.display().to_string())?;
    }
    Ok(Some(fingerprint))
}

/// Hears of the progress of a job, and tells of it as it is asked for.
pub(super) struct Told {
    bar: Bar,
    form: Telling,
    /// What was finished last without a file of its own.
    last: Mutex<Option<Line>>,
    /// Whether the caller writes a file for everything that is finished without one.
    awaits_files: bool,
}

/// A line of `--progress json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Line {
    pub(super) step: usize,
    pub(super) steps: usize,
    pub(super) of: usize,
    pub(super) seconds: f64,
    pub(super) bytes: Option<u64>,
    pub(super) file: Option<String>,
    pub(super) certified: bool,
    pub(super) resumed: bool,
    /// Why there is no file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) error: Option<String>,
}

impl Told {
    /// For so many things.
    pub(super) fn new(form: Telling, length: usize, things: &str, verbosity: Verbosity) -> Self {
        let verbosity = match form {
            Telling::Bar => verbosity,
            Telling::Json => Verbosity::new(true, false),
        };
        Self {
            bar: Bar::new(length, things, verbosity),
            form,
            last: Mutex::new(None),
            awaits_files: false,
        }
    }

    /// The same for a caller that writes a file for everything that is finished, and tells of it by [`Told::wrote`].
    pub(super) fn awaiting_files(mut self) -> Self {
        self.awaits_files = true;
        self
    }

    /// Whether everything in what was finished last is certified.
    pub(super) fn last_is_certified(&self) -> bool {
        let last = self.last.lock().ok();
        last.and_then(|last| last.as_ref().map(|line| line.certified))
            .unwrap_or(true)
    }

    /// What was finished last has become a file.
    pub(super) fn wrote(&self, file: &Path, bytes: u64) {
        let last = self.last.lock().ok().and_then(|mut last| last.take());
        if let Some(line) = last {
            self.say(&Line {
                bytes: Some(bytes),
                file: Some(file.to_string_lossy().into_owned()),
                ..line
            });
        }
    }

    /// The job is done: the bar goes.
    pub(super) fn finish(&self) {
        self.bar.finish();
    }

    /// One more thing is done.
    pub(super) fn one_more(&self) {
        // Only the user ends this, who has ended the program then.
        let _ = self.bar.advance(1);
    }

    /// Tells of what was finished, if it is to be told in lines.
    pub(super) fn say(&self, line: &Line) {
        if self.form == Telling::Json
            && let Ok(text) = serde_json::to_string(line)
        {
            // As with all messages: where nobody can be told, the work goes on.
            let _ = writeln!(stderr().lock(), "{text}");
        }
    }
}

impl Progress for Told {
    fn begin(&self, pieces: usize) {
        self.bar.begin(pieces);
    }

    fn advance(&self, pieces: usize) -> Result<(), Cancelled> {
        self.bar.advance(pieces)
    }

    fn finished(&self, finished: &Finished<'_>) {
        let line = Line {
            step: finished.steps.start,
            steps: finished.steps.len(),
            of: finished.of,
            seconds: finished.seconds,
            bytes: finished.file.map(|(_, bytes)| bytes),
            file: finished
                .file
                .map(|(file, _)| file.to_string_lossy().into_owned()),
            certified: finished.is_certified,
            resumed: finished.is_resumed,
            error: None,
        };
        match self.awaits_files && line.file.is_none() {
            true => {
                if let Ok(mut last) = self.last.lock() {
                    *last = Some(line);
                }
            }
            false => self.say(&line),
        }
    }
}

/// What a command would read and write, for programs that share its work out.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Plan {
    /// The version of the program.
    pub(super) version: &'static str,
    /// How many parts `--only` can tell apart: steps, pictures or frames.
    pub(super) of: usize,
    /// What pictures of all steps have in common, for --planned.
    pub(super) overview: Option<PlannedOverview>,
    /// The files that are read, as they are named: scene, meshes, and the files that those refer to; "-" for stdin.
    pub(super) inputs: Vec<String>,
    /// The files that are written.
    pub(super) outputs: Vec<PlannedFile>,
}

/// A file that a command would write.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct PlannedFile {
    /// Its path; none where the run of a sweep is an error.
    pub(super) file: Option<String>,
    /// The first step in it, counted from 0, and the one after the last.
    pub(super) steps: [usize; 2],
    /// Whether an earlier run with --resume has finished it.
    pub(super) finished: bool,
    /// Of a finished file whether everything in it is certified.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) certified: Option<bool>,
    /// Why there will be no file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) error: Option<String>,
}

impl PlannedFile {
    /// A file with these steps, and its seal if it is finished.
    pub(super) fn new(file: &Path, steps: Range<usize>, seal: Option<Seal>) -> Self {
        Self {
            file: Some(file.display().to_string()),
            steps: [steps.start, steps.end],
            finished: seal.is_some(),
            certified: seal.map(|seal| seal.is_certified),
            error: None,
        }
    }
}

impl Plan {
    /// The plan of a command that reads `input` and writes `outputs`, which are of so many.
    pub(super) fn new(
        args: &InputArgs,
        input: &Input,
        outputs: Vec<PlannedFile>,
        of: usize,
    ) -> Self {
        let stdin = args.input.iter().filter(|path| is_stdout(path));
        let inputs = stdin.chain(&input.files);
        Self {
            version: env!("CARGO_PKG_VERSION"),
            of,
            overview: None,
            inputs: inputs.map(|file| file.display().to_string()).collect(),
            outputs,
        }
    }

    /// Prints the plan to stdout.
    pub(super) fn print(&self) -> anyhow::Result<()> {
        let text = serde_json::to_string_pretty(self)?;
        print_if_open(|out| Ok(writeln!(out, "{text}")?))
    }
}
