//! Dialogs, and what they save.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::State;
use crate::analysis::Analysis;
use crate::app::worker::Reply;
use crate::deployment::Deployment;
use crate::evaluation::vehicle::{LARGEST_POSE_ERROR_M, vehicle_trajectory};
use crate::export;
use crate::export::report::{self, Chapter};

/// A dialog that closes before this was never seen.
const QUICKEST_CANCEL: Duration = Duration::from_millis(300);

impl State {
    pub(super) fn open_folder_dialog(&self) {
        let dialog =
            rfd::AsyncFileDialog::new().set_title("Open a deployment's folder").pick_folder();
        self.open_picked(dialog);
    }

    pub(super) fn open_file_dialog(&self) {
        let dialog = rfd::AsyncFileDialog::new()
            .set_title("Open a deployment's tracks")
            .add_filter("Tracks (bag, csv)", &["bag", "csv"])
            .add_filter("All files", &["*"])
            .pick_file();
        self.open_picked(dialog);
    }

    fn open_picked(&self, dialog: impl Future<Output = Option<rfd::FileHandle>> + Send + 'static) {
        self.worker.beside(move || {
            let asked = Instant::now();
            match pollster::block_on(dialog) {
                Some(picked) => Some(Reply::Picked(picked.path().to_owned())),
                // rfd does not tell a cancelled dialog from one that the system cannot show; nobody cancels this fast.
                None if asked.elapsed() < QUICKEST_CANCEL => Some(Reply::Done(Err(
                    "this system shows no file dialog (no desktop portal, no zenity); drop the folder or bag on the \
                     window, or start with `resect PATH`"
                        .to_owned(),
                ))),
                None => None,
            }
        });
    }

    /// A dialog for a file named after the deployment.
    fn save_dialog(
        &self,
        title: &str,
        extension: &str,
    ) -> impl Future<Output = Option<rfd::FileHandle>> + use<> {
        let name = self.active().map_or("resect", |open| open.deployment.name.as_str());
        rfd::AsyncFileDialog::new()
            .set_title(title)
            .set_file_name(format!("{}.{extension}", name.replace('/', "_")))
            .save_file()
    }

    pub(super) fn save_recording(&self) {
        let dialog = self.save_dialog("Save a recording for Rerun", "rrd");
        self.with_analysis(move |deployment, analysis| {
            let path = pollster::block_on(dialog)?.path().to_owned();
            let result = export::rerun::save(&deployment, &analysis, &path)
                .map(|()| format!("{} written", path.display()))
                .map_err(|error| error.to_string());
            Some(Reply::Done(result))
        });
    }

    pub(super) fn save_trajectory(&self) {
        let dialog = self.save_dialog("Save the vehicle's trajectory (TUM)", "tum");
        self.with_analysis(move |deployment, analysis| {
            let path = pollster::block_on(dialog)?.path().to_owned();
            let result = trajectory_text(&deployment, &analysis).and_then(|text| {
                std::fs::write(&path, text)
                    .map(|()| format!("{} written", path.display()))
                    .map_err(|error| format!("{}: {error}", path.display()))
            });
            Some(Reply::Done(result))
        });
    }

    pub(super) fn save_picture(&self, image: Arc<image::RgbaImage>) {
        let dialog = self.save_dialog("Save the picture of the scene (PNG)", "png");
        self.worker.beside(move || {
            let path = pollster::block_on(dialog)?.path().to_owned();
            let result = image
                .save_with_format(&path, image::ImageFormat::Png)
                .map(|()| format!("{} written", path.display()))
                .map_err(|error| format!("{}: {error}", path.display()));
            Some(Reply::Done(result))
        });
    }

    pub(super) fn save_report(&self) {
        let dialog = self.save_dialog("Save the report (HTML)", "html");
        self.with_analysis(move |deployment, analysis| {
            let path = pollster::block_on(dialog)?.path().to_owned();
            let analysis = Box::new(Analysis::clone(&analysis));
            let page = report::page(&[Chapter::Analysed { deployment, analysis }]);
            let result = export::atomic::write(&path, &page)
                .map(|()| format!("{} written", path.display()))
                .map_err(|error| error.to_string());
            Some(Reply::Done(result))
        });
    }

    pub(super) fn save_study(&self) {
        let Some(result) = self.studies.result.clone() else { return };
        let dialog = rfd::AsyncFileDialog::new()
            .set_title("Save CSV, SVG and PNG into a folder")
            .pick_folder();
        self.worker.beside(move || {
            let folder = pollster::block_on(dialog)?.path().to_owned();
            let written = export::study::write(result.study(), &folder);
            Some(Reply::Done(
                written
                    .map(|files| format!("{} files written to {}", files.len(), folder.display()))
                    .map_err(|error| error.to_string()),
            ))
        });
    }

    pub(super) fn with_analysis(
        &self,
        job: impl FnOnce(Arc<Deployment>, Arc<Analysis>) -> Option<Reply> + Send + 'static,
    ) {
        if let Some((open, analysis)) = self.analysed() {
            let (deployment, analysis) = (Arc::clone(&open.deployment), Arc::clone(analysis));
            self.worker.beside(move || job(deployment, analysis));
        }
    }
}

fn trajectory_text(deployment: &Deployment, analysis: &Analysis) -> Result<String, String> {
    let answer = analysis.answer.as_ref().map_err(ToString::to_string)?;
    let (trajectory, _) = vehicle_trajectory(
        deployment,
        analysis.triplets(),
        analysis.offer.targets,
        &answer.calibration.station1_from_station,
        LARGEST_POSE_ERROR_M,
    )
    .map_err(|error| error.to_string())?;
    let calibration = &answer.calibration;
    let header = format!(
        "{}: frame of station 1, by method {}, verdict {}",
        deployment.name,
        calibration.method.letter(),
        calibration.verdict.name()
    );
    Ok(export::tum::tum(&trajectory, &header))
}
