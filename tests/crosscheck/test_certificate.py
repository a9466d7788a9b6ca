"""The certificate is true: every point of one surface has a point of the other within the proven `total`.

Two questions, each asked at 20,000 random points.

- *Is the true surface all there?* A random point of the surface at rest, curved shapes by their
  parametrisation, is mapped by the oracle. Its distance from the exported triangles is at most `total`.
- *Is nothing there but the true surface?* A random point q of an exported triangle. The triangle's corners
  are taken back to rest: light arriving from a place left it as long ago as it had to go, and boosting that
  event into the rest frame gives a point x_i at rest. With the weights that make q of the corners the x_i
  make a point x at rest; the nearest point x' of the true surface to it, mapped by the oracle, is a point of
  the true photosurface. So the distance of q from the true photosurface is at most |q - seen(x')|, whatever
  x' is: that this is at most `total` proves the certificate at q. (That it is so small follows from what the
  certificate adds up: the gap from q to seen(x), the stretched distance from x to x', rounding.)

For the measure of surfaces x' is led along the surface to where it is seen nearest to q, if it is too far away.

The distances too are on the safe side: vtk chooses a triangle, and were it not the nearest, the distance from
it, by trimesh, would only be larger. Where the tolerance is an angle, so is the distance: that between the two
points as the observer, at the origin, sees them.
"""

import json
import math
import re

import numpy
import pytest
import pyvista.examples
import trimesh
from mpmath import mpf

import glb
import ply
from many import ManyPoints
from oracle import Moment, Source, View
from scenes import CUBE, write_airplane
from surfaces import Cylinder, Sphere, Torus, Triangles, box, random_on_triangles
from test_validator import assert_valid

POINTS = 20_000
POINTS_WITH_MANY_DIGITS = 200

# So many steps lead a place along a surface.
LED_STEPS = 12

# A direction of motion along no edge and no axis.
ASKEW = [2, -1, -2]

SPHERE = {"sphere": {"radius": 1}}
BOX = {"box": {"size": [2, 2, 2]}}
TORUS = {"torus": {"major_radius": 2, "minor_radius": 0.5}}
CYLINDER = {"cylinder": {"radius": 1, "height": 2}}
LATTICE = {"lattice": {"cells": 2, "spacing": 1, "thickness": 0.25}}

# Name: shape, where it is (the observer is at the origin), beta, tolerance.
CASES = {
    "sphere, near": (SPHERE, [0.5, 1.5, -1], 0.95, "1e-3"),
    "sphere, near, slow": (SPHERE, [0.5, 1.5, -1], 0.6, "1e-3"),
    "sphere, near, fast": (SPHERE, [0.5, 1.5, -1], 0.99, "1e-2"),
    "sphere, inside": (SPHERE, [0.25, 0.125, -0.5], 0.95, "1e-3"),
    "sphere, touching": (SPHERE, [0, -1, 0], 0.95, "1e-3"),
    "sphere, by angle": (SPHERE, [0.5, 1.5, -1], 0.95, "deg:0.2"),
    "cylinder, near": (CYLINDER, [0.5, 1.5, -1], 0.95, "1e-3"),
    "cylinder, in a lid": (CYLINDER, [0.25, 1, 0.125], 0.95, "1e-2"),
    "torus, near": (TORUS, [0, 1, -2.5], 0.99, "1e-3"),
    "torus, in the tube": (TORUS, [2.125, 0.25, 0], 0.95, "1e-2"),
    "torus, touching": (TORUS, [-2.5, 0, 0], 0.6, "1e-3"),
    "torus, a length": (TORUS, [0, 1, -2.5], 0.95, "abs:0.02"),
    "cube, near": (BOX, [0.5, 1.125, -0.5], 0.95, "1e-3"),
    "cube, inside": (BOX, [0.25, 0.125, -0.5], 0.99, "1e-3"),
    "cube, on a vertex": (BOX, [1, 1, 1], 0.95, "1e-3"),
    "cube, on a vertex, fast": (BOX, [-1, 1, 1], 0.99, "1e-3"),
    "cube, in a face": (BOX, [0.25, 0.125, 1], 0.95, "1e-3"),
    "cube, in a face, slow": (BOX, [0.25, 0.125, 1], 0.6, "1e-3"),
    "cube, a length": (BOX, [0.5, 1.125, -0.5], 0.95, "abs:0.001"),
    "cube, by angle": (BOX, [0.5, 1.125, -0.5], 0.95, "deg:0.05"),
    "cube, by angle, inside": (BOX, [0.25, 0.125, -0.5], 0.99, "deg:0.1"),
    "lattice, near": (LATTICE, [0.5, 0.25, -2], 0.95, "1e-3"),
    "lattice, in a cell": (LATTICE, [0.5, 0.5, 0.5], 0.99, "1e-3"),
    "lattice, by angle": (LATTICE, [0.5, 0.5, 0.5], 0.6, "deg:0.1"),
}

# Where the observer of the airplane is: place, beta, tolerance.
AIRPLANE_CASES = {
    "airplane, near": ("near", 0.95, "1e-4"),
    "airplane, inside": ("inside", 0.99, "1e-2"),
    "airplane, on a vertex": ("vertex", 0.95, "1e-3"),
    "airplane, in a face": ("face", 0.6, "1e-3"),
    "airplane, by angle": ("near", 0.95, "deg:0.01"),
}


@pytest.fixture(scope="module")
def airplane(tmp_path_factory):
    """The path of a GLB file."""
    return write_airplane(tmp_path_factory.mktemp("airplane"))


def airplane_case(name, path):
    """Its scene and its surface: from pyvista's file, by trimesh."""
    mesh = trimesh.load(pyvista.examples.planefile, process=False)
    where, beta, tolerance = AIRPLANE_CASES[name]
    triangles = mesh.vertices.astype(numpy.float32).astype(float)[mesh.faces]
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    place = {
        "near": high + [0, 0.1 * numpy.ptp(triangles), 0],
        "inside": (low + high) / 2,
        "vertex": triangles[len(triangles) // 2][0],
        "face": triangles[len(triangles) // 3].mean(axis=0),
    }[where]
    scene = {
        "observer": {"position": place.tolist(), "velocity": {"beta": beta, "direction": ASKEW}},
        "objects": [{"name": "thing", "file": str(path)}],
    }
    return scene, tolerance, Triangles(triangles)


def case(name, airplane, export):
    """The scene, its tolerance, and the true surface in the mesh's coordinates."""
    if name in AIRPLANE_CASES:
        return airplane_case(name, airplane)
    shape, position, beta, tolerance = CASES[name]
    scene = {
        "observer": {"velocity": {"beta": beta, "direction": ASKEW}},
        "objects": [{"name": "thing", "shape": shape, "position": position}],
    }
    return scene, tolerance, true_surface(shape, export)


def true_surface(shape, export):
    ((kind, size),) = shape.items()
    match kind:
        case "sphere":
            return Sphere(size["radius"])
        case "torus":
            return Torus(size["major_radius"], size["minor_radius"])
        case "cylinder":
            return Cylinder(size["radius"], size["height"])
        case "box":
            return box(size["size"])
        case _:
            rest = export({"objects": [{"name": "rest", "shape": shape}]}, "--no-subdivide", to="rest.ply")
            return Triangles(ply.read(rest).mesh.triangles)


def distances(found, places, unit):
    """How far the one are from the other, in the certificate's unit."""
    if unit == "length":
        return numpy.linalg.norm(found - places, axis=1)
    across = numpy.linalg.norm(numpy.cross(found, places), axis=1)
    return numpy.degrees(numpy.arctan2(across, (found * places).sum(axis=1)))


def assert_the_view_is_the_oracles(view, many, points, seen):
    """Some of the places, one by one with 60 digits. Returns how far the others may be off."""
    sample = numpy.linspace(0, len(points) - 1, POINTS_WITH_MANY_DIGITS).astype(int)
    limits = []
    for index in sample:
        offset = view.source.placed(points[index].tolist())
        truth = view.seen(offset)
        # Of the 64 bits half may be lost in the square under the root: where the observer touches.
        limits.append(float(view.rounding_scale(offset)))
        for found, expected in zip(seen[index], truth, strict=True):
            assert abs(mpf(str(found)) - expected) <= mpf(2) ** -28 * mpf(limits[-1]), f"{points[index]}"
    back = many.at_rest(seen[sample])
    assert abs(back - points[sample]).max() <= 2**-24 * max(limits)


def view_at(scene, step):
    """The oracle's view of the only object."""
    (spec,) = scene["objects"]
    proper_time = scene.get("steps", [0])[step]
    return View(Moment.along(scene, proper_time), Source.of_object(spec))


def measure(scene, surface, path, certificate, step=0):
    """The largest distances: of true points from the mesh, of points of the mesh from the true surface."""
    view, unit = view_at(scene, step), certificate["unit"]
    many = ManyPoints(view)
    random = numpy.random.default_rng(3)
    (node,) = glb.Gltf(path).nodes
    places = node.at_step(step)
    triangles = places[node.triangles]

    points = surface.random(POINTS, random)
    seen = many.seen(points.astype(numpy.longdouble))
    assert_the_view_is_the_oracles(view, many, points, seen)
    seen = seen.astype(float)
    missing = distances(Triangles(triangles).nearest(seen), seen, unit).max()

    found, chosen, weights = random_on_triangles(triangles, POINTS, random)
    at_rest = many.at_rest(places).astype(float)[node.triangles]
    near_surface = (weights[:, :, None] * at_rest[chosen]).sum(axis=1)
    on_surface = surface.nearest(near_surface)
    true = many.seen(on_surface.astype(numpy.longdouble)).astype(float)
    off = distances(found, true, unit)
    if certificate["measure"] == "surface":
        for start in (on_surface, surface.nearest(many.at_rest(found).astype(float))):
            # As points these are beyond the bound.
            slid = off > certificate["total"]
            if slid.any():
                led = seen_nearest(found[slid], many, surface, start[slid])
                off[slid] = numpy.minimum(off[slid], distances(found[slid], led, unit))
    return missing, off.max()


def seen_nearest(found, many, surface, start):
    """Places of the true photosurface near the ones it is nearest to: by Levenberg and Marquardt's method, along the
    surface at rest from `start`, to where the distance as seen is smallest."""

    def seen(points):
        return many.seen(points.astype(numpy.longdouble)).astype(float)

    here = start
    there = seen(here)
    off = numpy.linalg.norm(found - there, axis=1)
    damping = numpy.full(len(found), 1e-3)
    size = 1e-5 * (numpy.ptp(here, axis=0).max() + 1e-300)
    for _ in range(LED_STEPS):
        axes = size * numpy.eye(3)
        moved = [seen(surface.nearest(here + axis)) - seen(surface.nearest(here - axis)) for axis in axes]
        jacobian = numpy.stack(moved, axis=2) / (2 * size)
        square = numpy.swapaxes(jacobian, 1, 2) @ jacobian
        scale = damping * numpy.trace(square, axis1=1, axis2=2) + 1e-300
        wanted = numpy.swapaxes(jacobian, 1, 2) @ (found - there)[:, :, None]
        step = numpy.linalg.solve(square + scale[:, None, None] * numpy.eye(3), wanted)[:, :, 0]
        tried = surface.nearest(here + step)
        tried_there = seen(tried)
        tried_off = numpy.linalg.norm(found - tried_there, axis=1)
        nearer = tried_off < off
        here, there = numpy.where(nearer[:, None], [tried, tried_there], [here, there])
        off = numpy.minimum(off, tried_off)
        damping = numpy.where(nearer, damping / 4, damping * 8)
    return there


@pytest.fixture(scope="module")
def ratios():
    """Measured over bound, of every case that was looked at."""
    return {}


@pytest.mark.parametrize("subdivide", [True, False], ids=["subdivided", "as it is"])
@pytest.mark.parametrize("name", [*CASES, *AIRPLANE_CASES])
def test_every_point_is_within_the_bound(name, subdivide, airplane, export, ratios):
    scene, tolerance, surface = case(name, airplane, export)
    flags = ["--tolerance", tolerance, *([] if subdivide else ["--no-subdivide"])]
    path = export(scene, *flags, certified=None)
    (node,) = glb.Gltf(path).nodes
    certificate = node.extras["certificate"]
    assert certificate["unit"] == ("degrees" if tolerance.startswith("deg") else "length")
    measured = measure(scene, surface, path, certificate)
    ratios[name, subdivide] = max(measured) / certificate["total"]
    print(f"{name}: {measured[0]:.3e} {measured[1]:.3e} of {certificate['total']:.3e}")
    assert max(measured) <= certificate["total"]


def test_the_bounds_are_near_what_is_there(ratios):
    """Each is reached to more than a twentieth, and some hardly missed. Measured over bound is printed."""
    for (name, subdivide), ratio in ratios.items():
        print(f"{'subdivided' if subdivide else 'as it is':>10}  {name:26} {ratio:.3f}")
    assert min(ratios.values()) > 0.05
    assert max(ratios.values()) > 0.9


@pytest.mark.parametrize("name", [*CASES, *AIRPLANE_CASES])
def test_the_tolerance_is_kept(name, airplane, export):
    scene, tolerance, _ = case(name, airplane, export)
    export(scene, "--tolerance", tolerance)


@pytest.mark.parametrize("name", [*CASES, *AIRPLANE_CASES])
def test_the_arithmetic_of_the_certificate(name, airplane, export):
    scene, tolerance, _ = case(name, airplane, export)
    for flags in ([], ["--no-subdivide"]):
        path = export(scene, "--tolerance", tolerance, *flags, certified=None)
        (node,) = glb.Gltf(path).nodes
        (facts,) = json.loads((path.parent / "report.json").read_text())["objects"]
        assert facts == node.extras
        certificate = facts["certificate"]
        gap = {"points": "gap", "surface": "surface_gap"}[certificate["measure"]]
        parts = [certificate[part] for part in (gap, "curvature", "rounding")]
        assert all(part >= 0 for part in parts)
        total, asked = certificate["total"], certificate["tolerance"]
        if certificate["unit"] == "length":
            assert total == pytest.approx(sum(parts), rel=2**-48)
            assert total >= sum(parts) * (1 - 2**-51)
        else:
            assert total >= max(parts)
        assert certificate["complete"] == (total <= asked)
        assert certificate["triangles_out"] == facts["triangles"] == len(node.triangles)
        assert 0 < certificate["triangles_in"] <= certificate["triangles_out"]
        if flags:
            assert certificate["triangles_in"] == certificate["triangles_out"]
        ratio = certificate["triangles_out"] / certificate["minimum_with_source"]
        assert certificate["ratio"] == pytest.approx(ratio, rel=2**-50)
        if not tolerance.startswith(("abs:", "deg:")):
            # A fraction of the diagonal of the photosurface of the vertices at rest, all of which are in the
            # file; curved shapes are made anew.
            if certificate["curvature"] == 0:
                diagonal = numpy.linalg.norm(numpy.ptp(unrefined(scene, export), axis=0))
                assert asked == pytest.approx(float(tolerance) * diagonal, rel=2**-22)
        else:
            assert asked == float(tolerance.partition(":")[2])


def unrefined(scene, export):
    (node,) = glb.Gltf(export(scene, "--no-subdivide", certified=None)).nodes
    return node.world


@pytest.mark.parametrize(
    "name", ["sphere, near", "cube, in a face", "torus, near", "lattice, near", "airplane, inside"]
)
def test_what_rounding_moves_is_within_its_bound(name, airplane, export):
    """A .glb and a .ply of the same scene, with the same vertices in f32 and in f64."""
    scene, _, _ = case(name, airplane, export)
    (node,) = glb.Gltf(export(scene, "--no-subdivide")).nodes
    exact = ply.read(export(scene, "--no-subdivide", to="out.ply"))
    assert exact.triangles.tolist() == node.triangles.tolist()
    apart = numpy.linalg.norm(exact.positions - node.world, axis=1).max()
    single = node.extras["certificate"]["rounding"]
    (facts,) = json.loads(
        (export(scene, "--no-subdivide", to="out.ply").parent / "report.json").read_text()
    )["objects"]
    double = facts["certificate"]["rounding"]
    print(f"{apart:.3e} of {single:.3e}, and {double:.3e} of the .ply")
    assert 0.05 * single < apart <= single + double
    assert 0 < double < 2**-20 * single


FLYBY = {
    "observer": {"velocity": {"beta": 0.95, "direction": [-1, 0, 0]}},
    "objects": [{"name": "cube", "shape": BOX, "position": [0.5, 1.125, -0.5]}],
}


def certificates(path):
    return [node.extras["certificate"] for node in glb.Gltf(path).nodes]


@pytest.mark.parametrize("shape", [BOX, SPHERE, TORUS, LATTICE], ids=["cube", "sphere", "torus", "lattice"])
def test_levels_of_detail(shape, export):
    """A file for each tolerance: the finer, the lower the bound and the more triangles."""
    (spec,) = FLYBY["objects"]
    scene = {**FLYBY, "objects": [{**spec, "shape": shape}]}
    tolerances = ["1e-2", "1e-3", "1e-4"]
    directory = export(scene, "--lod", ",".join(tolerances)).parent
    levels = []
    for level, tolerance in enumerate(tolerances):
        path = directory / f"out_lod{level}.glb"
        assert_valid(path)
        (certificate,) = certificates(path)
        (reported,) = json.loads((directory / f"report_lod{level}.json").read_text())["objects"]
        assert reported["certificate"] == certificate
        assert certificate["complete"]
        alone = export(scene, "--tolerance", tolerance)
        assert path.read_bytes() == alone.read_bytes()
        levels.append(certificate)
    for coarse, fine in zip(levels, levels[1:], strict=False):
        assert fine["total"] < coarse["total"]
        assert fine["triangles_out"] > coarse["triangles_out"]
        assert fine["tolerance"] == pytest.approx(coarse["tolerance"] / 10, rel=1e-12)
    assert not (directory / "out.glb").exists()
    assert len(list(directory.glob("*.glb"))) == len(tolerances)


@pytest.mark.parametrize("shape", [BOX, SPHERE, TORUS], ids=["cube", "sphere", "torus"])
@pytest.mark.parametrize("tolerance", ["1e-5", "abs:1e-4", "deg:0.001"])
def test_a_budget_is_kept_and_the_tolerance_named_fits(shape, tolerance, export):
    budget = 2000
    (spec,) = FLYBY["objects"]
    scene = {**FLYBY, "objects": [{**spec, "shape": shape}]}
    path = export(scene, "--tolerance", tolerance, "--max-triangles", str(budget), certified=False)
    (certificate,) = certificates(path)
    assert not certificate["complete"]
    assert certificate["triangles_out"] <= budget
    assert_valid(path)
    messages = (path.parent / "messages.txt").read_text()
    (named,) = re.findall(r"--tolerance (\S+) fits", messages)
    assert named.partition(":")[1:2] == tolerance.partition(":")[1:2]
    fitting = export(scene, "--tolerance", named, "--max-triangles", str(budget))
    (fits,) = certificates(fitting)
    assert fits["complete"] and fits["triangles_out"] <= budget
    # Nor was the budget left unused.
    assert certificate["triangles_out"] > budget / 4


def test_a_budget_that_is_enough_changes_nothing(export):
    whole = export(FLYBY)
    within = export(FLYBY, "--max-triangles", "100000")
    assert whole.read_bytes() == within.read_bytes()


def test_without_subdivision_the_certificate_is_open_and_true(export):
    """`test_every_point_is_within_the_bound` looks into such files too."""
    path = export(FLYBY, "--no-subdivide", certified=None)
    (certificate,) = certificates(path)
    assert certificate["total"] > certificate["tolerance"]
    assert not certificate["complete"]
    assert certificate["triangles_out"] == certificate["triangles_in"]
    assert_valid(path)


@pytest.mark.parametrize("tolerance", ["1e-2", "1e-4", "abs:0.01", "deg:0.05"])
def test_files_of_any_tolerance_are_valid(tolerance, export):
    assert_valid(export(FLYBY, "--tolerance", tolerance))


def test_tolerances_of_objects_and_of_the_scene(export):
    """An object's own goes before the scene's, a flag before both."""
    (spec,) = FLYBY["objects"]
    own = {**spec, "name": "own", "tolerance": {"absolute": 0.03}}
    scene = {**FLYBY, "objects": [spec, own], "tolerance": {"angle_deg": 0.5}}
    first, second = certificates(export(scene))
    assert (first["unit"], first["tolerance"]) == ("degrees", 0.5)
    assert (second["unit"], second["tolerance"]) == ("length", 0.03)
    for certificate in certificates(export(scene, "--tolerance", "abs:0.02")):
        assert (certificate["unit"], certificate["tolerance"]) == ("length", 0.02)


def test_of_a_turned_and_stretched_box_that_moves_too(export):
    """The same two questions where object and observer both move."""
    scene = {**CUBE, "steps": [0]}
    path = export(scene)
    (spec,) = scene["objects"]
    ((_, size),) = spec["shape"].items()
    (certificate,) = certificates(path)
    measured = measure(scene, box(size["size"]), path, certificate)
    print(measured, certificate["total"])
    assert max(measured) <= certificate["total"]


# Past the observer, with the step of the case above in between.
MORPH_STEPS = [-1.5, 0, 0.75]
MORPHING = ["sphere, near", "sphere, by angle", "cylinder, near", "torus, near", "cube, near", "cube, in a face"]
MORPHING += ["lattice, near", "airplane, near"]


@pytest.mark.parametrize("name", MORPHING)
def test_one_mesh_for_all_steps_is_within_the_bound_of_each(name, airplane, export):
    """Base and target of a morphing mesh, asked the same two questions at every step."""
    scene, tolerance, surface = case(name, airplane, export)
    scene = {**scene, "steps": MORPH_STEPS}
    path = export(scene, "--tolerance", tolerance, "--animate=morph")
    (node,) = glb.Gltf(path).nodes
    assert [frame["proper_time"] for frame in node.extras["frames"]] == MORPH_STEPS
    reported = json.loads((path.parent / "report.json").read_text())["objects"]
    assert reported == node.extras["frames"]
    for step, facts in enumerate(node.extras["frames"]):
        certificate = facts["certificate"]
        measured = measure(scene, surface, path, certificate, step)
        print(f"{name} {step}: {measured[0]:.3e} {measured[1]:.3e} of {certificate['total']:.3e}")
        assert max(measured) <= certificate["total"]


@pytest.mark.parametrize("name", MORPHING)
def test_a_vertex_that_morphs_stays_the_same_point_at_rest(name, airplane, export):
    """Where the first step has it says which point it is; the oracle says where that is seen at the others."""
    scene, tolerance, _ = case(name, airplane, export)
    scene = {**scene, "steps": MORPH_STEPS}
    (node,) = glb.Gltf(export(scene, "--tolerance", tolerance, "--animate=morph")).nodes
    at_rest = ManyPoints(view_at(scene, 0)).at_rest(node.at_step(0))
    # Base and target are rounded, each of three coordinates.
    largest = max(abs(values).max() for values in [node.positions, *(t["POSITION"] for t in node.targets)])
    rounding = 2**-24 * 2 * 3**0.5 * largest
    for step in range(1, 3):
        view = view_at(scene, step)
        # To rest and back an error grows by exp(rapidity) each way at most.
        stretch = float(2 * view.relative_gamma()) ** 2
        limit = (1 + stretch) * rounding
        places = node.at_step(step)
        assert abs(ManyPoints(view).seen(at_rest) - places).max() <= limit
        for vertex in numpy.linspace(0, len(places) - 1, 20).astype(int):
            point = [mpf(str(x)) for x in at_rest[vertex]]
            seen = view.seen(view.source.placed(point))
            assert all(abs(s - mpf(p)) <= limit for s, p in zip(seen, places[vertex].tolist(), strict=True))


@pytest.mark.parametrize("name", ["sphere", "cube", "lattice", "street", "snapshot"])
def test_built_in_scenes_are_certified(name, export, photosurface):
    for certificate in certificates_of_things(export(json.loads(photosurface("example", name)))):
        assert certificate["complete"]
        assert math.isfinite(certificate["ratio"])


def certificates_of_things(path):
    """All but the observer's marker, which is no photosurface."""
    return [node.extras["certificate"] for node in glb.Gltf(path).nodes if "extras" in node.json]
