//! Corrections of a deployment's data. They are stored only in the [`Extras`] of its source; each change has the deployment
//! read again, and can be undone.

use std::path::PathBuf;

use super::State;
use crate::app::file_dialog::{Question, Wanted};
use crate::app::model::undo::{Change, Changed, Moment};
use crate::app::model::{OpenDeployment, Picked};
use resect_core::deployment::{Deployment, MaskedReading, OneOrMany, Overrides, as_numbered};
use resect_io::override_changes::extras_changes;
use resect_io::source::{Extras, Source};

/// A file beside the tracks that the user selects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extra {
    Rig,
    ControlPoints,
}

impl State {
    /// Returns the extras of the active deployment, or those last requested while it is read again; `None` for data without a source.
    pub fn extras(&self) -> Option<&Extras> {
        self.wanted_source(self.active()?.id).map(|source| &source.extras)
    }

    /// Returns the source of a deployment, or its next one while it is read again.
    pub(super) fn wanted_source(&self, id: u64) -> Option<&Source> {
        let pending =
            self.deployments.opening.iter().rev().find(|opening| opening.replaces() == Some(id));
        let own = || self.deployments.get(id)?.source.as_ref();
        pending.map(|opening| &opening.source).or_else(own)
    }

    pub(super) fn apply_corrections(&mut self, extras: Extras) {
        if let Some(id) = self.active().map(|open| open.id) {
            self.read_with(id, extras, true);
        }
    }

    /// Reads a deployment again with other extras. `step` is true for an undoable step; undo and redo themselves are none.
    pub(super) fn read_with(&mut self, id: u64, mut extras: Extras, step: bool) {
        let Some(open) = self.deployments.get(id) else { return };
        extras.corrections = extras.corrections.beyond(&open.deployment.as_read);
        if let Err((what, remedy)) = extras.corrections.check() {
            self.toasts.error(&format!("{what}; {remedy}"));
            return;
        }
        let Some(source) = self.wanted_source(id) else {
            self.toasts.error(
                "the open deployment has no file; save it, open the saved file, and add to it",
            );
            return;
        };
        if source.extras == extras {
            return;
        }
        let source = source.clone().with(extras);
        if self.live.is_running() && self.live.id == Some(id) {
            self.apply_live_corrections(id, source, step);
            return;
        }
        self.give_up_replacing(id);
        self.replace_by(id, source, step);
    }

    /// Cancels the reading for the user's latest change; returns true if there was one.
    pub(super) fn take_back_pending(&mut self) -> bool {
        let Some(id) = self.active().map(|open| open.id) else { return false };
        self.deployments.opening.iter().any(|opening| opening.is_step_of(id))
            && self.give_up_replacing(id)
    }

    /// Records a change of the extras as an undoable step, once it is read.
    pub(super) fn record_extras(&mut self, id: u64, before: Extras, after: Extras) {
        let Some(open) = self.deployments.get(id) else { return };
        if before != after {
            let changes = extras_changes(&before, &after, &open.deployment.as_read);
            let words = changes.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
            let what = Changed::Extras { both: Box::new([before, after]), words };
            self.deployments.undo.record(vec![Change { id, what }], Moment::NEVER);
        }
    }

    pub(super) fn choose_extra_dialog(&mut self, extra: Extra) {
        let Some(id) = self.active().map(|open| open.id) else { return };
        let title = match extra {
            Extra::Rig => "Choose a file that describes the rig",
            Extra::ControlPoints => "Choose a file of control points",
        };
        let answer = self.ask(Question::new(title, Wanted::ToOpen { folder: false }));
        self.jobs.start_unnumbered(
            move || answer.wait(),
            move |state: &mut Self, path| state.take_picked_extra(id, extra, path),
        );
    }

    pub(super) fn take_picked_extra(&mut self, id: u64, extra: Extra, path: PathBuf) {
        let Some(source) = self.wanted_source(id) else { return };
        let mut extras = source.extras.clone();
        match extra {
            Extra::Rig => use_rig(&mut extras, path),
            Extra::ControlPoints if extras.gcp.contains(&path) => {}
            Extra::ControlPoints => extras.gcp.push(path),
        }
        self.read_with(id, extras, true);
    }
}

/// Requests that the pane unfolds its corrections when it is next drawn.
pub fn unfold(ctx: &egui::Context) {
    ctx.data_mut(|data| data.insert_temp(unfold_id(), true));
}

/// Returns true once after each request to unfold.
pub fn take_unfold(ctx: &egui::Context) -> bool {
    ctx.data_mut(|data| data.remove_temp(unfold_id())).unwrap_or(false)
}

fn unfold_id() -> egui::Id {
    egui::Id::unique("unfold what can be put right")
}

/// Sets the file of the rig, and removes an earlier override of its distances.
pub fn use_rig(extras: &mut Extras, path: PathBuf) {
    extras.rig = Some(path);
    extras.corrections.inter_prism_m = None;
}

/// Returns the effective overrides: the corrections, and elsewhere those of the files.
pub fn effective(extras: &Extras, deployment: &Deployment) -> Overrides {
    extras.corrections.clone().over(deployment.as_read.clone())
}

/// Returns the extras with the numbers of two stations (from 0) exchanged.
pub fn exchanged(extras: &Extras, deployment: &Deployment, [a, b]: [usize; 2]) -> Extras {
    let mut extras = extras.clone();
    let now = effective(&extras, deployment);
    let before = now.stations.unwrap_or_else(|| as_numbered(deployment.tracks.len()));
    let mut after = before.clone();
    after.as_mut_slice().swap(a, b);
    extras.corrections.masked = now.masked;
    extras.corrections.renumber(&before, after);
    extras
}

/// Returns the extras with these readings masked or unmasked.
pub fn masked(
    extras: &Extras,
    deployment: &Deployment,
    readings: impl IntoIterator<Item = Picked>,
    leave_out: bool,
) -> Extras {
    let mut extras = extras.clone();
    let mut masks = effective(&extras, deployment).masked.unwrap_or_default();
    for picked in readings {
        let Some(time_s) = picked.time_s(deployment) else { continue };
        let mask = MaskedReading { station: picked.station as u8 + 1, time_s };
        let same = |other: &MaskedReading| *other == mask;
        match leave_out {
            true if masks.iter().any(same) => {}
            true => masks.push(mask),
            false => masks.retain(|other| !is_near(other, &mask)),
        }
    }
    extras.corrections.masked = Some(masks);
    extras
}

/// Text files round stamps to microseconds, so a mask may differ that much from its reading.
fn is_near(a: &MaskedReading, b: &MaskedReading) -> bool {
    a.station == b.station && (a.time_s - b.time_s).abs() < 2e-6
}

/// Returns true if this reading is masked; readings outside the used time interval are not.
pub fn is_masked(extras: &Extras, deployment: &Deployment, picked: Picked) -> bool {
    let masks = extras.corrections.masked.as_ref().or(deployment.as_read.masked.as_ref());
    let Some(time_s) = picked.time_s(deployment) else { return false };
    let mask = MaskedReading { station: picked.station as u8 + 1, time_s };
    masks.into_iter().flatten().any(|other| is_near(other, &mask))
}

/// Returns the readings of a station within a time interval (s).
pub fn within(deployment: &Deployment, station: usize, [from_s, to_s]: [f64; 2]) -> Vec<Picked> {
    let readings =
        deployment.tracks.as_slice().get(station).map_or(&[][..], |track| &track.measurements);
    let from = readings.partition_point(|m| m.time_s < from_s);
    let to = readings.partition_point(|m| m.time_s <= to_s).max(from);
    (from..to).map(|index| Picked { station, index }).collect()
}

/// Returns the extras with the used time interval (s); `None` for all times.
pub fn with_span(extras: &Extras, open: &OpenDeployment, span_s: Option<[f64; 2]>) -> Extras {
    let mut extras = extras.clone();
    // An interval of the folder cannot be removed, only overridden.
    let all = || open.deployment.as_read.span_s.map(|_| open.timeline.whole_s);
    extras.corrections.span_s = span_s.or_else(all);
    extras
}

/// Returns the extras without one of the present control-point files.
pub fn without_control_points(extras: &Extras, deployment: &Deployment, file: &str) -> Extras {
    let mut extras = extras.clone();
    let of_user = extras.gcp.iter().position(|path| path.display().to_string() == file);
    match of_user {
        Some(index) => {
            extras.gcp.remove(index);
        }
        None => {
            let named = |set: &str| extras.gcp.iter().any(|path| path.display().to_string() == set);
            let others = deployment.control_points.iter().map(|set| set.file.clone());
            let others = others.filter(|other| other != file && !named(other)).collect();
            extras.corrections.control_points = Some(others);
        }
    }
    extras
}

/// Returns the files of the tracks as one name or a list.
pub fn one_or_many(mut files: Vec<String>) -> OneOrMany {
    match files.pop() {
        Some(only) if files.is_empty() => OneOrMany::One(only),
        last => OneOrMany::Many(files.into_iter().chain(last).collect()),
    }
}
