//! The thread that calibrates and prepares the drawing, so that no frame ever waits.
//!
//! The newest request wins: one run with the last settings answers all requests that queue up behind a running one. Each answer has the
//! number of its request, so a stale one is recognised.
//!
//! The joint estimate takes longer than a frame, so the paper's calibration is sent
//! first. The joint one follows when no deployment waits for a first answer any more.

use std::collections::HashMap;
use std::panic::AssertUnwindSafe;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use super::{CloudMaker, Clouds, PreparedPlots, RawReadings};
use resect_core::analysis::{Analysis, Analyst, Settings};
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;

#[expect(clippy::large_enum_variant, reason = "a handful wait at any time")]
enum Request {
    Analyse {
        number: u64,
        id: u64,
        deployment: Arc<Deployment>,
        settings: Settings,
        /// Cancelled by a newer request.
        progress: Arc<Progress>,
        /// Wall time of the pipeline (ms) once the paper's calibration was sent and only the joint estimate remains.
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

    /// The number of the deployment.
    fn id(&self) -> u64 {
        match self {
            Self::Analyse { id, .. } | Self::Forget(id) => *id,
        }
    }

    /// Returns true if a first answer to the request is shown already.
    fn can_wait(&self) -> bool {
        matches!(self, Self::Analyse { published_after_ms: Some(_), .. })
    }
}

/// An analysis, with its prepared plots and clouds.
pub struct Answered {
    /// The number of the request.
    pub number: u64,
    /// The number of the deployment.
    pub id: u64,
    pub analysis: Arc<Analysis>,
    pub plots: Arc<PreparedPlots>,
    pub clouds: Clouds,
    /// True if this is the paper's calibration alone, and the joint estimate for the same request follows.
    pub joint_follows: bool,
}

/// The window's handle of the thread.
pub struct Analyser {
    requests: Sender<Request>,
    /// Progress of the newest analysis of each deployment.
    analysing: HashMap<u64, Arc<Progress>>,
}

impl Analyser {
    /// Starts the thread, which passes each answer to `take`, or the request's number after a panic.
    pub fn start(take: impl Fn(Result<Answered, u64>) + Send + 'static) -> Self {
        let (requests, inbox) = channel();
        // Ends when the window drops its sender.
        std::thread::Builder::new()
            .name("resect analyser".to_owned())
            .spawn(move || work(&inbox, take))
            .expect("a thread can be started");
        Self { requests, analysing: HashMap::new() }
    }

    /// Requests an analysis, and cancels earlier requests for the same deployment.
    pub fn analyse(
        &mut self,
        number: u64,
        id: u64,
        deployment: Arc<Deployment>,
        settings: Settings,
    ) {
        let progress = Arc::new(Progress::default());
        if let Some(overtaken) = self.analysing.insert(id, Arc::clone(&progress)) {
            overtaken.cancel();
        }
        let published_after_ms = None;
        let request =
            Request::Analyse { number, id, deployment, settings, progress, published_after_ms };
        // The thread lives as long as this end of the channel: it catches its own panics.
        self.requests.send(request).ok();
    }

    /// Returns the progress of the newest analysis of a deployment.
    pub fn progress(&self, id: u64) -> Option<&Progress> {
        self.analysing.get(&id).map(Arc::as_ref)
    }

    /// Frees the stored data of a deployment.
    pub fn forget(&mut self, id: u64) {
        if let Some(unwanted) = self.analysing.remove(&id) {
            unwanted.cancel();
        }
        self.requests.send(Request::Forget(id)).ok();
    }
}

/// Stored data of a deployment.
struct RememberedDeployment {
    analyst: Analyst,
    /// Independent of the settings.
    readings: Arc<RawReadings>,
    clouds: CloudMaker,
}

fn work(inbox: &Receiver<Request>, take: impl Fn(Result<Answered, u64>)) {
    let mut known: HashMap<u64, RememberedDeployment> = HashMap::new();
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
        let found = std::panic::catch_unwind(AssertUnwindSafe(|| answer(request, &mut known)));
        match found {
            Ok((answered, rest)) => {
                answered.into_iter().for_each(|answered| take(Ok(answered)));
                waiting.extend(rest);
            }
            Err(_) => {
                known.clear();
                take(Err(number));
            }
        }
    }
}

/// Returns the requests that are not superseded: the last of each deployment, and every `Forget`.
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

/// Returns the answer, and the rest of the request.
fn answer(
    request: Request,
    known: &mut HashMap<u64, RememberedDeployment>,
) -> (Option<Answered>, Option<Request>) {
    match request {
        Request::Analyse { number, id, deployment, settings, progress, published_after_ms } => {
            let known = known.entry(id).or_insert_with(|| RememberedDeployment {
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
                // If the paper's method fails, there is nothing to show before the joint estimate.
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
            // The stages of the pipeline were cached by then.
            analysis.pipeline_ms += published_after_ms.unwrap_or(0.0);
            let clouds = known.clouds.make(known.analyst.deployment(), &analysis);
            let plots =
                Arc::new(PreparedPlots::of(known.analyst.deployment(), &analysis, &known.readings));
            let analysis = Arc::new(analysis);
            (Some(Answered { number, id, analysis, plots, clouds, joint_follows }), rest)
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
    use resect_core::calibration::Method;
    use resect_io::sample::Sample;

    fn settings(tau_l_seconds: f64) -> Settings {
        let mut settings = Settings::default();
        settings.pipeline.thresholds.tau_l_seconds = tau_l_seconds;
        settings
    }

    /// An analyser and the receiver of its answers.
    fn start() -> (Analyser, Receiver<Answered>) {
        let (sender, answers) = channel();
        let analyser = Analyser::start(move |found| {
            sender.send(found.expect("no bug")).expect("awaited");
        });
        (analyser, answers)
    }

    /// Returns number, method and `joint_follows` of every answer, until the last answer to the request with this number.
    fn answers_until(all: &Receiver<Answered>, last: u64) -> Vec<(u64, Method, bool)> {
        let mut answers = Vec::new();
        while let Ok(answered) = all.recv() {
            let answer = answered.analysis.answer.as_ref().expect("an answer");
            answers.push((answered.number, answer.calibration.method, answered.joint_follows));
            if answered.number == last && !answered.joint_follows {
                break;
            }
        }
        answers
    }

    #[test]
    fn the_papers_answer_comes_first_and_the_joint_estimate_follows() {
        let deployment = Arc::new(Sample::Warthog.open().expect("built in"));
        let (mut analyser, answers) = start();
        analyser.analyse(1, 7, Arc::clone(&deployment), Settings::default());
        let both = [(1, Method::InterPrism, true), (1, Method::Joint, false)];
        assert_eq!(answers_until(&answers, 1), both);
        // A request for the paper's method itself has no second answer.
        let mut published = Settings::default();
        published.calibration.method = Some(Method::InterPrism);
        analyser.analyse(2, 7, deployment, published);
        assert_eq!(answers_until(&answers, 2), [(2, Method::InterPrism, false)]);
    }

    #[test]
    fn a_newer_request_takes_the_place_of_a_joint_estimate_that_is_under_way() {
        let deployment = Arc::new(Sample::Warthog.open().expect("built in"));
        let (mut analyser, answers) = start();
        analyser.analyse(1, 7, Arc::clone(&deployment), settings(6.0));
        assert!(answers.recv().expect("one").joint_follows);
        analyser.analyse(2, 7, deployment, settings(7.0));
        let answers = answers_until(&answers, 2);
        // The first request may have been answered already.
        let own: Vec<_> = answers.iter().filter(|(number, ..)| *number != 1).collect();
        assert_eq!(own, [&(2, Method::InterPrism, true), &(2, Method::Joint, false)]);
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
