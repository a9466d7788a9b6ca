//! The flag that was meant, for an error about one that nobody knows.

/// Words that people try, each with the flags that they mean, of which a command has some.
const MEANT: &[(&str, &[&str])] = &[
    ("accuracy", &["tolerance"]),
    ("angle", &["fov"]),
    ("animation", &["animate"]),
    ("aspect", &["size"]),
    ("axis", &["axes", "direction"]),
    ("background-color", &["background"]),
    ("bg", &["background"]),
    ("budget", &["max-triangles"]),
    ("colour", &["background"]),
    ("color", &["background"]),
    ("dir", &["direction"]),
    ("effect", &["doppler"]),
    ("error", &["tolerance"]),
    ("field-of-view", &["fov"]),
    ("framerate", &["fps"]),
    ("frames", &["steps"]),
    ("height", &["size"]),
    ("jobs", &["threads"]),
    ("levels", &["lod"]),
    ("lorentz", &["gamma"]),
    ("morph", &["animate"]),
    ("out", &["output"]),
    ("outfile", &["output"]),
    ("pixels", &["size"]),
    ("place", &["observer"]),
    ("position", &["observer"]),
    ("precision", &["tolerance"]),
    ("proper-time", &["steps"]),
    ("quality", &["tolerance", "samples"]),
    ("rays", &["samples", "pixel-samples"]),
    ("resolution", &["size"]),
    ("samples", &["places", "pixel-samples"]),
    ("scene", &["example"]),
    ("silent", &["quiet"]),
    ("speed", &["beta"]),
    ("step", &["steps"]),
    ("time-step", &["steps"]),
    ("times", &["steps"]),
    ("tol", &["tolerance"]),
    ("v", &["beta"]),
    ("vel", &["velocity"]),
    ("width", &["size"]),
];

/// The flags of a command that `argument` may mean, as users write them; none if nobody can tell.
pub(super) fn meant(cli: &clap::Command, argument: &str, command: Option<&str>) -> Vec<String> {
    let word = argument.trim_start_matches('-');
    let word = word
        .split('=')
        .next()
        .unwrap_or(word)
        .to_lowercase()
        .replace('_', "-");
    let Some(command) = command.and_then(|name| cli.find_subcommand(name)) else {
        return vec![];
    };
    let has = |flag: &str| {
        let mut flags = command
            .get_arguments()
            .filter_map(|argument| argument.get_long());
        flags.any(|long| long == flag)
    };
    let known = MEANT.iter().filter(|(tried, _)| *tried == word);
    let flags = known.flat_map(|(_, flags)| flags.iter().copied());
    let flags = flags.filter(|flag| has(flag));
    flags.map(|flag| format!("--{flag}")).collect()
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn words_that_people_try_name_a_flag_and_are_none() {
        let cli = super::super::command::Cli::command();
        let longs: Vec<&str> = cli
            .get_subcommands()
            .flat_map(|command| command.get_arguments())
            .chain(cli.get_arguments())
            .filter_map(|argument| argument.get_long())
            .collect();
        for (tried, flags) in MEANT {
            assert!(!flags.is_empty());
            for flag in *flags {
                assert!(longs.contains(flag), "--{flag} is no flag");
            }
            let own = format!("--{tried}");
            for command in cli.get_subcommands() {
                let is_there = command
                    .get_arguments()
                    .any(|argument| argument.get_long() == Some(tried));
                let hint = meant(&cli, &own, Some(command.get_name()));
                assert!(!is_there || hint.iter().all(|hint| *hint != own), "{own}");
            }
        }
        assert!(MEANT.windows(2).all(|pair| pair[0].0 != pair[1].0));
        assert_eq!(meant(&cli, "--speed=0.9", Some("export")), ["--beta"]);
        assert_eq!(meant(&cli, "--resolution", Some("render")), ["--size"]);
        assert_eq!(meant(&cli, "--resolution", Some("check")), [""; 0]);
        assert_eq!(
            meant(&cli, "--samples", Some("cost")),
            ["--places", "--pixel-samples"]
        );
        assert_eq!(meant(&cli, "--nonsense", Some("export")), [""; 0]);
    }
}
