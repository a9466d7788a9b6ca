//! What several tests share: an independent oracle, repeatable random numbers, a record of errors.

pub(crate) mod alone;
pub(crate) mod command;
pub(crate) mod curve;
pub(crate) mod glb;
pub(crate) mod oracle;
pub(crate) mod passing;
pub(crate) mod progress;
pub(crate) mod refining;

use photosurface::light_cone::PhotosurfaceMap;
use photosurface::{DVec3, Velocity};
use proptest::test_runner::{Config, RngSeed};

/// What relative roundings may add up to in one result: one costs half an epsilon, and from given
/// numbers to a position, time, Doppler factor, rapidity... at most 20 follow each other.
pub(crate) const RELATIVE: f64 = 10.0 * f64::EPSILON;

/// How far, in radians, a direction may seem turned: a unit vector is known to its last place, and
/// sums of products with it (`n.d`, `n x d`, twice in a row) round by `1.5` epsilon of `|d|` each.
pub(crate) const TURN: f64 = 4.0 * f64::EPSILON;

/// What turning either direction by a unit angle can do, at most, to the parts `v = c1 s2 n2 + s1 c2 n1`
/// and `w = s1 s2 n2 x n1` of two boosts' product.
///
/// `c`, `s` are hyperbolic functions of half the rapidities. The resulting rapidity has
/// `|v| = sinh(eta / 2)`, the angle of the rotation has `tan(angle / 2) = |w| / alpha`, and
/// `hypot(alpha, |w|) = cosh(eta / 2)`.
pub(crate) fn composition_swings(first: &Velocity, second: &Velocity) -> (f64, f64) {
    let (first, second) = (0.5 * first.rapidity(), 0.5 * second.rapidity());
    (
        first.sinh() * second.cosh() + first.cosh() * second.sinh(),
        first.sinh() * second.sinh(),
    )
}

/// The error a unit normal may have, given relative errors `relative` and directions that may be turned
/// by `turn`.
///
/// With `m` the normal at rest, `n` the direction of motion, `s = d_across / r`, the normal is along
/// `M = D m_across + (m.n) (n - gamma beta s)`. Its parts across the motion may cancel: a relative error
/// in them counts as `D |m_across| + |m.n| (1 + gamma beta |s|)` over `|M|`. A turn of `d` or `n` changes
/// `m_across`, `m.n` and `s` by as much and `D` by `gamma beta |s|` times that.
pub(crate) fn normal_limit(
    observer: &Velocity,
    offset: DVec3,
    normal: DVec3,
    relative: f64,
    turn: f64,
) -> f64 {
    let n = observer.direction();
    let gamma_beta = observer.gamma_beta();
    let doppler = PhotosurfaceMap::new(observer).doppler_factor(offset);
    let s = n.cross(offset).cross(n) / offset.length();
    let along = n.dot(normal);
    let across = n.cross(normal).cross(n);
    let slanted = n - s * gamma_beta;
    let length = (across * doppler + slanted * along).length();
    let parts = doppler * across.length() + along.abs() * (1.0 + gamma_beta * s.length());
    let swing = gamma_beta * s.length() * across.length()
        + doppler
        + slanted.length()
        + along.abs() * (1.0 + gamma_beta);
    (relative * parts + turn * swing) / length + relative
}

/// Repeatable pseudo-random numbers (SplitMix64: Steele, Lea, Flood 2014).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Even in `[low, high)`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        let fraction = (self.next() >> 11) as f64 / (1u64 << 53) as f64;
        low + (high - low) * fraction
    }

    /// One of the whole numbers below `limit`.
    pub(crate) fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit as u64) as usize
    }

    /// Even on the sphere, its length 1 but for rounding.
    pub(crate) fn direction(&mut self) -> DVec3 {
        let height = self.between(-1.0, 1.0);
        let around = self.between(0.0, std::f64::consts::TAU);
        let across = ((1.0 - height) * (1.0 + height)).sqrt();
        DVec3::new(across * around.cos(), across * around.sin(), height)
    }
}

/// So many cases for each property, the same on every run, unless `PROPTEST_RNG_SEED` asks for others.
///
/// A case that fails is found again by running the test again, so that none is written down.
pub(crate) fn cases(cases: u32) -> Config {
    let asked = Config::default();
    Config {
        cases,
        failure_persistence: None,
        rng_seed: match asked.rng_seed {
            RngSeed::Random => RngSeed::Fixed(1),
            fixed => fixed,
        },
        ..asked
    }
}

/// The largest error met, in units of the limit derived for it and in units in the last place.
///
/// `cargo test -- --nocapture` shows the numbers measured.
pub(crate) struct Worst {
    quantity: &'static str,
    measured: usize,
    of_limit: f64,
    of_limit_case: String,
    ulps: f64,
    ulps_case: String,
}

impl Worst {
    pub(crate) fn new(quantity: &'static str) -> Self {
        Self {
            quantity,
            measured: 0,
            of_limit: 0.0,
            of_limit_case: String::new(),
            ulps: 0.0,
            ulps_case: String::new(),
        }
    }

    /// Takes down an `error`, the `limit` derived for it and the `size` of what it is an error of.
    pub(crate) fn record(
        &mut self,
        error: f64,
        limit: f64,
        size: f64,
        case: impl FnOnce() -> String,
    ) {
        self.measured += 1;
        let of_limit = if error == 0.0 { 0.0 } else { error / limit };
        let ulps = if error == 0.0 {
            0.0
        } else {
            error / (size * f64::EPSILON)
        };
        // Written so that NaN counts as worse than anything.
        let beyond = !(of_limit <= self.of_limit);
        let wider = !(ulps <= self.ulps);
        if beyond || wider {
            let case = case();
            if beyond && !self.of_limit.is_nan() {
                (self.of_limit, self.of_limit_case) = (of_limit, case.clone());
            }
            if wider && !self.ulps.is_nan() {
                (self.ulps, self.ulps_case) = (ulps, case);
            }
        }
    }

    /// Panics if an error was over its limit, or if nothing was measured at all.
    #[track_caller]
    pub(crate) fn check(&self) {
        assert!(self.measured > 0, "{}: nothing measured", self.quantity);
        println!(
            "{}: worst {:.3e} of its limit ({}); worst {:.3e} units in the last place ({})",
            self.quantity, self.of_limit, self.of_limit_case, self.ulps, self.ulps_case
        );
        assert!(
            self.of_limit <= 1.0,
            "{}: an error of {:.3e} times its limit, at {}",
            self.quantity,
            self.of_limit,
            self.of_limit_case
        );
    }
}
