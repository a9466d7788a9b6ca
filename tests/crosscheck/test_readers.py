"""trimesh and pyvista read from the files what the files' own JSON says is there."""

import json

import numpy
import pytest
import pyvista
import trimesh

import glb
import ply
from scenes import CUBE, SEVERAL, SPHERE, write_obj

SCENES = {"sphere": SPHERE, "cube": CUBE, "several": SEVERAL}


@pytest.fixture(params=["sphere", "cube", "several", "obj"])
def exported(request, export, tmp_path):
    """A file, and what its JSON says."""
    if request.param == "obj":
        path = export({"objects": [{"name": "roof", "file": str(write_obj(tmp_path))}], "steps": [0, 1]})
    else:
        path = export(SCENES[request.param])
    return path, glb.Gltf(path)


def test_names_of_steps(export):
    names = [node.name for node in glb.Gltf(export(SPHERE)).nodes]
    assert names == ["sphere_step000", "sphere_step001", "sphere_step002"]


def test_the_name_of_a_single_step(export):
    (node,) = glb.Gltf(export({**SPHERE, "steps": [0]})).nodes
    assert node.name == "sphere"


def test_the_marker_is_a_ball_around_the_origin(export):
    """Every step's observer is at the origin of its own frame: one marker is enough."""
    (marker,) = [n for n in glb.Gltf(export(SEVERAL)).nodes if n.name == "observer"]
    radius = SEVERAL["observer"]["marker"]
    # In f32: each coordinate is rounded by at most 2^-24 of itself.
    assert abs(numpy.linalg.norm(marker.world, axis=1) / radius - 1).max() < 2**-23


def test_trimesh_finds_every_part(exported):
    path, document = exported
    scene = trimesh.load_scene(path, process=False, merge_primitives=False)
    assert sorted(scene.graph.nodes_geometry) == sorted(node.name for node in document.nodes)
    for node in document.nodes:
        transform, geometry_name = scene.graph[node.name]
        geometry = scene.geometry[geometry_name]
        assert geometry_name == node.name
        assert transform[:3, :3].tolist() == numpy.eye(3).tolist()
        assert transform[:3, 3].tolist() == node.translation.tolist()
        assert geometry.vertices.tolist() == node.positions.astype(float).tolist()
        assert geometry.faces.tolist() == node.triangles.tolist()
        assert geometry.vertex_normals.tolist() == node.attributes["NORMAL"].astype(float).tolist()


def test_trimesh_reads_the_extras(exported):
    """Those of the scene, and those of each node as metadata of its geometry or its edge in the graph."""
    path, document = exported
    scene = trimesh.load_scene(path, process=False)
    (spec,) = document.json["scenes"]
    for key, value in spec["extras"].items():
        assert scene.metadata[key] == value, key
    for node in document.nodes:
        edge = scene.graph.transforms.edge_data[(scene.graph.transforms.parents[node.name], node.name)]
        assert edge.get("metadata", {}) == node.json.get("extras", {})


def test_pyvista_finds_as_much(exported):
    """pyvista keeps no names and rounds places to f32: counts and bounds remain."""
    path, document = exported
    blocks = pyvista.read(path).combine()
    world = numpy.concatenate([node.world for node in document.nodes])
    triangles = sum(len(node.triangles) for node in document.nodes)
    assert (blocks.n_points, blocks.n_cells) == (len(world), triangles)
    bounds = numpy.array(blocks.bounds).reshape(3, 2)
    # Two roundings to f32: that of the translation and that of the sum.
    limit = 2 * 2**-24 * (numpy.abs(world).max() + max(abs(n.translation).max() for n in document.nodes))
    assert abs(bounds[:, 0] - world.min(axis=0)).max() <= limit
    assert abs(bounds[:, 1] - world.max(axis=0)).max() <= limit


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES)
def test_ply_and_glb_hold_the_same(scene, export):
    """The .ply is the parts of the .glb one after the other, with places that are not rounded to f32."""
    found = ply.read(export(scene, to="out.ply"))
    nodes = glb.Gltf(export(scene)).nodes
    starts = numpy.cumsum([0, *(len(node.positions) for node in nodes)])
    triangles = numpy.concatenate([n.triangles + start for n, start in zip(nodes, starts, strict=False)])
    assert found.triangles.tolist() == triangles.tolist()
    normals = numpy.concatenate([node.attributes["NORMAL"] for node in nodes])
    assert found.normals.tolist() == normals.tolist()
    for node, start in zip(nodes, starts, strict=False):
        places = found.positions[start : start + len(node.positions)]
        limit = 2**-24 * abs(node.positions) + 2**-52 * abs(places)
        assert (abs(places - node.world) <= limit).all()


def test_pictures_arrive_with_their_coordinates(export, tmp_path):
    """The OBJ's painted quad, seen by an observer at rest, has the picture laid from corner to corner."""
    spec = {"name": "roof", "file": str(write_obj(tmp_path))}
    path = export({"objects": [spec]})
    scene = trimesh.load_scene(path, process=False, merge_primitives=False)
    (node,) = [node for node in glb.Gltf(path).nodes if "TEXCOORD_0" in node.attributes]
    painted = scene.geometry[node.name].visual
    assert painted.uv.tolist() == ((node.world[:, :2] + 1) / 2).tolist()
    assert colours(painted.material.baseColorTexture) == [[10, 200, 30]]


def colours(picture):
    """Every colour in it, once."""
    return numpy.unique(numpy.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0).tolist()


def test_a_checker_shows_its_two_colours(export):
    path = export(SEVERAL)
    scene = trimesh.load_scene(path, process=False, merge_primitives=False)
    found = colours(scene.geometry["ball_step000"].visual.material.baseColorTexture)
    # That of "checker" as it is written, and the colour of an object that names none.
    assert len(found) == 2
    assert [0x20, 0x40, 0x80] in found


def test_pyvista_reads_ply(export):
    path = export(CUBE, to="out.ply")
    found, expected = pyvista.read(path), ply.read(path)
    assert (found.n_points, found.n_cells) == (len(expected.positions), len(expected.triangles))
    assert abs(found.points - expected.positions).max() <= 2**-24 * abs(expected.positions).max()


def test_split_files_hold_one_step_each(export):
    """The same nodes as in one file, one file for each step."""
    together = glb.Gltf(export(SPHERE))
    paths = sorted(export(SPHERE, "--split", to="split.glb").parent.glob("*.glb"))
    assert len(paths) == len(SPHERE["steps"])
    for path, whole in zip(paths, together.nodes, strict=True):
        (node,) = glb.Gltf(path).nodes
        assert node.extras["step"] == whole.extras["step"]
        assert node.world.tolist() == whole.world.tolist()


def test_gltf_with_a_separate_buffer_holds_the_same(export):
    together = glb.Gltf(export(CUBE))
    apart = glb.Gltf(export(CUBE, to="out.gltf"))
    for a, b in zip(apart.nodes, together.nodes, strict=True):
        assert (a.name, a.extras) == (b.name, b.extras)
        assert a.world.tolist() == b.world.tolist()
        assert a.triangles.tolist() == b.triangles.tolist()


def test_the_report_says_what_the_extras_say(exported):
    path, document = exported
    report = json.loads((path.parent / "report.json").read_text())
    (scene,) = document.json["scenes"]
    assert report["scene"] == scene["extras"]
    assert report["objects"] == [node.extras for node in document.nodes if node.name != "observer"]
