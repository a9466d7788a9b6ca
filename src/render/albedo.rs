//! How much of an even light from all around a gloss sends to the eye: a table.
//!
//! The gloss is that of [`super::shading`], which depends on the roughness and on the angle of the eye. The table is made by
//! `fixtures/albedo.py`, and a test of `shading.rs` holds it against sums over the lamps of a whole sky.

/// For roughnesses of 0.1, 0.2, ... 1, and for cosines between normal and eye that are the squares of 0, 0.1, ... 1: the part
/// that is in the colour of a metal, and the part that is white however it is coloured.
#[rustfmt::skip]
pub(super) const TABLE: [[[f64; 2]; 11]; 10] = [
    [[0.1384, 0.7778], [0.1155, 0.7581], [0.2032, 0.7587], [0.3823, 0.6093], [0.5835, 0.4137], [0.7626, 0.2362], [0.8921, 0.1073], [0.9650, 0.0347], [0.9938, 0.0061], [0.9997, 0.0003], [1.0000, 0.0000]],
    [[0.3619, 0.5547], [0.3430, 0.5548], [0.3380, 0.5353], [0.4322, 0.4836], [0.5962, 0.3654], [0.7610, 0.2219], [0.8864, 0.1052], [0.9599, 0.0355], [0.9904, 0.0068], [0.9978, 0.0004], [0.9975, 0.0000]],
    [[0.5445, 0.3711], [0.5365, 0.3708], [0.5244, 0.3592], [0.5468, 0.3244], [0.6315, 0.2630], [0.7532, 0.1780], [0.8653, 0.0938], [0.9398, 0.0353], [0.9750, 0.0079], [0.9873, 0.0007], [0.9910, 0.0000]],
    [[0.6699, 0.2407], [0.6667, 0.2391], [0.6602, 0.2303], [0.6622, 0.2080], [0.6907, 0.1707], [0.7513, 0.1224], [0.8262, 0.0716], [0.8930, 0.0311], [0.9361, 0.0086], [0.9576, 0.0011], [0.9677, 0.0000]],
    [[0.7405, 0.1544], [0.7388, 0.1525], [0.7344, 0.1453], [0.7302, 0.1304], [0.7326, 0.1072], [0.7495, 0.0784], [0.7867, 0.0486], [0.8299, 0.0237], [0.8686, 0.0079], [0.8968, 0.0013], [0.9158, 0.0000]],
    [[0.7647, 0.0994], [0.7629, 0.0976], [0.7574, 0.0919], [0.7485, 0.0815], [0.7386, 0.0666], [0.7370, 0.0489], [0.7439, 0.0312], [0.7597, 0.0162], [0.7809, 0.0062], [0.8033, 0.0013], [0.8245, 0.0000]],
    [[0.7533, 0.0647], [0.7508, 0.0632], [0.7430, 0.0588], [0.7295, 0.0514], [0.7138, 0.0415], [0.6997, 0.0304], [0.6886, 0.0195], [0.6825, 0.0105], [0.6822, 0.0043], [0.6875, 0.0011], [0.6977, 0.0000]],
    [[0.7160, 0.0427], [0.7126, 0.0416], [0.7020, 0.0382], [0.6841, 0.0328], [0.6634, 0.0261], [0.6404, 0.0189], [0.6173, 0.0121], [0.5959, 0.0067], [0.5777, 0.0029], [0.5638, 0.0008], [0.5551, 0.0000]],
    [[0.6605, 0.0288], [0.6562, 0.0279], [0.6430, 0.0253], [0.6215, 0.0213], [0.5953, 0.0166], [0.5655, 0.0118], [0.5341, 0.0075], [0.5027, 0.0042], [0.4725, 0.0018], [0.4447, 0.0006], [0.4199, 0.0000]],
    [[0.5939, 0.0197], [0.5889, 0.0190], [0.5734, 0.0170], [0.5490, 0.0141], [0.5183, 0.0107], [0.4835, 0.0075], [0.4466, 0.0047], [0.4093, 0.0026], [0.3730, 0.0012], [0.3387, 0.0004], [0.3068, 0.0000]],
];

/// The part of an even light that a gloss whose reflectance head-on is 1 sends to the eye: times this reflectance the first
/// number, and in white the second.
///
/// # Accuracy
///
/// Linear between the numbers of the table: 0.025 of the light (test of `shading.rs`).
pub(super) fn albedo(roughness: f64, eye_cosine: f64) -> [f64; 2] {
    let (row, down) = place(10.0 * roughness - 1.0, TABLE.len());
    let (column, right) = place(10.0 * eye_cosine.sqrt(), TABLE[0].len());
    let mix =
        |[a, b]: [f64; 2], [c, d]: [f64; 2], part: f64| [a + (c - a) * part, b + (d - b) * part];
    let [above, below] =
        [&TABLE[row], &TABLE[row + 1]].map(|row| mix(row[column], row[column + 1], right));
    mix(above, below, down)
}

/// The first of two neighbours among `count` numbers, and how far on from it; beyond the ends, the end.
fn place(at: f64, count: usize) -> (usize, f64) {
    let at = at.clamp(0.0, (count - 1) as f64);
    let first = (at as usize).min(count - 2);
    (first, at - first as f64)
}
