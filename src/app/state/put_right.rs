//! What is put right in the data of a deployment. There is one store, [`Extras`] of its source; whatever changes it has
//! the deployment read again, and can be undone.

use std::path::PathBuf;

use super::State;
use crate::app::file_dialog::{Question, Wanted};
use crate::app::model::undo::{Change, Changed, Moment};
use crate::app::model::{OpenDeployment, Picked};
use resect_core::deployment::{AS_NUMBERED, Deployment, MaskedReading, OneOrMany, Overrides};
use resect_io::override_changes::extras_changes;
use resect_io::source::{Extras, Source};

/// A file that the user names beside the tracks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extra {
    Rig,
    ControlPoints,
}

impl State {
    /// What the active deployment is read with; while it is read again, what was asked for last. None of data that came
    /// from no file.
    pub fn extras(&self) -> Option<&Extras> {
        self.wanted_source(self.active()?.id).map(|source| &source.extras)
    }

    /// Where a deployment is read from now, or will be.
    pub(super) fn wanted_source(&self, id: u64) -> Option<&Source> {
        let pending =
            self.deployments.opening.iter().rev().find(|opening| opening.replaces() == Some(id));
        let own = || self.deployments.get(id)?.source.as_ref();
        pending.map(|opening| &opening.source).or_else(own)
    }

    pub(super) fn put_right(&mut self, extras: Extras) {
        if let Some(id) = self.active().map(|open| open.id) {
            self.read_with(id, extras, true);
        }
    }

    /// Reads a deployment again with other extras. `step`: whether that can be undone once it is read; going back or
    /// forth by a step is none itself.
    pub(super) fn read_with(&mut self, id: u64, mut extras: Extras, step: bool) {
        let Some(open) = self.deployments.get(id) else { return };
        extras.put_right = extras.put_right.beyond(&open.deployment.as_read);
        if let Err((what, remedy)) = extras.put_right.check() {
            self.toasts.error(&format!("{what}; {remedy}"));
            return;
        }
        let Some(source) = self.wanted_source(id) else {
            self.toasts.error("what is open came from no file; save it, open that, and add to it");
            return;
        };
        if source.extras == extras {
            return;
        }
        let source = source.clone().with(extras);
        if self.live.is_running() && self.live.id == Some(id) {
            self.put_right_live(id, source, step);
            return;
        }
        self.give_up_replacing(id);
        self.replace_by(id, source, step);
    }

    /// Gives up reading a deployment again that the user just asked for; tells whether there was one.
    pub(super) fn take_back_pending(&mut self) -> bool {
        let Some(id) = self.active().map(|open| open.id) else { return false };
        self.deployments.opening.iter().any(|opening| opening.is_step_of(id))
            && self.give_up_replacing(id)
    }

    /// Keeps what was changed, now that it is read.
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

/// Has the lines of what can be put right unfolded where they are drawn next.
pub fn unfold(ctx: &egui::Context) {
    ctx.data_mut(|data| data.insert_temp(unfold_id(), true));
}

/// Whether they are to be unfolded, once.
pub fn take_unfold(ctx: &egui::Context) -> bool {
    ctx.data_mut(|data| data.remove_temp(unfold_id())).unwrap_or(false)
}

fn unfold_id() -> egui::Id {
    egui::Id::unique("unfold what can be put right")
}

/// The rig is that of this file, and not what was said of it before.
pub fn use_rig(extras: &mut Extras, path: PathBuf) {
    extras.rig = Some(path);
    extras.put_right.inter_prism_m = None;
}

/// What a deployment is read with in the end: what is put right, and where nothing is, what its files say.
pub fn effective(extras: &Extras, deployment: &Deployment) -> Overrides {
    extras.put_right.clone().over(deployment.as_read.clone())
}

/// The extras with the files' numbers of two stations exchanged (0 to 2).
pub fn exchanged(extras: &Extras, deployment: &Deployment, [a, b]: [usize; 2]) -> Extras {
    let mut extras = extras.clone();
    let now = effective(&extras, deployment);
    let before = now.stations.unwrap_or(AS_NUMBERED);
    let mut after = before;
    after.swap(a, b);
    extras.put_right.masked = now.masked;
    extras.put_right.renumber(before, after);
    extras
}

/// The extras with these readings left out, or used again.
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
    extras.put_right.masked = Some(masks);
    extras
}

/// Text files round stamps to microseconds: a mask from one may be that far from the reading that it leaves out.
fn is_near(a: &MaskedReading, b: &MaskedReading) -> bool {
    a.station == b.station && (a.time_s - b.time_s).abs() < 2e-6
}

/// Whether this very reading is masked; one outside of the span that is used is not.
pub fn is_masked(extras: &Extras, deployment: &Deployment, picked: Picked) -> bool {
    let masks = extras.put_right.masked.as_ref().or(deployment.as_read.masked.as_ref());
    let Some(time_s) = picked.time_s(deployment) else { return false };
    let mask = MaskedReading { station: picked.station as u8 + 1, time_s };
    masks.into_iter().flatten().any(|other| is_near(other, &mask))
}

/// Readings of a station within a span of time (s).
pub fn within(deployment: &Deployment, station: usize, [from_s, to_s]: [f64; 2]) -> Vec<Picked> {
    let readings = deployment.tracks.get(station).map_or(&[][..], |track| &track.measurements);
    let from = readings.partition_point(|m| m.time_s < from_s);
    let to = readings.partition_point(|m| m.time_s <= to_s).max(from);
    (from..to).map(|index| Picked { station, index }).collect()
}

/// The extras with only this span of time used, or all of it.
pub fn with_span(extras: &Extras, open: &OpenDeployment, span_s: Option<[f64; 2]>) -> Extras {
    let mut extras = extras.clone();
    // Where the folder names a span, only another one can be said over it.
    let all = || open.deployment.as_read.span_s.map(|_| open.timeline.whole_s);
    extras.put_right.span_s = span_s.or_else(all);
    extras
}

/// The extras without one of the control-point files that are used now.
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
            extras.put_right.control_points = Some(others);
        }
    }
    extras
}

/// The answer to which files hold the tracks.
pub fn one_or_many(mut files: Vec<String>) -> OneOrMany {
    match files.pop() {
        Some(only) if files.is_empty() => OneOrMany::One(only),
        last => OneOrMany::Many(files.into_iter().chain(last).collect()),
    }
}
