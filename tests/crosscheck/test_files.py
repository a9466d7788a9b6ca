"""What the files promise beyond what readers check: exact bounds, plain structure, the same bytes."""

import numpy
import pytest

import glb
from oracle import Moment, Source, View
from scenes import CUBE, SEVERAL, SPHERE, TORUS, write_obj

SCENES = {"sphere": SPHERE, "cube": CUBE, "torus": TORUS, "several": SEVERAL}


@pytest.fixture(params=[*SCENES, "obj"])
def scene(request, tmp_path):
    if request.param == "obj":
        return {"objects": [{"name": "roof", "file": str(write_obj(tmp_path))}]}
    return SCENES[request.param]


def test_bounds_are_exact(scene, export):
    document = glb.Gltf(export(scene))
    for node in document.nodes:
        (primitive,) = node.mesh["primitives"]
        spec = document.json["accessors"][primitive["attributes"]["POSITION"]]
        assert spec["min"] == node.positions.min(axis=0).tolist()
        assert spec["max"] == node.positions.max(axis=0).tolist()


def test_the_structure_is_plain(scene, export):
    """One scene of meshes that only translate, those of each of several steps below one node; core glTF, names that every
    program keeps."""
    document = glb.Gltf(export(scene))
    json = document.json
    assert json["asset"]["version"] == "2.0"
    assert "extensionsUsed" not in json
    assert len(json["scenes"]) == 1
    steps = {node.extras["step"] for node in document.nodes if "extras" in node.json}
    parents = [node for node in json["nodes"] if "mesh" not in node]
    times = json["scenes"][0]["extras"]["steps"]
    expected = [
        {
            "name": f"step{step:03}",
            "children": [
                index for index, node in enumerate(json["nodes"]) if "mesh" in node and node.get("extras", {}).get("step") == step
            ],
            "extras": {"step": step, "proper_time": times[step]},
        }
        for step in sorted(steps if len(steps) > 1 else [])
    ]
    assert parents == expected
    below = {child for parent in parents for child in parent["children"]}
    roots = [index for index in range(len(json["nodes"])) if index not in below]
    assert json["scenes"][0]["nodes"] == roots
    names = [node["name"] for node in json["nodes"]]
    assert len(set(names)) == len(names)
    for node in json["nodes"]:
        # three.js drops or replaces these.
        assert not set(node["name"]) & set("[].:/") and not any(c.isspace() for c in node["name"])
        if "mesh" not in node:
            continue
        assert node["name"] == json["meshes"][node["mesh"]]["name"]
        assert node.keys() <= {"name", "mesh", "translation", "extras"}
    for mesh in json["meshes"]:
        (primitive,) = mesh["primitives"]
        assert primitive.get("mode", 4) == 4  # triangles
        assert json["accessors"][primitive["indices"]]["componentType"] == 5125  # u32


def test_normals_are_unit(scene, export):
    for node in glb.Gltf(export(scene)).nodes:
        length = numpy.linalg.norm(node.attributes["NORMAL"].astype(float), axis=1)
        assert abs(length - 1).max() <= 2**-24 * 1.001  # each component is rounded by 2^-24 of itself


def test_numbers_are_finite(scene, export):
    for node in glb.Gltf(export(scene)).nodes:
        for name, values in node.attributes.items():
            assert numpy.isfinite(values).all(), f"{node.name} {name}"


def test_local_positions_stay_near_the_translation(scene, export):
    """The translation is near the middle, so that f32 has little to hold: half the extent, or hardly more."""
    for node in glb.Gltf(export(scene)).nodes:
        half_extent = numpy.ptp(node.positions.astype(float), axis=0).max() / 2
        assert abs(node.positions).max() <= 1.125 * half_extent


def test_the_same_bytes_every_time(scene, export, photosurface, tmp_path):
    """On two runs, and for any number of threads."""
    path = export(scene)
    for threads in (1, 3):
        again = tmp_path / f"{threads}.glb"
        photosurface(
                "export", path.parent / "scene.json", "-o", again, "--allow-read", tmp_path, threads=threads
            )
        assert again.read_bytes() == path.read_bytes()


def test_stdout_holds_the_same_file(export, photosurface):
    path = export(CUBE)
    scene = path.parent / "scene.json"
    assert photosurface("export", scene, "-o", "-") == path.read_bytes()
    assert photosurface("export", "-", "-o", "-", stdin=scene.read_bytes()) == path.read_bytes()


def test_facts_about_each_step(export):
    """Counts, step, proper time and relative gamma as the file and the oracle know them."""
    for node in glb.Gltf(export(SEVERAL)).nodes:
        if node.name == "observer":
            continue
        facts = node.extras
        assert facts["name"] == node.name
        assert (facts["vertices"], facts["triangles"]) == (len(node.positions), len(node.triangles))
        (spec,) = [spec for spec in SEVERAL["objects"] if spec["name"] == facts["object"]]
        assert facts["proper_time"] == SEVERAL["steps"][facts["step"]]
        gamma = View(Moment.of_scene(SEVERAL), Source.of_object(spec)).relative_gamma()
        # Two speeds given to half an ulp, a composition and a cosh.
        assert abs(facts["relative_gamma"] / gamma - 1) < 2**-49


def test_colours_are_written_linear(export):
    """glTF's factors are linear, "#rrggbb" is sRGB: by the two-piece curve of IEC 61966-2-1."""
    document = glb.Gltf(export(SEVERAL))
    (drum, *_) = [node for node in document.nodes if node.name.startswith("drum")]
    (primitive,) = drum.mesh["primitives"]
    material = document.json["materials"][primitive["material"]]
    *colour, opacity = material["pbrMetallicRoughness"]["baseColorFactor"]
    linear = [((value / 255 + 0.055) / 1.055) ** 2.4 for value in (0xC0, 0x40, 0x20)]
    assert abs(numpy.array(colour) - linear).max() < 2**-23  # written with the digits of an f32
    assert opacity == 1
