"""three.js reads from every kind of file what the file's own JSON says is there."""

import io
import json
import os
import subprocess
from pathlib import Path

import numpy
import pytest
from PIL import Image

import glb
import handmade
from kinds import FRAMES_PER_SECOND, KINDS, PLAYING

SCRIPT = Path(__file__).with_name("three.cjs")

# What three.js calls the attributes of glTF that it knows; it writes all others in lower case.
ATTRIBUTES = {
    "POSITION": "position",
    "NORMAL": "normal",
    "TANGENT": "tangent",
    "COLOR_0": "color",
    "TEXCOORD_0": "uv",
    "TEXCOORD_1": "uv1",
    "TEXCOORD_2": "uv2",
    "TEXCOORD_3": "uv3",
}


def ask(path, *times):
    """What three.js finds in a file, and where it puts the vertices at these times of the animations."""
    command = ["node", SCRIPT, path, *map(str, times)]
    done = subprocess.run(command, capture_output=True, text=True, env=os.environ)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return json.loads(done.stdout)


def shown(pose):
    """The meshes that have a size, by name, with their vertices in the world."""
    return {
        name: numpy.array(mesh["positions"])
        for name, mesh in pose.items()
        if numpy.abs(mesh["scale"]).min() > 0
    }


@pytest.fixture(scope="module", params=KINDS)
def read(request, export, tmp_path_factory):
    """Of each file of a kind: its JSON, and what three.js finds."""
    paths = KINDS[request.param](export, tmp_path_factory.mktemp("sources"))
    return [(glb.Gltf(path), ask(path)) for path in paths]


def each_mesh(read):
    """Each node of the files with the mesh that it is in three.js."""
    for document, answer in read:
        assert [mesh["name"] for mesh in answer["meshes"]] == [node.name for node in document.nodes]
        for node, mesh in zip(document.nodes, answer["meshes"], strict=True):
            yield document, node, mesh


def test_meshes_have_the_names_of_nodes_and_their_attributes(read):
    for _, node, mesh in each_mesh(read):
        assert mesh["indices"] == node.triangles.ravel().tolist()
        names = {ATTRIBUTES.get(name, name.lower()): name for name in node.attributes}
        assert mesh["attributes"].keys() == names.keys()
        for name, written in names.items():
            values = node.attributes[written]
            if values.dtype == numpy.uint8:
                values = values / 255  # normalized
            assert numpy.array_equal(mesh["attributes"][name], values.reshape(len(values), -1)), written


def test_places_are_exact(read):
    """three.js adds the translation in f64: the place is that in the file to the last bit."""
    for document, answer in read:
        for node in document.nodes:
            place = numpy.array(answer["pose"][node.name]["positions"])
            scale = numpy.array(node.json.get("scale", [1, 1, 1]))
            assert place.tolist() == (node.translation + scale * node.positions.astype(float)).tolist()


def test_facts_are_user_data(read):
    for document, answer in read:
        (scene,) = document.json["scenes"]
        assert answer["scene"] == scene.get("extras", {})
    for _, node, mesh in each_mesh(read):
        # three.js adds the name itself, and what is known of the mesh.
        extras = node.mesh.get("extras", {}) | node.json.get("extras", {})
        assert mesh["extras"] == extras | {"name": node.name}


def test_materials(read):
    for document, node, mesh in each_mesh(read):
        found, written = mesh["material"], node.material
        surface = written.get("pbrMetallicRoughness", {})
        assert found["name"] == written.get("name", "")
        assert [*found["color"], found["opacity"]] == surface.get("baseColorFactor", [1, 1, 1, 1])
        # What is multiplied by the colours of the vertices: white, where they are all that is to be seen.
        assert found["vertexColors"] == ("COLOR_0" in node.attributes)
        assert found["emissive"] == written.get("emissiveFactor", [0, 0, 0])
        assert found["metalness"] == surface.get("metallicFactor", 1)
        assert found["roughness"] == surface.get("roughnessFactor", 1)
        assert found["doubleSided"] == written.get("doubleSided", False)
        assert found["transparent"] == (written.get("alphaMode") == "BLEND")
        textures = {
            "map": surface.get("baseColorTexture"),
            "metalnessMap": surface.get("metallicRoughnessTexture"),
            "roughnessMap": surface.get("metallicRoughnessTexture"),
            "normalMap": written.get("normalTexture"),
            "aoMap": written.get("occlusionTexture"),
            "emissiveMap": written.get("emissiveTexture"),
        }
        for name, texture in textures.items():
            assert (found[name] is None) == (texture is None), name
            if texture is not None:
                size = Image.open(io.BytesIO(document.picture(texture))).size
                assert found[name]["size"] == list(size)
                # Colours are sRGB, all else is data.
                assert found[name]["sRGB"] == (name in ("map", "emissiveMap"))


def test_pictures_are_looked_at_in_some_kind(export, tmp_path):
    """Else the test above would say nothing of them."""
    (path,) = KINDS["hierarchy with a texture"](export, tmp_path)
    sizes = [mesh["material"]["map"] and mesh["material"]["map"]["size"] for mesh in ask(path)["meshes"]]
    assert sizes == [[8, 4], [8, 4], None] * 2


def test_animations_arrive_whole(read):
    for document, answer in read:
        assert_animations_arrive(document, answer)


def assert_animations_arrive(document, answer):
    """Every channel is a track with the same keys."""
    tracks = {"scale": "scale", "weights": "morphTargetInfluences", "translation": "position", "rotation": "quaternion"}
    animations = document.json.get("animations", [])
    assert [clip["name"] for clip in answer["animations"]] == [it["name"] for it in animations]
    for written, clip in zip(animations, answer["animations"], strict=True):
        for channel, track in zip(written["channels"], clip["tracks"], strict=True):
            sampler = written["samplers"][channel["sampler"]]
            node = document.json["nodes"][channel["target"]["node"]]
            assert track["name"] == f"{node['name']}.{tracks[channel['target']['path']]}"
            assert track["interpolation"] == sampler.get("interpolation", "LINEAR")
            assert track["times"] == document.accessor(sampler["input"]).tolist()
            assert track["values"] == document.accessor(sampler["output"]).ravel().tolist()


@pytest.mark.parametrize("kind", PLAYING)
def test_each_frame_shows_its_step(kind, export, tmp_path):
    """To the last bit; and a mesh for each step stays until the next."""
    (path,) = PLAYING[kind](export, tmp_path)
    document = glb.Gltf(path)
    morphs = any(node.targets for node in document.nodes)
    # Seconds as an f32 holds them: 1 / 24 is none.
    times = [float(numpy.float32(step / FRAMES_PER_SECOND)) for step in range(7)]
    parts = [0] if morphs else [0, 0.9]
    times = [time + part / FRAMES_PER_SECOND for time in times for part in parts]
    poses = ask(path, *times)["poses"]
    for index, pose in enumerate(poses):
        expected = document.at_step(index // len(parts))
        found = shown(pose["meshes"])
        assert found.keys() == expected.keys()
        for name, places in expected.items():
            assert found[name].tolist() == places.tolist(), (index, name)


# What the questions about animations rest on: files made by hand, the poses of which are known.


@pytest.mark.parametrize(
    ("time", "step"), [(0, 0), (0.25, 0), (0.499, 0), (0.5, 1), (0.75, 1), (0.999, 1), (1, 2), (2, 2)]
)
def test_scale_keys_show_one_step_at_a_time(time, step, tmp_path):
    path = handmade.write_scale_keys(tmp_path)
    answer = ask(path, time)
    assert_animations_arrive(glb.Gltf(path), answer)
    ((name, places),) = shown(answer["poses"][0]["meshes"]).items()
    assert name == handmade.step_name(step)
    assert places.tolist() == (handmade.STEPS[step] + handmade.TRANSLATIONS[step]).tolist()


def test_morph_targets_go_from_step_to_step(tmp_path):
    times = [0, 0.25, 0.5, 0.75, 1]
    path = handmade.write_morph_targets(tmp_path)
    answer = ask(path, *times)
    assert_animations_arrive(glb.Gltf(path), answer)
    assert answer["meshes"][0]["morphTargets"] == [handmade.step_name(1), handmade.step_name(2)]
    first, second, third = (step + handmade.TRANSLATIONS[0] for step in handmade.STEPS)
    expected = [first, (first + second) / 2, second, (second + third) / 2, third]
    for pose, places in zip(answer["poses"], expected, strict=True):
        assert shown(pose["meshes"])["thing"].tolist() == places.tolist()
