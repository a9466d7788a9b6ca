//! What an observer sees, by brute force in 300 digits.
//!
//! Nothing here knows the photosurface map. The straight worldline of a point is written down in the
//! scene frame, the light-cone equation of the observer's event is solved there, and the emission
//! event is boosted into the observer's frame by a 4x4 matrix. Derivatives are differences of such
//! solutions. At 300 digits nothing has to be arranged so as not to cancel.

use dashu_float::{FBig, round::mode::HalfEven};
use photosurface::spacetime::Event;
use photosurface::{DQuat, DVec3, Velocity};

/// A real number with [`PRECISION`] bits.
pub(crate) type Big = FBig<HalfEven, 2>;

/// Bits of every [`Big`]: 308 digits. The worst cancellation in the tests takes 261 of them (`exp(2 * 300)`:
/// a composed boost of rapidity 300 undone to find its rotation). Differences, whose steps take 120,
/// are asked for up to a rapidity of 30 only, which takes 26.
const PRECISION: usize = 1024;

/// A vector of three.
pub(crate) type Vector = [Big; 3];

/// Time and place, or a four-vector.
pub(crate) type FourVector = [Big; 4];

/// A Lorentz matrix acting on columns `(t, x, y, z)`.
pub(crate) type Matrix = [[Big; 4]; 4];

/// Exactly `value`.
pub(crate) fn big(value: f64) -> Big {
    Big::try_from(value)
        .expect("finite")
        .with_precision(PRECISION)
        .value()
}

/// Exactly `vector`.
pub(crate) fn big_vector(vector: DVec3) -> Vector {
    vector.to_array().map(big)
}

/// The nearest `f64`.
pub(crate) fn small(value: &Big) -> f64 {
    value.to_f64().value()
}

pub(crate) fn dot(a: &[Big], b: &[Big]) -> Big {
    a.iter()
        .zip(b)
        .fold(big(0.0), |sum, (a, b)| sum + a.clone() * b)
}

pub(crate) fn cross(a: &Vector, b: &Vector) -> Vector {
    let component = |i: usize, j: usize| a[i].clone() * &b[j] - a[j].clone() * &b[i];
    [component(1, 2), component(2, 0), component(0, 1)]
}

pub(crate) fn length(vector: &[Big]) -> Big {
    square_root(&dot(vector, vector))
}

pub(crate) fn scaled<const N: usize>(vector: &[Big; N], factor: &Big) -> [Big; N] {
    std::array::from_fn(|i| vector[i].clone() * factor)
}

pub(crate) fn sum<const N: usize>(a: &[Big; N], b: &[Big; N]) -> [Big; N] {
    std::array::from_fn(|i| a[i].clone() + &b[i])
}

pub(crate) fn difference<const N: usize>(a: &[Big; N], b: &[Big; N]) -> [Big; N] {
    std::array::from_fn(|i| a[i].clone() - &b[i])
}

pub(crate) fn normalized(vector: &Vector) -> Vector {
    let length = length(vector);
    std::array::from_fn(|i| vector[i].clone() / &length)
}

/// `|value - exact|`, where `value` may agree with `exact` in all its digits.
pub(crate) fn error(value: f64, exact: &Big) -> f64 {
    if !value.is_finite() {
        return f64::NAN;
    }
    small(&(big(value) - exact)).abs()
}

/// `|value - exact|` of vectors.
pub(crate) fn vector_error(value: DVec3, exact: &Vector) -> f64 {
    if !value.is_finite() {
        return f64::NAN;
    }
    small(&length(&difference(&big_vector(value), exact)))
}

pub(crate) fn square_root(value: &Big) -> Big {
    if *value == big(0.0) {
        return big(0.0);
    }
    value.sqrt()
}

/// The pure boost into the frame of something that moves with `velocity`.
///
/// The rapidity is taken as exact. So is the direction as it was given, [`Velocity::heading`].
pub(crate) fn boost(velocity: &Velocity) -> Matrix {
    let growth = big(velocity.rapidity()).exp();
    let shrink = big(1.0) / &growth;
    let gamma = (growth.clone() + &shrink) / big(2.0);
    let gamma_beta = (growth - &shrink) / big(2.0);
    let n = normalized(&big_vector(velocity.heading()));
    std::array::from_fn(|row| {
        std::array::from_fn(|column| match (row, column) {
            (0, 0) => gamma.clone(),
            (0, i) | (i, 0) => -(gamma_beta.clone() * &n[i - 1]),
            (i, j) => {
                let unit = big(if i == j { 1.0 } else { 0.0 });
                unit + (gamma.clone() - big(1.0)) * &n[i - 1] * &n[j - 1]
            }
        })
    })
}

/// First `right`, then `left`.
pub(crate) fn product(left: &Matrix, right: &Matrix) -> Matrix {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            (0..4).fold(big(0.0), |sum, k| sum + left[i][k].clone() * &right[k][j])
        })
    })
}

pub(crate) fn apply(matrix: &Matrix, vector: &FourVector) -> FourVector {
    std::array::from_fn(|i| dot(&matrix[i], vector))
}

/// The transformation back, by the Lorentz metric: time and space change sign where they mix.
pub(crate) fn inverse(matrix: &Matrix) -> Matrix {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let entry = matrix[j][i].clone();
            if (i == 0) == (j == 0) { entry } else { -entry }
        })
    })
}

/// One uniformly moving object and one observer.
pub(crate) struct Oracle {
    /// Where the object's origin is at scene time 0.
    origin: FourVector,
    object_to_scene: Matrix,
    /// The observer's event in the scene frame.
    event: FourVector,
    scene_to_observer: Matrix,
}

/// What the observer sees of one point.
pub(crate) struct Sight {
    /// The emission event in the observer's frame, whose origin is the event of observation.
    pub(crate) event: FourVector,
    /// The reading of the point's own clock at emission.
    pub(crate) clock: Big,
}

impl Sight {
    pub(crate) fn position(&self) -> Vector {
        std::array::from_fn(|i| self.event[i + 1].clone())
    }

    pub(crate) fn emission_time(&self) -> &Big {
        &self.event[0]
    }
}

impl Oracle {
    /// An object whose origin is at `object_position` at scene time 0 and moves with `object_velocity`,
    /// seen from `observer_event` in motion with `observer_velocity`; all in the scene frame.
    pub(crate) fn new(
        object_position: DVec3,
        object_velocity: &Velocity,
        observer_event: Event,
        observer_velocity: &Velocity,
    ) -> Self {
        let four = |time: f64, position: DVec3| {
            let [x, y, z] = big_vector(position);
            [big(time), x, y, z]
        };
        Self {
            origin: four(0.0, object_position),
            object_to_scene: inverse(&boost(object_velocity)),
            event: four(observer_event.time, observer_event.position),
            scene_to_observer: boost(observer_velocity),
        }
    }

    /// An object at rest in the scene, and an observer who passes its origin with `observer_velocity`.
    pub(crate) fn observer_moves(observer_velocity: &Velocity) -> Self {
        Self::new(
            DVec3::ZERO,
            &Velocity::ZERO,
            Event::default(),
            observer_velocity,
        )
    }

    /// The same observer with its axes turned by `rotation`, which is given in them.
    ///
    /// The coordinate along a turned axis is the product with that axis.
    pub(crate) fn turned(mut self, rotation: DQuat) -> Self {
        let [x, y, z, w] = rotation.to_array().map(big);
        let vector = [x, y, z];
        let square = dot(&vector, &vector) + w.clone() * &w;
        let axes: [Vector; 3] = DVec3::AXES.map(|axis| {
            // q a q* / |q|^2 = ((w^2 - v.v) a + 2 (v.a) v + 2 w v x a) / |q|^2
            let axis = big_vector(axis);
            let kept = scaled(&axis, &(w.clone() * &w - dot(&vector, &vector)));
            let along = scaled(&vector, &(big(2.0) * dot(&vector, &axis)));
            let across = scaled(&cross(&vector, &axis), &(big(2.0) * &w));
            scaled(
                &sum(&sum(&kept, &along), &across),
                &(big(1.0) / square.clone()),
            )
        });
        let turn: Matrix = std::array::from_fn(|row| {
            std::array::from_fn(|column| match (row, column) {
                (0, 0) => big(1.0),
                (0, _) | (_, 0) => big(0.0),
                (row, column) => axes[row - 1][column - 1].clone(),
            })
        });
        self.scene_to_observer = product(&turn, &self.scene_to_observer);
        self
    }

    /// What is seen of the point at `vertex` in the object's rest frame.
    pub(crate) fn see(&self, vertex: &Vector) -> Sight {
        self.see_later(vertex, &big(0.0))
    }

    /// The same when the observer's clock has gone on by `proper_time`.
    fn see_later(&self, vertex: &Vector, proper_time: &Big) -> Sight {
        let scene = |time: Big, place: &Vector| {
            let [x, y, z] = place.clone();
            apply(&self.object_to_scene, &[time, x, y, z])
        };
        // The point's worldline start + clock * step, and the observer's event, in the scene frame.
        let start = sum(&self.origin, &scene(big(0.0), vertex));
        let step = scene(big(1.0), &[big(0.0), big(0.0), big(0.0)]);
        let flow: FourVector = inverse(&self.scene_to_observer).map(|[time, ..]| time);
        let now = sum(&self.event, &scaled(&flow, proper_time));

        // Zero interval is a quadratic equation for the clock; the earlier root lies in the past.
        let back = difference(&start, &now);
        let (a, b, c) = (
            interval(&step, &step),
            interval(&step, &back),
            interval(&back, &back),
        );
        let discriminant = b.clone() * &b - a.clone() * &c;
        let clock = (square_root(&discriminant) - b) / a;
        let flight = sum(&back, &scaled(&step, &clock));

        // Whatever the algebra: the event must be in the past and on the light cone.
        let distance = length(&flight[1..]);
        let miss = small(&(flight[0].clone() + &distance)).abs();
        assert!(
            flight[0] <= big(0.0) && miss <= 1e-150 * (1.0 + small(&distance)),
            "the oracle missed the light cone by {miss:e}"
        );
        Sight {
            event: apply(&self.scene_to_observer, &flight),
            clock,
        }
    }

    /// Frequency seen over frequency emitted: how far the point's clock is seen to go on while the
    /// observer's goes on by one unit.
    pub(crate) fn doppler_factor(&self, vertex: &Vector) -> Big {
        let step = self.step(vertex);
        let later = self.see_later(vertex, &step).clock;
        let earlier = self.see_later(vertex, &-step.clone()).clock;
        (later - earlier) / (big(2.0) * step)
    }

    /// The derivative of the position seen along `direction` in the rest frame.
    pub(crate) fn derivative(&self, vertex: &Vector, direction: &Vector) -> Vector {
        let step = self.step(vertex);
        let shift = scaled(direction, &step);
        let ahead = self.see(&sum(vertex, &shift)).position();
        let behind = self.see(&difference(vertex, &shift)).position();
        scaled(&difference(&ahead, &behind), &(big(0.5) / step))
    }

    /// The unit normal of the photosurface where the surface at rest has the normal `normal`: two
    /// tangents of the one, mapped, span the other.
    pub(crate) fn normal(&self, vertex: &Vector, normal: DVec3) -> Vector {
        let aside = big_vector(normal.any_orthogonal_vector());
        let normal = big_vector(normal);
        let first = cross(&normal, &aside);
        let second = cross(&normal, &first);
        normalized(&cross(
            &self.derivative(vertex, &first),
            &self.derivative(vertex, &second),
        ))
    }

    /// A step for central differences: their error is its square, relative to the distance on which
    /// the map bends, which is not below `exp(-30)` of the distance seen.
    fn step(&self, vertex: &Vector) -> Big {
        big(1e-60) * length(&self.see(vertex).position())
    }
}

fn interval(a: &FourVector, b: &FourVector) -> Big {
    dot(&a[1..], &b[1..]) - a[0].clone() * &b[0]
}
