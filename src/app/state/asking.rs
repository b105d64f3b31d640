//! Path dialogs, of the system or inside the window.

use std::path::{Path, PathBuf};
use std::sync::mpsc::channel;

use super::State;
use super::dialogs::OpenPrompt;
use crate::app::file_dialog::{
    Answer, Listing, PathPrompt, PromptCommand, PromptStep, Question, Wanted, system,
};

impl State {
    /// Asks for a path. Cancels a prompt that is still open.
    pub(super) fn ask(&mut self, question: Question) -> Answer {
        if self.dialogs.system.is_ready() {
            return Answer::OfSystem(system::ask(&question));
        }
        let (answer, receiver) = channel();
        let folder = self.last_folder(&question.wanted).clone();
        let folder = folder.or_else(|| std::env::current_dir().ok());
        let recent = self.session.recent.iter().zip(self.session.recent_names());
        let recent = recent.filter_map(|(it, name)| Some((name, it.source.path()?.to_owned())));
        let (shown, step) = PathPrompt::new(question, folder.unwrap_or_default(), recent.collect());
        self.dialogs.prompt = Some(OpenPrompt { shown, answer });
        self.follow(step);
        Answer::OfWindow(receiver)
    }

    /// Returns the last folder chosen for this purpose. Files are not saved to the data's folder by default.
    fn last_folder(&mut self, wanted: &Wanted) -> &mut Option<PathBuf> {
        match wanted {
            Wanted::ToOpen { .. } => &mut self.dialogs.last_folder_opened,
            Wanted::Saved | Wanted::Folder | Wanted::NewFile { .. } => {
                &mut self.dialogs.last_folder_saved
            }
        }
    }

    pub(super) fn answer_prompt(&mut self, command: PromptCommand) {
        if let Some(prompt) = &mut self.dialogs.prompt {
            let step = prompt.shown.handle(command);
            self.follow(step);
        }
    }

    fn follow(&mut self, step: PromptStep) {
        match step {
            PromptStep::Stay => {}
            PromptStep::Read(folder) => {
                self.jobs.start_unnumbered(
                    move || Some(Listing::read(&folder)),
                    |state: &mut Self, listing| {
                        if let Some(prompt) = &mut state.dialogs.prompt {
                            prompt.shown.take(listing);
                        }
                    },
                );
            }
            PromptStep::Chosen(path) => {
                if let Some(prompt) = self.dialogs.prompt.take() {
                    // A typed path may be in a folder that was not listed.
                    *self.last_folder(&prompt.shown.question.wanted) =
                        path.parent().map(Path::to_owned);
                    // The receiver may be gone.
                    prompt.answer.send(path).ok();
                }
            }
            PromptStep::Cancelled => self.dialogs.prompt = None,
        }
    }
}
