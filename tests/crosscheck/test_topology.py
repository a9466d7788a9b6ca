"""The photosurface map is one-to-one and keeps orientation: what was closed stays closed.

Its determinant is the Doppler factor, so that the volume of the photosurface is the integral of the
Doppler factor over the body at rest.
"""

import math
from pathlib import Path

import numpy
import pytest
import trimesh
from mpmath import mp, mpf

import glb
import ply

SHAPES = {
    "sphere": {"sphere": {"radius": 1}},
    "box": {"box": {"size": [1, 2, 3]}},
    "cylinder": {"cylinder": {"radius": 1, "height": 2}},
    "cone": {"cone": {"radius": 1, "height": 2}},
    "torus": {"torus": {"major_radius": 2, "minor_radius": 0.5}},
    "rod": {"rod": {"length": 4, "radius": 0.1}},
    "lattice": {"lattice": {"cells": 3, "spacing": 1, "thickness": 0.1}},
}
BETA = 0.9
DIRECTION = numpy.array([2, -1, 2]) / 3
CENTRE = numpy.array([3.0, 4.0, -1.0])


def solid(positions, triangles):
    """A mesh with corners of equal place (where normals or textures part them) made one."""
    places, index = numpy.unique(positions + 0.0, axis=0, return_inverse=True)
    return trimesh.Trimesh(places, index.reshape(-1)[triangles], process=False)


def at_rest_and_seen(shape, export, *flags):
    """The solid in its own frame, with the observer at the origin, and its photosurface."""
    spec = {"name": "solid", "shape": shape}
    rest = ply.read(export({"objects": [spec]}, "--no-subdivide", to="rest.ply"))
    observer = {"velocity": {"beta": BETA, "direction": DIRECTION.tolist()}}
    moving = {"observer": observer, "objects": [{**spec, "position": CENTRE.tolist()}]}
    (node,) = glb.Gltf(export(moving, *flags)).nodes
    return solid(rest.positions + CENTRE, rest.triangles), solid(node.positions, node.triangles)


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_closed_stays_closed(shape, export):
    rest, seen = at_rest_and_seen(shape, export, "--no-subdivide")
    _, subdivided = at_rest_and_seen(shape, export)
    for mesh in (rest, seen, subdivided):
        assert mesh.is_watertight
        assert mesh.is_winding_consistent
        assert mesh.volume > 0
    assert len(seen.vertices) == len(rest.vertices)
    assert len(seen.faces) == len(rest.faces)
    assert seen.euler_number == subdivided.euler_number == rest.euler_number


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_no_triangle_comes_twice_or_has_no_inside(shape, export):
    _, seen = at_rest_and_seen(shape, export)
    corners = numpy.sort(seen.faces, axis=1)
    assert (numpy.diff(corners, axis=1) > 0).all()
    assert len(numpy.unique(corners, axis=0)) == len(corners)


@pytest.mark.parametrize("to", ["six.glb", "six.gltf", "six.ply"])
@pytest.mark.parametrize("place", ["3,0.4,0.5", "1000.3,0.4,0.5"])
def test_parts_that_close_a_body_close_its_photosurface(place, to, export):
    """trimesh's own sum of its parts is watertight, with corners welded where all their bits are equal and nowhere else."""
    six_sides = Path(__file__).parents[2] / "fixtures/meshes/six_sides.obj"
    path = export(six_sides, "--beta", "0.9", "--observer", place, to=to)
    loaded = trimesh.load(path, process=False)
    parts = loaded.dump() if isinstance(loaded, trimesh.Scene) else [loaded]
    assert len(parts) == (1 if to.endswith(".ply") else 6)
    assert not any(part.is_watertight for part in parts if len(parts) > 1)
    whole = trimesh.util.concatenate(parts)
    seen = solid(whole.vertices, whole.faces)
    assert seen.is_watertight and seen.is_winding_consistent
    assert seen.volume > 0 and seen.euler_number == 2


def test_euler_numbers(export):
    for name, euler in {"sphere": 2, "box": 2, "cylinder": 2, "cone": 2, "torus": 0}.items():
        for flags in ([], ["--no-subdivide"]):
            _, seen = at_rest_and_seen(SHAPES[name], export, *flags)
            assert seen.euler_number == euler, name


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES)
def test_the_volume_of_a_polyhedron(shape, export):
    """The integral of the Doppler factor over the solid, as a sum over its facets at rest.

    D = gamma (1 + beta n.d/r) is gamma times the divergence of d/3 + beta r n. By Gauss the second term
    is the flux of r n through the facets, and a facet mapped by its corners alone has r linear on it.
    """
    rest, seen = at_rest_and_seen(shape, export, "--no-subdivide")
    gamma = 1 / math.sqrt(1 - BETA**2)
    distance = numpy.linalg.norm(rest.vertices, axis=1)[rest.faces].mean(axis=1)
    facing = (rest.area_faces * rest.face_normals.T).T @ DIRECTION
    expected = gamma * (rest.volume + BETA * (distance * facing).sum())
    # Every corner is off by at most 2^-24 of its local coordinates' length: the volume by that times
    # the area.
    limit = 2**-24 * numpy.linalg.norm(seen.vertices, axis=1).max() * seen.area
    assert abs(seen.volume - expected) <= limit


def mean_cosine_over_a_ball(radius, centre, direction):
    """The mean over a ball, which the observer is outside of, of the cosine of the angle to `direction`.

    The mean of d/r over the ball is along its centre: 1 - R^2 / (5 c^2), the gradient of the mean of r.
    """
    distance = numpy.linalg.norm(centre)
    return (centre @ direction) / distance * (1 - radius**2 / (5 * distance**2))


def test_the_mean_over_a_ball_by_quadrature():
    """The closed form above against mpmath's quadrature over the ball, along its axis."""
    mp_distance = mpf(2)

    def shell(s):
        def ring(c):
            along = mp_distance + s * c
            return along / mp.sqrt(along**2 + s**2 * (1 - c**2))

        return s**2 * mp.quad(ring, [-1, 1])

    mean = mp.quad(shell, [0, 1]) * 3 / 2
    along_x = numpy.array([1.0, 0.0, 0.0])
    assert abs(mean - mean_cosine_over_a_ball(1, 2 * along_x, along_x)) < 2**-50


def test_the_volume_of_a_sphere(export):
    """Its photosurface has the volume of the integral of the Doppler factor over the ball.

    The mesh lacks two things. The polyhedron at rest is inscribed and lacks a known volume, anywhere
    between the least and the largest Doppler factor times it. And its flat facets lie beside the true
    surface, along the motion, by at most gamma beta L^2 / 8 r for edges of length L at distance r.
    """
    rest, seen = at_rest_and_seen(SHAPES["sphere"], export, "--no-subdivide")
    gamma = 1 / math.sqrt(1 - BETA**2)
    ball = 4 / 3 * math.pi
    expected = ball * gamma * (1 + BETA * mean_cosine_over_a_ball(1, CENTRE, DIRECTION))

    aim = numpy.arccos(CENTRE @ DIRECTION / numpy.linalg.norm(CENTRE))
    spread = math.asin(1 / numpy.linalg.norm(CENTRE))
    least, most = (gamma * (1 + BETA * math.cos(aim + side * spread)) for side in (1, -1))
    inscribed = ball - rest.volume
    assert 0 < inscribed < 0.01 * ball

    facing = numpy.abs((rest.area_faces * rest.face_normals.T).T @ DIRECTION)
    corners = rest.vertices[rest.faces]
    longest = numpy.linalg.norm(corners - numpy.roll(corners, 1, axis=1), axis=2).max(axis=1)
    nearest = numpy.linalg.norm(CENTRE) - 1
    beside = (gamma * BETA * longest**2 / (8 * nearest) * facing).sum()

    assert expected - most * inscribed - beside <= seen.volume
    assert seen.volume <= expected - least * inscribed + beside
