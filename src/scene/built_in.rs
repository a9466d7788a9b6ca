//! The scenes that the program carries with it.

/// A scene that is part of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuiltInScene {
    /// What it is called on the command line.
    pub name: &'static str,
    /// What it shows.
    pub summary: &'static str,
    /// The scene file.
    pub json: &'static str,
}

/// All built-in scenes; the first is the one taken when none is named.
pub const BUILT_IN_SCENES: &[BuiltInScene] = &[
    BuiltInScene {
        name: "sphere",
        summary: "a sphere flies by at 0.95 c, seven steps (Rau et al. 1998, Fig. 3)",
        json: include_str!("../../examples/scenes/sphere.json"),
    },
    BuiltInScene {
        name: "cube",
        summary: "a cube flies by at 0.9 c, six steps (Rau et al. 1998, Fig. 4)",
        json: include_str!("../../examples/scenes/cube.json"),
    },
    BuiltInScene {
        name: "terrell",
        summary: "a cube at 0.8 c, abeam: it looks turned by 53 degrees (Terrell 1959)",
        json: include_str!("../../examples/scenes/terrell.json"),
    },
    BuiltInScene {
        name: "stretched",
        summary: "a sphere ahead at 0.95 c: stretched to six times its width, its outline a circle (Penrose 1959)",
        json: include_str!("../../examples/scenes/stretched.json"),
    },
    BuiltInScene {
        name: "plane",
        summary: "a plane across the motion at 0.95 c: a sheet of a hyperboloid",
        json: include_str!("../../examples/scenes/plane.json"),
    },
    BuiltInScene {
        name: "speeds",
        summary: "one cube at 0.1, 0.5, 0.9 and 0.99 c, all seen abeam at once",
        json: include_str!("../../examples/scenes/speeds.json"),
    },
    BuiltInScene {
        name: "rod",
        summary: "two rods at 0.9 c: along the motion, long and then short; across it, bent",
        json: include_str!("../../examples/scenes/rod.json"),
    },
    BuiltInScene {
        name: "lattice",
        summary: "into a lattice of bars at 0.9 c: straight bars become hyperbolas",
        json: include_str!("../../examples/scenes/lattice.json"),
    },
    BuiltInScene {
        name: "street",
        summary: "down a street of cubes at 0.95 c: what lies beside comes into view ahead",
        json: include_str!("../../examples/scenes/street.json"),
    },
    BuiltInScene {
        name: "night",
        summary: "down a street at night at 0.9 c, lit by its own lamps, light shifted in colour and brightness",
        json: include_str!("../../examples/scenes/night.json"),
    },
    BuiltInScene {
        name: "snapshot",
        summary: "a sphere at 0.999 c and a cube at 0.8 c, as photographed by Hornof et al. 2025",
        json: include_str!("../../examples/scenes/snapshot.json"),
    },
    BuiltInScene {
        name: "flight",
        summary: "over a test scene, accelerating from 0.95 c to 0.994 c (Rau et al. 1998, Figs 6-9)",
        json: include_str!("../../examples/scenes/flight.json"),
    },
    BuiltInScene {
        name: "takeoff",
        summary: "constant thrust from rest: what is ahead recedes first, then all freezes on the horizon",
        json: include_str!("../../examples/scenes/takeoff.json"),
    },
    BuiltInScene {
        name: "turn",
        summary: "a coordinated turn at 0.9 c, as an airplane flies it",
        json: include_str!("../../examples/scenes/turn.json"),
    },
    BuiltInScene {
        name: "orbit",
        summary: "a full circle at 0.6 c",
        json: include_str!("../../examples/scenes/orbit.json"),
    },
    BuiltInScene {
        name: "models",
        summary: "a sphere and a cube at 0.9 c; try --models seen,delayed,contracted,rest --sheet",
        json: include_str!("../../examples/scenes/models.json"),
    },
    BuiltInScene {
        name: "stars",
        summary: "a sky of stars at 0.9 c: black bodies, shifted and crowded ahead; try --full-sky",
        json: include_str!("../../examples/scenes/stars.json"),
    },
];

impl BuiltInScene {
    /// The built-in scene of that name.
    pub fn named(name: &str) -> Option<&'static Self> {
        BUILT_IN_SCENES.iter().find(|scene| scene.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Scene;
    use super::*;

    #[test]
    fn every_built_in_scene_is_a_scene_and_fits_the_schema() {
        let schema = Scene::json_schema();
        let validator = jsonschema::validator_for(schema.as_value()).unwrap();
        for built_in in BUILT_IN_SCENES {
            let scene = Scene::from_json(built_in.json);
            assert!(scene.is_ok(), "{}: {}", built_in.name, scene.unwrap_err());
            let json = serde_json::from_str(built_in.json).unwrap();
            let faults: Vec<_> = validator
                .iter_errors(&json)
                .map(|e| e.to_string())
                .collect();
            assert!(faults.is_empty(), "{}: {faults:?}", built_in.name);
        }
    }
}
