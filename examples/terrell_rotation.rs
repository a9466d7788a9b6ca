//! The cube that looks rotated: prints the apparent angle of a small cube that passes at right angles.
//!
//! Its image is that of a cube turned by asin(beta) (Terrell 1959); its photosurface is not turned but
//! sheared: the face towards us is shortened by 1/gamma, and the side that comes into view leans back by
//! atan(beta), longer than it is at rest (Mathews and Lakshmanan 1972).
//!
//!     cargo run --release --example terrell_rotation

use photosurface::light_cone::PhotosurfaceMap;
use photosurface::{DVec3, Velocity};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("  beta   front   side   looks turned by   side is long   and leans by");
    for beta in [0.1, 0.5, 0.8, 0.9, 0.99] {
        // The cube flies along +x, so the observer moves along -x; it is seen at right angles, along -z.
        let map = PhotosurfaceMap::new(&Velocity::from_beta(beta, DVec3::NEG_X)?);
        let toward_cube = map.rest_offset(DVec3::new(0.0, 0.0, -1000.0));
        let jacobian = map.jacobian(toward_cube);
        let front = jacobian * DVec3::X;
        let side = jacobian * DVec3::NEG_Z;
        println!(
            "{beta:>6} {:>7.4} {:>6.4} {:>15.3}° {:>14.4} {:>13.3}°",
            front.x,
            side.x.abs(),
            side.x.abs().atan2(front.x).to_degrees(),
            side.length(),
            side.x.abs().atan2(-side.z).to_degrees(),
        );
    }
    Ok(())
}
