"""Small glTF files made by hand: sources that are awkward in a known way, animations whose poses are known.

Nothing here is written by the program under test, so a reader that answers wrongly about these files is
itself at fault.
"""

import io
import json
import struct

import numpy
from PIL import Image

COMPONENTS = {"f4": 5126, "u4": 5125, "u1": 5121}
TYPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}

# Where the steps of the animations below change, in seconds, and what their vertices are then. Dyadic
# numbers: every sum of them is exact in f32.
TIMES = [0.0, 0.5, 1.0]
TRIANGLE = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.5]], dtype="f4")
STEPS = [TRIANGLE, TRIANGLE * 2, TRIANGLE + numpy.array([0, 0, 3], dtype="f4")]
TRANSLATIONS = [[0.0, 4.0, 0.0], [-2.0, 0.25, 0.0], [8.0, 0.0, -1.0]]


class Document:
    """A glTF document in the making: its JSON, and the bytes that this refers to."""

    def __init__(self):
        self.bytes = bytearray()
        self.json = {"asset": {"version": "2.0"}, "scene": 0, "bufferViews": [], "accessors": []}

    def view(self, data):
        """The index of a new buffer view of these bytes."""
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        self.json["bufferViews"].append(
            {"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(data)}
        )
        self.bytes += data
        return len(self.json["bufferViews"]) - 1

    def accessor(self, values, kind="f4"):
        """The index of a new accessor of these numbers."""
        array = numpy.asarray(values, dtype=numpy.dtype(kind).newbyteorder("<"))
        columns = array.reshape(len(array), -1)
        self.json["accessors"].append(
            {
                "bufferView": self.view(array.tobytes()),
                "componentType": COMPONENTS[kind],
                "count": len(array),
                "type": TYPES[columns.shape[1]],
                "min": columns.min(axis=0).tolist(),
                "max": columns.max(axis=0).tolist(),
            }
        )
        return len(self.json["accessors"]) - 1

    def write(self, path, **rest):
        """Writes it as GLB, with these further top-level parts; returns the path."""
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        text = json.dumps(self.json | {"buffers": [{"byteLength": len(self.bytes)}]} | rest).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        chunks += struct.pack("<I4s", len(self.bytes), b"BIN\0") + self.bytes
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
        return path


def png(size, colours):
    """A PNG of this width and height, upright stripes of these colours."""
    picture = Image.new("RGB", size)
    picture.putdata([colours[x % len(colours)] for _ in range(size[1]) for x in range(size[0])])
    data = io.BytesIO()
    picture.save(data, "PNG")
    return data.getvalue()


def write_hierarchy(directory):
    """A painted panel twice below a turned node, its frame in plain colour beside it; returns the path."""
    document = Document()
    corners = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]]
    shared = {
        "POSITION": document.accessor(corners),
        "NORMAL": document.accessor([[0, 0, 1]] * 4),
        "TEXCOORD_0": document.accessor([[0, 1], [1, 1], [1, 0], [0, 0]]),
    }
    indices = document.accessor([0, 1, 2, 0, 2, 3], "u4")

    def mesh(name, material):
        primitive = {"attributes": shared, "indices": indices, "material": material}
        return {"name": name, "primitives": [primitive]}

    picture = document.view(png((8, 4), [(200, 30, 20), (20, 30, 200)]))
    return document.write(
        directory / "panels.glb",
        scenes=[{"nodes": [0]}],
        nodes=[
            # A quarter turn about y.
            {"name": "stand", "rotation": [0, 0.5**0.5, 0, 0.5**0.5], "children": [1, 2, 3]},
            {"name": "left", "mesh": 0, "translation": [-3, 0, 0], "extras": {"price": 2.5, "maker": "nobody"}},
            {"name": "right", "mesh": 0, "translation": [3, 0, 1], "scale": [1, 2, 1]},
            {"name": "frame", "mesh": 1, "translation": [0, -2, 0]},
        ],
        meshes=[mesh("panel", 0), mesh("frame", 1)],
        materials=[
            {"name": "painted", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}},
            {
                "name": "plain",
                "pbrMetallicRoughness": {
                    "baseColorFactor": [0.5, 0.25, 0.125, 1],
                    "metallicFactor": 0.25,
                    "roughnessFactor": 0.75,
                },
            },
        ],
        textures=[{"source": 0}],
        images=[{"name": "stripes", "mimeType": "image/png", "bufferView": picture}],
    )


def write_scale_keys(directory):
    """One mesh for each step, of which STEP keys of the nodes' scales show one at a time; returns the path."""
    document = Document()
    indices = document.accessor([0, 1, 2], "u4")
    times = document.accessor(TIMES)
    samplers = [
        {
            "input": times,
            "interpolation": "STEP",
            "output": document.accessor([[float(shown == step)] * 3 for shown in range(len(STEPS))]),
        }
        for step in range(len(STEPS))
    ]
    meshes = [
        {
            "name": step_name(step),
            "primitives": [
                {
                    "attributes": {
                        "POSITION": document.accessor(local),
                        "_HEAT": document.accessor(heat(step)),
                    },
                    "indices": indices,
                }
            ],
        }
        for step, local in enumerate(STEPS)
    ]
    nodes = [
        {"name": step_name(step), "mesh": step, "translation": translation, "scale": [float(step == 0)] * 3}
        for step, translation in enumerate(TRANSLATIONS)
    ]
    channels = [
        {"sampler": step, "target": {"node": step, "path": "scale"}} for step in range(len(STEPS))
    ]
    return document.write(
        directory / "scale_keys.glb",
        scenes=[{"nodes": list(range(len(STEPS)))}],
        nodes=nodes,
        meshes=meshes,
        animations=[{"name": "steps", "samplers": samplers, "channels": channels}],
    )


def write_morph_targets(directory):
    """One mesh whose morph targets are the steps, with LINEAR weights between them; returns the path."""
    document = Document()
    base, *targets = STEPS
    primitive = {
        "attributes": {"POSITION": document.accessor(base)},
        "indices": document.accessor([0, 1, 2], "u4"),
        "targets": [{"POSITION": document.accessor(target - base)} for target in targets],
    }
    weights = [[float(step == target) for target in range(1, len(STEPS))] for step in range(len(STEPS))]
    sampler = {
        "input": document.accessor(TIMES),
        "interpolation": "LINEAR",
        "output": document.accessor(numpy.ravel(weights)),
    }
    names = [step_name(step) for step in range(1, len(STEPS))]
    return document.write(
        directory / "morph_targets.glb",
        scenes=[{"nodes": [0]}],
        nodes=[{"name": "thing", "mesh": 0, "translation": TRANSLATIONS[0]}],
        meshes=[
            {
                "name": "thing",
                "primitives": [primitive],
                "weights": weights[0],
                "extras": {"targetNames": names},
            }
        ],
        animations=[
            {
                "name": "steps",
                "samplers": [sampler],
                "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
            }
        ],
    )


def heat(step):
    """An attribute of its own that each of the vertices of a step has."""
    return numpy.array([-1.5, 0.25, 2.0 + step], dtype="f4")


def step_name(step):
    return f"thing_step{step:03}"
