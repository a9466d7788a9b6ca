//! The triangles that one object will take at each of many steps, from predictions at a few of them.
//!
//! Few moments of a passage or of a flight are dear: those at which the observer is near the object. So predictions look
//! at evenly spread steps and at those around the nearest ones, and are interpolated between them.

use std::collections::BTreeSet;

use super::predicting::Predicted;

/// Up to this number all steps are examined, otherwise so many evenly spread ones.
const EVENLY_SPREAD: usize = 32;
const OF_MANY: usize = 24;

/// The largest number of steps examined.
const MAX_EXAMINED: usize = 48;

/// The nearest steps are searched among so many evenly spread ones, for all objects together, but at least among
/// [`MIN_SCANNED`] for each; and then among all steps beside these.
const MAX_SCANNED: usize = 200_000;
const MIN_SCANNED: usize = 100;

/// Predictions for one object at some steps, in their order; the first and the last step are among them.
#[derive(Clone, Debug)]
pub(super) struct ObjectForecast(Vec<(usize, Predicted)>);

impl ObjectForecast {
    /// Predictions by `predict` at the `examined` steps.
    pub(super) fn new(examined: &[usize], predict: impl Fn(usize) -> Predicted) -> Self {
        Self(examined.iter().map(|&step| (step, predict(step))).collect())
    }

    /// The prediction for all steps together.
    pub(super) fn all_steps(&self) -> Predicted {
        let mut sum = Predicted {
            triangles: 0.0,
            before: 0.0,
            reachable: true,
        };
        for (_, predicted) in &self.0 {
            sum.triangles += predicted.triangles;
            sum.before += predicted.before;
            sum.reachable &= predicted.reachable;
        }
        for pair in self.0.windows(2) {
            let [(from, a), (to, b)] = [pair[0], pair[1]];
            let between = to - from - 1;
            if between == 0 {
                // Nothing times a number of triangles that is beyond f64 would not be a number.
                continue;
            }
            let half_of_those_between = 0.5 * between as f64;
            sum.triangles += half_of_those_between * (a.triangles + b.triangles);
            sum.before += half_of_those_between * (a.before + b.before);
        }
        sum
    }

    /// A number at each of `steps` steps, interpolated between those that were examined.
    pub(super) fn each_step(&self, steps: usize, number: impl Fn(&Predicted) -> f64) -> Vec<f64> {
        let at = |step: usize| {
            let next = self.0.partition_point(|&(examined, _)| examined < step);
            let (to, b) = &self.0[next.min(self.0.len() - 1)];
            if *to == step || next == 0 {
                return number(b);
            }
            let (from, a) = &self.0[next - 1];
            let part = (step - from) as f64 / (to - from) as f64;
            number(a) * (1.0 - part) + number(b) * part
        };
        (0..steps).map(at).collect()
    }
}

/// The steps to examine of so many: all, or evenly spread ones and those around the steps at which the `distance` of the
/// observer from an object, one of `objects`, is smallest.
pub(super) fn examined_steps(
    steps: usize,
    objects: usize,
    distance: impl Fn(usize) -> f64,
) -> Vec<usize> {
    if steps <= EVENLY_SPREAD {
        return (0..steps).collect();
    }
    let last = steps - 1;
    let spread = |count: usize| (0..count).map(move |index| index * last / (count - 1));
    let mut examined: BTreeSet<usize> = spread(OF_MANY).collect();
    let scanned = steps.min((MAX_SCANNED / objects).max(MIN_SCANNED));
    let scanned: Vec<usize> = spread(scanned).collect();
    for nearest in nearest_steps(steps, &scanned, distance) {
        // The dearer a moment, the shorter it is: closer and closer steps around it.
        let mut aside = 0;
        while aside <= steps / OF_MANY {
            for step in [nearest.saturating_sub(aside), (nearest + aside).min(last)] {
                if examined.len() < MAX_EXAMINED {
                    examined.insert(step);
                }
            }
            aside = (2 * aside).max(1);
        }
    }
    examined.into_iter().collect()
}

/// The steps at which the observer is nearer than shortly before and after, the nearest first.
fn nearest_steps(steps: usize, scanned: &[usize], distance: impl Fn(usize) -> f64) -> Vec<usize> {
    let distances: Vec<f64> = scanned.iter().map(|&step| distance(step)).collect();
    let at = |index: usize| distances.get(index).copied().unwrap_or(f64::INFINITY);
    let is_nearest =
        |&index: &usize| at(index) <= at(index + 1) && (index == 0 || at(index) < at(index - 1));
    let mut nearest: Vec<(usize, f64)> = (0..scanned.len())
        .filter(is_nearest)
        .map(|index| {
            let from = scanned[index.saturating_sub(1)];
            let to = scanned.get(index + 1).map_or(steps, |&next| next + 1);
            let beside = (from..to).map(|step| (step, distance(step)));
            let nearer = |a: (usize, f64), b: (usize, f64)| if b.1 < a.1 { b } else { a };
            beside.reduce(nearer).unwrap_or((scanned[index], at(index)))
        })
        .collect();
    nearest.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    nearest.into_iter().map(|(step, _)| step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_steps_are_examined_and_those_around_them() {
        assert_eq!(examined_steps(1, 1, |_| 0.0), [0]);
        assert_eq!(examined_steps(32, 1, |_| 0.0).len(), 32);
        for steps in [33, 100, 1001, 100_000] {
            for passed in [0, 7, steps / 3, steps - 1] {
                let examined = examined_steps(steps, 1, |step| step.abs_diff(passed) as f64);
                assert!(examined.len() <= MAX_EXAMINED && examined.is_sorted());
                assert_eq!((examined[0], *examined.last().unwrap()), (0, steps - 1));
                for near in [
                    passed.saturating_sub(1),
                    passed,
                    (passed + 1).min(steps - 1),
                ] {
                    assert!(examined.contains(&near), "{steps} {passed}: {examined:?}");
                }
            }
        }
    }

    #[test]
    fn what_lies_between_is_interpolated() {
        let predict = |step: usize| Predicted {
            triangles: step as f64,
            before: 1.0,
            reachable: step < 100,
        };
        let forecast = ObjectForecast::new(&[0, 3, 4, 10], predict);
        let sum = forecast.all_steps();
        assert_eq!(
            (sum.triangles, sum.before, sum.reachable),
            (55.0, 11.0, true)
        );
        let each = forecast.each_step(11, |predicted| predicted.triangles);
        assert!(
            each.iter()
                .zip(0..)
                .all(|(&found, step)| (found - f64::from(step)).abs() < 1e-12)
        );
        assert!(
            !ObjectForecast::new(&[0, 100], predict)
                .all_steps()
                .reachable
        );
    }
}
