"""Meshes that nobody here made come back as they were where nothing moves: Blender's own, and MeshLab's samples.

At rest, with the observer at the origin and no subdivision, the photosurface is the mesh itself.
"""

from pathlib import Path

import bpy
import numpy
import pymeshlab
import pytest

import glb
import ply

SAMPLES = Path(pymeshlab.__file__).parent / "tests/sample_meshes"

PRIMITIVES = {
    "cube": lambda: bpy.ops.mesh.primitive_cube_add(),
    "ball": lambda: bpy.ops.mesh.primitive_uv_sphere_add(),
    "icosphere": lambda: bpy.ops.mesh.primitive_ico_sphere_add(),
    "cone": lambda: bpy.ops.mesh.primitive_cone_add(),
    "cylinder": lambda: bpy.ops.mesh.primitive_cylinder_add(),
    "torus": lambda: bpy.ops.mesh.primitive_torus_add(),
    "grid": lambda: bpy.ops.mesh.primitive_grid_add(),
    "monkey": lambda: bpy.ops.mesh.primitive_monkey_add(),
}


def paint(mesh):
    """A material with a picture, and a colour at every vertex."""
    material = bpy.data.materials.new(mesh.name)
    nodes, links = material.node_tree.nodes, material.node_tree.links
    picture = nodes.new("ShaderNodeTexImage")
    picture.image = bpy.data.images.new(mesh.name, 8, 4)
    picture.image.generated_type = "COLOR_GRID"
    colours = nodes.new("ShaderNodeVertexColor")
    colours.layer_name = "Col"
    mixed = nodes.new("ShaderNodeMix")
    mixed.data_type, mixed.blend_type = "RGBA", "MULTIPLY"
    mixed.inputs["Factor"].default_value = 1
    links.new(picture.outputs["Color"], mixed.inputs["A"])
    links.new(colours.outputs["Color"], mixed.inputs["B"])
    links.new(mixed.outputs["Result"], nodes["Principled BSDF"].inputs["Base Color"])
    mesh.materials.append(material)
    layer = mesh.color_attributes.new("Col", "BYTE_COLOR", "CORNER")
    for index, entry in enumerate(layer.data):
        entry.color = [index % 5 / 4, index % 3 / 2, index % 2, 1]


@pytest.fixture(scope="module")
def from_blender(tmp_path_factory):
    """All of Blender's meshes, turned and moved, in one GLB that Blender itself writes."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for number, (name, add) in enumerate(PRIMITIVES.items()):
        add()
        made = bpy.context.object
        made.name = made.data.name = name
        made.location = (3.1 * number, 0.7, -number / 3)
        made["number"] = number
        paint(made.data)
    path = tmp_path_factory.mktemp("blender") / "primitives.glb"
    done = bpy.ops.export_scene.gltf(filepath=str(path), export_extras=True, export_vertex_color="MATERIAL")
    assert done == {"FINISHED"}
    return path


def at_rest(path):
    return {"objects": [{"name": "it", "file": str(path)}]}


def test_meshes_of_blender(from_blender, export):
    before = glb.Gltf(from_blender)
    after = glb.Gltf(export(at_rest(from_blender), "--no-subdivide"))
    assert sorted(node.name for node in before.nodes) == sorted(PRIMITIVES)
    for old, new in zip(before.nodes, after.nodes, strict=True):
        assert new.name == f"it_{old.name}"
        assert new.triangles.tolist() == old.triangles.tolist()
        assert new.attributes.keys() == old.attributes.keys() >= {"NORMAL", "TEXCOORD_0", "COLOR_0"}
        # What an f32 beside a translation in f64 cannot hold, and nothing else.
        limit = 2**-24 * abs(new.positions) + 2**-52 * abs(old.world)
        assert (abs(new.world - old.world) <= limit).all()
        assert new.attributes["TEXCOORD_0"].tolist() == old.attributes["TEXCOORD_0"].tolist()
        # Blender's are as long as f32 has them, ours made unit in f64 first.
        assert abs(new.attributes["NORMAL"] - old.attributes["NORMAL"]).max() <= 2**-22
        colours = old.attributes["COLOR_0"]
        if colours.dtype.kind == "u":
            colours = colours / numpy.iinfo(colours.dtype).max
        found = new.attributes["COLOR_0"] / 255
        assert abs(found[:, : colours.shape[1]] - colours).max() <= 0.5 / 255 + 2**-24
        assert numpy.ptp(found[:, :3]) == 1
        assert new.json["extras"]["source"]["node"] == old.json["extras"]


def test_pictures_of_blender(from_blender, export):
    """Byte for byte."""
    before = glb.Gltf(from_blender)
    after = glb.Gltf(export(at_rest(from_blender), "--no-subdivide"))
    for old, new in zip(before.nodes, after.nodes, strict=True):
        pictures = [
            document.picture(node.material["pbrMetallicRoughness"]["baseColorTexture"])
            for document, node in [(before, old), (after, new)]
        ]
        assert pictures[0] == pictures[1]
        assert len(pictures[0]) > 0


def read_obj(path):
    """The corners of the triangles of a file of triangles: their places, texture coordinates and normals."""
    tables = {"v": [], "vt": [], "vn": []}
    corners = []
    for line in path.read_text().splitlines():
        word, *rest = line.split() or [""]
        if word in tables:
            tables[word].append([float(number) for number in rest])
        elif word == "f":
            assert len(rest) == 3
            corners += [[int(index or 0) for index in corner.split("/")] for corner in rest]
    columns = zip(*corners, strict=True)
    # An index may count from the end, which then is -1.
    found = {}
    for (name, table), indices in zip(tables.items(), columns, strict=False):
        indices = numpy.array(indices)
        if indices.any():
            found[name] = numpy.array(table)[indices - (indices > 0)]
    return found


@pytest.mark.parametrize("name", ["airplane", "bunny", "bunny10k_textured", "cow", "cube"])
def test_samples_of_meshlab(name, export):
    """Places to the last bit of an f64 (.ply), texture coordinates to that of an f32 (.glb)."""
    path = SAMPLES / f"{name}.obj"
    before = read_obj(path)
    exact = ply.read(export(at_rest(path), "--no-subdivide", to="out.ply"))
    assert exact.positions[exact.triangles.ravel()].tolist() == before["v"][:, :3].tolist()
    (node,) = glb.Gltf(export(at_rest(path), "--no-subdivide")).nodes
    corners = node.triangles.ravel()
    assert (abs(node.world[corners] - before["v"][:, :3]) <= 2**-24 * abs(node.positions[corners])).all()
    assert ("TEXCOORD_0" in node.attributes) == ("vt" in before)
    if "vt" in before:
        expected = numpy.column_stack([before["vt"][:, 0], 1 - before["vt"][:, 1]])
        assert abs(node.attributes["TEXCOORD_0"][corners] - expected).max() <= 2**-24 * abs(expected).max()
    if "vn" in before:
        unit = before["vn"] / numpy.linalg.norm(before["vn"], axis=1)[:, None]
        assert abs(node.attributes["NORMAL"][corners] - unit).max() <= 2**-24


def test_some_samples_have_texture_coordinates_and_normals():
    """Else the test above would say nothing of them."""
    found = [read_obj(SAMPLES / f"{name}.obj").keys() for name in ("bunny10k_textured", "bunny")]
    assert any("vt" in keys for keys in found)
    assert any("vn" in keys for keys in found)
