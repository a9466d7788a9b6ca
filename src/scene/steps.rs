//! Steps: the proper times at which the observer looks.

use super::error::{InvalidScene, MAX_STEPS};

/// `count` evenly spaced proper times, the first `from`, the last `to`; `from` alone if `count` is 1.
///
/// # Errors
///
/// `count` is zero or above a hundred thousand, or an end is not finite.
pub fn even_steps(from: f64, to: f64, count: usize) -> Result<Vec<f64>, InvalidScene> {
    if count == 0 || count > MAX_STEPS {
        return Err(InvalidScene::StepCount(count));
    }
    for (index, end) in [(0, from), (count - 1, to)] {
        if !end.is_finite() {
            return Err(InvalidScene::Step(index, end));
        }
    }
    let intervals = (count - 1).max(1) as f64;
    let step = |index: usize| {
        let part = index as f64 / intervals;
        match index {
            0 => from,
            _ if index == count - 1 => to,
            // The difference of two numbers of a scene may be beyond f64.
            _ if !(to - from).is_finite() => from * (1.0 - part) + to * part,
            _ => from + (to - from) * part,
        }
    };
    Ok((0..count).map(step).collect())
}
