"""The surfaces at rest that photosurfaces are judged by: random points on them, and the nearest points.

Curved ones by their parametrisation, flat ones as triangles. All in the mesh's own coordinates, in f64.
"""

from dataclasses import dataclass

import numpy
import pyvista
import trimesh


def random_on_triangles(triangles, count, random):
    """Points spread evenly over the area of triangles; which triangle, and the weights of its corners."""
    sides = triangles[:, 1:] - triangles[:, :1]
    area = numpy.linalg.norm(numpy.cross(sides[:, 0], sides[:, 1]), axis=1)
    chosen = random.choice(len(triangles), count, p=area / area.sum())
    a, b = random.random((2, count))
    root = numpy.sqrt(a)
    weights = numpy.column_stack([1 - root, root * (1 - b), root * b])
    return (weights[:, :, None] * triangles[chosen]).sum(axis=1), chosen, weights


class Triangles:
    """A surface of flat triangles. vtk says which triangle is nearest, trimesh where on it."""

    def __init__(self, triangles):
        self.triangles = numpy.asarray(triangles, dtype=numpy.float64)
        sides = self.triangles[:, 1:] - self.triangles[:, :1]
        # vtk's search of triangles without an inside is not defined; their edges are those of others.
        has_area = numpy.linalg.norm(numpy.cross(sides[:, 0], sides[:, 1]), axis=1) > 0
        self.triangles = self.triangles[has_area]
        faces = numpy.arange(3 * len(self.triangles)).reshape(-1, 3)
        self._vtk = pyvista.PolyData.from_regular_faces(self.triangles.reshape(-1, 3), faces)
        assert self._vtk.points.dtype == numpy.float64

    def random(self, count, random):
        return random_on_triangles(self.triangles, count, random)[0]

    def nearest(self, points):
        """A point of the surface for each: hardly farther than the nearest, and never off the surface."""
        cells = numpy.atleast_1d(self._vtk.find_closest_cell(points))
        return trimesh.triangles.closest_point(self.triangles[cells], points)


@dataclass
class Sphere:
    radius: float

    def random(self, count, random):
        return self.nearest(random.standard_normal((count, 3)))

    def nearest(self, points):
        return self.radius * points / numpy.linalg.norm(points, axis=1)[:, None]


@dataclass
class Torus:
    major: float
    minor: float

    def random(self, count, random):
        around, tube = 2 * numpy.pi * random.random((2, 4 * count))
        # The area of a piece goes with its distance from the axis.
        distance = self.major + self.minor * numpy.cos(tube)
        kept = random.random(4 * count) * (self.major + self.minor) < distance
        around, tube, distance = (x[kept][:count] for x in (around, tube, distance))
        assert len(around) == count
        return numpy.column_stack(
            [distance * numpy.cos(around), self.minor * numpy.sin(tube), distance * numpy.sin(around)]
        )

    def nearest(self, points):
        from_axis = numpy.hypot(points[:, 0], points[:, 2])
        outward = points * [1, 0, 1] / from_axis[:, None]
        spine = self.major * outward
        return spine + self.minor * unit(points - spine)


@dataclass
class Cylinder:
    radius: float
    height: float

    def random(self, count, random):
        around = 2 * numpy.pi * random.random(count)
        side = 2 * numpy.pi * self.radius * self.height
        lid = numpy.pi * self.radius**2
        where = random.choice(3, count, p=numpy.array([side, lid, lid]) / (side + 2 * lid))
        y = numpy.select([where == 1, where == 2], [1.0, -1.0], random.uniform(-1, 1, count))
        radius = self.radius * numpy.where(where == 0, 1, numpy.sqrt(random.random(count)))
        return numpy.column_stack([radius * numpy.cos(around), y * self.height / 2, radius * numpy.sin(around)])

    def nearest(self, points):
        from_axis = numpy.hypot(points[:, 0], points[:, 2])
        on_side = points * (self.radius / from_axis)[:, None]
        on_side[:, 1] = points[:, 1].clip(-self.height / 2, self.height / 2)
        on_lid = points * numpy.minimum(1, self.radius / from_axis)[:, None]
        on_lid[:, 1] = numpy.copysign(self.height / 2, points[:, 1])
        nearer = numpy.linalg.norm(on_side - points, axis=1) < numpy.linalg.norm(on_lid - points, axis=1)
        return numpy.where(nearer[:, None], on_side, on_lid)


def unit(vectors):
    return vectors / numpy.linalg.norm(vectors, axis=1)[:, None]


def box(size):
    """A box centred on the origin."""
    return Triangles(trimesh.creation.box(size).triangles)
