//! The file of a sweep: a list of overrides, each of which becomes the arguments of a command.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail, ensure};
use clap::{Args, FromArgMatches};
use photosurface::jobs::{MAX_SCENE_BYTES, text_of};
use photosurface::read::read_whole;
use serde_json::{Map, Value, json};

use super::unique::Unique;
use crate::cli::export::ExportArgs;
use crate::cli::output::is_stdout;
use crate::cli::render::RenderArgs;

/// A command with all of its arguments.
pub(super) enum Configured {
    Export(Box<ExportArgs>),
    Render(Box<RenderArgs>),
}

/// One run of a sweep.
pub(super) struct Configuration {
    pub(super) name: String,
    pub(super) command: Configured,
}

/// What the command line says of all runs.
pub(super) struct Common<'a> {
    /// The scene or mesh, in place of that of the file.
    pub(super) input: Option<&'a Path>,
    /// The folder of the files that the list does not name.
    pub(super) folder: &'a Path,
    pub(super) resume: bool,
    pub(super) plan: bool,
}

/// The keys that are no flags.
const KEYS: [&str; 4] = ["command", "input", "all", "runs"];

/// Reads the runs of a sweep.
///
/// # Errors
///
/// The file cannot be read, or a run is not possible; the error names the file, the run and the flag.
pub(super) fn configurations(
    path: &Path,
    common: &Common<'_>,
) -> anyhow::Result<Vec<Configuration>> {
    let place = path.display().to_string();
    let bytes = match is_stdout(path) {
        true => {
            let mut text = String::new();
            std::io::Read::read_to_string(&mut std::io::stdin().lock(), &mut text)
                .context("stdin")?;
            text.into_bytes()
        }
        false => read_whole(path, MAX_SCENE_BYTES)?,
    };
    let text = text_of(&bytes).with_context(|| place.clone())?;
    let Unique(value) = serde_json::from_str(text).with_context(|| place.clone())?;
    of_json(value, common).with_context(|| place)
}

fn of_json(value: Value, common: &Common<'_>) -> anyhow::Result<Vec<Configuration>> {
    let mut whole = match value {
        Value::Array(runs) => Map::from_iter([("runs".to_owned(), Value::Array(runs))]),
        Value::Object(whole) => whole,
        other => bail!(
            "is {}, expected a list of runs, or an object with \"runs\"",
            kind(&other)
        ),
    };
    if let Some(key) = whole.keys().find(|key| !KEYS.contains(&key.as_str())) {
        bail!("unknown key \"{key}\", expected command, input, all or runs");
    }
    let command = match whole.remove("command") {
        None => "export".to_owned(),
        Some(Value::String(name)) if ["export", "render"].contains(&name.as_str()) => name,
        Some(other) => bail!("\"command\" is {other}, expected \"export\" or \"render\""),
    };
    let input = match (common.input, whole.remove("input")) {
        (Some(input), _) => Some(input.to_owned()),
        (None, None) => None,
        (None, Some(Value::String(input))) => Some(PathBuf::from(input)),
        (None, Some(other)) => bail!("\"input\" is {}, expected the name of a file", kind(&other)),
    };
    let all = match whole.remove("all") {
        None => Map::new(),
        Some(Value::Object(flags)) => flags,
        Some(other) => bail!("\"all\" is {}, expected an object of flags", kind(&other)),
    };
    let runs = match whole.remove("runs") {
        Some(Value::Array(runs)) if !runs.is_empty() => runs,
        _ => bail!("has no runs, expected a list of at least one in \"runs\""),
    };
    let digits = (runs.len() - 1).to_string().len().max(3);
    let (mut names, mut files) = (HashSet::new(), HashMap::new());
    let mut configurations = vec![];
    for (number, run) in runs.into_iter().enumerate() {
        let Value::Object(mut run) = run else {
            bail!(
                "runs[{number}] is {}, expected an object of flags",
                kind(&run)
            );
        };
        let name = match run.remove("name") {
            None => format!("run{number:0digits$}"),
            Some(Value::String(name)) if is_file_name(&name) => name,
            Some(other) => bail!(
                "runs[{number}]: \"name\" is {other}, expected a text without / and \\, from which files get their names"
            ),
        };
        ensure!(
            names.insert(name.clone()),
            "runs[{number}]: the name \"{name}\" is that of another run, expected a name of its own"
        );
        let mut flags = all.clone();
        flags.extend(run);
        let command =
            configured(&command, input.as_deref(), &name, flags, common).map_err(|error| {
                let of_all = configured(&command, input.as_deref(), &name, all.clone(), common);
                match of_all.err() {
                    Some(of_all) if of_all.to_string() == error.to_string() => error.context("all"),
                    _ => error.context(format!("runs[{number}] \"{name}\"")),
                }
            })?;
        for file in command.files() {
            if let Some(other) = files.insert(file.to_owned(), name.clone()) {
                bail!(
                    "runs[{number}] \"{name}\" writes {}, which \"{other}\" writes too; expected a file for each",
                    file.display()
                );
            }
        }
        configurations.push(Configuration { name, command });
    }
    Ok(configurations)
}

fn is_file_name(name: &str) -> bool {
    !name.is_empty() && name != "." && name != ".." && !name.contains(['/', '\\', '\0'])
}

/// The command with the flags of one run.
fn configured(
    command: &str,
    input: Option<&Path>,
    name: &str,
    mut flags: Map<String, Value>,
    common: &Common<'_>,
) -> anyhow::Result<Configured> {
    let extension = match command {
        "render" => "png",
        _ => match flags.get("format") {
            Some(Value::String(format)) => format.as_str(),
            _ => "glb",
        },
    };
    let own = common.folder.join(format!("{name}.{extension}"));
    let is_film = flags.contains_key("film");
    if !is_film && !flags.contains_key("output") {
        flags.insert("output".to_owned(), own.to_string_lossy().into());
    }
    for flag in ["plan", "planned", "progress", "threads"] {
        ensure!(
            !flags.contains_key(flag),
            "\"{flag}\" is for the whole sweep, expected it on the command line"
        );
    }
    flags.insert("quiet".to_owned(), true.into());
    flags.insert("resume".to_owned(), (common.resume && !is_film).into());
    if common.plan {
        // Runs are not made in parts, so that none needs an overview.
        flags.insert("plan".to_owned(), "files".into());
    }
    let input = input.map(|input| input.to_string_lossy().into_owned());
    let parsed = match command {
        "render" => parsed(command, flags, input).map(|args| Configured::Render(Box::new(args))),
        _ => parsed(command, flags, input).map(|args| Configured::Export(Box::new(args))),
    };
    let configured = parsed?;
    ensure!(
        !configured.files().into_iter().any(is_stdout),
        "a file is named -, expected files of each run"
    );
    Ok(configured)
}

/// A flag with its value, as an argument.
fn argument(flag: &str, value: Value) -> anyhow::Result<Option<String>> {
    let word = |value: &Value| match value {
        Value::String(text) => Ok(text.clone()),
        Value::Number(number) => Ok(number.to_string()),
        other => Err(anyhow!(
            "\"{flag}\" has {} in it, expected texts or numbers",
            kind(other)
        )),
    };
    Ok(match value {
        Value::Null | Value::Bool(false) => None,
        Value::Bool(true) => Some(format!("--{flag}")),
        Value::Array(values) => {
            let words: Vec<String> = values.iter().map(word).collect::<Result<_, _>>()?;
            Some(format!("--{flag}={}", words.join(",")))
        }
        Value::Object(_) => bail!("\"{flag}\" is an object, expected a text, a number or a list"),
        value => Some(format!("--{flag}={}", word(&value)?)),
    })
}

/// The arguments of a command as its flags say.
fn parsed<T: Args + FromArgMatches>(
    name: &str,
    flags: Map<String, Value>,
    input: Option<String>,
) -> anyhow::Result<T> {
    let mut command = T::augment_args(clap::Command::new("run")).disable_help_flag(true);
    command.build();
    let needs_value = |flag: &str| {
        let mut arguments = command.get_arguments();
        let argument = arguments.find(|argument| argument.get_long() == Some(flag));
        let values = argument.and_then(|argument| argument.get_num_args());
        values.is_some_and(|values| values.min_values() > 0)
    };
    let mut arguments = vec![name.to_owned()];
    for (flag, value) in flags {
        ensure!(
            value != Value::Bool(true) || !needs_value(&flag),
            "\"{flag}\" is true, expected a value"
        );
        arguments.extend(argument(&flag, value)?);
    }
    arguments.extend(input.into_iter().flat_map(|input| ["--".to_owned(), input]));
    let matches = command.try_get_matches_from(arguments);
    let parsed = matches.and_then(|matches| T::from_arg_matches(&matches));
    parsed.map_err(|error| {
        let text = error.to_string();
        // Beside what is wrong there is how the command is used, which nobody asked for.
        let lines = text.lines().take_while(|line| !line.starts_with("Usage"));
        let lines = lines.map(str::trim);
        // In a list of runs no word passes for a value.
        let lines = lines.filter(|line| !line.is_empty() && !line.starts_with("tip: to pass"));
        let told = lines.collect::<Vec<_>>().join("; ");
        let told = told.trim_start_matches("error: ");
        let told = told.split("; For more information").next().unwrap_or(told);
        anyhow!("{}", told.trim_end_matches(';'))
    })
}

impl Configured {
    /// The files that the flags name; the first one names all files of its kind.
    pub(super) fn files(&self) -> Vec<&Path> {
        let files = match self {
            Self::Export(args) => [args.output_file(), args.report_file()],
            Self::Render(args) => [args.output_file(), None],
        };
        files.into_iter().flatten().collect()
    }
}

fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}

/// The JSON Schema of the file of a sweep: the flags of both commands are the keys of a run.
pub(in crate::cli) fn json_schema() -> Value {
    let mut flags = Map::new();
    let export = ExportArgs::augment_args(clap::Command::new("export"));
    let render = RenderArgs::augment_args(clap::Command::new("render"));
    for argument in export.get_arguments().chain(render.get_arguments()) {
        let Some(flag) = argument.get_long() else {
            continue;
        };
        if ["plan", "planned", "progress", "resume", "quiet", "verbose"].contains(&flag) {
            continue;
        }
        let help = argument.get_help().map(ToString::to_string);
        let value = json!({
            "description": help,
            "type": match argument.get_action().takes_values() {
                true => json!(["string", "number", "array", "boolean", "null"]),
                false => json!(["boolean", "null"]),
            },
            "items": { "type": ["string", "number"] },
        });
        flags.entry(flag.to_owned()).or_insert(value);
    }
    let mut run = flags.clone();
    run.insert(
        "name".to_owned(),
        json!({
            "description": "The name of the run in the table, and of its file unless \"output\" names that",
            "type": "string", "minLength": 1, "pattern": "^[^/\\\\]+$",
        }),
    );
    let runs = json!({
        "description": "The runs in their order; each overrides flags of all",
        "type": "array", "minItems": 1,
        "items": { "type": "object", "properties": run, "additionalProperties": false },
    });
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Sweep",
        "description": "Many runs of one command: a list of runs, or an object with such a list",
        "oneOf": [
            runs,
            {
                "type": "object",
                "properties": {
                    "command": { "description": "The command of all runs", "enum": ["export", "render"], "default": "export" },
                    "input": { "description": "The scene or the mesh of all runs, as the command line names it", "type": "string" },
                    "all": { "description": "Flags of all runs", "type": "object", "properties": flags, "additionalProperties": false },
                    "runs": runs,
                },
                "required": ["runs"],
                "additionalProperties": false,
            },
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(value: Value) -> anyhow::Result<Vec<Configuration>> {
        let common = Common {
            input: None,
            folder: Path::new("out"),
            resume: false,
            plan: false,
        };
        of_json(value, &common)
    }

    #[test]
    fn runs_have_the_flags_of_all_and_their_own() {
        let runs = read(
            json!({ "input": "a.json", "all": { "beta": 0.5, "split": true },
            "runs": [{}, { "name": "b", "beta": null, "velocity": [0.1, -0.2, 0], "format": "ply" }] }),
        );
        let runs = runs.unwrap();
        let outputs: Vec<_> = runs.iter().map(|run| run.command.files()[0]).collect();
        assert_eq!(
            outputs,
            [Path::new("out/run000.glb"), Path::new("out/b.ply")]
        );
        let names: Vec<_> = runs.iter().map(|run| run.name.as_str()).collect();
        assert_eq!(names, ["run000", "b"]);
    }

    #[test]
    fn mistakes_are_named_with_their_run() {
        for (value, words) in [
            (json!(3), vec!["a number", "list of runs"]),
            (json!([]), vec!["at least one"]),
            (json!({ "run": [] }), vec!["\"run\"", "expected command"]),
            (
                json!({ "runs": [{}], "command": "cost" }),
                vec!["\"cost\"", "\"render\""],
            ),
            (
                json!([{}, { "bet": 1 }]),
                vec!["runs[1] \"run001\"", "--bet"],
            ),
            (json!([{ "beta": "fast" }]), vec!["runs[0]", "fast"]),
            (
                json!([{ "beta": { "x": 1 } }]),
                vec!["\"beta\"", "an object"],
            ),
            (
                json!([{ "name": "a" }, { "name": "a" }]),
                vec!["runs[1]", "another run"],
            ),
            (json!([{ "name": "a/b" }]), vec!["\"a/b\"", "without /"]),
            (
                json!([{ "output": "x.glb" }, { "output": "x.glb" }]),
                vec!["x.glb", "run000"],
            ),
            (
                json!([{ "report": "r.json" }, { "report": "r.json" }]),
                vec!["runs[1]", "r.json", "run000"],
            ),
            (
                json!([{ "name": "a" }, { "name": "b", "report": "out/a.glb" }]),
                vec!["runs[1]", "out/a.glb", "\"a\""],
            ),
            (json!([{ "output": "-" }]), vec!["expected files"]),
            (json!([{ "report": "-" }]), vec!["expected files"]),
            (
                json!([{ "beta": true }]),
                vec!["runs[0]", "\"beta\" is true", "expected a value"],
            ),
            (json!([{ "plan": true }]), vec!["\"plan\"", "command line"]),
            (
                json!({ "all": { "beta": "fast" }, "runs": [{}, {}] }),
                vec!["all: ", "fast"],
            ),
            (
                json!({ "all": { "beta": 0.5 }, "runs": [{ "beta": "fast" }] }),
                vec!["runs[0]", "fast"],
            ),
        ] {
            let error = read(value.clone()).err().map(|error| format!("{error:#}"));
            let error = error.unwrap_or_else(|| panic!("{value} is accepted"));
            for word in words {
                assert!(error.contains(word), "{value}: {error}");
            }
        }
    }
}
