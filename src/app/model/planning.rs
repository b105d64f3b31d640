//! The plan that the window shows, its handles, and its prediction.

use std::path::PathBuf;

use nalgebra::{Rotation2, Vector2};

use super::background_value::BackgroundValue;
use resect_core::network::{Number, Station};
use resect_tools::planning::{FigureEight, Improvement, Loop, Piece, Plan, PlanError, Prediction};
use resect_tools::simulation::{Preset, Ramp, Waypoint};

/// A plan, with its prediction and proposed improvements.
pub struct Planning {
    pub plan: Plan,
    /// The file that it was last read from or written to.
    pub path: Option<PathBuf>,
    /// True if the user changed the plan; the initial example need not be saved.
    pub touched: bool,
    /// Number of plans set so far.
    pub version: u64,
    pub foreseen: BackgroundValue<Result<Prediction, PlanError>>,
    pub better: BackgroundValue<Result<Vec<Improvement>, PlanError>>,
    pub selected: Option<Handle>,
}

/// Commands of the plan.
#[derive(Clone, Debug)]
pub enum PlanCommand {
    /// Sets another plan, with a description for the undo step.
    Set(Box<Plan>, &'static str),
    Select(Option<Handle>),
    OpenDialog,
    Open(PathBuf),
    SaveDialog,
    /// Creates a plan from the drive of the active deployment.
    FromDeployment,
    FromPreset(Preset),
}

/// A point of a plan that the pointer can move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Handle {
    Station(usize),
    Waypoint {
        piece: usize,
        index: usize,
    },
    /// Centre of a figure-eight or a loop, by the index of its piece.
    Middle(usize),
    /// Tip of a figure-eight, which rotates and stretches it, or the start of a loop.
    Tip(usize),
    Ramp(usize),
}

impl Default for Planning {
    /// Usual stations and rig, with an approach to a figure-eight.
    fn default() -> Self {
        let eight =
            FigureEight { centre_m: [58.0, 6.0], length_m: 24.0, heading_rad: 0.0, times: 1 };
        let approach = [[24.0, -4.0], [44.0, 2.0]].map(|place| Waypoint::at(Vector2::from(place)));
        let way = vec![Piece::Waypoints(approach.to_vec()), Piece::FigureEight(eight)];
        Self {
            plan: Plan { name: "example".to_owned(), way, ..Plan::default() },
            path: None,
            touched: false,
            version: 0,
            foreseen: BackgroundValue::default(),
            better: BackgroundValue::default(),
            selected: None,
        }
    }
}

impl Planning {
    /// Sets another plan; the old prediction stays until the new one is computed.
    pub fn set(&mut self, plan: Plan) {
        self.plan = plan;
        self.version += 1;
        self.touched = true;
        if self.selected.is_some_and(|handle| handle.place_m(&self.plan).is_none()) {
            self.selected = None;
        }
    }

    /// Returns true if the prediction is for exactly this plan.
    pub fn is_foreseen(&self) -> bool {
        self.foreseen.is_of((self.version, 0))
    }
}

/// Names a piece of a plan: "figure-eight", or "figure-eight 2" if there are several.
pub fn manoeuvre_name(plan: &Plan, piece: usize) -> String {
    let kind = |piece: &Piece| match piece {
        Piece::FigureEight(_) => "figure-eight",
        Piece::Loop(_) => "loop",
        Piece::Waypoints(_) => "way",
    };
    let Some(own) = plan.way.get(piece).map(kind) else { return "manoeuvre".to_owned() };
    let alike = |pieces: &[Piece]| pieces.iter().filter(|other| kind(other) == own).count();
    match alike(&plan.way) {
        1 => own.to_owned(),
        _ => format!("{own} {}", alike(&plan.way[..=piece])),
    }
}

impl Handle {
    /// Returns all handles of a plan.
    pub fn all(plan: &Plan) -> Vec<Self> {
        let stations = (0..plan.stations_m.len()).map(Self::Station);
        let ramps = (0..plan.ground.ramps.len()).map(Self::Ramp);
        let of_way = plan.way.iter().enumerate().flat_map(|(piece, one)| match one {
            Piece::Waypoints(waypoints) => {
                (0..waypoints.len()).map(|index| Self::Waypoint { piece, index }).collect()
            }
            Piece::FigureEight(_) | Piece::Loop(_) => vec![Self::Middle(piece), Self::Tip(piece)],
        });
        // Stations come last: they are drawn above everything else, and the pointer finds them first.
        of_way.chain(ramps).chain(stations).collect()
    }

    /// Returns the handle's name for the user.
    pub fn name(self, plan: &Plan) -> String {
        match self {
            Self::Station(station) => format!("station {}", station + 1),
            Self::Waypoint { piece, index } => {
                let before = plan.way[..piece.min(plan.way.len())].iter().map(|one| match one {
                    Piece::Waypoints(waypoints) => waypoints.len(),
                    Piece::FigureEight(_) | Piece::Loop(_) => 0,
                });
                format!("waypoint {}", before.sum::<usize>() + index + 1)
            }
            Self::Middle(piece) => format!("middle of the {}", manoeuvre_name(plan, piece)),
            Self::Tip(piece) => format!("tip of the {}", manoeuvre_name(plan, piece)),
            Self::Ramp(index) => format!("ramp {}", index + 1),
        }
    }

    /// Returns the position (m, the plan's frame); `None` if the plan has no such handle.
    pub fn place_m(self, plan: &Plan) -> Option<[f64; 2]> {
        Some(match self {
            Self::Station(station) => {
                let station_m = plan.stations_m.get(Station::at(station))?;
                [station_m.x, station_m.y]
            }
            Self::Waypoint { piece, index } => match plan.way.get(piece)? {
                Piece::Waypoints(waypoints) => {
                    let at = waypoints.get(index)?;
                    [at.x_m, at.y_m]
                }
                Piece::FigureEight(_) | Piece::Loop(_) => return None,
            },
            Self::Middle(piece) => match plan.way.get(piece)? {
                Piece::FigureEight(FigureEight { centre_m, .. })
                | Piece::Loop(Loop { centre_m, .. }) => *centre_m,
                Piece::Waypoints(_) => return None,
            },
            Self::Tip(piece) => match plan.way.get(piece)? {
                Piece::FigureEight(eight) => tip_of_eight(eight).into(),
                Piece::Loop(one) => {
                    let out = Rotation2::new(one.from_rad) * Vector2::new(one.radius_m, 0.0);
                    (Vector2::from(one.centre_m) + out).into()
                }
                Piece::Waypoints(_) => return None,
            },
            Self::Ramp(index) => plan.ground.ramps.get(index)?.centre_m,
        })
    }

    /// Returns the plan with this handle moved to a position (m); unchanged if there is no such handle.
    pub fn moved(self, plan: &Plan, to_m: [f64; 2]) -> Plan {
        let mut plan = plan.clone();
        let to = Vector2::from(to_m);
        match self {
            Self::Station(station) => {
                [plan.stations_m[station].x, plan.stations_m[station].y] = to_m;
            }
            Self::Waypoint { piece, index } => {
                if let Some(Piece::Waypoints(waypoints)) = plan.way.get_mut(piece)
                    && let Some(at) = waypoints.get_mut(index)
                {
                    [at.x_m, at.y_m] = to_m;
                }
            }
            Self::Middle(piece) => match plan.way.get_mut(piece) {
                Some(Piece::FigureEight(eight)) => eight.centre_m = to_m,
                Some(Piece::Loop(one)) => one.centre_m = to_m,
                Some(Piece::Waypoints(_)) | None => {}
            },
            Self::Tip(piece) => match plan.way.get_mut(piece) {
                Some(Piece::FigureEight(eight)) => {
                    // The tip is to the left of the heading, at a distance of two radii of a lobe.
                    let out = to - Vector2::from(eight.centre_m);
                    eight.length_m = (2.0 * out.norm()).clamp(2.0, 1000.0);
                    eight.heading_rad = out.y.atan2(out.x) - std::f64::consts::FRAC_PI_2;
                }
                Some(Piece::Loop(one)) => {
                    let out = to - Vector2::from(one.centre_m);
                    one.radius_m = out.norm().clamp(0.5, 1000.0);
                    one.from_rad = out.y.atan2(out.x);
                }
                Some(Piece::Waypoints(_)) | None => {}
            },
            Self::Ramp(index) => {
                if let Some(ramp) = plan.ground.ramps.get_mut(index) {
                    ramp.centre_m = to_m;
                }
            }
        }
        plan
    }

    /// Returns the plan without this element; `None` for a station, or if the rest would be no valid plan.
    pub fn taken_out(self, plan: &Plan) -> Option<Plan> {
        let mut plan = plan.clone();
        match self {
            Self::Station(_) => return None,
            Self::Waypoint { piece, index } => {
                let Some(Piece::Waypoints(waypoints)) = plan.way.get_mut(piece) else {
                    return None;
                };
                if index >= waypoints.len() {
                    return None;
                }
                waypoints.remove(index);
                if waypoints.is_empty() {
                    plan.way.remove(piece);
                }
            }
            Self::Middle(piece) | Self::Tip(piece) => {
                if piece >= plan.way.len() {
                    return None;
                }
                plan.way.remove(piece);
            }
            Self::Ramp(index) => {
                if index >= plan.ground.ramps.len() {
                    return None;
                }
                plan.ground.ramps.remove(index);
            }
        }
        plan.check().is_ok().then_some(plan)
    }
}

fn tip_of_eight(eight: &FigureEight) -> Vector2<f64> {
    let out = Rotation2::new(eight.heading_rad) * Vector2::new(0.0, eight.length_m / 2.0);
    Vector2::from(eight.centre_m) + out
}

/// An element that can be added to a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Addition {
    Waypoint,
    FigureEight,
    Loop,
    Ramp,
}

impl Addition {
    pub const ALL: [Self; 4] = [Self::Waypoint, Self::FigureEight, Self::Loop, Self::Ramp];

    pub fn name(self) -> &'static str {
        match self {
            Self::Waypoint => "waypoint",
            Self::FigureEight => "figure-eight",
            Self::Loop => "loop",
            Self::Ramp => "ramp",
        }
    }

    /// Returns the plan with this element at a position (m): a ramp at that place, anything else at the end of the path.
    pub fn put(self, plan: &Plan, place_m: [f64; 2]) -> Plan {
        let mut plan = plan.clone();
        match self {
            Self::Waypoint => {
                let at = Waypoint::at(Vector2::from(place_m));
                match plan.way.last_mut() {
                    Some(Piece::Waypoints(waypoints)) => waypoints.push(at),
                    _ => plan.way.push(Piece::Waypoints(vec![at])),
                }
            }
            Self::FigureEight => plan.way.push(Piece::FigureEight(FigureEight {
                centre_m: place_m,
                length_m: 16.0,
                heading_rad: 0.0,
                times: 1,
            })),
            Self::Loop => plan.way.push(Piece::Loop(Loop {
                centre_m: place_m,
                radius_m: 6.0,
                from_rad: 0.0,
                turns: 1.0,
            })),
            Self::Ramp => {
                plan.ground.ramps.push(Ramp { centre_m: place_m, radius_m: 4.0, height_m: 0.4 });
            }
        }
        plan
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_handle_goes_where_it_is_moved_to_and_nothing_else_does() {
        let start = Addition::Ramp.put(&Planning::default().plan, [40.0, 3.0]);
        let start = Addition::Loop.put(&start, [70.0, -12.0]);
        start.check().expect("sound");
        for handle in Handle::all(&start) {
            let place_m = handle.place_m(&start).expect("there");
            let to_m = [place_m[0] + 1.5, place_m[1] - 2.5];
            let moved = handle.moved(&start, to_m);
            let found_m = handle.place_m(&moved).expect("still there");
            let off_m = (Vector2::from(found_m) - Vector2::from(to_m)).norm();
            assert!(off_m < 1e-9, "{handle:?}: {found_m:?} instead of {to_m:?}");
            let others = Handle::all(&start).into_iter().filter(|other| match (handle, *other) {
                // A tip moves with its centre.
                (Handle::Middle(a), Handle::Tip(b)) => a != b,
                (a, b) => a != b,
            });
            for other in others {
                let (before, after) = (other.place_m(&start), other.place_m(&moved));
                assert_eq!(before, after, "{other:?} moved with {handle:?}");
            }
        }
    }

    #[test]
    fn what_is_taken_out_is_gone_and_a_way_stays_a_way() {
        let plan = Planning::default().plan;
        assert!(Handle::Station(1).taken_out(&plan).is_none());
        let without = Handle::Middle(1).taken_out(&plan).expect("an approach is left");
        assert_eq!(without.way.len(), 1);
        let alone = Handle::Waypoint { piece: 0, index: 0 }.taken_out(&without);
        assert!(alone.is_none(), "one waypoint is no way");
    }
}
