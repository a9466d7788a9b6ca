"""MeshLab reads from every kind of file what the file's own JSON says is there, and the Doppler factor from PLY."""

import numpy
import pymeshlab
import pytest

import glb
import ply
from kinds import KINDS
from scenes import CUBE, SEVERAL, SPHERE, TORUS


def open_file(path):
    """The meshes of a file."""
    opened = pymeshlab.MeshSet()
    opened.load_new_mesh(str(path))
    return list(opened)


@pytest.mark.parametrize("kind", KINDS)
def test_meshes_are_those_of_the_file(kind, export, tmp_path):
    """Labels, counts, faces, and places through the mesh's matrix, which MeshLab holds in f64: to the last bit."""
    for path in KINDS[kind](export, tmp_path):
        meshes = open_file(path)
        nodes = glb.Gltf(path).nodes
        assert [mesh.label() for mesh in meshes] == [node.name for node in nodes]
        for node, mesh in zip(nodes, meshes, strict=True):
            assert (mesh.vertex_number(), mesh.face_number()) == (len(node.positions), len(node.triangles))
            assert mesh.face_matrix().tolist() == node.triangles.tolist()
            matrix = mesh.transform_matrix()
            assert matrix[:3, :3].tolist() == numpy.eye(3).tolist()
            assert (mesh.vertex_matrix() + matrix[:3, 3]).tolist() == node.world.tolist()


@pytest.mark.parametrize(
    "scene", [SPHERE, CUBE, TORUS, SEVERAL], ids=["steps", "placed", "one step", "several"]
)
def test_ply_keeps_its_precision(scene, export):
    path = export(scene, to="out.ply")
    (mesh,) = open_file(path)
    expected = ply.read(path)
    assert mesh.vertex_matrix().tolist() == expected.positions.tolist()
    assert mesh.face_matrix().tolist() == expected.triangles.tolist()
    assert mesh.vertex_scalar_array().tolist() == expected.quality.tolist()


def test_more_numbers_at_vertices_change_nothing(export):
    """MeshLab takes of a PLY file the properties it knows, and is not led astray by the others."""
    path = export(SEVERAL, "--attributes", "doppler,emission_time,rest_position", to="out.ply")
    (mesh,) = open_file(path)
    # Vertices with numbers of their own are measured by points.
    (plain,) = open_file(export(SEVERAL, "--measure", "points", to="out.ply"))
    assert mesh.vertex_matrix().tolist() == plain.vertex_matrix().tolist()
    assert mesh.face_matrix().tolist() == plain.face_matrix().tolist()
    assert mesh.vertex_scalar_array().tolist() == plain.vertex_scalar_array().tolist()


# A point at rest relative to the observer, the velocity of the object, where the observer sees the point, and
# its Doppler factor: by a solver that bisects the equation of the light cone with 60 digits.
POINTS = [
    (
        [1, 2, 3],
        [0.9, 0, 0],
        [-5.4313983388049515138295837447721, 2, 3],
        1.7423319331691484324362615291394,
    ),
    (
        [1.5, -2, 4],
        [0.3, -0.5, 0.6],
        [0.27887192972565097842337570482008, 0.035213450457248369374293825299875, 1.5577438594513019568467514096402],
        0.33557433389690035039644029663942,
    ),
]


@pytest.mark.parametrize(("point", "velocity", "place", "doppler"), POINTS, ids=["along x", "askew"])
def test_a_known_point_is_where_it_is_known_to_be(point, velocity, place, doppler, export, tmp_path):
    """Far better than an f32 could say."""
    corners = [point, [point[0] + 1, point[1], point[2]], [point[0], point[1] + 1, point[2]]]
    lines = ["v {} {} {}".format(*corner) for corner in corners] + ["f 1 2 3"]
    (tmp_path / "triangle.obj").write_text("\n".join(lines))
    spec = {"name": "triangle", "file": str(tmp_path / "triangle.obj")}
    observer = {"velocity": [-component for component in velocity]}
    path = export({"observer": observer, "objects": [spec]}, "--no-subdivide", to="out.ply")
    (mesh,) = open_file(path)
    # A velocity is rounded to half an ulp; 1 - beta^2 = 0.19 or more makes at most 10 of that.
    assert abs(mesh.vertex_matrix()[0] - place).max() < 2**-47 * numpy.linalg.norm(place)
    assert abs(mesh.vertex_scalar_array()[0] / doppler - 1) < 2**-24 + 2**-47  # it is an f32


@pytest.mark.parametrize("scene", [SPHERE, TORUS], ids=["steps", "near light speed"])
def test_quality_is_the_doppler_factor(scene, export):
    """In the observer's frame it is 1 / (gamma (1 + beta cos theta)), theta from the object's velocity."""
    speed = scene["observer"]["velocity"]
    one_minus_beta = speed.get("one_minus_beta", 1 - speed.get("beta", 0))
    beta = 1 - one_minus_beta
    gamma = 1 / numpy.sqrt(one_minus_beta * (2 - one_minus_beta))
    forward = -numpy.array(speed["direction"], dtype=float)

    path = export(scene, to="out.ply")
    (mesh,) = open_file(path)
    places = mesh.vertex_matrix()
    cosine = places @ forward / numpy.linalg.norm(places, axis=1)
    approach = 1 + beta * cosine
    expected = 1 / (gamma * approach)
    found = mesh.vertex_scalar_array()
    # Up to eight roundings of half an epsilon of 1, of the place and of what follows, weigh the more the smaller
    # `approach` is. And it is an f32.
    limit = 8 * 2**-53 / approach + 2**-24 + 2**-50
    assert (abs(found / expected - 1) <= limit).all()
    assert numpy.ptp(found) > 0.5


def test_quality_paints(export):
    """What recedes and what approaches get the two ends of the colours of MeshLab's filter."""
    opened = pymeshlab.MeshSet()
    opened.load_new_mesh(str(export(SPHERE, to="out.ply")))
    opened.compute_color_from_scalar_per_vertex(colormap="RGB")
    mesh = opened.current_mesh()
    quality = mesh.vertex_scalar_array()
    colours = mesh.vertex_color_matrix()[:, :3]
    assert (colours[[quality.argmin(), quality.argmax()]] == [[1, 0, 0], [0, 0, 1]]).all()
    assert len(numpy.unique(colours, axis=0)) > 100
