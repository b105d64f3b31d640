//! Save dialogs, and the files that they write.

use std::path::Path;
use std::sync::Arc;

use super::State;
use crate::app::file_dialog::{Answer, Question, Wanted};
use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;
use resect_core::evaluation::vehicle::{Instants, PoseLimits, prism_by, trajectory_by};
use resect_core::network::Prism;
use resect_io::atomic;
use resect_io::file_mark::{FileMark, marks_of};
use resect_report::copy::{CopiedTransforms, CopyFormat};
use resect_report::of_run;
use resect_report::report;
use resect_report::report::{Chapter, EvaluationChapter};
use resect_report::trajectory::{FileKind, STATION1};
use resect_tools::estimates::GroundTruth;

/// A line for the user, or the error; `None` if the user cancelled.
type Told = Option<Result<String, String>>;

impl State {
    pub(super) fn open_folder_dialog(&mut self) {
        let wanted = Wanted::ToOpen { folder: true };
        self.open_picked(Question::new("Open a deployment's folder", wanted));
    }

    pub(super) fn open_file_dialog(&mut self) {
        let question =
            Question::new("Open a deployment's tracks", Wanted::ToOpen { folder: false });
        self.open_picked(question.kinds(&[("Tracks (bag, csv)", &["bag", "csv"])]));
    }

    pub(super) fn open_session_dialog(&mut self) {
        let question = Question::new("Open a session", Wanted::Saved);
        self.open_picked(question.kinds(&[("Sessions (toml)", &["toml"])]));
    }

    fn open_picked(&mut self, question: Question) {
        let answer = self.ask(question);
        self.jobs.start_unnumbered(
            move || answer.wait(),
            |state: &mut Self, path| state.look_at(vec![path]),
        );
    }

    /// Asks for a file named after the deployment.
    pub(super) fn ask_where(&mut self, title: &str, extension: &str) -> Answer {
        let name = self.active().map_or("resect", |open| open.deployment.name.as_str());
        self.ask(Question::new_file(title, name, extension))
    }

    pub(super) fn copy_transforms(
        &mut self,
        format: CopyFormat,
        copied: CopiedTransforms,
        ctx: &egui::Context,
    ) {
        if let Some(summary) = self.active().and_then(|open| open.summary.as_ref()) {
            ctx.copy_text(resect_report::copy::text(format, summary, copied));
            self.toasts.done(format!("copied as {}", format.title()));
        }
    }

    pub(super) fn open_in_rerun(&self) {
        self.with_analysis(|deployment, analysis| {
            let result = resect_report::rerun::open_viewer(&deployment, &analysis)
                .map(|()| "shown in the Rerun viewer".to_owned())
                .map_err(|error| error.to_string());
            Some(result)
        });
    }

    pub(super) fn save_recording(&mut self) {
        self.save_of_analysis("Save a recording for Rerun", "rrd", |path, deployment, analysis| {
            resect_report::rerun::save(&deployment, &analysis, path)
                .map_err(|error| error.to_string())
        });
    }

    pub(super) fn save_trajectory(&mut self) {
        let title = "Save the vehicle's trajectory (.tum, .csv, .ply, .mcap or .bag)";
        self.save_of_analysis(title, "tum", |path, deployment, analysis| {
            let kind = FileKind::of(path).map_err(|why| why.to_string())?;
            let content = trajectory_file(kind, &deployment, &analysis)?;
            atomic::write(path, content).map_err(|error| error.to_string())
        });
    }

    pub(super) fn save_report(&mut self) {
        let judgement = self.active().and_then(|open| {
            let of = (open.analysis_run, open.judging.version);
            open.judging.judgement.newest.clone().filter(|_| open.judging.judgement.is_of(of))
        });
        let title = "Save the report (HTML)";
        self.save_of_analysis(title, "html", move |path, deployment, analysis| {
            let mut files = marks_of(&deployment);
            let chapter = match (GroundTruth::of(&deployment, &analysis, None), judgement) {
                (truth @ GroundTruth::Trajectory(..), Some(judgement)) => {
                    let paths = judgement.judged.iter().map(|one| &one.estimate.path);
                    files.extend(paths.filter_map(|path| FileMark::of(path).ok()));
                    let evaluation = EvaluationChapter::of(&truth, judgement, files);
                    Chapter::Evaluated(Box::new(evaluation))
                }
                (_, judgement) => {
                    let (deployment, analysis) =
                        (Arc::clone(&deployment), Box::new(Analysis::clone(&analysis)));
                    Chapter::Analysed { deployment, analysis, files, judgement }
                }
            };
            let page = report::page(&[chapter], of_run::date());
            atomic::write(path, page).map_err(|error| error.to_string())
        });
    }

    /// Asks for a file and writes it from the active deployment's result.
    fn save_of_analysis(
        &mut self,
        title: &str,
        extension: &str,
        write: impl FnOnce(&Path, Arc<Deployment>, Arc<Analysis>) -> Result<(), String> + Send + 'static,
    ) {
        if self.analysed().is_none() {
            self.toasts.error("there is no result to save yet; open a deployment first");
            return;
        }
        let answer = self.ask_where(title, extension);
        self.with_analysis(move |deployment, analysis| {
            let path = answer.wait()?;
            let written = write(&path, deployment, analysis);
            Some(written.map(|()| format!("{} written", path.display())))
        });
    }

    pub(super) fn with_analysis(
        &self,
        job: impl FnOnce(Arc<Deployment>, Arc<Analysis>) -> Told + Send + 'static,
    ) {
        if let Some((open, analysis)) = self.analysed() {
            let (deployment, analysis) = (Arc::clone(&open.deployment), Arc::clone(analysis));
            self.tell_when_done(move || job(deployment, analysis));
        }
    }

    /// Runs a job in the background, and shows its result to the user.
    pub(super) fn tell_when_done(&self, job: impl FnOnce() -> Told + Send + 'static) {
        self.jobs.start_unnumbered(job, |state: &mut Self, told| match told {
            Ok(line) => state.toasts.done(line),
            Err(line) => state.toasts.error(&line),
        });
    }
}

fn trajectory_file(
    kind: FileKind,
    deployment: &Deployment,
    analysis: &Analysis,
) -> Result<Vec<u8>, String> {
    let answer = analysis.answer.as_ref().map_err(ToString::to_string)?;
    let calibration = &answer.calibration;
    let header = format!(
        "{}: frame of station 1, by {}, verdict {}",
        deployment.name,
        calibration.method_in_words(),
        calibration.verdict_in_words()
    );
    let (triplets, followed, wanted) =
        (analysis.triplets(), &analysis.offer.followed, Instants::Usual);
    if Prism::is_one(followed) {
        let positions = prism_by(deployment, triplets, calibration, wanted);
        let positions = positions.map_err(|why| why.to_string())?;
        return resect_report::trajectory::prism_file(kind, &positions, &header)
            .map_err(|why| why.to_string());
    }
    let (trajectory, _) =
        trajectory_by(deployment, triplets, followed, calibration, wanted, &PoseLimits::default())
            .map_err(|why| why.to_string())?;
    resect_report::trajectory::file(kind, &trajectory, &header, STATION1)
        .map_err(|why| why.to_string())
}
