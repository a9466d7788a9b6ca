"""Normals against finite differences of the oracle.

A sphere's normal at rest is its radius, a box's an axis, so that the oracle needs nothing from the file
but the place. Each component of a unit vector is at most 1 and is rounded to f32, by at most 2^-25; the
2^-40 more is for f64, whose roundings the boost here multiplies by less than 2^12.
"""

import numpy
import pytest
from mpmath import mpf

import glb
from oracle import unit
from scenes import CUBE, SPHERE
from test_vertices import nodes_of_step, views

LIMIT = mpf(2) ** -25 + mpf(2) ** -40


def assert_normals(scene, document, offsets, normals):
    """`normals` are those in the rest frame, one for each offset."""
    sample = range(0, len(offsets), max(1, len(offsets) // 150))
    for step, view in enumerate(views(scene)):
        (node,) = nodes_of_step(document, step)
        for index in sample:
            truth = view.normal([mpf(x) for x in offsets[index]], normals[index])
            found = node.attributes["NORMAL"][index].tolist()
            for component, expected in zip(found, truth, strict=True):
                assert abs(component - expected) <= LIMIT, f"vertex {index}: {found} {truth}"


def test_the_sphere(export, placed_vertices):
    offsets = placed_vertices(SPHERE["objects"][0]).positions.tolist()
    normals = [unit([mpf(x) for x in offset]) for offset in offsets]
    assert_normals(SPHERE, glb.Gltf(export(SPHERE, "--no-subdivide")), offsets, normals)


def test_the_box_turned_and_scaled(export, placed_vertices):
    spec = CUBE["objects"][0]
    (view, *_) = views(CUBE)
    at_rest = placed_vertices(spec)
    # The side that a vertex belongs to is told by its normal at rest, which is a turned axis.
    axes = [
        view.source.placed_normal([sign * (i == axis) for i in range(3)])
        for axis in range(3)
        for sign in (1, -1)
    ]
    as_numbers = numpy.array([[float(x) for x in axis] for axis in axes])
    nearest = (at_rest.normals @ as_numbers.T).argmax(axis=1)
    normals = [axes[side] for side in nearest]
    assert set(nearest) == set(range(6))
    assert_normals(CUBE, glb.Gltf(export(CUBE, "--no-subdivide")), at_rest.positions.tolist(), normals)


@pytest.mark.parametrize("flags", [[], ["--no-subdivide"]], ids=["subdivided", "as it is"])
@pytest.mark.parametrize("scene", [SPHERE, CUBE], ids=["sphere", "cube"])
def test_facets_and_normals_agree(scene, flags, export):
    """No triangle is wound against the normals of its corners."""
    for node in glb.Gltf(export(scene, *flags)).nodes:
        corners = node.positions[node.triangles].astype(float)
        facet = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        mean = node.attributes["NORMAL"][node.triangles].astype(float).sum(axis=1)
        assert ((facet * mean).sum(axis=1) > 0).all()
