//! The largest values of quadratic functions on a triangle.

/// The largest size of `sum f_i l_i + 4 sum b_k l_i l_j` over the weights `l` of a triangle: `corners` holds the values `f`
/// at the corners, `bulges` how far the value in the middle of the side opposite each corner is from the mean of its
/// ends.
pub(super) fn largest(corners: [f64; 3], bulges: [f64; 3]) -> f64 {
    let (f, b) = (corners, bulges);
    let mut most = f[0].abs().max(f[1].abs()).max(f[2].abs());
    let value = |l: [f64; 3]| {
        let linear = f[0] * l[0] + f[1] * l[1] + f[2] * l[2];
        linear + 4.0 * (b[0] * l[1] * l[2] + b[1] * l[2] * l[0] + b[2] * l[0] * l[1])
    };
    for k in 0..3 {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        let t = 0.5 + (f[j] - f[i]) / (8.0 * b[k]);
        if t > 0.0 && t < 1.0 {
            let mut l = [0.0; 3];
            (l[i], l[j]) = (1.0 - t, t);
            most = most.max(value(l).abs());
        }
    }
    // Inside, as a function of the second and the third weight: the place without a slope.
    let (xx, yy, xy) = (-8.0 * b[2], -8.0 * b[1], 4.0 * (b[0] - b[1] - b[2]));
    let (x_slope, y_slope) = (f[1] - f[0] + 4.0 * b[2], f[2] - f[0] + 4.0 * b[1]);
    let determinant = xx * yy - xy * xy;
    let x = (y_slope * xy - x_slope * yy) / determinant;
    let y = (x_slope * xy - y_slope * xx) / determinant;
    if x > 0.0 && y > 0.0 && x + y < 1.0 {
        most = most.max(value([1.0 - x - y, x, y]).abs());
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_sample_is_larger_and_some_are_nearly_as_large() {
        for step in 0..2_000 {
            let wave = |f: f64| (f64::from(step) * f).sin();
            let corners = [0.7, 1.3, 2.9].map(|f| if step % 3 == 0 { 0.0 } else { wave(f) });
            let bulges = [0.31, 1.7, 3.7].map(wave);
            let found = largest(corners, bulges);
            let mut sampled: f64 = 0.0;
            for i in 0..=40 {
                for j in 0..=40 - i {
                    let [x, y] = [i, j].map(|k| f64::from(k) / 40.0);
                    let l = [1.0 - x - y, x, y];
                    let linear: f64 = (0..3).map(|k| corners[k] * l[k]).sum();
                    let bulge =
                        bulges[0] * l[1] * l[2] + bulges[1] * l[2] * l[0] + bulges[2] * l[0] * l[1];
                    sampled = sampled.max((linear + 4.0 * bulge).abs());
                }
            }
            assert!(
                found >= sampled - 1e-12,
                "{corners:?} {bulges:?}: {found} {sampled}"
            );
            assert!(
                found <= sampled + 0.02,
                "{corners:?} {bulges:?}: {found} {sampled}"
            );
        }
    }
}
