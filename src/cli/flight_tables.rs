//! Tables of the observer's moments: for people, and as CSV.

use std::io::Write;

use photosurface::DVec3;
use photosurface::pipeline::MomentFacts;
use photosurface::scene::Units;

use super::tables::{csv, table};

const HEADINGS: [&str; 8] = [
    "proper time",
    "time",
    "x",
    "y",
    "z",
    "beta",
    "gamma",
    "rapidity",
];

/// One row for each moment, and what the numbers are.
pub(super) fn table_of(
    moments: &[MomentFacts],
    units: Option<Units>,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    let rows = moments.iter().map(cells);
    let Some(units) = units else {
        table(HEADINGS, rows, out)?;
        writeln!(
            out,
            "scene frame; times and lengths in scene units, the speed of light is 1"
        )?;
        return Ok(());
    };
    let [a, b, c, d, e, f, g, h] = HEADINGS;
    let headings = [a, b, c, d, e, f, g, h, "time s", "acceleration g"];
    let rows = rows.zip(moments).map(|(cells, moment)| {
        let [a, b, c, d, e, f, g, h] = cells;
        let seconds = significant(moment.time * units.time_s());
        let acceleration = DVec3::from_array(moment.acceleration).length() / units.gravity();
        [a, b, c, d, e, f, g, h, seconds, significant(acceleration)]
    });
    table(headings, rows, out)?;
    writeln!(
        out,
        "scene frame; the unit of length is {} m, the speed of light is 1; g is standard gravity",
        significant(units.length_m())
    )?;
    Ok(())
}

fn cells(moment: &MomentFacts) -> [String; HEADINGS.len()] {
    let [x, y, z] = moment.position.map(significant);
    [
        significant(moment.proper_time),
        significant(moment.time),
        x,
        y,
        z,
        speed(moment.rapidity),
        significant(moment.gamma),
        significant(moment.rapidity),
    ]
}

/// The speed of a rapidity; close to that of light what it lacks.
fn speed(rapidity: f64) -> String {
    // 1 - tanh(r), without cancellation.
    let lacks = 2.0 / ((2.0 * rapidity).exp() + 1.0);
    match lacks < 1e-4 {
        true => format!("1-{lacks:.2e}"),
        false => significant(rapidity.tanh()),
    }
}

/// A number with six digits.
fn significant(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    // As it is after rounding: 999999.6 has seven digits.
    let rounded: f64 = format!("{number:.5e}").parse().unwrap_or(number);
    let power = rounded.abs().log10().floor();
    if !(-4.0..9.0).contains(&power) {
        return format!("{number:.5e}");
    }
    format!("{number:.*}", (5.0 - power).max(0.0) as usize)
}

/// Columns of the CSV, and where their numbers stand in the JSON of a moment.
const COLUMNS: [(&str, &str); 25] = [
    ("proper_time", "/proper_time"),
    ("time", "/time"),
    ("position_x", "/position/0"),
    ("position_y", "/position/1"),
    ("position_z", "/position/2"),
    ("velocity_x", "/velocity/0"),
    ("velocity_y", "/velocity/1"),
    ("velocity_z", "/velocity/2"),
    ("gamma", "/gamma"),
    ("rapidity", "/rapidity"),
    ("axis_x_t", "/axes/0/0"),
    ("axis_x_x", "/axes/0/1"),
    ("axis_x_y", "/axes/0/2"),
    ("axis_x_z", "/axes/0/3"),
    ("axis_y_t", "/axes/1/0"),
    ("axis_y_x", "/axes/1/1"),
    ("axis_y_y", "/axes/1/2"),
    ("axis_y_z", "/axes/1/3"),
    ("axis_z_t", "/axes/2/0"),
    ("axis_z_x", "/axes/2/1"),
    ("axis_z_y", "/axes/2/2"),
    ("axis_z_z", "/axes/2/3"),
    ("acceleration_x", "/acceleration/0"),
    ("acceleration_y", "/acceleration/1"),
    ("acceleration_z", "/acceleration/2"),
];

pub(super) fn csv_of_moments(moments: &[MomentFacts]) -> String {
    csv(COLUMNS, moments)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_six_digits_and_speeds_say_what_they_lack() {
        let numbers = [0.0, 0.95, -12.3456789, 999_999.6, 1e12, -2e-7];
        let words = [
            "0",
            "0.950000",
            "-12.3457",
            "1000000",
            "1.00000e12",
            "-2.00000e-7",
        ];
        assert_eq!(numbers.map(significant), words);
        assert_eq!(speed(0.0), "0");
        assert_eq!(speed(0.5f64.atanh()), "0.500000");
        assert_eq!(speed(20.0), "1-8.50e-18");
    }
}
