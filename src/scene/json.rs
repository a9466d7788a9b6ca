//! The scene file: JSON in, a scene or one error that names line, column and place out.

use schemars::Schema;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use serde::de::DeserializeOwned;
use serde_json::Value;
use thiserror::Error;

use super::Scene;
use super::nearest::with_nearest;

/// Why a text is not a scene.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("line {line}, column {column}: {}{message}", at_prefix(.at))]
#[non_exhaustive]
pub struct SceneError {
    /// Line of the mistake or of the end of the value it is in, from 1.
    pub line: usize,
    /// Column, from 1, likewise.
    pub column: usize,
    /// The value's place in the scene, like `objects[1].velocity`; empty for the whole scene.
    pub at: String,
    /// What stands there and what was expected.
    pub message: String,
}

fn at_prefix(at: &str) -> String {
    if at.is_empty() {
        String::new()
    } else {
        format!("{at}: ")
    }
}

impl Scene {
    /// Reads a scene from JSON text. Files that it names are not touched.
    ///
    /// # Errors
    ///
    /// Malformed JSON, unknown keys, wrong types, impossible values: line, column, place and what was
    /// expected.
    ///
    /// # Example
    ///
    /// ```
    /// use photosurface::Scene;
    ///
    /// let error = Scene::from_json(r#"{ "objects": [ { "name": "a", "shpe": 1 } ] }"#).unwrap_err();
    /// assert_eq!((error.line, error.at.as_str()), (1, "objects[0].shpe"));
    /// ```
    pub fn from_json(text: &str) -> Result<Self, SceneError> {
        read(text, "scene")
    }

    /// The JSON Schema of the scene file.
    pub fn json_schema() -> Schema {
        SchemaSettings::draft2020_12()
            .with_transform(RecursiveTransform(for_scene_authors))
            .into_generator()
            .into_root_schema_for::<Self>()
    }
}

/// Reads a value from JSON text; `kind` is what the text is called in messages.
pub(super) fn read<T: DeserializeOwned>(text: &str, kind: &str) -> Result<T, SceneError> {
    // Some editors mark text as UTF-8 with one character before it.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let value = serde_path_to_error::deserialize(&mut deserializer).map_err(|error| {
        let at = error.path().to_string();
        let mut error = scene_error(text, &error.into_inner(), &at, kind);
        if error.message == format!("more text after the end of the {kind}") {
            error.message =
                "expected the list to end here: it is too long, or a bracket is missing before"
                    .to_owned();
        }
        error
    })?;
    let end = deserializer.end();
    end.map_err(|error| scene_error(text, &error, ".", kind))?;
    Ok(value)
}

/// The error of a text that is wrong as a whole, found when all of it has been read.
pub(super) fn at_end(text: &str, message: String) -> SceneError {
    let read = text.trim_end();
    SceneError {
        line: read.lines().count().max(1),
        column: read.lines().last().map_or(0, str::len).max(1),
        at: String::new(),
        message,
    }
}

/// Descriptions come from the documentation of Rust types: what is for programmers is left out.
fn for_scene_authors(schema: &mut Schema) {
    let Some(Value::String(description)) = schema.get_mut("description") else {
        return;
    };
    // Sections such as "# Example" come last.
    if let Some((before, _)) = description.split_once("\n\n# ") {
        *description = before.to_owned();
    }
    *description = description.replace("[`", "`").replace("`]", "`");
}

/// What serde and serde_json say, and how it is called in a scene; longer phrases before what they contain.
const IN_WORDS_OF_SCENES: &[(&str, &str)] = &[
    ("EOF while parsing", "the text ends in the middle of"),
    (
        "expected ident",
        "expected true, false, null, a number, a string, a list or an object",
    ),
    ("expected value", "expected a value"),
    ("trailing characters", "more text after the end of the KIND"),
    ("invalid type: sequence", "found a list"),
    ("invalid type: map", "found an object"),
    ("invalid value: map", "found an empty object"),
    ("invalid type: integer", "found"),
    ("invalid type: floating point", "found"),
    ("invalid type: ", "found "),
    ("invalid value: integer", "found"),
    ("invalid value: ", "found "),
    ("invalid length", "found a list of length"),
    (
        "expected a sequence of 3 f64 values",
        "expected a list of 3 numbers",
    ),
    ("expected an array of length", "expected a list of length"),
    ("expected fewer elements in array", "expected fewer values"),
    ("expected a sequence", "expected a list"),
    ("expected f64", "expected a number"),
    ("expected usize", "expected a whole number >= 0"),
    ("missing field", "missing key"),
    ("unknown field", "unknown key"),
    ("duplicate field", "repeated key"),
];

fn in_words_of_scenes(message: &str, kind: &str) -> String {
    let mut message = message.to_owned();
    for (theirs, ours) in IN_WORDS_OF_SCENES {
        if let Some(start) = message.find(theirs) {
            // What a user wrote comes in quotes or backticks, behind the words that are replaced.
            message.replace_range(start..start + theirs.len(), &ours.replace("KIND", kind));
        }
    }
    message
}

fn scene_error(json: &str, error: &serde_json::Error, at: &str, kind: &str) -> SceneError {
    let (line, column) = (error.line(), error.column());
    // serde_json has no message without its position; here the position has fields of its own.
    let text = error.to_string();
    let suffix = format!(" at line {line} column {column}");
    let message = in_words_of_scenes(text.strip_suffix(&suffix).unwrap_or(&text), kind);
    let message = with_nearest(message);
    let whole = at_end(json, message);
    SceneError {
        // "." is the whole scene, "?" a place inside a value that was never begun.
        at: at.trim_end_matches(['.', '?']).to_owned(),
        // An empty text, or one that ends with a line, has no column there.
        line: if line == 0 { whole.line } else { line },
        column: if line == 0 {
            whole.column
        } else {
            column.max(1)
        },
        ..whole
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::Source;
    use super::*;
    use crate::spacetime::{Integrator, Segment};

    const OBJECTS: &str =
        r#""objects": [ { "name": "s", "shape": { "sphere": { "radius": 1 } } } ]"#;

    fn error(text: &str) -> SceneError {
        Scene::from_json(text).expect_err(text)
    }

    #[test]
    fn the_scene_of_the_design_is_read_as_written() {
        let scene = Scene::from_json(
            r##"{
              "title": "A sphere flies by at 0.95 c",
              "observer": { "time": 1, "position": [1, 2, 3], "velocity": { "beta": 0.95, "direction": [-2, 0, 0] } },
              "objects": [
                { "name": "sphere", "shape": { "sphere": { "radius": 1 } }, "position": [0, 3, 0] },
                { "name": "bunny", "file": "bunny.glb", "position": [0, -3, 0], "rotation": [0, 0, 1, 0],
                  "scale": 10, "velocity": { "gamma": 5, "direction": [0, 0, 1] } }
              ],
              "steps": { "from": -6, "to": 6, "count": 7 }
            }"##,
        )
        .unwrap();
        assert_eq!(scene.title(), Some("A sphere flies by at 0.95 c"));
        assert_eq!(scene.observer().time.get(), 1.0);
        assert_eq!(scene.observer().position.get(), DVec3::new(1.0, 2.0, 3.0));
        assert_eq!(scene.observer().velocity.direction(), DVec3::NEG_X);
        assert_eq!(scene.steps(), [-6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0]);
        let [sphere, bunny] = scene.objects() else {
            panic!("two objects")
        };
        assert!(matches!(sphere.source, Source::Shape(..)));
        assert_eq!(sphere.velocity.rapidity(), 0.0);
        assert_eq!(bunny.source, Source::File("bunny.glb".into()));
        assert_eq!(bunny.scale.get(), DVec3::splat(10.0));
        assert!((bunny.velocity.gamma() - 5.0).abs() < 4e-15);
        assert_eq!(bunny.rotation.get() * DVec3::X, DVec3::NEG_X);
    }

    #[test]
    fn a_flight_is_read_as_written() {
        let scene = Scene::from_json(&format!(
            r#"{{ "units": {{ "length_m": 299792458 }}, "observer": {{
                "orientation": {{ "look": [2, 0, 0], "up": [1, 3, 0] }}, "integrator": {{ "euler": 0.5 }}, "flight": [
                {{ "proper_time": 2, "acceleration": [1, 2, 3], "turn_rate": [4, 5, 6] }},
                {{ "proper_time": 1, "acceleration_g": [0, 0, -2] }},
                {{ "proper_time": 3, "steer": "coordinated" }} ] }}, {OBJECTS} }}"#
        ))
        .unwrap();
        let observer = scene.observer();
        let ahead = observer.orientation.get() * DVec3::NEG_Z;
        assert!(ahead.distance(DVec3::X) < 4e-16, "{ahead}");
        assert!((observer.orientation.get() * DVec3::Y).distance(DVec3::Y) < 4e-16);
        let g = scene.units().unwrap().gravity();
        let expected = [
            Segment::free(2.0, DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0)),
            Segment::free(1.0, DVec3::NEG_Z * (2.0 * g), DVec3::ZERO),
            Segment::coordinated(3.0, DVec3::ZERO),
        ];
        assert_eq!(observer.flight, expected.map(Result::unwrap));
        assert_eq!(observer.integrator, Integrator::euler(0.5).unwrap());
        assert_eq!(scene.flight().proper_time(), 6.0);
    }

    #[test]
    fn a_speed_may_be_written_in_five_ways() {
        for velocity in [
            "[0, 0, -0.6]",
            r#"{ "beta": 0.6 }"#,
            r#"{ "one_minus_beta": 0.4 }"#,
            r#"{ "gamma": 1.25, "direction": [0, 0, -7] }"#,
            r#"{ "rapidity": 0.6931471805599453 }"#,
        ] {
            let scene = Scene::from_json(&format!(
                r#"{{ "observer": {{ "velocity": {velocity} }}, {OBJECTS} }}"#
            ));
            let velocity = scene.unwrap().observer().velocity;
            assert!((velocity.gamma_beta() - 0.75).abs() < 1e-15);
            assert_eq!(velocity.direction(), DVec3::NEG_Z);
        }
    }

    /// A scene whose observer has this flight, on the second line.
    fn flying(flight: &str) -> String {
        format!("{{ \"observer\": {{\n\"flight\": {flight} }}, {OBJECTS} }}")
    }

    #[test]
    fn mistakes_are_told_with_line_column_place_and_expectation() {
        // text, line, place, words of the message
        let cases: [(String, usize, &str, &str); 43] = [
            ("{".into(), 1, "", "the text ends in the middle of an object"),
            ("".into(), 1, "", "the text ends"),
            ("\u{feff}{".into(), 1, "", "the text ends"),
            (r#"["t", [0, [0, 0, 0], [0, 0, 0], null]]"#.into(), 1, "", "found a list, expected a scene like {"),
            (format!("{{ \"observer\": [0, [0, 0, 0], [0, 0, 0], null], {OBJECTS} }}"), 1, "observer", "found a list, expected an observer like {"),
            (r#"{ "objects": [["a"]] }"#.into(), 1, "objects[0]", "expected an object like {"),
            (r#"{ "objects": {} }"#.into(), 1, "objects", "found an object, expected a list"),
            (r#"{ "objects": [ { "name": "a", "shape": { "sphere": [1, 24] } } ] }"#.into(), 1, "objects[0].shape.sphere", "found a list, expected a sphere like { \"radius\": 1 }"),
            (r#"{ "objects": [ { "name": "a", "shape": "sphere" } ] }"#.into(), 1, "objects[0].shape", "found string \"sphere\", expected a shape like { \"sphere\": { \"radius\": 1 } }"),
            (r#"{ "objects": [ { "name": "a", "shape": {} } ] }"#.into(), 1, "objects[0].shape", "found an empty object, expected a shape like"),
            (r#"{ "objects": [ { "name": "a", "shape": { "sphere": { "radius": 1 }, "rod": {} } } ] }"#.into(), 1, "objects[0].shape", "both `sphere` and `rod`, expected exactly one shape"),
            (r#"{ "objects": [ { "name": "a", "shape": { "ball": { "radius": 1 } } } ] }"#.into(), 1, "objects[0].shape", "unknown shape `ball`, expected one of sphere, box"),
            (r#"{ "objects": [ { "name": "a", "file": "" } ] }"#.into(), 1, "objects[0].file", "the file name is empty"),

            (flying(r#"[{ "proper_time": 0 }]"#), 2, "observer.flight[0]", "the proper time is 0, expected a finite duration > 0"),
            (flying(r#"[{ "proper_time": 1 }, { "proper_time": 1, "acceleration": [1, 2] }]"#), 2, "observer.flight[1].acceleration", "found a list of length 2, expected a list"),
            (flying(r#"[{ "acceleration": [1, 0, 0] }]"#), 2, "observer.flight[0]", "missing key `proper_time`"),
            (flying(r#"[{ "proper_time": 1, "thrust": 3 }]"#), 2, "observer.flight[0].thrust", "unknown key `thrust`"),
            (flying(r#"[{ "proper_time": 1, "steer": "left" }]"#), 2, "observer.flight[0].steer", "expected \"free\" or \"coordinated\""),
            (flying(r#"[{ "proper_time": 1, "steer": "coordinated", "turn_rate": [0, 1, 0] }]"#), 2, "observer.flight[0]", "expected one of them"),
            (flying(r#"[{ "proper_time": 1, "acceleration": [0, 0, 1], "acceleration_g": [0, 0, 1] }]"#), 2, "observer.flight[0]", "expected one of them"),
            (flying(r#"[[1, [0, 0, 0]]]"#), 2, "observer.flight[0]", "expected a segment like {"),
            (flying("{}"), 2, "observer.flight", "found an object, expected a list"),
            (flying(r#"[{ "proper_time": 400, "acceleration": [1, 0, 0] }]"#), 2, "observer", "flight[0] ends at rapidity"),
            (flying(r#"[{ "proper_time": 1, "acceleration_g": [1, 0, 0] }]"#), 2, "", "flight[0] has \"acceleration_g\", which needs \"units\""),
            (format!("{{ \"observer\": {{\n\"integrator\": {{ \"rk4\": -1 }} }}, {OBJECTS} }}"), 2, "observer.integrator", "the step is -1, expected a finite proper time > 0"),
            (format!("{{ \"observer\": {{\n\"orientation\": {{ \"look\": [0, 2, 0] }} }}, {OBJECTS} }}"), 2, "observer.orientation", "not along one line"),
            ("[]".into(), 1, "", "expected a scene like"),
            (format!("{{ {OBJECTS} }} x"), 1, "", "more text after the end"),
            (r#"{ "objects": [] }"#.into(), 1, "", "at least one"),
            (
                format!("{{\n \"observr\": {{}},\n {OBJECTS} }}"),
                2,
                "observr",
                "expected one of",
            ),
            (
                format!("{{ \"observer\": {{\n\"velocity\": {{ \"beta\": 1.5 }} }}, {OBJECTS} }}"),
                2,
                "observer.velocity",
                "beta is 1.5, expected 0 <= beta < 1",
            ),
            (
                format!(
                    "{{ \"observer\": {{ \"velocity\": {{ \"gamma\": 2, \"beta\": 0.5 }} }}, {OBJECTS} }}"
                ),
                1,
                "observer.velocity",
                "exactly one of",
            ),
            (
                format!("{{ \"observer\": {{ \"velocity\": {{ \"gama\": 2 }} }}, {OBJECTS} }}"),
                1,
                "observer.velocity.gama",
                "expected one of `beta`",
            ),
            (
                format!("{{ \"observer\": {{ \"velocity\": [1, 1, 0] }}, {OBJECTS} }}"),
                1,
                "observer.velocity",
                "below the speed of light",
            ),
            (
                format!("{{ \"observer\": {{ \"velocity\": 0.5 }}, {OBJECTS} }}"),
                1,
                "observer.velocity",
                "expected a velocity [bx, by, bz] or a speed",
            ),
            (
                format!("{{ \"observer\": {{ \"position\": [1, 2] }}, {OBJECTS} }}"),
                1,
                "observer.position",
                "found a list of length 2, expected a list of 3 numbers",
            ),
            (
                format!("{{ \"observer\": {{ \"time\": \"now\" }}, {OBJECTS} }}"),
                1,
                "observer.time",
                "expected a number",
            ),
            (
                format!("{{ \"observer\": {{ \"time\": 1e999 }}, {OBJECTS} }}"),
                1,
                "observer.time",
                "out of range",
            ),
            (
                format!("{{ \"steps\": [], {OBJECTS} }}"),
                1,
                "",
                "at least one proper time",
            ),
            (
                format!("{{ \"steps\": {{ \"from\": 0, \"to\": 1, \"count\": 0 }}, {OBJECTS} }}"),
                1,
                "steps",
                "count is 0",
            ),
            (
                r#"{ "objects": [ { "name": "a" } ] }"#.into(),
                1,
                "objects[0]",
                "neither of \"file\" and \"shape\", expected one of them",
            ),
            (
                r#"{ "objects": [ { "name": "a", "file": "a.glb", "scale": 0 } ] }"#.into(),
                1,
                "objects[0].scale",
                "expected",
            ),
            (
                r#"{ "objects": [ { "name": "a", "file": "a.glb", "rotation": [0, 0, 0, 2] } ] }"#
                    .into(),
                1,
                "objects[0].rotation",
                "unit quaternion",
            ),
        ];
        for (text, line, at, words) in cases {
            let error = error(&text);
            assert_eq!(
                (error.line, error.at.as_str()),
                (line, at),
                "{text}\n{error}"
            );
            assert!(error.column > 0, "{text}\n{error}");
            assert!(error.message.contains(words), "{text}\n{error}");
        }
    }

    #[test]
    fn names_must_tell_objects_apart() {
        let object = r#"{ "name": "s", "shape": { "sphere": { "radius": 1 } } }"#;
        let error = error(&format!(r#"{{ "objects": [ {object}, {object} ] }}"#));
        assert!(
            error.message.contains("two objects are named \"s\""),
            "{error}"
        );
    }
}
