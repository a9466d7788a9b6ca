"""PLY files as trimesh reads them, with every property of the vertices."""

from dataclasses import dataclass

import numpy
import trimesh


@dataclass
class Ply:
    positions: numpy.ndarray
    normals: numpy.ndarray
    quality: numpy.ndarray
    triangles: numpy.ndarray
    mesh: trimesh.Trimesh


def read(path):
    mesh = trimesh.load(path, process=False)
    # What trimesh does not know stays in the table as it was in the file.
    vertices = mesh.metadata["_ply_raw"]["vertex"]["data"]
    columns = {name: vertices[name].reshape(len(mesh.vertices)) for name in vertices.dtype.names}
    return Ply(
        positions=numpy.column_stack([columns[axis] for axis in ("x", "y", "z")]),
        normals=numpy.column_stack([columns[axis] for axis in ("nx", "ny", "nz")]),
        quality=columns["quality"],
        triangles=numpy.asarray(mesh.faces),
        mesh=mesh,
    )
