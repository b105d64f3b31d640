//! Texts of the strip under the picture, the most important first.

use nalgebra::{Rotation3, Vector3};

use super::SceneContent;
use super::content::DrawnArrows;
use super::ghosts::Ghost;
use super::legend_rows;
use super::vehicle::PoseBy;
use crate::app::model::units::without_negative_zero;
use crate::app::model::{OpenDeployment, Ruler, Units};
use crate::app::prepared::placing::frame_in_words;
use crate::app::prepared::rig_at::LAST_READ_S;
use crate::app::state::State;
use resect_core::analysis::Analysis;
use resect_core::evaluation::trajectory::PoseSigma;
use resect_core::geometry::RigidTransform;
use resect_core::network::{Number, PerStation, Prism};
use resect_core::statistics::estimate::decimals_of;

pub struct Text {
    pub text: String,
    /// True if the text is of minor importance.
    pub faint: bool,
}

pub fn texts(
    open: &OpenDeployment,
    analysis: &Analysis,
    state: &State,
    content: &SceneContent,
) -> Vec<Text> {
    let mut plain = ruler(open, state, content);
    let mut cursor = cursor(open, analysis, content, state.workspace.units).into_iter();
    plain.extend(cursor.next());
    let hidden = legend_rows::hidden(open, analysis, &state.scene.visibility);
    if !hidden.is_empty() {
        plain.push(format!("hidden: {}", hidden.join(", ")));
    }
    if state.scene.options.height_scale != 1 {
        plain.push(format!("heights drawn ×{}", state.scene.options.height_scale));
    }
    plain.extend(ellipsoids(state, content));
    if let Some(DrawnArrows { scale, cut }) = content.arrows {
        let cut = if cut > 0 { format!(", {cut} truncated") } else { String::new() };
        plain.push(format!("residuals ×{scale}{cut}"));
    }
    plain.extend(cursor);
    let grid = content.grid.as_ref().map(|grid| format!("grid {}", grid.spacing()));
    let frame = frame_in_words(&open.deployment, analysis);
    // A trajectory has no readings.
    let has_readings = open.deployment.ground_truth.is_none();
    let counts = has_readings.then(|| counts(analysis, content));
    let faint = grid.into_iter().chain(counts).chain([frame]);
    let plain = plain.into_iter().map(|text| Text { text, faint: false });
    plain.chain(faint.into_iter().map(|text| Text { text, faint: true })).collect()
}

/// Describes the ruler's measurement, or the end that is missing.
fn ruler(open: &OpenDeployment, state: &State, content: &SceneContent) -> Vec<String> {
    let Ruler { active, ends } = &state.scene.ruler;
    let inter_prism_m = open.deployment.rig.as_ref().map(|rig| &rig.inter_prism_m);
    match &ends[..] {
        [] if *active => vec!["ruler: click the first point".to_owned()],
        [] => Vec::new(),
        [end] => vec![format!("ruler: from {}; click the second point", end.what)],
        [from, .., to] => {
            let lines = state.scene.ruler.lines(
                content.prisms_m.as_ref(),
                inter_prism_m,
                state.workspace.units,
            );
            let what = format!("ruler: {}", lines.join(", "));
            vec![what, format!("from {} to {}", from.what, to.what)]
        }
    }
}

/// Describes time and position at the cursor, then the attitude, then their source.
fn cursor(
    open: &OpenDeployment,
    analysis: &Analysis,
    content: &SceneContent,
    units: Units,
) -> Vec<String> {
    let Some(cursor_s) = open.timeline.cursor_s else { return Vec::new() };
    let time = format!("{:.2} s", cursor_s - open.start_s());
    let Some(prisms_m) = &content.prisms_m else {
        let answer = analysis.answer.as_ref().map(|answer| &answer.calibration);
        let why = match answer.map(|answer| answer.placing_tracks(&open.deployment)) {
            Err(_) => "prism positions not determined",
            Ok(None) => "the tracks are in another frame than this result",
            Ok(Some(_)) => return vec![format!("{time}  {}", last_read(&content.ghosts))],
        };
        return vec![format!("{time}  {why}")];
    };
    let Some(pose) = &content.pose else {
        let joint = analysis.answer.as_ref().is_ok_and(|a| a.calibration.joint().is_some());
        let why = match Prism::count(&analysis.offer.followed) {
            1 => "",
            2 => ", two prisms have no orientation",
            _ if joint => ", segment too short for a pose",
            _ => "",
        };
        return vec![format!("{time}  prism 1 {}{why}", position(&prisms_m[0], units))];
    };
    let (sigma, by) = match &pose.by {
        PoseBy::Motion => (sigma_by_way(open, cursor_s), "by the joint estimate"),
        // Without a σ of the interpolation, the σ of a single pose would be a guess from three distances.
        PoseBy::Triplet(sigma) => {
            (analysis.triplets().sigma_m.as_ref().map(|_| *sigma), "by one triplet")
        }
    };
    let RigidTransform { rotation, translation_m } = &pose.station1_from_vehicle;
    let place = position(translation_m, units);
    let orientation_sigma_rad = sigma.map(|sigma| sigma.orientation_rad);
    let mut lines =
        vec![format!("{time}  {place}"), attitude(rotation, orientation_sigma_rad, units)];
    if let Some(sigma) = sigma {
        let [position_m, orientation_rad] = [sigma.position_m, sigma.orientation_rad].map(Some);
        lines[0] += &format!("  ± {} mm", units.length_sigma(position_m));
        let small = units.angle.small_name();
        lines[1] += &format!("  ± {} {small}", units.angle_sigma(orientation_rad));
    }
    lines.push(format!("pose {by}"));
    lines
}

/// Returns σ of the joint estimate's motion at an instant, once it is computed for this calibration.
fn sigma_by_way(open: &OpenDeployment, time_s: f64) -> Option<PoseSigma> {
    let way = open.way.newest.as_deref().filter(|_| open.way.is_of((open.analysis_run, 0)))?;
    let at = way.at(time_s)?;
    let position_m = at.position_sigma_m();
    Some(PoseSigma { position_m, orientation_rad: at.turn_sigma_rad? })
}

/// Describes the age of the last readings, where there is no triplet.
fn last_read(ghosts: &PerStation<Option<Ghost>>) -> String {
    let read = ghosts.iter().enumerate().filter_map(|(prism, ghost)| Some((prism, (*ghost)?)));
    let (prisms, ages): (Vec<String>, Vec<String>) = read
        .map(|(prism, Ghost { age_s, rejected, .. })| {
            let rejected = if rejected { " (rejected)" } else { "" };
            ((prism + 1).to_string(), format!("{age_s:.1}{rejected}"))
        })
        .unzip();
    if prisms.is_empty() {
        return format!("no triplet, and no reading in the last {LAST_READ_S} s");
    }
    let plural = if prisms.len() > 1 { "s" } else { "" };
    let (prisms, ages) = (prisms.join(", "), ages.join(", "));
    format!("no triplet; prism{plural} {prisms} read {ages} s ago")
}

fn position(p: &Vector3<f64>, units: Units) -> String {
    let [x, y, z] = [p.x, p.y, p.z].map(|coordinate| units.length(coordinate));
    format!("x {x}  y {y}  z {z} {}", units.length.name())
}

/// Describes an attitude with the digits that its σ supports.
fn attitude(
    station1_from_vehicle: &Rotation3<f64>,
    sigma_rad: Option<f64>,
    units: Units,
) -> String {
    let (roll, pitch, yaw) = station1_from_vehicle.euler_angles();
    let per_radian = units.angle.per_radian();
    let decimals = sigma_rad.and_then(|sigma_rad| decimals_of(per_radian * sigma_rad));
    let [roll, pitch, yaw] = [roll, pitch, yaw].map(|angle_rad| match decimals {
        Some(decimals) => without_negative_zero(per_radian * angle_rad, decimals),
        None => units.angle(angle_rad),
    });
    format!("heading {yaw}  roll {roll}  pitch {pitch} {}", units.angle.name())
}

/// Describes the enlargement of the ellipsoids.
fn ellipsoids(state: &State, content: &SceneContent) -> Option<String> {
    let mut of = Vec::new();
    if content.station_ellipsoids {
        of.push("stations 95 %");
    }
    if content.track_ellipsoids {
        of.push("tracks 2σ of the interpolation");
    }
    if !content.tube.lines.is_empty() {
        of.push("tube of the vehicle 95 %");
    }
    let scale = state.scene.options.ellipsoid_scale;
    (!of.is_empty()).then(|| format!("ellipsoids ×{scale}: {}", of.join(", ")))
}

/// Describes the numbers of drawn readings and tracks.
fn counts(analysis: &Analysis, content: &SceneContent) -> String {
    use resect_core::pipeline::SampleFate;
    let stations = |shown: &PerStation<bool>| {
        shown.each().filter(|(_, shown)| **shown).map(|(station, _)| station).collect::<Vec<_>>()
    };
    let fates = SampleFate::ALL.into_iter().enumerate();
    let fates = fates.filter(|(place, _)| content.shown_fates >> place & 1 == 1);
    let fates: Vec<SampleFate> = fates.map(|(_, fate)| fate).collect();
    let readings: usize = (stations(&content.raw_shown).into_iter())
        .map(|at| {
            fates.iter().map(|fate| analysis.pipeline.count(at.index(), *fate)).sum::<usize>()
        })
        .sum();
    let track_points = stations(&content.tracks_shown).len() * analysis.triplets().len();
    format!("{readings} readings and {track_points} track points shown")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ghosts_are_told_with_the_age_of_their_readings() {
        let ghost = |age_s, rejected| Some(Ghost { position_m: Vector3::zeros(), age_s, rejected });
        assert_eq!(
            last_read(&[ghost(0.42, false), None, ghost(1.16, true)].into()),
            "no triplet; prisms 1, 3 read 0.4, 1.2 (rejected) s ago"
        );
        let one = last_read(&[None, ghost(2.0, false), None].into());
        assert_eq!(one, "no triplet; prism 2 read 2.0 s ago");
        assert_eq!(last_read(&[None; 3].into()), "no triplet, and no reading in the last 3 s");
    }
}
