"""Colours of vertices under the Doppler effect, as readers see them.

What a grey surface should look like is worked out here from Planck's law and the table of the CIE, with numpy, for the
Doppler factor that the same file has at each vertex. Of the program only the numbers of the table are used.
"""

import re
from pathlib import Path

import numpy
import pytest
import trimesh

import glb
from test_validator import assert_valid

TABLE = Path(__file__).parents[2] / "src/effects/cie_1931.rs"
DAYLIGHT = 6504
GREY = 0x80


def table():
    """Wavelengths in metres, and the three matching functions at each."""
    text = TABLE.read_text().split("MATCHING", 1)[1]
    rows = re.findall(r"\[([\d_.]+), ([\d_.]+), ([\d_.]+)\],", text)
    matching = numpy.array([[float(number.replace("_", "")) for number in row] for row in rows])
    assert matching.shape == (95, 3)
    return 1e-9 * (360 + 5 * numpy.arange(95)), matching


def black_bodies(kelvins):
    """Linear sRGB of the light of black bodies."""
    wavelengths, matching = table()
    light = wavelengths**-5 / numpy.expm1(0.014387768775039337 / numpy.outer(kelvins, wavelengths))
    xyz = light @ matching
    primaries = numpy.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]])
    columns = numpy.column_stack([primaries, 1 - primaries.sum(axis=1)]).T
    white = numpy.array([0.3127, 0.3290, 1 - 0.3127 - 0.3290]) / 0.3290
    to_xyz = columns * numpy.linalg.solve(columns, white)
    return numpy.linalg.solve(to_xyz, xyz.T).T


def luminance(colours):
    return colours @ [0.2126, 0.7152, 0.0722]


def bounded(colours):
    """No channel below 0, at the same luminance, or above 1, at the same hue."""
    grey = luminance(colours)[:, None]
    low = colours.min(axis=1, keepdims=True)
    colours = numpy.where(low < 0, grey + grey / numpy.where(low < 0, grey - low, 1) * (colours - grey), colours)
    return colours / numpy.maximum(colours.max(axis=1, keepdims=True), 1)


def linear(byte):
    part = byte / 255
    return part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4


def scene(effects, **spec):
    """A grey ball that an observer leaves behind, and one before the observer."""
    ball = {"shape": {"sphere": {"radius": 1}}, "color": f"#{GREY:02x}{GREY:02x}{GREY:02x}", **spec}
    return {
        "observer": {"velocity": {"beta": 0.6, "direction": [0, 0, -1]}},
        "objects": [
            {"name": "ahead", "position": [2, 0, -2], **ball},
            {"name": "behind", "position": [2, 0, 3], **ball},
        ],
        "effects": effects,
        "attributes": ["doppler"],
        "tolerance": {"relative": 0.01},
    }


@pytest.mark.parametrize("searchlight", [False, True])
def test_grey_surfaces_have_the_colours_of_black_bodies(export, searchlight):
    path = export(scene({"doppler": "spectrum", "searchlight": searchlight}))
    assert_valid(path)
    nodes = glb.Gltf(path).nodes
    loaded = trimesh.load(path, process=False)
    for node in nodes:
        factors = node.attributes["_DOPPLER"].astype(float)
        seen = black_bodies(DAYLIGHT * factors) / black_bodies([DAYLIGHT])
        if not searchlight:
            seen /= luminance(seen)[:, None]
        expected = 255 * bounded(linear(GREY) * seen)
        found = node.attributes["COLOR_0"]
        assert found.dtype == numpy.uint8 and (found[:, 3] == 255).all()
        # Rounded to the nearest; the tables of the program are off by less.
        assert abs(found[:, :3] - expected).max() < 0.52
        # The colours of the vertices are all that the material shows.
        surface = node.material["pbrMetallicRoughness"]
        assert "baseColorTexture" not in surface
        assert surface.get("baseColorFactor", [1, 1, 1, 1]) == [1, 1, 1, 1]
        visual = loaded.geometry[node.name].visual
        # Beside a material, trimesh keeps them as an attribute.
        read = getattr(visual, "vertex_attributes", {}).get("color", getattr(visual, "vertex_colors", None))
        assert numpy.array_equal(numpy.asarray(read)[:, :3], found[:, :3])


def test_black_bodies_have_their_own_light(export):
    path = export(scene({"doppler": "spectrum"}, emission={"kelvin": 3000}))
    assert_valid(path)
    for node in glb.Gltf(path).nodes:
        factors = node.attributes["_DOPPLER"].astype(float)
        seen = black_bodies(3000 * factors) / black_bodies([DAYLIGHT])
        expected = 255 * bounded(seen / luminance(seen)[:, None])
        assert abs(node.attributes["COLOR_0"][:, :3] - expected).max() < 0.52
        assert "KHR_materials_unlit" in node.material["extensions"]
        assert node.extras["emission"] == {"kelvin": 3000, "luminance": 1}


def test_the_ramp_is_grey_where_light_is_unshifted(export):
    path = export(scene({"doppler": "ramp"}))
    assert_valid(path)
    for node in glb.Gltf(path).nodes:
        factors = node.attributes["_DOPPLER"]
        red, _, blue = node.attributes["COLOR_0"][:, :3].astype(int).T
        assert (blue[factors > 1.05] > red[factors > 1.05]).all()
        assert (blue[factors < 0.95] < red[factors < 0.95]).all()


def test_a_texture_becomes_colours_of_vertices(export, tmp_path):
    """A checkered box: its texture is gone, its colours at the vertices are shifted, and a note says so."""
    box = {"name": "box", "shape": {"box": {"size": [1, 1, 1]}}, "position": [0, 0, -4], "checker": "#000000"}
    observer = {"velocity": [0, 0, -0.5]}
    path = export({"observer": observer, "objects": [box], "effects": {"doppler": "spectrum"}})
    assert_valid(path)
    (node,) = glb.Gltf(path).nodes
    assert "baseColorTexture" not in node.material.get("pbrMetallicRoughness", {})
    assert len(numpy.unique(node.attributes["COLOR_0"], axis=0)) > 1
    said = (path.parent / "messages.txt").read_text()
    assert "became colours of vertices" in said


def test_without_effects_there_are_no_colours(export):
    for node in glb.Gltf(export(scene({}))).nodes:
        assert "COLOR_0" not in node.attributes


def test_a_ply_has_the_colours_as_a_screen_shows_them(export):
    """MeshLab takes the bytes of a PLY as sRGB: those of the glTF, encoded."""
    source = scene({"doppler": "spectrum"})
    linears = numpy.concatenate([node.attributes["COLOR_0"][:, :3] for node in glb.Gltf(export(source)).nodes])
    mesh = trimesh.load(export(source, to="out.ply"), process=False)
    vertices = mesh.metadata["_ply_raw"]["vertex"]["data"]
    found = numpy.column_stack([vertices[name].reshape(-1) for name in ("red", "green", "blue")])
    assert len(found) == len(linears)
    part = linears / 255
    encoded = 255 * numpy.where(part <= 0.0031308, 12.92 * part, 1.055 * part ** (1 / 2.4) - 0.055)
    # Half a step of linear light is several of the encoded ones in the dark.
    assert abs(found - encoded).max() < 3
