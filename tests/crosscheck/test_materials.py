"""Materials come out as they went in: the JSON, the images byte for byte, and what programs see of them.

Files of this repository, and files that trimesh writes with all that its own material can say, go through
the program at rest and in motion. Each is read here from its bytes.
"""

import base64
import json
import re
from pathlib import Path

import numpy
import pytest
import trimesh
from PIL import Image

import glb
from test_validator import ERROR, WARNING, validate

FIXTURES = Path(__file__).parents[2] / "fixtures/meshes"
# Files with materials of which nothing has to be left out.
WHOLE = ["looks.glb", "webp.glb", "two_primitives.glb"]
# Files with materials of which something is, and an OBJ file.
MENDED = ["materials.glb", "unplaced_textures.glb", "factors_out_of_range.glb", "texture_out_of_range.glb"]
MENDED += ["looks.obj", "groups.obj"]
# A warning about sources that have a normal texture without tangents: viewers make their own (MikkTSpace).
NO_TANGENTS = {"MESH_PRIMITIVE_GENERATED_TANGENT_SPACE"}
MOVING = ["--beta", "0.9", "--observer", "3,0.5,2", "--steps", "0,1"]


class Source:
    """A glTF file of any kind, as far as materials go."""

    def __init__(self, path):
        data = path.read_bytes()
        self.json, self.chunk = glb._split(data) if data[:4] == b"glTF" else (json.loads(data), None)
        self.folder = path.parent

    def read(self, item):
        """The bytes of an image or a buffer."""
        uri = item.get("uri")
        if uri is None:
            return self.view(item["bufferView"]) if "bufferView" in item else self.chunk
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        return (self.folder / uri).read_bytes()

    def view(self, index):
        view = self.json["bufferViews"][index]
        start = view.get("byteOffset", 0)
        return self.read(self.json["buffers"][view["buffer"]])[start : start + view["byteLength"]]

    def image(self, index):
        image = self.json["images"][index]
        said = {k: v for k, v in image.items() if k not in ("uri", "bufferView", "mimeType")}
        return said | {"bytes": self.read(image)}

    def texture(self, index):
        texture = dict(self.json["textures"][index])
        if "sampler" in texture:
            texture["sampler"] = self.json["samplers"][texture["sampler"]]
        if "source" in texture:
            texture["source"] = self.image(texture["source"])
        extensions = texture.get("extensions", {}).items()
        texture["extensions"] = {k: v | {"source": self.image(v["source"])} for k, v in extensions}
        return texture

    def resolved(self, value, name=""):
        """The same with textures in place of their indices."""
        if isinstance(value, list):
            return [self.resolved(item) for item in value]
        if not isinstance(value, dict) or name == "extras":
            return value
        found = {key: self.resolved(item, key) for key, item in value.items()}
        if re.search("Texture$", name) and "index" in value:
            found["index"] = self.texture(value["index"])
        return found

    def materials(self):
        """Those that are drawn, each primitive's, in their order; None for none."""
        primitives = [p for mesh in self.json["meshes"] for p in mesh["primitives"]]
        every = self.json.get("materials")
        return [self.resolved(every[p["material"]]) if "material" in p else None for p in primitives]


def write_trimesh(path):
    """A quad with everything that trimesh's material knows, and a plain ball, each with a name."""

    def picture(*color):
        return Image.new("RGB", (2, 3), color)

    material = trimesh.visual.material.PBRMaterial(
        name="all of trimesh",
        baseColorFactor=[10, 20, 30, 40],
        baseColorTexture=picture(200, 10, 30),
        metallicFactor=0.3,
        roughnessFactor=0.7,
        metallicRoughnessTexture=picture(0, 128, 255),
        normalTexture=picture(128, 128, 255),
        occlusionTexture=picture(9, 9, 9),
        emissiveTexture=picture(1, 2, 3),
        emissiveFactor=[0.1, 0.2, 0.3],
        alphaMode="MASK",
        alphaCutoff=0.3,
        doubleSided=True,
    )
    uv = numpy.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    quad = trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]], visual=visual, process=False)
    ball = trimesh.creation.icosphere(subdivisions=1)
    plain = trimesh.visual.material.PBRMaterial(name="plain", baseColorFactor=[255, 0, 0, 255])
    ball.visual = trimesh.visual.TextureVisuals(material=plain)
    scene = trimesh.Scene({"quad": quad, "ball": ball})
    if path.suffix == ".glb":
        scene.export(path)
    else:
        for name, data in trimesh.exchange.gltf.export_gltf(scene).items():
            (path.parent / (path.name if name == "model.gltf" else name)).write_bytes(data)
    return path


@pytest.fixture(params=[*WHOLE, "trimesh.glb", "trimesh.gltf"])
def whole(request, tmp_path):
    if request.param.startswith("trimesh"):
        return write_trimesh(tmp_path / request.param)
    return FIXTURES / request.param


@pytest.mark.parametrize("to", ["out.glb", "out.gltf"])
@pytest.mark.parametrize("flags", [["--beta", "0", "--no-subdivide"], MOVING], ids=["at rest", "moving"])
def test_materials_come_out_as_they_went_in(whole, flags, to, export):
    before = Source(whole).materials()
    path = export(whole, *flags, to=to)
    after = Source(path).materials()
    steps = 2 if flags is MOVING else 1
    assert len(after) == steps * len(before)
    assert any(before)
    for old, new in zip(before * steps, after, strict=True):
        assert text(new) == text(old)  # where 1 is not 1.0


def text(material):
    return json.dumps(material, sort_keys=True, default=bytes.hex)


@pytest.mark.parametrize("name", [*WHOLE, *MENDED])
def test_the_validator_has_nothing_to_say(name, export):
    assert_no_more_than(NO_TANGENTS if name == "looks.obj" else set(), export(FIXTURES / name, *MOVING))


def test_what_trimesh_writes_is_valid(tmp_path, export):
    source = write_trimesh(tmp_path / "trimesh.glb")
    assert_no_more_than(NO_TANGENTS, source)
    assert_no_more_than(NO_TANGENTS, export(source, *MOVING))


def assert_no_more_than(expected, path):
    """Exactly these errors and warnings."""
    messages, report = validate(path)
    assert report["info"]["totalTriangleCount"] > 0
    assert {m["code"] for m in messages if m["severity"] in (ERROR, WARNING)} == expected


def test_extensions_are_declared_as_they_are_used(export):
    """Exactly those that stand in materials and textures, whatever the source declares."""
    for name in [*WHOLE, *MENDED]:
        document = Source(export(FIXTURES / name, *MOVING)).json
        said = [document.get(key, []) for key in ("materials", "textures", "samplers", "images")]
        assert sorted(document.get("extensionsUsed", [])) == sorted(used(said)), name
        assert set(document.get("extensionsRequired", [])) <= used(said), name


def used(value):
    if isinstance(value, list):
        return set().union(*map(used, value))
    if not isinstance(value, dict):
        return set()
    inner = (used(item) for key, item in value.items() if key != "extras")
    return set(value.get("extensions", {})).union(*inner)


@pytest.mark.parametrize("name", WHOLE)
def test_vertices_at_rest_are_what_they_were(name, export):
    """Everything but positions bit for bit; these within the rounding of their sum with the translation."""
    before = Source(FIXTURES / name)
    scene = {"objects": [{"name": "it", "file": str(FIXTURES / name)}]}
    after = glb.Gltf(export(scene, "--no-subdivide"))
    primitives = [p for mesh in before.json["meshes"] for p in mesh["primitives"]]
    for primitive, node in zip(primitives, after.nodes, strict=True):
        reader = glb.Gltf.__new__(glb.Gltf)
        reader.json, reader._buffer = before.json, before.chunk
        old = {key: reader.accessor(index) for key, index in primitive["attributes"].items()}
        if "NORMAL" not in old:  # flat ones, and vertices of their own for each triangle
            corners = reader.accessor(primitive["indices"])
            old = {key: values[corners] for key, values in old.items()}
        for key, values in old.items():
            if key == "POSITION":
                limit = 2**-24 * abs(node.positions)
                assert (abs(node.world - values) <= limit).all()
            else:
                assert node.attributes[key].tolist() == values.tolist(), key


def test_trimesh_sees_the_same_material(tmp_path, export):
    source = write_trimesh(tmp_path / "trimesh.glb")
    before = trimesh.load_scene(source, process=False).geometry["quad"].visual.material
    path = export(source, *MOVING)
    scene = trimesh.load_scene(path, process=False, merge_primitives=False)
    quads = [g for name, g in scene.geometry.items() if "quad" in name]
    assert len(quads) == 2
    for quad in quads:
        after = quad.visual.material
        for key in ("name", "alphaMode", "alphaCutoff", "doubleSided", "metallicFactor", "roughnessFactor"):
            assert getattr(after, key) == getattr(before, key), key
        for key in ("baseColorFactor", "emissiveFactor"):
            assert getattr(after, key).tolist() == getattr(before, key).tolist(), key
        slots = ("baseColor", "metallicRoughness", "normal", "occlusion", "emissive")
        for slot in slots:
            pictures = [numpy.asarray(getattr(m, slot + "Texture")).tolist() for m in (before, after)]
            assert pictures[0] == pictures[1], slot
