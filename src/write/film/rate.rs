//! How long each frame of a film is shown.

use thiserror::Error;

/// Frames per second that a GIF has at most: programs show a frame of less than 2/100 s for 1/10 s.
pub(super) const MAX_GIF_RATE: f64 = 50.0;

/// A frame rate that no film has.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("{0:?} frames per second, expected a number from 1 to 120")]
pub struct FrameRateError(pub f64);

/// Frames per second of a film, from 1 to 120.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameRate(f64);

impl FrameRate {
    /// The frame rate of so many frames per second.
    ///
    /// # Errors
    ///
    /// The number is below 1, above 120, or none.
    pub fn new(frames_per_second: f64) -> Result<Self, FrameRateError> {
        match (1.0..=120.0).contains(&frames_per_second) {
            true => Ok(Self(frames_per_second)),
            false => Err(FrameRateError(frames_per_second)),
        }
    }

    /// Frames per second.
    pub fn get(self) -> f64 {
        self.0
    }

    /// How long a frame, counted from 0, is shown, in whole parts of a second of which there are `parts`. Frames differ by
    /// at most one part, so that the whole film is as long as it should be to half a part.
    pub(super) fn duration(self, frame: usize, parts: f64) -> u32 {
        let start = |frame: usize| (frame as f64 * parts / self.0).round();
        (start(frame + 1) - start(frame)) as u32
    }

    /// The time of a frame in seconds as a fraction of two numbers of 16 bits, the nearest with the least numerator.
    pub(super) fn seconds_as_fraction(self) -> (u16, u16) {
        let last = (f64::from(u16::MAX) / self.0) as u16;
        let denominator = |numerator: u16| (f64::from(numerator) * self.0).round();
        let error = |numerator: u16| {
            let rate = denominator(numerator) / f64::from(numerator);
            (rate - self.0).abs()
        };
        let exact = (1..=last).find(|&numerator| error(numerator) < 1e-9 * self.0);
        let nearest = || (1..=last).min_by(|&a, &b| error(a).total_cmp(&error(b)));
        let numerator = exact.or_else(nearest).unwrap_or(1);
        (numerator, denominator(numerator) as u16)
    }
}

impl Default for FrameRate {
    /// 25 frames per second.
    fn default() -> Self {
        Self(25.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_that_do_not_fit_into_parts_of_a_second_are_as_long_together() {
        for rate in [1.0, 7.3, 24.0, 29.97, 30.0, 33.3, 50.0, 120.0] {
            let rate = FrameRate::new(rate).unwrap();
            for parts in [100.0, 1000.0] {
                let durations = (0..1000).map(|frame| rate.duration(frame, parts));
                let durations: Vec<u32> = durations.collect();
                let all: u32 = durations.iter().sum();
                assert!((f64::from(all) - 1000.0 * parts / rate.get()).abs() <= 0.5 + 1e-6);
                let (least, most) = (durations.iter().min(), durations.iter().max());
                assert!(most.unwrap() - least.unwrap() <= 1);
            }
        }
    }

    #[test]
    fn fractions_are_those_of_the_rate() {
        let of = |rate: f64| FrameRate::new(rate).unwrap().seconds_as_fraction();
        assert_eq!(of(25.0), (1, 25));
        assert_eq!(of(12.5), (2, 25));
        assert_eq!(of(29.97), (100, 2997));
        let (numerator, denominator) = of(std::f64::consts::PI);
        let rate = f64::from(denominator) / f64::from(numerator);
        assert!((rate - std::f64::consts::PI).abs() < 1e-6);
    }

    #[test]
    fn rates_that_no_film_has_are_refused() {
        for wrong in [0.0, -25.0, 0.5, 121.0, 1e9, f64::NAN, f64::INFINITY] {
            let message = FrameRate::new(wrong).unwrap_err().to_string();
            assert!(message.contains("from 1 to 120"), "{message}");
        }
    }
}
