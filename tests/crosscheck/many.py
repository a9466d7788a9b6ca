"""The oracle's view for many points at once, in numpy's long doubles, and its inverse.

The same steps as in `oracle`: worldlines in the scene frame, a quadratic equation, a matrix.
"""

import numpy
from mpmath import mp

from oracle import boost, boost_back


def long_double(value):
    return numpy.longdouble(mp.nstr(value, 30))


def matrix(rows):
    return numpy.array([[long_double(x) for x in row] for row in rows])


def interval(a, b):
    return (a[..., 1:] * b[..., 1:]).sum(axis=-1) - a[..., 0] * b[..., 0]


class ManyPoints:
    """What one observation shows of one object: `View` of `oracle`, for arrays of points."""

    def __init__(self, view):
        moment, source = view.moment, view.source
        self._event = numpy.array([long_double(x) for x in moment.event])
        self._u = numpy.array([long_double(x) for x in source.u])
        self._origin = numpy.array([long_double(x) for x in [0, *source.position]])
        self._placing = matrix(source.rotation) * numpy.array([long_double(s) for s in source.scale])
        self._unplacing = matrix((mp.matrix(placing_rows(source)) ** -1).tolist())
        self._scene_to_observer = matrix(moment.scene_to_observer())
        self._observer_to_scene = matrix(moment.observer_to_scene())
        self._rest_to_scene = matrix(boost_back(source.u))
        self._scene_to_rest = matrix(boost(source.u))

    def seen(self, points):
        """Where points of the mesh are seen."""
        offsets = points @ self._placing.T
        at_zero = offsets @ self._rest_to_scene[:, 1:].T + self._origin
        separation = at_zero - self._event
        half = interval(separation, self._u)
        # half^2 + separation^2 is the square of the distance at rest: never below zero but by rounding.
        proper_time = half - numpy.sqrt(numpy.maximum(half**2 + interval(separation, separation), 0))
        event = separation + proper_time[:, None] * self._u
        return (event @ self._scene_to_observer.T)[:, 1:]

    def at_rest(self, seen):
        """The points of the mesh that are seen there: light left them when it had so far to go."""
        seen = seen.astype(numpy.longdouble)
        time = -numpy.sqrt((seen**2).sum(axis=1))
        event = numpy.column_stack([time, seen]) @ self._observer_to_scene.T + self._event
        offsets = ((event - self._origin) @ self._scene_to_rest.T)[:, 1:]
        return offsets @ self._unplacing.T


def placing_rows(source):
    return [[r * s for r, s in zip(row, source.scale, strict=True)] for row in source.rotation]
