//! Several drives of one set-up, joined into one deployment and solved together.

use super::control_points::{ControlPoint, ControlPointSet};
use super::deployment::Deployment;
use super::findings::recordings::{drive_distances_differ, drive_shifted};
use crate::network::PrismChange;

/// A drive that cannot be solved together with the others, with the reason and the remedy.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{drive}: {what}; {remedy}")]
pub struct OtherSetUp {
    pub drive: String,
    pub what: String,
    pub remedy: String,
}

/// Shortest pause between drives (s), with which the pipeline can separate them.
const LEAST_PAUSE_S: f64 = 10.0;
/// Pause inserted between drives whose stamps overlap (s after the end of the previous one).
const PAUSE_S: f64 = 60.0;
/// Rigs are different if their measured distances differ by more than this (m).
const SAME_RIG_M: f64 = 0.005;
/// Distances that differ by less than this (m) are equal but for rounding.
const SAME_DISTANCES_M: f64 = 5e-5;

impl Deployment {
    /// Adds further drives with the same set-up of the stations and the same rig.
    ///
    /// A drive keeps its stamps unless it begins before the end of the previous one. It is then shifted behind it, with a
    /// finding. Each drive has its own clock offsets.
    ///
    /// # Errors
    /// [`OtherSetUp`] if a drive has another rig, other prisms or other frames than the first.
    pub fn take_in(&mut self, drives: Vec<Self>) -> Result<(), OtherSetUp> {
        let mut all = drives;
        all.sort_by(|a, b| start_s(a).total_cmp(&start_s(b)));
        for mut drive in all {
            self.check_same_set_up(&drive)?;
            let from_s = self.end_s().unwrap_or(0.0);
            if start_s(&drive) < from_s + LEAST_PAUSE_S {
                let by_s = from_s + PAUSE_S - start_s(&drive);
                drive.shift(by_s);
                self.findings.push(drive_shifted(&drive.name, by_s));
            }
            self.restarts_s.push(start_s(&drive));
            self.append(drive);
        }
        Ok(())
    }

    /// Returns true if both have the same readings of a control point, so that their stations were set up for the same survey.
    pub fn shares_survey_with(&self, other: &Self) -> bool {
        let points = |of: &Self| {
            of.control_points.iter().flat_map(|set| set.points.clone()).collect::<Vec<_>>()
        };
        let own = points(self);
        let is_measured = |point: &ControlPoint| point.readings.iter().all(Option::is_some);
        points(other).iter().any(|point| is_measured(point) && own.contains(point))
    }

    fn check_same_set_up(&mut self, other: &Self) -> Result<(), OtherSetUp> {
        let differs = |what: &str| {
            Err(OtherSetUp {
                drive: other.name.clone(),
                what: format!("{what} than {}", self.name),
                remedy: "only drives with the same rig and unmoved stations are solved together; open it \
                         separately"
                    .to_owned(),
            })
        };
        if start_s(other).is_infinite() {
            return Err(OtherSetUp {
                drive: other.name.clone(),
                what: "it has no readings".to_owned(),
                remedy: "leave it out".to_owned(),
            });
        }
        if let Some(station) = other.tracks.iter().position(|track| track.measurements.is_empty()) {
            return Err(OtherSetUp {
                drive: other.name.clone(),
                what: format!(
                    "station {} has no measurement; all stations are needed",
                    station + 1
                ),
                remedy: "leave it out".to_owned(),
            });
        }
        // Duplicate readings would only seem to reduce σ.
        let (own, others) = (&self.tracks[0].measurements, &other.tracks[0].measurements);
        if own.windows(others.len()).any(|part| part == others) {
            return Err(OtherSetUp {
                drive: other.name.clone(),
                what: "its readings are those of another drive that is already here".to_owned(),
                remedy: "give each drive once".to_owned(),
            });
        }
        if other.track_frame != self.track_frame {
            return differs("its tracks are in another frame");
        }
        if let (Some(own), Some(others)) = (&self.rig, &other.rig) {
            let pairs = own.inter_prism_m.iter().zip(&others.inter_prism_m);
            let apart_m = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            if apart_m > SAME_RIG_M {
                return differs("it has other inter-prism distances");
            }
            if apart_m > SAME_DISTANCES_M {
                let finding = drive_distances_differ(&other.name, &self.name, apart_m);
                self.findings.push(finding);
            }
        }
        if other.prisms.is_some() && self.prisms.is_some() && other.prisms != self.prisms {
            return differs("its stations follow another number of prisms");
        }
        Ok(())
    }

    fn shift(&mut self, by_s: f64) {
        for track in &mut self.tracks {
            track.measurements.iter_mut().for_each(|reading| reading.time_s += by_s);
            track.prism_changes.iter_mut().for_each(|change| change.time_s += by_s);
        }
        self.gnss.iter_mut().flatten().flatten().for_each(|fix| fix.time_s += by_s);
        self.time_corrections.iter_mut().flatten().for_each(|told| told.time_s += by_s);
    }

    /// Appends the changes of prisms; a drive that begins with other prisms than the one before ended with changes them at its start.
    fn append_prism_changes(&mut self, drive: &Self) {
        let (ends_with, begins_with) = (self.prism_schedule(), drive.prism_schedule());
        if ends_with.is_constant() && begins_with.is_constant() {
            return;
        }
        let time_s = start_s(drive);
        for ((station, more), track) in drive.tracks.each().zip(&mut self.tracks) {
            let prism = begins_with.at(f64::NEG_INFINITY)[station];
            if ends_with.at(f64::INFINITY)[station] != prism {
                track.prism_changes.push(PrismChange { time_s, prism });
            }
            track.prism_changes.extend(&more.prism_changes);
        }
    }

    fn append(&mut self, mut drive: Self) {
        self.name = format!("{} + {}", self.name, drive.name);
        self.append_prism_changes(&drive);
        for (track, more) in self.tracks.iter_mut().zip(&mut drive.tracks) {
            // The stations' own clocks are kept only if all drives have them.
            let all_known = |own: &[f64], readings: usize| own.len() == readings;
            if all_known(&track.own_clock_s, track.measurements.len())
                && all_known(&more.own_clock_s, more.measurements.len())
            {
                track.own_clock_s.append(&mut more.own_clock_s);
            } else {
                track.own_clock_s.clear();
            }
            if !track.left_out.is_empty() || !more.left_out.is_empty() {
                track.left_out.resize(track.measurements.len(), false);
                more.left_out.resize(more.measurements.len(), false);
                track.left_out.append(&mut more.left_out);
            }
            // Each drive has its own prism constant, and the track keeps only one.
            let constant_m = more.prism_constant_m - track.prism_constant_m;
            more.measurements.iter_mut().for_each(|reading| reading.range_m += constant_m);
            track.measurements.append(&mut more.measurements);
        }
        for set in drive.control_points {
            if !self.control_points.iter().any(|known| known.points == set.points) {
                let file = format!("{}/{}", drive.name, set.file);
                self.control_points.push(ControlPointSet { file, ..set });
            }
        }
        self.rig = self.rig.take().or(drive.rig);
        self.prisms = self.prisms.or(drive.prisms);
        self.gnss = match (self.gnss.take(), drive.gnss) {
            (Some(mut own), Some(more)) => {
                own.iter_mut().zip(more).for_each(|(own, more)| own.extend(more));
                Some(own)
            }
            _ => None,
        };
        for (own, more) in self.time_corrections.iter_mut().zip(drive.time_corrections) {
            own.extend(more);
        }
        for ingredient in &mut drive.ingredients {
            ingredient.file = format!("{}/{}", drive.name, ingredient.file);
        }
        self.ingredients.append(&mut drive.ingredients);
        let own = drive.findings.into_iter().map(|finding| finding.within(&drive.name));
        self.findings.extend(own);
    }
}

fn start_s(deployment: &Deployment) -> f64 {
    deployment.start_s().unwrap_or(f64::INFINITY)
}
