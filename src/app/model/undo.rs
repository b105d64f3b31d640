//! Undo and redo of settings, corrections of the data, evaluated trajectories, and the plan.
//!
//! A drag sends many settings, but is one step. egui's own `Undoer` merges all changes within a second, even of two
//! different switches, and cannot name a step. This stack merges only changes of the same setting.

use super::Units;
use super::judging::Added;
use resect_core::analysis::{Settings, setting_changes};
use resect_io::source::Extras;
use resect_tools::planning::Plan;

/// Longest pause between changes of the same setting in one step (s), as while a key repeats.
const SAME_STEP_S: f64 = 0.5;
/// Longest history (steps).
const MOST_STEPS: usize = 500;
/// Longest description of a step in a menu (characters).
const LONGEST_NAME: usize = 60;

/// A change of one deployment.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Id of the deployment.
    pub id: u64,
    pub what: Changed,
}

/// State before and after a change.
#[derive(Clone, Debug, PartialEq)]
#[expect(
    clippy::large_enum_variant,
    reason = "most changes are of settings, and a few hundred are kept"
)]
pub enum Changed {
    Settings([Settings; 2]),
    /// Extras beside the tracks, and a description of the change.
    Extras {
        both: Box<[Extras; 2]>,
        words: String,
    },
    /// Trajectories under evaluation, and a description of the change.
    Judged {
        both: Box<[Vec<Added>; 2]>,
        words: String,
    },
    /// The plan, which belongs to no deployment.
    Plan {
        both: Box<[Plan; 2]>,
        words: &'static str,
    },
}

impl Changed {
    /// Replaces the final state by that of a later change of the same settings.
    fn go_on(&mut self, later: &Self) {
        match (self, later) {
            (Self::Settings([_, after]), Self::Settings([_, new])) => *after = *new,
            (Self::Plan { both, .. }, Self::Plan { both: later, .. }) => both[1] = later[1].clone(),
            (Self::Judged { both, .. }, Self::Judged { both: later, .. }) => {
                both[1] = later[1].clone();
            }
            _ => {}
        }
    }

    fn is_none(&self) -> bool {
        match self {
            Self::Settings([before, after]) => before == after,
            Self::Plan { both, .. } => both[0] == both[1],
            Self::Judged { both, .. } => both[0] == both[1],
            Self::Extras { .. } => false,
        }
    }

    fn in_words(&self, units: Units) -> String {
        match self {
            Self::Settings([before, after]) => units.changes(before, after),
            Self::Extras { words, .. } | Self::Judged { words, .. } => words.clone(),
            Self::Plan { words, .. } => (*words).to_owned(),
        }
    }

    /// Returns the names of the changed settings, or the description of the change; `None` for extras, which are always a
    /// step of their own.
    fn touched(&self) -> Option<Vec<&str>> {
        match self {
            Self::Settings([before, after]) => {
                Some(setting_changes(before, after).iter().map(|change| change.name).collect())
            }
            Self::Plan { words, .. } => Some(vec![*words]),
            Self::Judged { words, .. } => Some(vec![words]),
            Self::Extras { .. } => None,
        }
    }
}

/// Changes that are undone together.
#[derive(Clone, Debug, PartialEq)]
pub struct UndoStep {
    pub changes: Vec<Change>,
    /// Time of the last change merged into the step (s, the window's clock).
    at_s: f64,
}

/// Time of a change.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Time of the change (s, the window's clock).
    pub now_s: f64,
    /// Time at which the pointer's button was pressed, while it is down (s, the window's clock).
    pub pressed_s: Option<f64>,
}

impl Moment {
    /// Time of a change that is always a step of its own.
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
    done: Vec<UndoStep>,
    undone: Vec<UndoStep>,
    /// Number of steps begun so far; the results of one step form one run.
    begun: u64,
}

impl UndoStack {
    /// Records simultaneous changes as a step, or merges them into the last one.
    pub fn record(&mut self, changes: Vec<Change>, moment: Moment) {
        if changes.is_empty() {
            return;
        }
        self.undone.clear();
        if let Some(last) = self.done.last_mut()
            && last.continues(&changes, moment)
        {
            for (change, new) in last.changes.iter_mut().zip(&changes) {
                change.what.go_on(&new.what);
            }
            last.at_s = moment.now_s;
            if last.changes.iter().all(|change| change.what.is_none()) {
                self.done.pop();
            }
            return;
        }
        self.begun += 1;
        self.done.push(UndoStep { changes, at_s: moment.now_s });
        if self.done.len() > MOST_STEPS {
            self.done.remove(0);
        }
    }

    /// Undoes the last step and returns it.
    pub fn undo(&mut self) -> Option<&UndoStep> {
        self.undone.push(self.done.pop()?);
        self.begun += 1;
        self.undone.last()
    }

    /// Redoes the step that was undone last and returns it.
    pub fn redo(&mut self) -> Option<&UndoStep> {
        self.done.push(self.undone.pop()?);
        self.begun += 1;
        self.done.last()
    }

    /// Returns the step that undo would revert.
    pub fn next_undo(&self) -> Option<&UndoStep> {
        self.done.last()
    }

    /// Returns the step that redo would apply.
    pub fn next_redo(&self) -> Option<&UndoStep> {
        self.undone.last()
    }

    /// Returns "Undo τ_r 2 → 1.5 m/s", or "Undo" if there is nothing to undo.
    pub fn undo_name(&self, units: Units) -> String {
        name("Undo", self.next_undo(), units)
    }

    pub fn redo_name(&self, units: Units) -> String {
        name("Redo", self.next_redo(), units)
    }

    /// Returns the number of steps begun so far.
    pub fn begun(&self) -> u64 {
        self.begun
    }

    /// Removes the changes of a closed deployment.
    pub fn forget(&mut self, id: u64) {
        self.keep(|change| change.id != id);
    }

    /// Removes the corrections of a deployment's data: its files contain them now, so undo could not revert them.
    pub fn forget_extras(&mut self, id: u64) {
        self.keep(|change| change.id != id || !matches!(change.what, Changed::Extras { .. }));
    }

    fn keep(&mut self, wanted: impl Fn(&Change) -> bool) {
        for steps in [&mut self.done, &mut self.undone] {
            for step in steps.iter_mut() {
                step.changes.retain(&wanted);
            }
            steps.retain(|step| !step.changes.is_empty());
        }
    }
}

impl UndoStep {
    fn continues(&self, changes: &[Change], moment: Moment) -> bool {
        let in_time = (0.0..SAME_STEP_S).contains(&(moment.now_s - self.at_s))
            || moment.pressed_s.is_some_and(|pressed_s| self.at_s >= pressed_s);
        let same = self.changes.len() == changes.len()
            && self.changes.iter().zip(changes).all(|(a, b)| a.id == b.id && same_setting(a, b));
        in_time && same
    }
}

fn name(verb: &str, step: Option<&UndoStep>, units: Units) -> String {
    let Some(change) = step.and_then(|step| step.changes.first()) else { return verb.to_owned() };
    let words = change.what.in_words(units);
    // Truncated so that menus stay narrow.
    match words.char_indices().nth(LONGEST_NAME) {
        Some((end, _)) => format!("{verb} {}…", words[..end].trim_end()),
        None => format!("{verb} {words}"),
    }
}

/// Returns true if both changes are of the same settings.
fn same_setting(a: &Change, b: &Change) -> bool {
    a.what.touched().is_some() && a.what.touched() == b.what.touched()
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
        vec![Change { id: 1, what: Changed::Settings([before, after]) }]
    }

    fn at(now_s: f64, pressed_s: Option<f64>) -> Moment {
        Moment { now_s, pressed_s }
    }

    #[test]
    fn a_drag_is_one_step_however_long_it_rests() {
        let mut stack = UndoStack::default();
        stack.record(change(with(2.0, 6.0), with(1.8, 6.0)), at(10.0, Some(9.9)));
        stack.record(change(with(1.8, 6.0), with(1.5, 6.0)), at(14.0, Some(9.9)));
        // The next drag of the same setting is a step of its own.
        stack.record(change(with(1.5, 6.0), with(1.0, 6.0)), at(20.0, Some(19.9)));
        let step = stack.undo().expect("two steps");
        assert_eq!(step.changes, change(with(1.5, 6.0), with(1.0, 6.0)));
        let step = stack.undo().expect("one step");
        assert_eq!(step.changes, change(with(2.0, 6.0), with(1.5, 6.0)));
        assert!(stack.undo().is_none());
        let again = stack.redo().expect("undone");
        assert_eq!(again.changes, change(with(2.0, 6.0), with(1.5, 6.0)));
    }

    #[test]
    fn what_comes_at_no_time_is_a_step_of_its_own() {
        let mut stack = UndoStack::default();
        stack.record(change(with(2.0, 6.0), with(1.0, 6.0)), at(1.0, None));
        stack.record(change(with(1.0, 6.0), with(0.5, 6.0)), Moment::NEVER);
        let step = stack.undo().expect("two");
        let Changed::Settings([before, _]) = step.changes[0].what else { panic!("settings") };
        assert_eq!(before, with(1.0, 6.0));
    }

    #[test]
    fn different_settings_are_different_steps_however_quick() {
        let mut stack = UndoStack::default();
        stack.record(change(with(2.0, 6.0), with(1.0, 6.0)), at(1.0, None));
        stack.record(change(with(1.0, 6.0), with(1.0, 9.0)), at(1.1, None));
        let step = stack.undo().expect("two");
        let Changed::Settings([before, _]) = step.changes[0].what else { panic!("settings") };
        assert_eq!(before, with(1.0, 6.0));
        let step = stack.undo().expect("one");
        assert_eq!(step.changes, change(with(2.0, 6.0), with(1.0, 6.0)));
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

    #[test]
    fn a_correction_has_a_name_and_shares_the_stack() {
        let mut stack = UndoStack::default();
        stack.record(change(with(2.0, 6.0), with(1.0, 6.0)), at(1.0, None));
        let mut extras = Extras::default();
        extras.corrections.stations = Some([1, 3, 2].into());
        let words = "station numbers 1 2 3 → 1 3 2".to_owned();
        let what = Changed::Extras { both: Box::new([Extras::default(), extras]), words };
        stack.record(vec![Change { id: 1, what }], at(1.1, None));
        assert_eq!(stack.undo_name(Units::default()), "Undo station numbers 1 2 3 → 1 3 2");
        stack.undo();
        assert_eq!(stack.undo_name(Units::default()), "Undo τ_r 2 → 1 m/s");
        stack.redo();
        stack.forget_extras(1);
        assert_eq!(stack.undo_name(Units::default()), "Undo τ_r 2 → 1 m/s");
        let what = Changed::Extras { both: Box::default(), words: "reading left out, ".repeat(9) };
        stack.record(vec![Change { id: 1, what }], Moment::NEVER);
        assert!(
            stack.undo_name(Units::default()).chars().count() < 70,
            "{}",
            stack.undo_name(Units::default())
        );
    }
}
