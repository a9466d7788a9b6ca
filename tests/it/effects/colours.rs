//! Colours of light and of surfaces seen moving, against colour-science (PyPI).

use photosurface::DVec3;
use photosurface::effects::{Daylight, Reflectance, black_body_color};
use serde_json::Value;

fn fixture() -> Value {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/colours.json");
    let text = std::fs::read_to_string(path).expect("a fixture");
    serde_json::from_str(&text).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn numbers(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|index| number(&value[index]))
}

/// Both use the same table of the observer and the same constants; what is left is rounding, of sums that cancel where a
/// channel is small beside the others.
#[track_caller]
fn assert_near(found: DVec3, expected: &Value) {
    let expected = DVec3::from_array(numbers(expected));
    let error = (found - expected).abs().max_element();
    assert!(
        error <= 1e-12 * expected.abs().max_element(),
        "{found} {expected}"
    );
}

#[test]
fn black_bodies_and_moving_surfaces_have_the_colours_of_colour_science() {
    let fixture = fixture();
    let bodies = fixture["bodies"].as_array().expect("a list");
    for body in bodies {
        assert_near(black_body_color(number(&body["kelvin"])), &body["color"]);
    }
    let surfaces = fixture["surfaces"].as_array().expect("a list");
    for surface in surfaces {
        let light = Daylight::new(number(&surface["kelvin"])).expect("warm enough");
        let reflectance = Reflectance::Sigmoid(numbers(&surface["coefficients"]));
        let seen = light.seen_color(&reflectance, number(&surface["factor"]));
        assert_near(seen, &surface["color"]);
    }
    assert_eq!((bodies.len(), surfaces.len()), (9, 72));
}
