"""Where a moving observer sees a point, by brute force, with 60 digits.

The worldline of the point is written down in the scene frame, the event on it that lies on the
observer's backward light cone is found there from a quadratic equation, and that event is boosted into
the observer's frame. Boosts are the 4x4 matrices of any textbook. The Doppler factor is the ratio of two
proper times, the normal the cross product of two tangents, both by differencing. No formula of the crate
is used. c = 1; events are lists [t, x, y, z]; the metric is (-, +, +, +).
"""

from dataclasses import dataclass

from mpmath import mp, mpf

mp.dps = 60

# Step of the central differences: their error is of the order of its square.
DIFFERENCE = mpf(10) ** -20

IDENTITY = [[mpf(1 if row == column else 0) for column in range(3)] for row in range(3)]


def dot(a, b):
    return mp.fsum(x * y for x, y in zip(a, b, strict=True))


def norm(a):
    return mp.sqrt(dot(a, a))


def unit(a):
    length = norm(a)
    return [x / length for x in a]


def cross(a, b):
    return [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]


def apply(matrix, vector):
    return [dot(row, vector) for row in matrix]


def interval(a, b):
    """The scalar product of two four-vectors."""
    return dot(a[1:], b[1:]) - a[0] * b[0]


def four_velocity(velocity):
    """The four-velocity [gamma, gamma v] of a velocity as the scene file writes it."""
    if velocity is None:
        return [mpf(1), mpf(0), mpf(0), mpf(0)]
    if isinstance(velocity, list):
        beta_vector = [mpf(b) for b in velocity]
        gamma = 1 / mp.sqrt(1 - dot(beta_vector, beta_vector))
        return [gamma, *(gamma * b for b in beta_vector)]
    direction = unit([mpf(x) for x in velocity["direction"]])
    if "beta" in velocity:
        gamma = 1 / mp.sqrt(1 - mpf(velocity["beta"]) ** 2)
    elif "one_minus_beta" in velocity:
        gamma = 1 / mp.sqrt(1 - (1 - mpf(velocity["one_minus_beta"])) ** 2)
    elif "gamma" in velocity:
        gamma = mpf(velocity["gamma"])
    else:
        gamma = mp.cosh(mpf(velocity["rapidity"]))
    gamma_beta = mp.sqrt(gamma**2 - 1)
    if mpf(velocity.get("beta", 0)) < 0 or mpf(velocity.get("rapidity", 0)) < 0:
        gamma_beta = -gamma_beta
    return [gamma, *(gamma_beta * x for x in direction)]


def boost(u):
    """The matrix of the pure boost into the frame that moves with the four-velocity `u`."""
    gamma, w = u[0], u[1:]
    matrix = [[gamma, *(-x for x in w)]]
    for i in range(3):
        row = [(1 if i == j else 0) + w[i] * w[j] / (1 + gamma) for j in range(3)]
        matrix.append([-w[i], *row])
    return matrix


def boost_back(u):
    """The matrix of the pure boost out of the frame that moves with the four-velocity `u`."""
    return boost([u[0], *(-x for x in u[1:])])


def rotation_matrix(quaternion):
    """The rotation matrix of the quaternion [x, y, z, w], made unit first."""
    x, y, z, w = unit([mpf(c) for c in quaternion])
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]


@dataclass
class Moment:
    """What an observer is at one instant: its event and its four-velocity in the scene frame, and the
    matrix that turns coordinates along the axes of a pure boost into those along its own."""

    event: list
    u: list
    turn: list

    @classmethod
    def of_scene(cls, scene):
        spec = scene.get("observer", {})
        place = [mpf(x) for x in spec.get("position", [0, 0, 0])]
        u = four_velocity(spec.get("velocity"))
        return cls([mpf(spec.get("time", 0)), *place], u, IDENTITY)

    @classmethod
    def along(cls, scene, proper_time):
        """The observer of a scene after that much proper time of its flight, axes and all."""
        spec = scene.get("observer", {})
        moment = cls.of_scene(scene)
        if "orientation" in spec:
            moment = moment.turned(spec["orientation"])
        left = mpf(proper_time)
        for segment in spec.get("flight", []) if left > 0 else []:
            duration = min(left, mpf(segment["proper_time"]))
            moment = moment._flown(segment, duration)
            left -= duration
        return moment.after(left)

    def _flown(self, segment, proper_time):
        """The same observer after a part of a segment: the matrix exponential of [[K, e_0], [0, 0]]."""
        a = [mpf(x) for x in segment.get("acceleration", [0, 0, 0])]
        w = [mpf(x) for x in segment.get("turn_rate", [0, 0, 0])]
        if segment.get("steer") == "coordinated":
            ahead = apply(self.turn, unit(self.u[1:]))
            assert abs(dot(ahead, a)) < mpf(10) ** -50, "this oracle turns at constant speed only"
            w = [x * self.u[0] / norm(self.u[1:]) for x in cross(ahead, a)]
        generator = mp.matrix([
            [0, a[0], a[1], a[2], 1],
            [a[0], 0, -w[2], w[1], 0],
            [a[1], w[2], 0, -w[0], 0],
            [a[2], -w[1], w[0], 0, 0],
            [0, 0, 0, 0, 0],
        ])
        tetrad = mp.matrix([[*row, e] for row, e in zip(self.observer_to_scene(), self.event, strict=True)])
        flown = tetrad * mp.expm(generator * proper_time)
        u, event = ([flown[i, k] for i in range(4)] for k in (0, 4))
        # The axes before the turn are those of the pure boost: the boost back leaves the turn.
        axes = [apply(boost(u), [flown[i, k] for i in range(4)])[1:] for k in (1, 2, 3)]
        return Moment(event, u, axes)

    def after(self, proper_time):
        """The same observer, coasting, after that much proper time."""
        event = [e + mpf(proper_time) * u for e, u in zip(self.event, self.u, strict=True)]
        return Moment(event, self.u, self.turn)

    def turned(self, quaternion):
        """The same observer with its axes turned by a rotation that is given in them."""
        axes = zip(*rotation_matrix(quaternion), strict=True)
        columns = list(zip(*self.turn, strict=True))
        return Moment(self.event, self.u, [[dot(axis, c) for c in columns] for axis in axes])

    def scene_to_observer(self):
        """The matrix of the boost and the turn after it."""
        time, *space = boost(self.u)
        columns = list(zip(*space, strict=True))
        return [time, *([dot(row, c) for c in columns] for row in self.turn)]

    def observer_to_scene(self):
        """The matrix back: time and space change sign where they mix."""
        columns = zip(*self.scene_to_observer(), strict=True)
        return [
            [-x if (row == 0) != (column == 0) else x for column, x in enumerate(entries)]
            for row, entries in enumerate(columns)
        ]


@dataclass
class Source:
    """A uniformly moving object: where its origin is at scene time 0, its four-velocity, its placing."""

    position: list
    u: list
    rotation: list
    scale: list

    @classmethod
    def of_object(cls, spec):
        scale = spec.get("scale", 1)
        return cls(
            [mpf(x) for x in spec.get("position", [0, 0, 0])],
            four_velocity(spec.get("velocity")),
            rotation_matrix(spec["rotation"]) if "rotation" in spec else IDENTITY,
            [mpf(s) for s in (scale if isinstance(scale, list) else [scale] * 3)],
        )

    def placed(self, vertex):
        """A vertex of the mesh, scaled and turned, in the object's rest frame."""
        return apply(self.rotation, [s * mpf(x) for s, x in zip(self.scale, vertex, strict=True)])

    def placed_normal(self, normal):
        """A normal of the mesh in the object's rest frame: scaled by the inverse, as normals are."""
        return unit(apply(self.rotation, [mpf(x) / s for s, x in zip(self.scale, normal, strict=True)]))


class View:
    """What one observation shows of one object."""

    def __init__(self, moment, source):
        self.moment = moment
        self.source = source
        self._to_observer = moment.scene_to_observer()
        self._to_scene = boost_back(source.u)

    def emission(self, offset):
        """The event, in the scene frame, at which the point `offset` (in the rest frame) emitted the
        light that arrives now, and the point's proper time there."""
        at_zero = apply(self._to_scene, [mpf(0), *offset])
        at_zero = [at_zero[0], *(x + p for x, p in zip(at_zero[1:], self.source.position, strict=True))]
        # The worldline is at_zero + s u. It meets the light cone where (at_zero + s u - event)^2 = 0,
        # a quadratic equation in s with u^2 = -1; the smaller root is the past one.
        separation = [a - e for a, e in zip(at_zero, self.moment.event, strict=True)]
        half = interval(separation, self.source.u)
        proper_time = half - mp.sqrt(half**2 + interval(separation, separation))
        event = [a + proper_time * u for a, u in zip(at_zero, self.source.u, strict=True)]
        return event, proper_time

    def seen_event(self, offset):
        """The emission event [t, x, y, z] in the observer's frame, the observation at its origin."""
        event, _ = self.emission(offset)
        return apply(
            self._to_observer, [x - e for x, e in zip(event, self.moment.event, strict=True)]
        )

    def seen(self, offset):
        return self.seen_event(offset)[1:]

    def shown(self, model, offset):
        """Where the point is shown under a model, by the model's own definition."""
        if model == "seen":
            return self.seen(offset)
        now = self._now(offset) if model == "contracted" else self._whole(offset)
        if model != "delayed":
            return now
        # It is at `now` at time 0 and moves on straight: its light left at the time t <= 0 with |now + v t| = -t.
        v = [x / self._motion()[0] for x in self._motion()[1:]]
        a, b, c = 1 - dot(v, v), -dot(now, v), -dot(now, now)
        time = (-b - mp.sqrt(b * b - a * c)) / a
        return [n + time * w for n, w in zip(now, v, strict=True)]

    def _motion(self):
        """The object's four-velocity in the observer's frame."""
        return apply(self._to_observer, self.source.u)

    def _now(self, offset):
        """Where the point is at the moment of observation, in the observer's frame."""
        at_zero = apply(self._to_scene, [mpf(0), *offset])
        at_zero = [at_zero[0], *(x + p for x, p in zip(at_zero[1:], self.source.position, strict=True))]
        start = apply(self._to_observer, [x - e for x, e in zip(at_zero, self.moment.event, strict=True)])
        u = self._motion()
        return [x - start[0] / u[0] * w for x, w in zip(start[1:], u[1:], strict=True)]

    def _whole(self, offset):
        """The point's offset from the observer in the object's rest frame, in the observer's axes.

        It is what the point has now, made longer along the motion by what contraction takes.
        """
        now, motion = self._now(offset), self._motion()
        if norm(motion[1:]) == 0:
            return now
        along = unit(motion[1:])
        longer = (motion[0] - 1) * dot(along, now)
        return [x + longer * n for x, n in zip(now, along, strict=True)]

    def doppler(self, offset):
        """Frequency seen over frequency emitted: proper time elapsed there per proper time here."""
        _, earlier = View(self.moment.after(-DIFFERENCE), self.source).emission(offset)
        _, later = View(self.moment.after(DIFFERENCE), self.source).emission(offset)
        return (later - earlier) / (2 * DIFFERENCE)

    def normal(self, offset, normal):
        """The unit normal of the photosurface where the surface at rest has `normal`."""
        # Any two tangents t1 x t2 = normal do; the axis least along the normal starts them.
        axis = [mpf(0)] * 3
        axis[min(range(3), key=lambda i: abs(normal[i]))] = mpf(1)
        first = unit(cross(axis, normal))
        second = cross(normal, first)
        return unit(cross(self._derivative(offset, first), self._derivative(offset, second)))

    def _derivative(self, offset, along):
        ahead = self.seen([o + DIFFERENCE * a for o, a in zip(offset, along, strict=True)])
        behind = self.seen([o - DIFFERENCE * a for o, a in zip(offset, along, strict=True)])
        return [(a - b) / (2 * DIFFERENCE) for a, b in zip(ahead, behind, strict=True)]

    def relative_gamma(self):
        return -interval(self.moment.u, self.source.u)

    def rounding_scale(self, offset):
        """The length that f64 rounding errors of any honest evaluation are relative to.

        Going to the object's rest frame makes terms of the size of gamma times the separation from its
        origin (in time and space); adding the offset gives the offset from the observer; and mapping
        that makes terms of the size of the relative gamma times it.
        """
        separation = norm(self.moment.event) + norm(self.source.position)
        return self.relative_gamma() * (norm(offset) + 2 * self.source.u[0] * separation)
