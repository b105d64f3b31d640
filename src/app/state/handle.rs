//! Carrying out commands.

use std::sync::Arc;

use super::State;
use super::put_right::{self, Extra};
use crate::app::layout::Layout;
use crate::app::model::undo::{Change, Changed, Moment};
use crate::app::model::{Command, Lookup, Overlay, Palette, Pane, Picked, Timeline, studies};
use crate::app::{theme, words};
use resect_core::analysis::Settings;
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;
use resect_io::source::Source;

impl State {
    /// Carries out a command.
    pub fn handle(&mut self, command: Command, ctx: &egui::Context) {
        match command {
            Command::OpenPaths(paths) => self.look_at(paths),
            Command::OpenSource(source) => self.open_source(source),
            Command::OpenSample(sample) => self.open_source(Source::sample(sample)),
            Command::CancelOpening(number) => self.cancel_opening(number),
            Command::OpenFolderDialog => self.open_folder_dialog(),
            Command::OpenFileDialog => self.open_file_dialog(),
            Command::Prompt(command) => self.answer_prompt(command),
            Command::OpenSessionDialog => self.open_session_dialog(),
            Command::ReopenLast => self.reopen_last(),
            Command::DiscardRecovered => self.discard_recovered(),
            Command::SaveSession => self.save_session(false),
            Command::SaveSessionAs => self.save_session(true),
            Command::HoverPaths(paths) => self.hover_paths(paths),
            Command::RetryMissing => self.retry_missing(),
            Command::ForgetMissing(index) => {
                if index < self.session.missing.len() {
                    let missing = self.session.missing.remove(index);
                    self.toasts.settled(&missing.saved.source.place);
                }
            }
            Command::Activate(id) => {
                if let Some(index) = self.open.iter().position(|open| open.id == id) {
                    self.show(index);
                    self.session.keep_shown(id);
                }
            }
            Command::Close(id) => self.close(id),

            Command::Set(settings) => {
                self.change_active(settings, Moment::now(ctx));
            }
            Command::SetAll => {
                let ids: Vec<u64> = self.open.iter().map(|open| open.id).collect();
                self.change(&ids, *self.settings(), Moment::now(ctx));
            }
            Command::CancelAnalysis(id) => self.cancel_analysis(id),
            Command::Undo => {
                // What is not done yet is not done.
                if self.take_back_pending() {
                    return;
                }
                let step = self.undo.undo().cloned();
                self.go(step.map_or_else(Vec::new, |step| step.changes), 0);
            }
            Command::Redo => {
                let step = self.undo.redo().cloned();
                self.go(step.map_or_else(Vec::new, |step| step.changes), 1);
            }

            Command::PutRight(extras) => self.put_right(extras),
            Command::ShowPutRight => {
                self.layout.show(Pane::Deployment);
                put_right::unfold(ctx);
            }
            Command::ChooseRigDialog => self.choose_extra_dialog(Extra::Rig),
            Command::AddControlPointsDialog => self.choose_extra_dialog(Extra::ControlPoints),
            Command::WriteDeploymentToml => self.propose_deployment_toml(),
            Command::EditAsked(asked) => self.edit_asked(asked),
            Command::AnswerAsked(answer) => self.answer_asked(answer),
            Command::CancelAsked => self.cancel_asked(),

            Command::Pin => self.pin_active(),
            Command::PinRun(id) => self.pin_run(id),
            Command::Unpin(id) => self.results.pins.retain(|pin| pin.id != id),
            Command::ShowPin(id, shown) => {
                if let Some(pin) = self.results.pins.iter_mut().find(|pin| pin.id == id) {
                    pin.shown = shown;
                }
            }
            Command::UsePinned(id) => {
                if let Some(settings) = self.settings_of_pin(id) {
                    self.change_active(settings, Moment::now(ctx));
                }
            }
            Command::RestoreRun(id) => {
                if let Some(settings) = self.results.run(id).map(|run| run.settings) {
                    self.change_active(settings, Moment::now(ctx));
                }
            }

            Command::Hover(time_s) => self.hover_s = Some(time_s),
            Command::MoveCursor(time_s) => self.with_timeline(|timeline, _| {
                timeline.move_cursor(time_s);
            }),
            Command::StepCursor(steps) => self.step_cursor(steps),
            Command::ShowTimes(span_s) => self.with_timeline(|timeline, _| timeline.show(span_s)),
            Command::ShowAllTimes => self.with_timeline(|timeline, _| timeline.show_all()),
            Command::Select(span_s) => self.with_timeline(|timeline, _| timeline.select(span_s)),
            Command::ZoomToSelection => self.with_timeline(|timeline, _| {
                if let Some(span_s) = timeline.selection_s {
                    timeline.show(span_s);
                }
            }),
            Command::TogglePlay => {
                if let Some(open) = self.open.get_mut(self.active) {
                    self.playback.toggle(&mut open.timeline);
                }
            }
            Command::SetPlaySpeed(speed) => self.playback.speed = speed,
            Command::PickInScene(picked) => {
                // Who picks a reading asks about it; where no pane tells, none is forced upon the user.
                if self.layout.holds(Pane::Reading) {
                    self.layout.show(Pane::Reading);
                }
                self.pick(picked);
            }
            Command::PickInPlot(picked) => {
                self.fly_to(picked);
                self.pick(picked);
            }
            Command::LookAtTimes(span_s) => self.look_at_times(span_s),
            Command::LookAtPoint { file, marker } => self.look_at_point(&file, marker),
            Command::Unpick => self.with_timeline(|timeline, _| timeline.picked = None),

            Command::Plot(plotted) => {
                self.plotted = plotted;
                self.layout.show(Pane::Channels);
            }
            Command::Show(visibility) => self.visibility = visibility,
            Command::Colour(colouring) => self.colouring = colouring,
            Command::SetScene(options) => self.scene = options,
            Command::Measure(ruler) => self.ruler = ruler,
            Command::SetUnits(units) => self.units = units,
            Command::UseTheme(theme) => {
                ctx.set_theme(theme);
                self.theme = theme;
            }
            Command::ReadInTheSun(on) => {
                theme::in_the_sun(ctx, on);
                self.in_the_sun = on;
            }
            Command::Look(preset) => self.look(preset),
            Command::ComeTo(position_m) => self.come_to(&position_m),
            Command::ShowPane(pane) => self.layout.show(pane),
            Command::UseLayout(preset) => self.layout = Layout::from(preset),
            Command::ResetLayout => self.layout = Layout::default(),
            Command::ShowPalette => self.overlay = Overlay::Palette(Palette::default()),
            Command::EditPalette(palette) => self.overlay = Overlay::Palette(palette),
            Command::ShowShortcuts => self.overlay = Overlay::Shortcuts,
            Command::Explain => {
                let of = words::pointed_at(ctx);
                self.overlay = Overlay::Glossary(Lookup { of, ..Lookup::default() });
            }
            Command::LookUp(lookup) => self.overlay = Overlay::Glossary(lookup),
            Command::CloseOverlay => self.overlay = Overlay::None,

            Command::ScenePicture(to) => {
                self.layout.show(Pane::Scene);
                self.wanted_picture = Some(to);
                ctx.request_repaint();
            }
            Command::Copy(text) => {
                ctx.copy_text(text);
                self.toasts.done("copied");
            }
            Command::CopyTransforms(format, part) => {
                if let Some(summary) = self.active().and_then(|open| open.summary.as_ref()) {
                    ctx.copy_text(resect_report::copy::text(format, summary, part));
                    self.toasts.done(format!("copied as {}", format.title()));
                }
            }
            Command::OpenInRerun => self.with_analysis(|deployment, analysis| {
                let result = resect_report::rerun::open_viewer(&deployment, &analysis)
                    .map(|()| "shown in the Rerun viewer".to_owned())
                    .map_err(|error| error.to_string());
                Some(result)
            }),
            Command::SaveRecordingDialog => self.save_recording(),
            Command::SaveTrajectoryDialog => self.save_trajectory(),
            Command::SaveReportDialog => self.save_report(),
            Command::SaveChannelsDialog => self.save_channels(),

            Command::AddEstimates(paths) => self.add_estimates(paths),
            Command::AddEstimateDialog => self.add_estimate_dialog(),
            Command::Judge(added) => self.judge(added, Moment::now(ctx)),
            Command::PlotWay(plots) => self.way_plots = plots,

            Command::Plan(command) => self.handle_plan(command, Moment::now(ctx)),
            Command::Live(command) => self.handle_live(command),

            Command::ValidateOthers => self.validate_others(),

            Command::SetStudy(options) => self.studies.options = options.within_bounds(),
            Command::RunStudy => self.run_study(),
            Command::CancelStudy => {
                if let Some((_, progress)) = &self.studies.running {
                    progress.cancel();
                }
            }
            Command::SaveStudyDialog => self.save_study(),
            Command::DismissToast(id) => self.toasts.dismiss(id),
            Command::HoldToast(id) => self.toasts.hold(id),
        }
    }

    /// Shows an open deployment. What was played or measured in another means nothing in it.
    pub(super) fn show(&mut self, index: usize) {
        self.active = index;
        self.playback.playing = false;
        self.ruler.ends.clear();
    }

    /// Gives the active deployment new settings; without one, the next that is opened.
    pub(super) fn change_active(&mut self, settings: Settings, moment: Moment) {
        match self.active().map(|open| open.id) {
            Some(id) => self.change(&[id], settings, moment),
            None => self.start_settings = settings,
        }
    }

    /// Gives deployments new settings as one step that can be undone.
    pub(super) fn change(&mut self, ids: &[u64], settings: Settings, moment: Moment) {
        let changes: Vec<Change> = ids
            .iter()
            .filter_map(|&id| {
                let before = self.open.iter().find(|open| open.id == id)?.settings;
                let what = Changed::Settings([before, settings]);
                (before != settings).then_some(Change { id, what })
            })
            .collect();
        for change in &changes {
            self.set(change.id, settings);
        }
        self.undo.record(changes, moment);
    }

    /// Goes to one side of a step's changes: 0 is before them, 1 is after.
    fn go(&mut self, changes: Vec<Change>, side: usize) {
        // What changes is seen to change.
        let shown = self.active().map(|open| open.id);
        let first = changes.first().map(|change| change.id);
        let unseen = changes.iter().all(|change| Some(change.id) != shown);
        for change in changes {
            match change.what {
                Changed::Settings(both) => self.set(change.id, both[side]),
                Changed::Extras { both, .. } => {
                    self.read_with(change.id, both[side].clone(), false);
                }
                Changed::Judged { both, .. } => {
                    let [before, after] = *both;
                    let (from, to) = if side == 0 { (after, before) } else { (before, after) };
                    self.with_open(change.id, |open| {
                        open.judging.set(open.judging.after_step(&from, to));
                    });
                }
                Changed::Plan { both, .. } => self.planning.set(both[side].clone()),
            }
        }
        if let Some(id) = first.filter(|_| unseen)
            && let Some(index) = self.open.iter().position(|open| open.id == id)
        {
            self.show(index);
        }
    }

    fn set(&mut self, id: u64, settings: Settings) {
        let Some(index) = self.open.iter().position(|open| open.id == id) else { return };
        let open = &mut self.open[index];
        if open.settings != settings {
            open.settings = settings;
            open.placeholder = false;
            self.analyse(index);
        }
    }

    pub(super) fn close(&mut self, id: u64) {
        let Some(index) = self.open.iter().position(|open| open.id == id) else { return };
        self.open.remove(index);
        self.analyser.forget(id);
        self.session.files.remove(&id);
        self.undo.forget(id);
        self.toasts.closed(id);
        // The one shown stays shown; of a closed one, its neighbour.
        if index == self.active {
            self.show(index.min(self.open.len().saturating_sub(1)));
        } else if index < self.active {
            self.active -= 1;
        }
    }

    pub(super) fn with_timeline(&mut self, change: impl FnOnce(&mut Timeline, &Deployment)) {
        if let Some(open) = self.open.get_mut(self.active) {
            change(&mut open.timeline, &open.deployment);
        }
    }

    fn pick(&mut self, picked: Picked) {
        self.with_timeline(|timeline, deployment| {
            if let Some(time_s) = picked.time_s(deployment) {
                timeline.picked = Some(picked);
                timeline.move_cursor(time_s);
                timeline.bring_into_view(time_s);
            }
        });
    }

    /// Moves the time cursor so many triplets further on; without triplets by tenths of a second.
    fn step_cursor(&mut self, steps: i32) {
        let Some(open) = self.open.get_mut(self.active) else { return };
        let timeline = &mut open.timeline;
        let from_s = timeline.cursor_s.unwrap_or(timeline.whole_s[0]);
        let time_s = open.analysis.as_ref().map(|analysis| &analysis.triplets().time_s);
        let to_s = match time_s.filter(|time_s| !time_s.is_empty()) {
            Some(time_s) => {
                // The first after the cursor, or the last before it, is one step away.
                let after = time_s.partition_point(|t| *t <= from_s) as i64;
                let before = time_s.partition_point(|t| *t < from_s) as i64;
                let steps = i64::from(steps);
                let index = if steps > 0 { after + steps - 1 } else { before + steps };
                time_s[index.clamp(0, time_s.len() as i64 - 1) as usize]
            }
            None => from_s + 0.1 * f64::from(steps),
        };
        timeline.move_cursor(to_s);
        timeline.bring_into_view(to_s);
    }

    fn run_study(&mut self) {
        let options = self.studies.options;
        let deployments: Vec<Arc<Deployment>> = if options.all_open {
            let named = self.open.iter().zip(self.names());
            named.map(|(open, name)| open.named(name)).collect()
        } else {
            self.active().map(|open| Arc::clone(&open.deployment)).into_iter().collect()
        };
        let settings = *self.settings();
        let progress = Arc::new(Progress::default());
        let shared = Arc::clone(&progress);
        let number = self.jobs.start(
            move || studies::run(&options, &deployments, &settings, &shared).map(Arc::new),
            Self::take_studied,
        );
        self.studies.running = Some((number, progress));
    }
}
