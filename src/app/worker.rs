//! The thread that calibrates, and those beside it that open, study and save, so that no frame ever waits.
//!
//! The newest request wins: requests that pile up behind a running one are answered by one run with the last
//! settings. Each reply carries the number of its request, so a stale one is recognised.
//!
//! The joint estimate takes longer than a frame, so the paper's answer goes first, and the joint one follows when nobody
//! waits for a first answer any more.

use std::collections::HashMap;
use std::panic::AssertUnwindSafe;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use eframe::egui;

use super::file_dialog::Listing;
use super::persist::hashes::HashCache;
use super::persist::session::{SavedDeployment, Session, SessionError};
use super::state::put_right::Extra;
use crate::analysis::{Analysis, Analyst, Settings};
use crate::app::model::studies::StudyResult;
use crate::app::model::{AskedToml, PictureTo, TableHead, Validated};
use crate::app::prepared::{CloudMaker, Clouds};
use crate::app::prepared::{PreparedPlots, RawReadings};
use crate::deployment::{Deployment, Finding, OpenError, Sorted, Source, sort};
use crate::experiment::StudyError;
use crate::progress::{Cancelled, Progress};

#[expect(clippy::large_enum_variant, reason = "a handful wait at any time")]
enum Request {
    Analyse {
        number: u64,
        id: u64,
        deployment: Arc<Deployment>,
        settings: Settings,
        /// Cancelled once a newer request has overtaken this one.
        progress: Arc<Progress>,
        /// Wall time of the pipeline (ms) once the paper's answer was sent, and the joint estimate is what is left to do.
        published_after_ms: Option<f64>,
    },
    /// The deployment with this id was closed.
    Forget(u64),
}

impl Request {
    fn number(&self) -> u64 {
        match self {
            Self::Analyse { number, .. } | Self::Forget(number) => *number,
        }
    }

    /// Of the deployment.
    fn id(&self) -> u64 {
        match self {
            Self::Analyse { id, .. } | Self::Forget(id) => *id,
        }
    }

    /// Whether an answer to it is shown already.
    fn can_wait(&self) -> bool {
        matches!(self, Self::Analyse { published_after_ms: Some(_), .. })
    }
}

/// An analysis, and what is drawn of it.
pub struct Answered {
    pub analysis: Arc<Analysis>,
    pub plots: Arc<PreparedPlots>,
    pub clouds: Clouds,
    /// It is the paper's answer alone, to the same request as the joint estimate that comes after it.
    pub joint_follows: bool,
}

pub enum Reply {
    Opened(u64, Result<Arc<Deployment>, OpenError>),
    Analysed {
        number: u64,
        id: u64,
        answered: Answered,
    },
    Studied(u64, Result<Arc<StudyResult>, StudyError>),
    /// Whether a calibration holds for other runs.
    Validated(u64, Result<Validated, Cancelled>),
    /// The picture of the scene that was asked for.
    Pictured {
        to: PictureTo,
        /// `None` if nothing of the scene was in the window.
        image: Option<egui::ColorImage>,
    },
    /// The residuals of a pinned result.
    PinDrawn {
        id: u64,
        plots: Arc<PreparedPlots>,
    },
    /// A request ended in a bug of the program.
    Failed(u64),
    /// The user chose a path in a dialog.
    Picked(PathBuf),
    /// The user chose a file to be used with the deployment of this id.
    PickedExtra {
        id: u64,
        extra: Extra,
        path: PathBuf,
    },
    /// The beginning of a table that the user is asked about.
    HeadRead(u64, Result<TableHead, String>),
    /// What would be written to a `deployment.toml`.
    TomlProposed(u64, Result<Box<AskedToml>, String>),
    TomlWritten(u64, Result<Box<AskedToml>, String>),
    /// What is in a folder that the prompt shows.
    Listed(Listing),
    /// What the paths are that the user dropped or chose.
    Sorted(u64, Box<Sorted>),
    /// A session's file was read: the session and what had to be left out of it.
    SessionRead(u64, PathBuf, Result<(Box<Session>, Vec<Finding>), SessionError>),
    /// The user chose where a session is saved; which of those that were opened it is.
    SessionPlace(PathBuf, Box<Session>, u64),
    SessionSaved(u64, PathBuf, Result<(), String>),
    /// What a session took the place of is kept.
    ReplacedKept(u64, Result<(), String>),
    /// Something that ran beside the worker is done: a line for the user, or why it failed.
    Done(Result<String, String>),
}

/// The window's end of the thread.
pub struct Worker {
    requests: Sender<Request>,
    replies: Receiver<Reply>,
    reply_to: Sender<Reply>,
    ctx: egui::Context,
    newest: u64,
    /// Of the newest analysis of each deployment.
    analysing: HashMap<u64, Arc<Progress>>,
}

impl Worker {
    pub fn start(ctx: egui::Context) -> Self {
        let (requests, inbox) = channel();
        let (outbox, replies) = channel();
        let reply_to = outbox.clone();
        let repaint = ctx.clone();
        // Ends when the window drops its sender.
        std::thread::Builder::new()
            .name("resect worker".to_owned())
            .spawn(move || work(&inbox, &outbox, &repaint))
            .expect("a thread can be started");
        Self { requests, replies, reply_to, ctx, newest: 0, analysing: HashMap::new() }
    }

    /// Reads a deployment beside the worker; gives the request's number.
    pub fn open(&mut self, source: Source, progress: Arc<Progress>) -> u64 {
        self.numbered(Reply::Opened, move || source.open(&progress).map(Arc::new))
    }

    /// The same for a deployment of a session: files that changed since are among its findings.
    pub fn open_again(
        &mut self,
        saved: SavedDeployment,
        cache: Arc<HashCache>,
        progress: Arc<Progress>,
    ) -> u64 {
        self.numbered(Reply::Opened, move || saved.open(&cache, &progress).map(Arc::new))
    }

    /// Finds out what paths are, beside the worker; gives the request's number.
    pub fn look_at(&mut self, paths: Vec<PathBuf>) -> u64 {
        self.numbered(Reply::Sorted, move || Box::new(sort(paths.iter().map(PathBuf::as_path))))
    }

    /// Asks for an analysis; gives the request's number.
    pub fn analyse(&mut self, id: u64, deployment: Arc<Deployment>, settings: Settings) -> u64 {
        let progress = Arc::new(Progress::default());
        // One that is under way stops: nobody wants its answer any more.
        if let Some(overtaken) = self.analysing.insert(id, Arc::clone(&progress)) {
            overtaken.cancel();
        }
        self.send(|number| Request::Analyse {
            number,
            id,
            deployment,
            settings,
            progress,
            published_after_ms: None,
        })
    }

    /// Lets go of what is remembered of a deployment.
    pub fn forget(&mut self, id: u64) {
        if let Some(unwanted) = self.analysing.remove(&id) {
            unwanted.cancel();
        }
        self.requests.send(Request::Forget(id)).ok();
    }

    /// Runs a study beside the worker; gives the request's number.
    pub fn study(
        &mut self,
        run: impl FnOnce() -> Result<Arc<StudyResult>, StudyError> + Send + 'static,
    ) -> u64 {
        self.numbered(Reply::Studied, run)
    }

    /// Runs something beside the worker under a number of its own.
    pub fn numbered<T: 'static>(
        &mut self,
        reply: fn(u64, T) -> Reply,
        run: impl FnOnce() -> T + Send + 'static,
    ) -> u64 {
        self.newest += 1;
        let number = self.newest;
        self.beside_as(number, move || Some(reply(number, run())));
        number
    }

    fn send(&mut self, request: impl FnOnce(u64) -> Request) -> u64 {
        self.newest += 1;
        // The worker lives as long as this end of the channel: it catches its own panics.
        self.requests.send(request(self.newest)).ok();
        self.newest
    }

    pub fn ctx(&self) -> &egui::Context {
        &self.ctx
    }

    /// For what runs elsewhere: takes its reply in as if it came from here.
    pub fn reply(&self) -> impl Fn(Reply) + Send + use<> {
        let (outbox, ctx) = (self.reply_to.clone(), self.ctx.clone());
        move |reply| {
            outbox.send(reply).ok();
            ctx.request_repaint();
        }
    }

    /// Runs something beside the worker (a dialog, an export) and repaints when it is done.
    pub fn beside(&self, job: impl FnOnce() -> Option<Reply> + Send + 'static) {
        // No request has this number.
        self.beside_as(0, job);
    }

    fn beside_as(&self, number: u64, job: impl FnOnce() -> Option<Reply> + Send + 'static) {
        let reply = self.reply();
        std::thread::spawn(move || {
            let done = std::panic::catch_unwind(AssertUnwindSafe(job));
            if let Some(done) = done.unwrap_or(Some(Reply::Failed(number))) {
                reply(done);
            }
        });
    }

    pub fn try_reply(&self) -> Option<Reply> {
        self.replies.try_recv().ok()
    }

    /// Waits for the next reply; for pictures and tests.
    pub fn wait_reply(&self) -> Option<Reply> {
        self.replies.recv_timeout(std::time::Duration::from_secs(120)).ok()
    }
}

/// What is remembered of a deployment.
struct Known {
    analyst: Analyst,
    /// No setting changes them.
    readings: Arc<RawReadings>,
    clouds: CloudMaker,
}

fn work(inbox: &Receiver<Request>, outbox: &Sender<Reply>, ctx: &egui::Context) {
    let mut known: HashMap<u64, Known> = HashMap::new();
    let mut waiting = Vec::new();
    loop {
        if waiting.is_empty() {
            match inbox.recv() {
                Ok(request) => waiting.push(request),
                Err(_) => return,
            }
        }
        waiting.extend(inbox.try_iter());
        waiting = without_overtaken(waiting);
        let next = waiting.iter().position(|request| !request.can_wait()).unwrap_or(0);
        let request = waiting.remove(next);
        let number = request.number();
        let answer = std::panic::catch_unwind(AssertUnwindSafe(|| reply(request, &mut known)));
        let (reply, rest) = answer.unwrap_or_else(|_| {
            known.clear();
            (Some(Reply::Failed(number)), None)
        });
        if let Some(reply) = reply {
            if outbox.send(reply).is_err() {
                return;
            }
            ctx.request_repaint();
        }
        waiting.extend(rest);
    }
}

/// What is still worth doing: of several requests about a deployment only the last, but to let go of it is always done.
fn without_overtaken(waiting: Vec<Request>) -> Vec<Request> {
    let ids: Vec<u64> = waiting.iter().map(Request::id).collect();
    waiting
        .into_iter()
        .enumerate()
        .filter(|(at, request)| {
            matches!(request, Request::Forget(_)) || !ids[at + 1..].contains(&ids[*at])
        })
        .map(|(_, request)| request)
        .collect()
}

/// The reply, and what is left to do of the request.
fn reply(request: Request, known: &mut HashMap<u64, Known>) -> (Option<Reply>, Option<Request>) {
    match request {
        Request::Analyse { number, id, deployment, settings, progress, published_after_ms } => {
            let known = known.entry(id).or_insert_with(|| Known {
                readings: Arc::new(RawReadings::of(&deployment)),
                clouds: CloudMaker::default(),
                analyst: Analyst::new(Arc::clone(&deployment)),
            });
            let analyst = &mut known.analyst;
            let first = match published_after_ms {
                None => analyst.run_published_while(&settings, &progress),
                Some(_) => Ok(None),
            };
            let found = match first {
                // Where the paper's method has no answer, there is nothing to show before the joint estimate.
                Ok(Some(published)) if published.answer.is_ok() => Ok((published, true)),
                Ok(_) => analyst.run_while(&settings, &progress).map(|analysis| (analysis, false)),
                Err(cancelled) => Err(cancelled),
            };
            let Ok((mut analysis, joint_follows)) = found else { return (None, None) };
            let rest = joint_follows.then_some(Request::Analyse {
                number,
                id,
                deployment,
                settings,
                progress,
                published_after_ms: Some(analysis.pipeline_ms),
            });
            // Then the pipeline's stages were remembered.
            analysis.pipeline_ms += published_after_ms.unwrap_or(0.0);
            let clouds = known.clouds.make(known.analyst.deployment(), &analysis);
            let plots = Arc::new(PreparedPlots::of(&analysis, &known.readings));
            let analysis = Arc::new(analysis);
            let answered = Answered { analysis, plots, clouds, joint_follows };
            (Some(Reply::Analysed { number, id, answered }), rest)
        }
        Request::Forget(id) => {
            known.remove(&id);
            (None, None)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::Method;
    use crate::deployment::Sample;

    fn settings(tau_l_seconds: f64) -> Settings {
        let mut settings = Settings::default();
        settings.pipeline.thresholds.tau_l_seconds = tau_l_seconds;
        settings
    }

    /// Number, method and whether another follows, of every answer until nothing follows the request with this number.
    fn answers_until(worker: &Worker, last: u64) -> Vec<(u64, Method, bool)> {
        let mut answers = Vec::new();
        while let Some(reply) = worker.wait_reply() {
            let Reply::Analysed { number, answered, .. } = reply else { panic!("an answer") };
            let answer = answered.analysis.answer.as_ref().expect("an answer");
            answers.push((number, answer.calibration.method, answered.joint_follows));
            if number == last && !answered.joint_follows {
                break;
            }
        }
        answers
    }

    #[test]
    fn the_papers_answer_comes_first_and_the_joint_estimate_follows() {
        let deployment = Arc::new(Sample::Warthog.open().expect("built in"));
        let mut worker = Worker::start(egui::Context::default());
        let number = worker.analyse(7, Arc::clone(&deployment), Settings::default());
        let both = [(number, Method::InterPrism, true), (number, Method::Joint, false)];
        assert_eq!(answers_until(&worker, number), both);
        // The paper's method itself has nothing that follows.
        let mut published = Settings::default();
        published.calibration.method = Some(Method::InterPrism);
        let number = worker.analyse(7, deployment, published);
        assert_eq!(answers_until(&worker, number), [(number, Method::InterPrism, false)]);
    }

    #[test]
    fn a_newer_request_takes_the_place_of_a_joint_estimate_that_is_under_way() {
        let deployment = Arc::new(Sample::Warthog.open().expect("built in"));
        let mut worker = Worker::start(egui::Context::default());
        let first = worker.analyse(7, Arc::clone(&deployment), settings(6.0));
        let Some(Reply::Analysed { answered, .. }) = worker.wait_reply() else { panic!("one") };
        assert!(answered.joint_follows);
        let second = worker.analyse(7, deployment, settings(7.0));
        let answers = answers_until(&worker, second);
        // Unless it was there already.
        let own: Vec<_> = answers.iter().filter(|(number, ..)| *number != first).collect();
        assert_eq!(own, [&(second, Method::InterPrism, true), &(second, Method::Joint, false)]);
    }

    #[test]
    fn first_answers_go_before_joint_estimates_and_a_closed_deployment_has_none() {
        let deployment = Arc::new(Sample::Warthog.open().expect("built in"));
        let analyse = |number, id, published_after_ms| Request::Analyse {
            number,
            id,
            deployment: Arc::clone(&deployment),
            settings: Settings::default(),
            progress: Arc::default(),
            published_after_ms,
        };
        assert!(analyse(1, 7, Some(2.0)).can_wait() && !analyse(2, 8, None).can_wait());
        let waiting = vec![analyse(1, 7, Some(2.0)), analyse(2, 8, Some(2.0)), Request::Forget(7)];
        let left: Vec<u64> = without_overtaken(waiting).iter().map(Request::id).collect();
        assert_eq!(left, [8, 7], "only the closed one's");
    }

    #[test]
    fn of_several_analyses_of_a_deployment_only_the_newest_is_run() {
        let deployment = Arc::new(Sample::Warthog.open().expect("built in"));
        let analyse = |number, id| Request::Analyse {
            number,
            id,
            deployment: Arc::clone(&deployment),
            settings: Settings::default(),
            progress: Arc::default(),
            published_after_ms: None,
        };
        let waiting =
            vec![analyse(1, 7), Request::Forget(2), analyse(3, 7), analyse(4, 8), analyse(5, 7)];
        let left: Vec<u64> = without_overtaken(waiting).iter().map(Request::number).collect();
        assert_eq!(left, [2, 4, 5]);
    }
}
