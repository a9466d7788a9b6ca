//! A flight by closed forms, in pieces each of which has a frame of its own.
//!
//! A displacement keeps its digits beside fast objects only if it is given in a frame that the observer does not leave far
//! behind. So a segment that leads to high rapidities becomes several pieces, and the displacements of neighbouring
//! pieces are added only where one frame serves them all.

use std::sync::Arc;

use glam::DVec3;

use super::constant::ConstantMotion;
use super::coordinated::{Coordinated, Course};
use super::{FlightError, Segment, Steering};
use crate::spacetime::moment::Leg;
use crate::spacetime::{Event, Lorentz, MAX_RAPIDITY, Moment, length};

/// The displacements of pieces are added in one frame while their own frames differ from it by less than this rapidity,
/// which costs about a digit.
const ONE_FRAME: f64 = 1.5;

/// A segment on which the rapidity relative to its beginning is higher than this becomes several pieces.
const MAX_PIECE: f64 = 1.5;

/// Limits on the number of pieces of a segment, on that of all segments beyond one for each, and on the number of legs.
/// Beyond them displacements are right to rounding in the scene, not beside fast objects.
const MAX_PIECES: f64 = 1024.0;
const MAX_MORE_PIECES: usize = 65_536;
const MAX_LEGS: usize = 4096;

/// The largest rapidity of a piece relative to its beginning: neither end is faster than [`MAX_RAPIDITY`].
const MAX_GAIN: f64 = 2.0 * MAX_RAPIDITY;

/// The states of a flight at the beginnings of all pieces.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pieces {
    pieces: Vec<Piece>,
    /// The complete legs of the whole flight.
    legs: Arc<[Leg]>,
    /// The observer at the end of the last piece.
    end: State,
}

/// A segment, or a part of it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Piece {
    /// Index of the segment.
    segment: usize,
    /// Proper time from the beginning of the segment.
    begin: f64,
    state: State,
    motion: Motion,
}

/// The observer at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
struct State {
    /// The number of complete legs before.
    legs: usize,
    /// The leg after these, as far as it has got.
    leg: Leg,
    scene_to_here: Lorentz,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    Coasting,
    Constant(ConstantMotion),
    Turn(Coordinated),
}

impl Pieces {
    /// The flight of an observer who begins in the frame of `scene_to_start`.
    pub(super) fn new(scene_to_start: &Lorentz, segments: &[Segment]) -> Result<Self, FlightError> {
        let mut pieces = Vec::with_capacity(segments.len());
        let mut legs = vec![];
        let mut state = State {
            legs: 0,
            leg: Leg::new(*scene_to_start, Event::default()),
            scene_to_here: *scene_to_start,
        };
        let mut more = MAX_MORE_PIECES;
        for (index, segment) in segments.iter().enumerate() {
            let proper_time = segment.proper_time();
            let whole = Motion::new(&state.scene_to_here, segment, index, proper_time)?;
            let count = whole.pieces(segment).min(1 + more);
            more -= count - 1;
            for part in 0..count {
                let at = |part: usize| proper_time * (part as f64 / count as f64);
                let (begin, duration) = (at(part), at(part + 1) - at(part));
                let motion = match part {
                    0 => whole,
                    _ => Motion::new(&state.scene_to_here, segment, index, duration)?,
                };
                pieces.push(Piece {
                    segment: index,
                    begin,
                    state,
                    motion,
                });
                let too_fast = |rapidity| FlightError::TooFast {
                    segment: index,
                    rapidity,
                };
                let gain = motion.boost_rapidity(duration);
                if !(gain <= MAX_GAIN) {
                    return Err(too_fast(gain));
                }
                let (next, finished) = state.after(&motion, duration);
                legs.extend(finished);
                state = next;
                let rapidity = state.scene_to_here.boost_velocity().rapidity();
                if !(rapidity <= MAX_RAPIDITY) {
                    return Err(too_fast(rapidity));
                }
            }
        }
        Ok(Self {
            pieces,
            legs: legs.into(),
            end: state,
        })
    }

    /// The observer who flew so from `start`, `proper_time` after the beginning of a segment.
    pub(super) fn moment(&self, start: &Moment, segment: usize, proper_time: f64) -> Moment {
        let begun = |piece: &Piece| (piece.segment, piece.begin) <= (segment, proper_time);
        let next = self.pieces.partition_point(begun);
        let piece = &self.pieces[next.saturating_sub(1)];
        let (state, finished) = piece.state.after(&piece.motion, proper_time - piece.begin);
        self.flown(start, piece.state.legs, finished, &state)
    }

    /// The observer at the end of the last segment.
    pub(super) fn end(&self, start: &Moment) -> Moment {
        self.flown(start, self.end.legs, None, &self.end)
    }

    fn flown(&self, start: &Moment, legs: usize, finished: Option<Leg>, state: &State) -> Moment {
        let last = finished.into_iter().chain([state.leg]);
        start.along(&self.legs, legs, last, state.scene_to_here)
    }
}

impl State {
    /// The observer after so much of a motion that begins here, and the leg that is complete thereby.
    fn after(&self, motion: &Motion, proper_time: f64) -> (Self, Option<Leg>) {
        let here = &self.scene_to_here;
        let (leg, scene_to_here) = match motion {
            Motion::Coasting => {
                let rest = Event::new(proper_time, DVec3::ZERO);
                (Leg::new(*here, rest), *here)
            }
            Motion::Constant(motion) => {
                let (displacement, own_to_next) = motion.after(proper_time);
                (Leg::new(*here, displacement), here.then(&own_to_next))
            }
            Motion::Turn(turn) => {
                let turned = turn.after(proper_time);
                let leg = Leg::new(turned.scene_to_frame, turned.displacement_frame);
                (leg, turned.scene_to_end)
            }
        };
        let one_leg = |leg: Leg| Self {
            legs: self.legs,
            leg,
            scene_to_here,
        };
        if self.leg.is_empty() {
            return (one_leg(leg), None);
        }
        if let Some(sum) = self.leg.with(&leg, ONE_FRAME) {
            return (one_leg(sum), None);
        }
        match self.legs {
            ..MAX_LEGS => {
                let next = one_leg(leg);
                let legs = self.legs + 1;
                (Self { legs, ..next }, Some(self.leg))
            }
            _ => (one_leg(self.leg.with_in_scene(&leg)), None),
        }
    }
}

impl Motion {
    /// How an observer in the frame of `scene_to_here` moves in a segment, or in so much of it.
    fn new(
        scene_to_here: &Lorentz,
        segment: &Segment,
        index: usize,
        proper_time: f64,
    ) -> Result<Self, FlightError> {
        let acceleration = segment.acceleration();
        let turn_rate = match segment.steering() {
            Steering::Free { turn_rate } => turn_rate,
            Steering::Coordinated => match Course::new(scene_to_here, acceleration, proper_time) {
                Course::Straight => DVec3::ZERO,
                Course::Stop => return Err(FlightError::StopsInTurn { segment: index }),
                Course::Turn(turn) if turn.turns_too_much(proper_time) => {
                    return Err(FlightError::TooManyTurns {
                        segment: index,
                        turn: turn.angle(proper_time),
                    });
                }
                Course::Turn(turn) => return Ok(Self::Turn(turn)),
            },
        };
        let constant = ConstantMotion::new(acceleration, turn_rate);
        Ok(constant.map_or(Self::Coasting, Self::Constant))
    }

    /// The number of pieces that a segment of this motion becomes.
    fn pieces(&self, segment: &Segment) -> usize {
        let proper_time = segment.proper_time();
        let path = match self {
            Self::Coasting => 0.0,
            Self::Constant(motion) if motion.max_rapidity(proper_time) <= MAX_PIECE => 0.0,
            Self::Constant(_) => length(segment.acceleration()) * proper_time,
            Self::Turn(turn) => (turn.rapidity(proper_time) - turn.rapidity(0.0)).abs(),
        };
        let count = (path / MAX_PIECE).ceil();
        match count <= MAX_PIECES {
            true => count.max(1.0) as usize,
            // A fast circle: no number of pieces would do.
            false => 1,
        }
    }

    /// A bound from below on the rapidity after `proper_time`, relative to the beginning.
    fn boost_rapidity(&self, proper_time: f64) -> f64 {
        match self {
            Self::Coasting => 0.0,
            Self::Constant(motion) => motion.boost_rapidity(proper_time),
            Self::Turn(turn) => turn.rapidity(proper_time) - turn.rapidity(0.0),
        }
    }
}
