//! The plan that the window shows: its handles, and what is foreseen of it.

use std::path::PathBuf;

use nalgebra::{Rotation2, Vector2};

use super::made::Made;
use resect_core::planning::{FigureEight, Improvement, Loop, Piece, Plan, PlanError, Prediction};
use resect_core::simulation::{Preset, Ramp, Waypoint};

/// A plan, and what is made of it beside the window.
pub struct Planning {
    pub plan: Plan,
    /// The file that it was read from or written to last.
    pub path: Option<PathBuf>,
    /// Whether it is the user's: what the program began with is nobody's loss.
    pub touched: bool,
    /// Counts the plans that were shown.
    pub version: u64,
    pub foreseen: Made<Result<Prediction, PlanError>>,
    pub better: Made<Result<Vec<Improvement>, PlanError>>,
    pub selected: Option<Handle>,
}

/// What is asked of the plan.
#[derive(Clone, Debug)]
pub enum PlanCommand {
    /// Another plan, with the words for the step that can be undone.
    Set(Box<Plan>, &'static str),
    Select(Option<Handle>),
    OpenDialog,
    Open(PathBuf),
    SaveDialog,
    /// What was driven in the active deployment.
    FromDeployment,
    FromPreset(Preset),
}

/// What of a plan is moved by the pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Handle {
    Station(usize),
    Waypoint {
        piece: usize,
        index: usize,
    },
    /// The middle of a figure-eight or a loop, by its piece.
    Middle(usize),
    /// The tip of a figure-eight, which turns and stretches it, or where a loop begins.
    Tip(usize),
    Ramp(usize),
}

impl Default for Planning {
    /// Stations and rig as they are usual, and an approach to a figure-eight.
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
            foreseen: Made::default(),
            better: Made::default(),
            selected: None,
        }
    }
}

impl Planning {
    /// Shows another plan; what was foreseen of the old one stays until the new one's is there.
    pub fn set(&mut self, plan: Plan) {
        self.plan = plan;
        self.version += 1;
        self.touched = true;
        if self.selected.is_some_and(|handle| handle.place_m(&self.plan).is_none()) {
            self.selected = None;
        }
    }

    /// What is foreseen of exactly this plan.
    pub fn is_foreseen(&self) -> bool {
        self.foreseen.is_of((self.version, 0))
    }
}

/// Names a piece of a plan: "figure-eight", or where there are several "figure-eight 2".
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
    /// Everything in a plan that can be moved.
    pub fn all(plan: &Plan) -> Vec<Self> {
        let stations = (0..3).map(Self::Station);
        let ramps = (0..plan.ground.ramps.len()).map(Self::Ramp);
        let of_way = plan.way.iter().enumerate().flat_map(|(piece, one)| match one {
            Piece::Waypoints(waypoints) => {
                (0..waypoints.len()).map(|index| Self::Waypoint { piece, index }).collect()
            }
            Piece::FigureEight(_) | Piece::Loop(_) => vec![Self::Middle(piece), Self::Tip(piece)],
        });
        // Stations come last: they are drawn above all else, and are what the pointer finds first.
        of_way.chain(ramps).chain(stations).collect()
    }

    /// How people call it.
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

    /// Where it is (m, in the frame of the plan); `None` where the plan has no such thing.
    pub fn place_m(self, plan: &Plan) -> Option<[f64; 2]> {
        Some(match self {
            Self::Station(station) => [plan.stations_m[station].x, plan.stations_m[station].y],
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

    /// The plan with this moved to a place (m); as it was where it has no such thing.
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
                    // The tip lies to the left of the heading, two radii of a lobe out.
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

    /// The plan without it; `None` of stations, and of what the way needs to be one.
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

/// What can be put on the way.
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

    /// The plan with it at a place (m): a ramp where it is, all else at the end of the way.
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
                // A tip goes with its middle.
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
