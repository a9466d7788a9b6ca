//! What a rocket of constant thrust sees freezes: no light from beyond its horizon ever reaches it.
//!
//! A rocket takes off from the origin along x with proper acceleration 0.5. Buoys rest in the scene, some ahead and some
//! behind. One sees the buoys ahead recede at first, then come and be passed; and all buoys, wherever they rest, end on a
//! paraboloid, the horizon, with the rocket at its focus.
//!
//!     cargo run --release --example horizon

use photosurface::light_cone::View;
use photosurface::spacetime::{Event, Flight, Integrator, Lorentz, Segment, WorldLine};
use photosurface::{DVec3, Moment, Velocity};

const THRUST: f64 = 0.5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let start = Moment::new(Event::default(), Lorentz::IDENTITY);
    let segment = Segment::free(40.0, DVec3::X * THRUST, DVec3::ZERO)?;
    let rocket = Flight::new(start, vec![segment], Integrator::Exact)?;
    let at_rest = WorldLine {
        origin: Event::default(),
        velocity: Velocity::ZERO,
    };
    let buoys = [
        DVec3::X * 2.0,
        DVec3::X * 5.0,
        DVec3::X * -1.0,
        DVec3::new(3.0, 4.0, 0.0),
    ];

    println!("  time  speed  along x, as seen, of the buoys that rest at");
    println!(
        "                {}",
        buoys
            .map(|buoy| format!("{:>9}", format!("{},{}", buoy.x, buoy.y)))
            .join(" ")
    );
    for proper_time in [0.0, 0.7, 1.4, 2.1, 2.8, 3.5, 5.0, 7.0, 10.0, 20.0, 40.0] {
        let moment = rocket.moment(proper_time);
        let view = View::new(&moment, &at_rest);
        let seen = buoys.map(|buoy| format!("{:9.4}", view.seen_position(buoy).x));
        println!(
            "{proper_time:6.1} {:6.4}   {}",
            moment.velocity().beta(),
            seen.join(" ")
        );
    }
    let paraboloid = |buoy: DVec3| {
        let aside = buoy.y.hypot(buoy.z);
        format!("{:9.4}", ((THRUST * aside).powi(2) - 1.0) / (2.0 * THRUST))
    };
    println!("the paraboloid: {}", buoys.map(paraboloid).join(" "));
    Ok(())
}
