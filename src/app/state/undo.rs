//! Undo and redo of settings.
//!
//! A drag sends many settings; it is one step. egui's own `Undoer` merges whatever comes within a second, also two
//! different switches, and cannot name a step; this one merges changes of the same setting only.

use eframe::egui;

use crate::analysis::{Settings, changes_in_words, setting_changes};

/// Changes of the same setting that come this soon after each other (s) are one step: a key held down.
const SAME_STEP_S: f64 = 0.5;
/// Nobody goes back further.
const MOST_STEPS: usize = 500;

/// What one deployment's settings were and became.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// Id of the deployment.
    pub id: u64,
    pub before: Settings,
    pub after: Settings,
}

/// What is undone at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    pub changes: Vec<Change>,
    /// When it was last added to (s of the window's clock).
    at_s: f64,
}

/// When a change comes.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Of the window's clock (s).
    pub now_s: f64,
    /// Since when the pointer's button is down, if it is (s).
    pub pressed_s: Option<f64>,
}

impl Moment {
    /// Of a change that is a step of its own.
    pub const NEVER: Self = Self { now_s: f64::NEG_INFINITY, pressed_s: None };

    pub fn now(ctx: &egui::Context) -> Self {
        ctx.input(|input| Self {
            now_s: input.time,
            pressed_s: input.pointer.press_start_time().filter(|_| input.pointer.any_down()),
        })
    }
}

#[derive(Debug, Default)]
pub struct UndoStack {
    done: Vec<Step>,
    undone: Vec<Step>,
    /// Counts steps ever begun: results that came of one step are one run.
    begun: u64,
}

impl UndoStack {
    /// Adds changes made at the same moment.
    pub fn record(&mut self, changes: Vec<Change>, moment: Moment) {
        if changes.is_empty() {
            return;
        }
        self.undone.clear();
        if let Some(last) = self.done.last_mut()
            && last.continues(&changes, moment)
        {
            for (change, new) in last.changes.iter_mut().zip(&changes) {
                change.after = new.after;
            }
            last.at_s = moment.now_s;
            if last.changes.iter().all(|change| change.before == change.after) {
                self.done.pop();
            }
            return;
        }
        self.begun += 1;
        self.done.push(Step { changes, at_s: moment.now_s });
        if self.done.len() > MOST_STEPS {
            self.done.remove(0);
        }
    }

    /// Takes the last step back; gives it.
    pub fn undo(&mut self) -> Option<&Step> {
        self.undone.push(self.done.pop()?);
        self.begun += 1;
        self.undone.last()
    }

    /// Does the step again that was taken back last; gives it.
    pub fn redo(&mut self) -> Option<&Step> {
        self.done.push(self.undone.pop()?);
        self.begun += 1;
        self.done.last()
    }

    /// What undo would take back.
    pub fn next_undo(&self) -> Option<&Step> {
        self.done.last()
    }

    /// What redo would do again.
    pub fn next_redo(&self) -> Option<&Step> {
        self.undone.last()
    }

    /// "Undo τ_r 2 → 1.5 m/s", or only "Undo".
    pub fn undo_name(&self) -> String {
        name("Undo", self.next_undo())
    }

    pub fn redo_name(&self) -> String {
        name("Redo", self.next_redo())
    }

    /// Changes whenever a step begins.
    pub fn begun(&self) -> u64 {
        self.begun
    }

    /// Lets go of a deployment that was closed.
    pub fn forget(&mut self, id: u64) {
        for steps in [&mut self.done, &mut self.undone] {
            for step in steps.iter_mut() {
                step.changes.retain(|change| change.id != id);
            }
            steps.retain(|step| !step.changes.is_empty());
        }
    }
}

impl Step {
    fn continues(&self, changes: &[Change], moment: Moment) -> bool {
        let in_time = (0.0..SAME_STEP_S).contains(&(moment.now_s - self.at_s))
            || moment.pressed_s.is_some_and(|pressed_s| self.at_s >= pressed_s);
        let same = self.changes.len() == changes.len()
            && self.changes.iter().zip(changes).all(|(a, b)| a.id == b.id && same_setting(a, b));
        in_time && same
    }
}

fn name(verb: &str, step: Option<&Step>) -> String {
    let Some(change) = step.and_then(|step| step.changes.first()) else { return verb.to_owned() };
    format!("{verb} {}", changes_in_words(&setting_changes(&change.before, &change.after)))
}

/// Whether two changes turn the same knobs.
fn same_setting(a: &Change, b: &Change) -> bool {
    touched(a) == touched(b)
}

fn touched(change: &Change) -> Vec<&'static str> {
    setting_changes(&change.before, &change.after).iter().map(|change| change.name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(tau_r: f64, tau_l: f64) -> Settings {
        let mut settings = Settings::default();
        settings.pipeline.thresholds.tau_r_m_per_s = tau_r;
        settings.pipeline.thresholds.tau_l_seconds = tau_l;
        settings
    }

    fn change(before: Settings, after: Settings) -> Vec<Change> {
        vec![Change { id: 1, before, after }]
    }

    fn at(now_s: f64, pressed_s: Option<f64>) -> Moment {
        Moment { now_s, pressed_s }
    }

    #[test]
    fn a_drag_is_one_step_however_long_it_rests() {
        let mut stack = UndoStack::default();
        stack.record(change(with(2.0, 6.0), with(1.8, 6.0)), at(10.0, Some(9.9)));
        stack.record(change(with(1.8, 6.0), with(1.5, 6.0)), at(14.0, Some(9.9)));
        // The next drag of the same line is a step of its own.
        stack.record(change(with(1.5, 6.0), with(1.0, 6.0)), at(20.0, Some(19.9)));
        let step = stack.undo().expect("two steps");
        assert_eq!(
            (step.changes[0].before, step.changes[0].after),
            (with(1.5, 6.0), with(1.0, 6.0))
        );
        let step = stack.undo().expect("one step");
        assert_eq!(
            (step.changes[0].before, step.changes[0].after),
            (with(2.0, 6.0), with(1.5, 6.0))
        );
        assert!(stack.undo().is_none());
        assert_eq!(stack.redo().expect("undone").changes[0].after, with(1.5, 6.0));
    }

    #[test]
    fn what_comes_at_no_time_is_a_step_of_its_own() {
        let mut stack = UndoStack::default();
        stack.record(change(with(2.0, 6.0), with(1.0, 6.0)), at(1.0, None));
        stack.record(change(with(1.0, 6.0), with(0.5, 6.0)), Moment::NEVER);
        assert_eq!(stack.undo().expect("two").changes[0].before, with(1.0, 6.0));
    }

    #[test]
    fn different_settings_are_different_steps_however_quick() {
        let mut stack = UndoStack::default();
        stack.record(change(with(2.0, 6.0), with(1.0, 6.0)), at(1.0, None));
        stack.record(change(with(1.0, 6.0), with(1.0, 9.0)), at(1.1, None));
        assert_eq!(stack.undo().expect("two").changes[0].before, with(1.0, 6.0));
        assert_eq!(stack.undo().expect("one").changes[0].before, with(2.0, 6.0));
    }

    #[test]
    fn there_and_back_is_no_step_and_a_new_change_ends_redo() {
        let mut stack = UndoStack::default();
        stack.record(change(with(2.0, 6.0), with(1.0, 6.0)), at(1.0, None));
        stack.record(change(with(1.0, 6.0), with(2.0, 6.0)), at(1.2, None));
        assert!(stack.next_undo().is_none());
        stack.record(change(with(2.0, 6.0), with(1.0, 6.0)), at(5.0, None));
        stack.undo();
        assert!(stack.next_redo().is_some());
        stack.record(change(with(2.0, 6.0), with(2.0, 7.0)), at(9.0, None));
        assert!(stack.next_redo().is_none());
        stack.forget(1);
        assert!(stack.undo().is_none());
    }
}
