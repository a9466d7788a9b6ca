//! How many points each of many triangles may have inside, if all together have a limit.

/// Limit on the number of turns; in each turn triangles are divided.
const TURNS: u32 = 2;

/// Points that a triangle may have beyond its prediction. Predictions are good on average, but not for each triangle.
const BEYOND: f64 = 4.0;

/// Upper limit on the prediction for one triangle.
const MAX_PREDICTED: f64 = 1e15;

/// A number of points that triangles share. The first turn gives shares in proportion to the predictions. The points
/// that some triangles leave then go to the triangles that were short of points, which are divided anew.
///
/// The shares depend only on the predictions and on the numbers of points used in the turn before.
pub(super) struct Room {
    weights: Vec<f64>,
    /// Points left for the triangles that get another turn.
    left: u64,
    turns: u32,
    /// Triangles to be divided next.
    short: Vec<usize>,
}

impl Room {
    /// A number of points for triangles with these predictions.
    pub(super) fn new(predicted: Vec<f64>, points: u64) -> Self {
        let weight = |predicted: f64| {
            // A prediction of NaN counts as too many points.
            if predicted < MAX_PREDICTED {
                predicted + BEYOND
            } else {
                MAX_PREDICTED
            }
        };
        Self {
            short: (0..predicted.len()).collect(),
            weights: predicted.into_iter().map(weight).collect(),
            left: points,
            turns: 0,
        }
    }

    /// The triangles to be divided next, in their order, and how many points each may have. The list is empty after the
    /// last turn.
    pub(super) fn turn(&mut self) -> Vec<(usize, usize)> {
        if self.turns == TURNS {
            return vec![];
        }
        self.turns += 1;
        let short = std::mem::take(&mut self.short);
        let weights: Vec<f64> = short.iter().map(|&number| self.weights[number]).collect();
        let shares = shares(self.left, &weights).into_iter();
        let most = shares.map(|share| usize::try_from(share).unwrap_or(usize::MAX));
        short.into_iter().zip(most).collect()
    }

    /// Whether the current turn is the last one.
    pub(super) fn is_last_turn(&self) -> bool {
        self.turns == TURNS
    }

    /// Records how many points a triangle has used, and whether it needs more.
    pub(super) fn used(&mut self, number: usize, points: usize, is_short: bool) {
        if is_short {
            self.short.push(number);
        } else {
            self.left -= points as u64;
        }
    }
}

/// Shares of `whole` in proportion to weights, which must not be negative. The sum of the shares is never more than
/// `whole`. It is less than `whole` by at most one for each share, if any weight is above zero and `whole` is below
/// 2^53.
pub(crate) fn shares(whole: u64, weights: &[f64]) -> Vec<u64> {
    let mut weight: f64 = weights.iter().sum();
    let mut left = whole;
    let share = |&own: &f64| {
        let share = if own < weight {
            ((left as f64 * (own / weight)) as u64).min(left)
        } else if own > 0.0 {
            left
        } else {
            0
        };
        weight -= own;
        left -= share;
        share
    };
    weights.iter().map(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The points that triangles get if they need `needed` points.
    fn shared(predicted: &[f64], needed: &[usize], points: u64) -> Vec<usize> {
        let mut room = Room::new(predicted.to_vec(), points);
        let mut got = vec![0; needed.len()];
        loop {
            let turn = room.turn();
            if turn.is_empty() {
                return got;
            }
            for (number, most) in turn {
                got[number] = needed[number].min(most);
                room.used(number, got[number], most < needed[number]);
            }
        }
    }

    #[test]
    fn shares_are_in_proportion_and_never_more_than_the_whole() {
        assert_eq!(shares(10, &[1.0, 1.0, 3.0]), [2, 2, 6]);
        assert_eq!(shares(7, &[0.0, 2.0, 0.0]), [0, 7, 0]);
        assert_eq!(shares(7, &[0.0, 0.0]), [0, 0]);
        let weights: Vec<f64> = (0..1000)
            .map(|i| (f64::from(i) * 0.7).sin().powi(8) * 1e9)
            .collect();
        for whole in [0, 1, 999, 1_000_003, 1 << 52] {
            let all: u128 = shares(whole, &weights).into_iter().map(u128::from).sum();
            assert!(
                all <= u128::from(whole) && all + 1000 >= u128::from(whole),
                "{whole}: {all}"
            );
        }
    }

    #[test]
    fn all_together_never_have_more_and_what_some_leave_goes_to_others() {
        let predicted = [10.0, 0.0, f64::NAN, 3.0, f64::INFINITY, 1e300, 0.5];
        let needed = [10, 500, 3, 3, 20, 0, 1];
        for points in [0, 1, 7, 50, 300, 537, 1000, 100_000, u64::MAX / 2] {
            let got = shared(&predicted, &needed, points);
            assert!(
                got.iter().sum::<usize>() as u64 <= points,
                "{points}: {got:?}"
            );
        }
        assert_eq!(shared(&predicted, &needed, 100_000), needed);
        // A triangle with a prediction of zero gets nearly all points.
        let got = shared(&[100.0, 100.0, 0.0], &[1, 1, 10_000], 9_000);
        assert!(got[2] > 8_900, "{got:?}");
    }
}
