//! States that the monkey has reached: one that reaches nothing breaks nothing, and must not pass.

use std::collections::BTreeSet;

use resect::app::{Asked, Overlay, Pane, State};

#[derive(Default)]
pub struct Reached(BTreeSet<String>);

impl Reached {
    /// Records the visible states.
    pub fn look(&mut self, state: &State) {
        let mut note = |what: &str| {
            if !self.0.contains(what) {
                self.0.insert(what.to_owned());
            }
        };
        match &state.dialogs.overlay {
            Overlay::None => {}
            Overlay::Palette(_) => note("command palette"),
            Overlay::Shortcuts => note("shortcuts"),
            Overlay::Glossary(_) => note("glossary"),
            Overlay::Licences(_) => note("licences"),
            Overlay::Closing => note("closing"),
            Overlay::Picture(_) => note("picture"),
        }
        match state.asked() {
            None => {}
            Some(Asked::Tracks(_)) => note("question: tracks"),
            Some(Asked::Stations(_)) => note("question: stations"),
            Some(Asked::Columns(_)) => note("question: columns"),
            Some(Asked::Files(_)) => note("question: files"),
            Some(Asked::Toml(_)) => note("question: deployment.toml"),
        }
        let shown =
            |pane: &&Pane| state.workspace.layout.place(**pane).is_some_and(|it| it.is_positive());
        Pane::ALL.iter().filter(shown).for_each(|pane| note(&format!("pane {pane:?}")));
        let others = [
            ("prompt", state.dialogs.prompt.is_some()),
            (
                "prompt: overwrite",
                state.dialogs.prompt.as_ref().is_some_and(|it| it.shown.overwrite.is_some()),
            ),
            ("two open", state.deployments.open.len() > 1),
            ("pin", !state.results.pins.is_empty()),
            ("several runs", state.results.runs.len() > 3),
            ("undo", state.deployments.undo.next_redo().is_some()),
            ("study", state.results.studies.result.is_some()),
            ("study runs", state.results.studies.running.is_some()),
            ("missing", !state.session.missing.is_empty()),
            ("recovered", state.session.recovered),
            ("playing", state.time.playback.playing),
            ("selection", state.active().is_some_and(|open| open.timeline.selection_s.is_some())),
            ("picked", state.active().is_some_and(|open| open.timeline.picked.is_some())),
            ("ruler", !state.scene.ruler.ends.is_empty()),
            ("written", state.toasts.shown().iter().any(|it| it.text.contains("written"))),
            ("error", state.toasts.errors().next().is_some()),
        ];
        others.into_iter().filter(|other| other.1).for_each(|other| note(other.0));
    }

    pub fn count(&self) -> usize {
        self.0.len()
    }
}

impl std::fmt::Display for Reached {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let all: Vec<&str> = self.0.iter().map(String::as_str).collect();
        f.write_str(&all.join(", "))
    }
}
