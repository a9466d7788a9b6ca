"""Every vertex is where the oracle says, to the rounding of the numbers in the file.

Without subdivision, so that the vertices are those of the mesh at rest, in its order.

The limits are not chosen but derived. A vertex in a .glb is an f64 translation plus an f32 number, which
rounding to nearest takes from the truth by at most 2^-24 of itself. What f64 loses on the way is limited
by ROUNDINGS half-units of `View.rounding_scale`, the size of the terms that any honest evaluation adds:
some five in each of placing, boost and map.
"""

import numpy
import pytest
from mpmath import mpf

import glb
import ply
from oracle import Moment, Source, View, norm
from scenes import CUBE, FLIGHT, ORBIT, SPHERE, TORUS, write_airplane, write_obj

F32 = mpf(2) ** -24
F64 = mpf(2) ** -53
ROUNDINGS = 16

SHAPES = [SPHERE, CUBE, TORUS, FLIGHT, ORBIT]
SHAPE_NAMES = ["sphere", "cube", "torus", "flight", "orbit"]


def steps_of(scene):
    steps = scene.get("steps", [0])
    if isinstance(steps, dict):
        return list(numpy.linspace(steps["from"], steps["to"], steps["count"]))
    return steps


def views(scene):
    """The oracle's view of the scene's only object at each step."""
    (spec,) = scene["objects"]
    return [View(Moment.along(scene, step), Source.of_object(spec)) for step in steps_of(scene)]


def nodes_of_step(document, step):
    return [node for node in document.nodes if node.extras["step"] == step]


def assert_seen(view, offsets, nodes):
    """Each offset in the rest frame is seen where the nodes, one after the other, have a vertex."""
    assert len(offsets) == sum(len(node.positions) for node in nodes)
    offsets = iter(offsets)
    for node in nodes:
        translation = [mpf(t) for t in node.translation]
        for local in node.positions.tolist():
            offset = [mpf(x) for x in next(offsets)]
            truth = [s - t for s, t in zip(view.seen(offset), translation, strict=True)]
            f64 = ROUNDINGS * F64 * view.rounding_scale(offset)
            for found, expected in zip(local, truth, strict=True):
                limit = F32 * abs(found) + f64
                assert abs(found - expected) <= limit, f"{node.name}: {offset} {found} {expected}"


@pytest.mark.parametrize("scene", SHAPES, ids=SHAPE_NAMES)
def test_shapes_as_glb(scene, export, placed_vertices):
    offsets = placed_vertices(scene["objects"][0]).positions.tolist()
    document = glb.Gltf(export(scene, "--no-subdivide"))
    for step, view in enumerate(views(scene)):
        assert_seen(view, offsets, nodes_of_step(document, step))


@pytest.mark.parametrize("scene", SHAPES, ids=SHAPE_NAMES)
def test_shapes_as_ply_keep_double_precision(scene, export, placed_vertices):
    """All steps are one after the other in one mesh; quality is the Doppler factor, in f32."""
    offsets = placed_vertices(scene["objects"][0]).positions.tolist()
    found = ply.read(export(scene, "--no-subdivide", to="out.ply"))
    assert found.positions.dtype == numpy.float64
    rows = zip(found.positions.tolist(), found.quality.tolist(), strict=True)
    for view in views(scene):
        for offset in offsets:
            offset = [mpf(x) for x in offset]
            position, quality = next(rows)
            truth = view.seen(offset)
            limit = ROUNDINGS * F64 * view.rounding_scale(offset)
            for coordinate, expected in zip(position, truth, strict=True):
                assert abs(coordinate - expected) <= limit, f"{offset} {position}"
            # The factor is a ratio of two lengths, so that length's limit is relative for it.
            doppler = view.doppler(offset)
            relative = F32 + limit / norm(truth)
            assert abs(quality - doppler) <= doppler * relative, f"{offset} {quality} {doppler}"
    assert next(rows, None) is None


@pytest.mark.parametrize("model", ["seen", "delayed", "contracted", "rest"])
@pytest.mark.parametrize("scene", SHAPES, ids=SHAPE_NAMES)
def test_every_model_is_what_it_says(scene, model, export, placed_vertices):
    offsets = placed_vertices(scene["objects"][0]).positions.tolist()
    found = ply.read(export({**scene, "model": model}, "--no-subdivide", to="out.ply"))
    rows = iter(found.positions.tolist())
    for view in views(scene):
        # Without contraction the light comes from something as many times as long.
        longer = view.relative_gamma() if model == "delayed" else 1
        for offset in offsets:
            offset = [mpf(x) for x in offset]
            limit = ROUNDINGS * F64 * view.rounding_scale(offset) * longer
            for coordinate, expected in zip(next(rows), view.shown(model, offset), strict=True):
                assert abs(coordinate - expected) <= limit, f"{offset} {coordinate} {expected}"
    assert next(rows, None) is None


# The vertices that the oracle is given come from the program, for an observer at rest. That they are no
# figment of it: a length there is off by some eight roundings of itself.
AT_REST = 8 * 2**-53


def test_the_sphere_is_a_sphere(placed_vertices):
    positions = placed_vertices(SPHERE["objects"][0]).positions
    assert abs(numpy.linalg.norm(positions, axis=1) - 1).max() <= AT_REST
    assert (positions.min(axis=0) < -0.99).all()
    assert (positions.max(axis=0) > 0.99).all()


def test_the_box_has_its_sides_and_corners(placed_vertices):
    spec = {**CUBE["objects"][0], "scale": 1, "rotation": [0, 0, 0, 1]}
    positions = placed_vertices(spec).positions
    half = numpy.array([0.5, 1, 0.25])
    limit = AT_REST * numpy.linalg.norm(half)
    assert abs(positions.min(axis=0) + half).max() <= limit
    assert abs(positions.max(axis=0) - half).max() <= limit
    on_a_side = abs(abs(positions) - half) <= limit
    assert on_a_side.any(axis=1).all()


def corners_as_vertices(source, node):
    """For each vertex of `node` the place of the source's vertex that its triangles have there.

    Where a source has no normals its facets are flat, and no two of them share a vertex any more.
    """
    assert node.triangles.shape == source.triangles.shape
    places = numpy.full(node.positions.shape, numpy.nan)
    places[node.triangles] = source.world[source.triangles]
    assert not numpy.isnan(places).any()
    return places.tolist()


def test_a_mesh_from_elsewhere_without_a_scene_file(export, tmp_path):
    """pyvista's airplane, whose vertices come from its own file, seen through flags alone."""
    mesh = write_airplane(tmp_path)
    flags = ["--beta", "0.9", "--direction", "1,2,-2", "--observer", "100,-50,900"]
    document = glb.Gltf(export(mesh, *flags, "--steps=-100,50", "--no-subdivide"))
    (source,) = glb.Gltf(mesh).nodes
    scene = {
        "observer": {
            "position": [100, -50, 900],
            "velocity": {"beta": 0.9, "direction": [1, 2, -2]},
        },
        "objects": [{}],
        "steps": [-100, 50],
    }
    for step, view in enumerate(views(scene)):
        (node,) = nodes_of_step(document, step)
        assert_seen(view, corners_as_vertices(source, node), [node])


def test_the_direction_defaults_to_that_of_a_gltf_camera(export, tmp_path):
    mesh = write_airplane(tmp_path)
    document = glb.Gltf(export(mesh, "--gamma", "3", "--observer", "0,0,0", "--no-subdivide"))
    (source,) = glb.Gltf(mesh).nodes
    observer = {"velocity": {"gamma": 3, "direction": [0, 0, -1]}}
    (view,) = views({"observer": observer, "objects": [{}]})
    (node,) = document.nodes
    assert_seen(view, corners_as_vertices(source, node), [node])


def test_an_obj_with_materials(export, placed_vertices, tmp_path):
    obj = write_obj(tmp_path)
    spec = {"name": "roof", "file": str(obj), "velocity": [0.2, 0, -0.9], "position": [0, 1, 5]}
    scene = {"observer": {"velocity": [0, 0.6, 0]}, "objects": [spec], "steps": [0, 3]}
    offsets = placed_vertices(spec).positions
    written = numpy.array(
        [line.split()[1:] for line in obj.read_text().splitlines() if line.startswith("v ")]
    ).astype(float)
    apart = numpy.linalg.norm(offsets[:, None] - written, axis=2)
    assert apart.min(axis=1).max() <= AT_REST * numpy.linalg.norm(written, axis=1).max()
    assert set(apart.argmin(axis=1)) == set(range(len(written)))
    document = glb.Gltf(export(scene, "--no-subdivide"))
    for step, view in enumerate(views(scene)):
        assert_seen(view, offsets.tolist(), nodes_of_step(document, step))
