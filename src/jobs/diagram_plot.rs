//! A Minkowski diagram of the observer's worldline, drawn.

use glam::DVec3;

use super::WorldlineDiagram;
use super::diagram::Emission;
use crate::plot::{
    Axes, Course, Dot, Line, Minkowski, PlotError, PlotSize, Role, Spot, Tick, png, svg,
};
use crate::spacetime::Event;

impl WorldlineDiagram {
    /// The diagram as SVG: time upward, the direction to the right, both at one scale.
    ///
    /// # Errors
    ///
    /// The drawing library says no.
    pub fn svg(&self, size: PlotSize) -> Result<String, PlotError> {
        svg(&self.drawing(), size)
    }

    /// The same as PNG.
    ///
    /// # Errors
    ///
    /// The drawing library or the encoder says no.
    pub fn png(&self, size: PlotSize) -> Result<Vec<u8>, PlotError> {
        png(&self.drawing(), size)
    }

    fn drawing(&self) -> Minkowski {
        let direction = name_of(self.direction);
        Minkowski {
            title: match &self.title {
                Some(title) => format!("Worldline of the observer: {title}"),
                None => "Worldline of the observer".to_owned(),
            },
            x_text: format!("{direction}, in scene units"),
            y_text: "time t, in scene units (c = 1)".to_owned(),
            within: self.within(),
            lines: self.lines(),
            dots: self.dots(),
            axes: self.axes(),
            ticks: self.ticks(),
            names: self.names(),
            off_plane_text: self.off_plane_text(),
        }
    }

    fn spot(&self, event: Event) -> Spot {
        (self.along(event), event.time)
    }

    fn is_off_plane(&self, event: Event) -> bool {
        self.off_plane(event) > 0.0
    }

    /// The events that the diagram is about.
    fn within(&self) -> Vec<Spot> {
        let emissions = self.emissions.iter().map(|emission| &emission.event);
        let events = self.worldline.iter().chain(emissions);
        events.map(|event| self.spot(*event)).collect()
    }

    fn lines(&self) -> Vec<Line> {
        let mut lines = vec![];
        for moment in &self.moments {
            let at = self.spot(moment.event);
            for toward in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
                lines.push(Line {
                    role: Role::Cone,
                    off_plane: false,
                    course: Course::Toward(at, toward),
                });
            }
        }
        for (index, point) in self.points.iter().enumerate() {
            let emitted = self.emissions_of(index);
            let off_plane = emitted.map(|emission| emission.event);
            let off_plane = off_plane.chain([point.world_line.origin]);
            lines.push(Line {
                role: Role::Object,
                off_plane: off_plane.into_iter().any(|event| self.is_off_plane(event)),
                course: Course::Endless(
                    self.spot(point.world_line.origin),
                    self.spot(point.world_line.velocity.four_velocity()),
                ),
            });
        }
        for emission in &self.emissions {
            let ends = [emission.event, self.moments[emission.moment].event];
            lines.push(Line {
                role: Role::Light,
                off_plane: ends.iter().any(|event| self.is_off_plane(*event)),
                course: Course::Path(ends.map(|event| self.spot(event)).to_vec()),
            });
        }
        lines.extend(self.worldline_parts());
        lines
    }

    /// The parts of the worldline in the plane and beside it, in turn.
    fn worldline_parts(&self) -> Vec<Line> {
        let is_off = |ends: &[Event]| ends.iter().any(|event| self.is_off_plane(*event));
        let mut parts: Vec<Line> = vec![];
        for ends in self.worldline.windows(2) {
            let (off_plane, end) = (is_off(ends), self.spot(ends[1]));
            match parts.last_mut() {
                Some(Line {
                    off_plane: before,
                    course: Course::Path(path),
                    ..
                }) if *before == off_plane => {
                    path.push(end);
                }
                _ => parts.push(Line {
                    role: Role::Observer,
                    off_plane,
                    course: Course::Path(vec![self.spot(ends[0]), end]),
                }),
            }
        }
        parts
    }

    fn dots(&self) -> Vec<Dot> {
        let moments = self.moments.iter().map(|moment| Dot {
            role: Role::Observer,
            off_plane: self.is_off_plane(moment.event),
            spot: self.spot(moment.event),
            label: Some(format!("\u{3c4} = {}", written(moment.proper_time))),
        });
        let emissions = self.emissions.iter().map(|emission| Dot {
            role: Role::Object,
            off_plane: self.is_off_plane(emission.event),
            spot: self.spot(emission.event),
            label: None,
        });
        emissions.chain(moments).collect()
    }

    fn axes(&self) -> Vec<Axes> {
        let direction = name_of(self.direction);
        let own = match direction.len() <= 2 {
            true => format!("{direction}'"),
            false => "s'".to_owned(),
        };
        let moments = self.moments.iter().enumerate();
        moments
            .map(|(index, moment)| {
                let seen = self
                    .emissions
                    .iter()
                    .filter(|emission| emission.moment == index);
                // What is beside the plane is seen beside the axis.
                let seen = seen.filter(|emission| {
                    !self.is_off_plane(emission.seen) && !self.is_off_plane(emission.event)
                });
                Axes {
                    origin: self.spot(moment.event),
                    time: (self.spot(moment.time_axis), "t'".to_owned()),
                    space: (self.spot(moment.space_axis), own.clone()),
                    seen: seen
                        .map(|emission| (self.spot(emission.seen), self.spot(emission.event)))
                        .collect(),
                }
            })
            .collect()
    }

    fn ticks(&self) -> Vec<Tick> {
        let apart = match self.ticks.as_slice() {
            [first, second, ..] => second.proper_time - first.proper_time,
            _ => 0.0,
        };
        // A moment beside it says its own proper time.
        let is_said = |time: f64| {
            let mut moments = self.moments.iter();
            moments.any(|moment| (moment.proper_time - time).abs() < 0.3 * apart)
        };
        let ticks = self.ticks.iter().map(|tick| Tick {
            spot: self.spot(tick.event),
            along: self.spot(tick.four_velocity),
            label: match is_said(tick.proper_time) {
                true => String::new(),
                false => written(tick.proper_time),
            },
        });
        ticks.collect()
    }

    fn names(&self) -> Vec<(Spot, Spot, String)> {
        let named = self.points.iter().map(|point| {
            let line = &point.world_line;
            (
                self.spot(line.origin),
                self.spot(line.velocity.four_velocity()),
                point.name.clone(),
            )
        });
        named.collect()
    }

    fn emissions_of(&self, point: usize) -> impl Iterator<Item = &Emission> {
        self.emissions
            .iter()
            .filter(move |emission| emission.point == point)
    }

    /// What it means that something is dashed or hollow, if anything is.
    fn off_plane_text(&self) -> Option<String> {
        let moments = self.moments.iter().map(|moment| &moment.event);
        let emissions = self.emissions.iter().map(|emission| &emission.event);
        let events = self.worldline.iter().chain(moments).chain(emissions);
        let farthest = events
            .map(|event| self.off_plane(*event))
            .fold(0.0, f64::max);
        (farthest > 0.0).then(|| format!("off this plane by up to {}", written(farthest)))
    }
}

/// Such as "x", "-z" or "along 0.6, 0, 0.8".
fn name_of(direction: DVec3) -> String {
    let axes = DVec3::AXES.into_iter().zip(["x", "y", "z"]);
    for (axis, name) in axes {
        if direction == axis {
            return name.to_owned();
        }
        if direction == -axis {
            return format!("-{name}");
        }
    }
    let [x, y, z] = direction.to_array().map(written);
    format!("along {x}, {y}, {z}")
}

/// A number in three digits or four, without zeros at its end.
fn written(number: f64) -> String {
    if number == 0.0 {
        return "0".to_owned();
    }
    let power = number.abs().log10().floor();
    if !(-4.0..6.0).contains(&power) {
        return format!("{number:.2e}");
    }
    let decimals = (3.0 - power).max(0.0) as usize;
    let text = format!("{number:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_directions_read_well() {
        let numbers = [0.0, 2.1, -0.25, 3.0, 1234.5678, 2e7, 1.0 / 3.0, 1e-7];
        let words = [
            "0", "2.1", "-0.25", "3", "1235", "2.00e7", "0.3333", "1.00e-7",
        ];
        assert_eq!(numbers.map(written), words);
        assert_eq!(name_of(DVec3::NEG_Z), "-z");
        assert_eq!(name_of(DVec3::new(0.6, 0.0, 0.8)), "along 0.6, 0, 0.8");
    }
}
