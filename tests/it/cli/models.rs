//! Models as users ask for them: the flag, the scene, each object; side by side in pictures and files; as ghosts.

use serde_json::{Value, json};

use crate::common::command::{Workplace, glb_json, node_names};

const MODELS: [&str; 4] = ["seen", "delayed", "contracted", "rest"];

fn scene(model: Option<&str>, of_object: Option<&str>) -> String {
    let mut scene = json!({ "observer": { "velocity": { "beta": 0.9 } }, "steps": [0, 1], "objects": [
        { "name": "cube", "shape": { "box": { "size": [1, 2, 1] } }, "position": [1, 0, -6] } ] });
    if let Some(model) = model {
        scene["model"] = model.into();
    }
    if let Some(model) = of_object {
        scene["objects"][0]["model"] = model.into();
    }
    scene.to_string()
}

fn workplace() -> Workplace {
    let workplace = Workplace::new();
    workplace.write("plain.json", scene(None, None));
    for model in MODELS {
        workplace.write(&format!("{model}.json"), scene(Some(model), None));
        workplace.write(
            &format!("object_{model}.json"),
            scene(Some("rest"), Some(model)),
        );
    }
    workplace
}

fn nodes(bytes: &[u8]) -> Vec<Value> {
    let json = glb_json(bytes);
    let mut nodes = json["nodes"].as_array().cloned().unwrap();
    nodes.retain(|node| node.get("mesh").is_some());
    nodes
}

#[test]
fn flag_scene_and_object_say_the_same() {
    let workplace = workplace();
    let exported = |line: String| {
        workplace
            .run(&format!("export {line} -o out.glb"))
            .success();
        workplace.read("out.glb")
    };
    let plain = exported("plain.json".into());
    for model in MODELS {
        let of_flag = exported(format!("plain.json --model {model}"));
        assert_eq!(exported(format!("{model}.json")), of_flag, "{model}");
        assert_eq!(exported(format!("object_{model}.json")), of_flag, "{model}");
        assert_eq!(of_flag == plain, model == "seen", "{model}");
        let facts = &nodes(&of_flag)[0]["extras"];
        let expected = if model == "seen" {
            Value::Null
        } else {
            model.into()
        };
        assert_eq!(facts["model"], expected);
    }
    workplace.write("wrong.json", scene(Some("shown"), None));
    workplace
        .run("check wrong.json")
        .error(&["wrong.json", "model", "contracted"]);
    workplace.write(
        "number.json",
        scene(None, None).replacen('{', r#"{ "model": 3, "#, 1),
    );
    workplace.run("check number.json").error(&[
        "number.json",
        "model",
        "\"seen\", \"delayed\", \"contracted\", \"rest\"",
    ]);
    workplace
        .run("check plain.json --model shown")
        .error(&["shown", "seen, delayed, contracted, rest"]);
    workplace
        .run("check plain.json --model delayed --rapidity 10")
        .success();
    for command in ["check", "export", "render"] {
        workplace
            .run(&format!(
                "{command} plain.json --model delayed --rapidity 20.1"
            ))
            .error(&["\"cube\"", "20.1", "at most 20", "delayed"]);
    }
}

/// What is moved aside in a file is otherwise what an export of the model alone is.
#[test]
fn files_have_models_side_by_side() {
    let workplace = workplace();
    workplace
        .run("export plain.json --models seen,delayed,contracted,rest -o side.glb")
        .success();
    let side = workplace.read("side.glb");
    let names: Vec<String> = ["000", "001"]
        .iter()
        .flat_map(|step| MODELS.map(|model| format!("cube_{model}_step{step}")))
        .collect();
    assert_eq!(node_names(&side), names);
    for (number, model) in MODELS.iter().enumerate() {
        workplace
            .run(&format!("export {model}.json -o alone.glb"))
            .success();
        let alone = nodes(&workplace.read("alone.glb"));
        for (step, there) in alone.iter().enumerate() {
            let here = &nodes(&side)[4 * step + number];
            let vector = |value: &Value| -> Vec<f64> {
                let numbers = value
                    .as_array()
                    .map(|list| list.iter().filter_map(Value::as_f64).collect());
                numbers.unwrap_or(vec![0.0; 3])
            };
            let beside = vector(&here["extras"]["beside"]);
            let translations = [here, there].map(|node| vector(&node["translation"]));
            for axis in 0..3 {
                assert_eq!(
                    translations[0][axis],
                    translations[1][axis] + beside[axis],
                    "{model}"
                );
            }
            assert_eq!(beside == vec![0.0; 3], *model == "seen");
            for key in ["gap", "total", "triangles_out"] {
                let of = |node: &Value| node["extras"]["certificate"][key].clone();
                assert_eq!(of(here), of(there), "{model} {key}");
            }
        }
    }
    workplace
        .run("export plain.json --models rest,rest")
        .error(&["--models", "\"rest\"", "twice"]);
    workplace
        .run("export plain.json --models rest --model seen")
        .error(&["--model"]);
    workplace
        .run("export plain.json --models delayed,rest --animate=morph -o morph.glb")
        .success();
    workplace
        .run("export plain.json --models delayed,rest -o side.ply")
        .success();
}

/// The study of accuracy measures the error of the model that is shown.
#[test]
fn cost_measures_what_is_shown() {
    let workplace = workplace();
    for model in MODELS {
        let line = format!(
            "cost plain.json --model {model} --only meshes --tolerances 1e-2,1e-3 --repeats 1 --json cost.json"
        );
        workplace.run(&line).success();
        let study = workplace.read_json("cost.json");
        let rows = study["meshes"].as_array().unwrap();
        assert_eq!(rows.len(), 2);
        for row in rows {
            let number = |key: &str| row["made"][key].as_f64().unwrap();
            assert!(number("error") <= number("bound"), "{model}: {row}");
            let bends = matches!(model, "seen" | "delayed");
            assert_eq!(number("triangles") > 24.0, bends, "{model}: {row}");
        }
    }
}

#[test]
fn pictures_have_models_side_by_side() {
    let workplace = workplace();
    let size = |line: &str| {
        workplace
            .run(&format!(
                "render plain.json --size 40x30 --samples 1 {line}"
            ))
            .success();
        let bytes = workplace.read("plain.png");
        [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()))
    };
    assert_eq!(size("--models seen,rest --steps 0 -o plain.png"), [84, 30]);
    assert_eq!(
        size("--models seen,rest,contracted --sheet --caption none -o plain.png"),
        [128, 132]
    );
    assert_eq!(
        size("--models delayed --view outside --together -o plain.png"),
        [40, 30]
    );
    let run = workplace
        .run("render plain.json --models seen,rest --size 16x9 -o two.png")
        .success();
    assert!(run.stdout.is_empty());
    workplace.read("two_step000.png");
    workplace.read("two_step001.png");
    // One exposure for all columns: that of the bright photosurface darkens what is at rest beside it.
    let picture = |flags: &str| {
        let line = format!(
            "render plain.json --beta 0.5 --steps 0 --size 40x60 --fov 30 --samples 1 --searchlight {flags} -o -"
        );
        let bytes = workplace.run(&line).success().stdout;
        image::load_from_memory(&bytes).unwrap().into_rgb8()
    };
    let brightest = |picture: &image::RgbImage, columns: std::ops::Range<u32>| {
        let pixels = picture.enumerate_pixels();
        let inside = pixels.filter(|(x, y, _)| columns.contains(x) && *y > 20);
        inside.map(|(_, _, pixel)| pixel.0[1]).max().unwrap()
    };
    let alone = picture("--models rest --exposure auto");
    let beside = picture("--models seen,rest --exposure auto");
    assert!(brightest(&beside, 44..84) < brightest(&alone, 0..40));
    workplace
        .run("render plain.json --models seen,rest --size 16000x10 -o wide.png")
        .error(&["--models", "side by side"]);
}

/// A ghost of each kind changes both views, and both methods of the observer's have it.
#[test]
fn ghosts_are_in_both_views() {
    let workplace = workplace();
    let picture = |flags: &str| {
        let line = format!("render plain.json --steps 0 --size 48x36 --samples 1 {flags} -o -");
        workplace.run(&line).success().stdout
    };
    for view in ["--fov 100", "--fov 100 --method mesh", "--view outside"] {
        let mut all: Vec<Vec<u8>> = vec![picture(view)];
        for model in MODELS {
            all.push(picture(&format!("{view} --ghost {model}")));
        }
        // Nothing is a ghost of itself.
        assert!(all[0] == all[1], "{view}: the ghost of what is seen");
        all.remove(1);
        for (number, one) in all.iter().enumerate() {
            assert!(
                all[..number].iter().all(|other| other != one),
                "{view}: ghost {number}"
            );
        }
    }
    workplace
        .run("render plain.json --ghost flat")
        .error(&["flat", "contracted"]);
}
