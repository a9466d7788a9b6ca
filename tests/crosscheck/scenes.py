"""The scenes that the cross-check asks about: each is awkward in another way."""

from PIL import Image

# The observer moves along an axis, in a few steps, past a curved surface.
SPHERE = {
    "observer": {"velocity": {"beta": 0.95, "direction": [-1, 0, 0]}},
    "objects": [
        {
            "name": "sphere",
            "shape": {"sphere": {"radius": 1, "resolution": 48}},
            "position": [0, 3, 0],
        }
    ],
    "steps": [-6, 0, 2],
    # What so many facets allow.
    "tolerance": {"relative": 0.02},
}

# Both move, in different directions (so that boosts do not commute), the observation is not at the
# origin, and the object is turned and scaled unevenly.
CUBE = {
    "observer": {"time": 1.5, "position": [2, -1, 0.5], "velocity": [0.3, -0.5, 0.6]},
    "objects": [
        {
            "name": "cube",
            "shape": {"box": {"size": [1, 2, 0.5], "resolution": 6}},
            "position": [-3, 2, 1],
            "rotation": [0.1, 0.7, -0.1, 0.7],
            "scale": [1, 2, 3],
            "velocity": {"gamma": 5, "direction": [1, -2, 2]},
        }
    ],
    "steps": {"from": -1, "to": 2, "count": 4},
}

# As good as light speed: the seen size is a thousand times the true one.
TORUS = {
    "observer": {"velocity": {"one_minus_beta": 1e-7, "direction": [0, 0, -1]}},
    "objects": [
        {
            "name": "torus",
            "shape": {"torus": {"major_radius": 2, "minor_radius": 0.5, "resolution": 32}},
            "position": [0, 1, -3],
            "scale": 2,
        }
    ],
    # What so many facets allow.
    "tolerance": {"relative": 0.02},
}

# The observer flies, its axes turned: every kind of segment, before, within and after them.
FLIGHT = {
    "observer": {
        "time": 0.5,
        "position": [1, 0, 2],
        "velocity": {"beta": 0.6, "direction": [0, 0, -1]},
        "orientation": [0.1, 0.7, -0.1, 0.7],
        "flight": [
            {"proper_time": 1.5, "acceleration": [0.5, 0.2, 0], "turn_rate": [0, 0.1, 0.7]},
            {"proper_time": 1, "acceleration": [0, 0, -1], "turn_rate": [0, 1, 0]},
            {"proper_time": 0.5},
            {"proper_time": 2, "acceleration": [0.3, -0.4, 0.1]},
        ],
    },
    "objects": [
        {
            "name": "cube",
            "shape": {"box": {"size": [1, 2, 0.5], "resolution": 4}},
            "position": [-3, 2, 1],
            "velocity": {"gamma": 2, "direction": [1, -2, 2]},
        }
    ],
    "steps": [-1, 0, 0.75, 2, 2.75, 4, 7],
}

# A coordinated turn, a full circle at 0.6 c.
ORBIT = {
    "observer": {
        "velocity": {"beta": 0.6, "direction": [0, 0, -1]},
        "flight": [{"proper_time": 8.377580409572782, "acceleration": [-0.5625, 0, 0], "steer": "coordinated"}],
    },
    "objects": [
        {"name": "cube", "shape": {"box": {"size": [1, 2, 0.5], "resolution": 4}}, "position": [-1, 3, 0]}
    ],
    "steps": [0, 2, 5, 8.377580409572782],
}

# Several objects at once, one of which recedes from the other.
SEVERAL = {
    "title": "several objects",
    "observer": {"velocity": {"rapidity": 1.5, "direction": [1, 1, 0]}, "marker": 0.25},
    "objects": [
        {"name": "ball", "shape": {"sphere": {"radius": 0.5}}, "position": [4, 0, 0], "checker": "#204080"},
        {
            "name": "drum",
            "shape": {"cylinder": {"radius": 1, "height": 2}},
            "position": [0, -3, 1],
            "color": "#c04020",
            "velocity": {"beta": 0.5, "direction": [0, 0, 1]},
        },
    ],
    "steps": [0, 1.25],
}

# A textured quad and a plain pyramid, each of a material of its own. All coordinates are f32 numbers.
OBJ = """
mtllib materials.mtl
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
v 0.25 0 1.5
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vn 0 0 -1
usemtl painted
f 1/1/1 4/4/1 3/3/1 2/2/1
usemtl plain
f 1 2 5
f 2 3 5
f 3 4 5
f 4 1 5
"""

MTL = """
newmtl painted
Kd 1 1 1
map_Kd paint.png
newmtl plain
Kd 0.8 0.2 0.1
"""


def write_obj(directory):
    """An OBJ file with materials and a texture; returns its path."""
    (directory / "roof.obj").write_text(OBJ)
    (directory / "materials.mtl").write_text(MTL)
    Image.new("RGB", (4, 4), (10, 200, 30)).save(directory / "paint.png")
    return directory / "roof.obj"


def write_airplane(directory):
    """pyvista's example mesh as trimesh writes it, in GLB; returns its path."""
    # Here, because the environment of Blender and MeshLab uses these scenes too but has no pyvista.
    import pyvista.examples
    import trimesh

    trimesh.load(pyvista.examples.planefile, process=False).export(directory / "airplane.glb")
    return directory / "airplane.glb"
