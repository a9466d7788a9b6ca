"""A reader of just the glTF that the program writes: the JSON as it is, accessors as numpy arrays.

Other readers add a node's translation to its vertices in f32; this one keeps the two apart.
"""

import json
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy

TYPES = {5121: "u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


@dataclass
class Node:
    """A node of the scene with its mesh's only primitive; the node above it, if there is one, moves nothing."""

    name: str
    json: dict
    mesh: dict
    translation: numpy.ndarray  # f64, as in the JSON
    attributes: dict  # name to array, as in the binary part
    triangles: numpy.ndarray
    targets: list  # of each morph target the arrays to be added, by name
    material: dict | None

    @property
    def extras(self):
        return self.json["extras"]

    @property
    def positions(self):
        """The local positions, f32."""
        return self.attributes["POSITION"]

    @property
    def world(self):
        """The positions in the observer's frame, f64."""
        return self.translation + self.positions.astype(numpy.float64)

    def at_step(self, step):
        """The positions that the node is to show at a step of an animation; None for nothing.

        That of the extras, not of the animation: what has no step is there always.
        """
        extras = self.json.get("extras", {})
        if "frames" in extras:
            local = self.positions.astype(numpy.float64)
            if step > 0:
                local += self.targets[step - 1]["POSITION"]
            return self.translation + local
        return self.world if extras.get("step", step) == step else None


class Gltf:
    def __init__(self, path):
        path = Path(path)
        data = path.read_bytes()
        if path.suffix == ".glb":
            self.json, self._buffer = _split(data)
        else:
            self.json = json.loads(data)
            (buffer,) = self.json["buffers"]
            self._buffer = (path.parent / buffer["uri"]).read_bytes()
        self.nodes = [self._node(node) for node in self.json["nodes"] if "mesh" in node]

    def at_step(self, step):
        """Everything that is to be seen at a step of an animation: positions in the observer's frame, by name."""
        places = {node.name: node.at_step(step) for node in self.nodes}
        return {name: found for name, found in places.items() if found is not None}

    def accessor(self, index):
        spec = self.json["accessors"][index]
        view = self.json["bufferViews"][spec["bufferView"]]
        element = numpy.dtype((TYPES[spec["componentType"]], (WIDTHS[spec["type"]],)))
        assert view.get("byteStride", element.itemsize) == element.itemsize, "interleaved"
        start = view.get("byteOffset", 0) + spec.get("byteOffset", 0)
        array = numpy.frombuffer(self._buffer, element, spec["count"], start)
        return array[:, 0] if spec["type"] == "SCALAR" else array

    def picture(self, texture):
        """The bytes of the file of pixels behind a reference to a texture, as a material has it."""
        source = self.json["textures"][texture["index"]]["source"]
        view = self.json["bufferViews"][self.json["images"][source]["bufferView"]]
        start = view.get("byteOffset", 0)
        return self._buffer[start : start + view["byteLength"]]

    def _node(self, node):
        mesh = self.json["meshes"][node["mesh"]]
        (primitive,) = mesh["primitives"]
        return Node(
            name=node["name"],
            json=node,
            mesh=mesh,
            translation=numpy.array(node.get("translation", [0, 0, 0]), dtype=numpy.float64),
            attributes={n: self.accessor(i) for n, i in primitive["attributes"].items()},
            triangles=self.accessor(primitive["indices"]).reshape(-1, 3),
            targets=[
                {n: self.accessor(i) for n, i in target.items()} for target in primitive.get("targets", [])
            ],
            material=self.json["materials"][primitive["material"]] if "material" in primitive else None,
        )


def _split(data):
    """The JSON and the binary chunk of a GLB file."""
    magic, version, length = struct.unpack_from("<4sII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    chunks = {}
    at = 12
    while at < length:
        size, kind = struct.unpack_from("<I4s", data, at)
        chunks[kind] = data[at + 8 : at + 8 + size]
        at += 8 + size
    return json.loads(chunks[b"JSON"]), chunks[b"BIN\0"]
