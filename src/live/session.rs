//! A live deployment with its threads: one that listens, one that takes in, two that calculate; behind one small handle.
//!
//! ```text
//! source ──events──▶ intake (engine) ──snapshot──▶ the paper's answer ─┐
//!                      ▲  │      └──────snapshot──▶ the settings' answer ─┤
//!                      │  └─▶ view, newest deployment                    │
//!                      └────────────────outcomes────────────────────────┘
//! ```
//! Queues are short: who is faster than the next waits. A snapshot is made when somebody is free to take it, so that the newest
//! readings are the next that are answered from.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::connect::{self, AddressError, Expected};
use super::engine::Engine;
use super::event::Event;
use super::judged::{Judged, Outcome, judge};
use super::next::Advising;
use super::recorder::{RecordError, Recorded, Recorder};
use super::replay;
use super::view::View;
use crate::analysis::{Analysis, Analyst, Settings};
use crate::calibration::Method;
use crate::deployment::{Deployment, Extras, Growing, OpenError, Source};
use crate::progress::Progress;

/// Events that wait to be taken in, at most.
const QUEUE: usize = 1024;
/// How often a view is made, what was recorded is flushed, and the paper's answer is asked for.
const TICK_S: f64 = 1.0;
/// Who calculates rests for this many times as long as it took: a drive of a day must not keep a laptop busy.
const REST: f64 = 1.0;

/// Where readings come from.
#[derive(Clone, Debug, PartialEq)]
pub enum Feed {
    /// The address of a stream.
    Url(String),
    /// A deployment, at so many times the speed of the drive.
    Replay { source: Box<Source>, speed: f64 },
}

/// What is wanted of a live deployment.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    pub feed: Feed,
    /// Folder with what is known beforehand: rig, control points, `deployment.toml`.
    pub deployment: Option<PathBuf>,
    pub extras: Extras,
    /// The instruments that are stations 1, 2, 3, where messages name instruments.
    pub instruments: Option<[String; 3]>,
    pub settings: Settings,
    pub record: Option<PathBuf>,
    /// Whether answers are calculated here; otherwise whoever holds the session hands them in ([`Session::answered`]).
    pub calculates: bool,
    /// What σ at the far end of the track has to come down to (m).
    pub target_m: f64,
}

/// Why nothing can be begun.
#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    #[error(transparent)]
    Address(#[from] AddressError),
    #[error(transparent)]
    Open(#[from] OpenError),
    #[error(transparent)]
    Record(#[from] RecordError),
    #[error("{0} is no speed; give a number above 0, where 1 is as fast as it was driven")]
    Speed(f64),
    #[error("{0} mm is no target; give a number above 0")]
    Target(f64),
}

/// What is left when a live deployment has ended.
pub struct Finished {
    pub deployment: Result<Deployment, OpenError>,
    pub view: View,
    pub recorded: Option<Result<Recorded, RecordError>>,
}

/// What others see of it while it runs.
#[derive(Default)]
struct Shown {
    view: Arc<View>,
    deployment: Option<Arc<Deployment>>,
    target_m: Option<f64>,
    settings: Settings,
    /// Whether the newest deployment was taken, and the next is wanted.
    is_taken: bool,
    /// Answers that were handed in.
    answered: Vec<Answered>,
}

/// An answer from elsewhere, of a deployment that was taken.
struct Answered {
    deployment: Arc<Deployment>,
    analysis: Arc<Analysis>,
    is_first: bool,
}

/// A live deployment.
pub struct Session {
    shown: Arc<Mutex<Shown>>,
    stop: Arc<AtomicBool>,
    progress: Arc<Progress>,
    intake: Option<JoinHandle<Finished>>,
}

impl Session {
    /// Begins to listen.
    pub fn start(wanted: &Wanted) -> Result<Self, LiveError> {
        if !(wanted.target_m > 0.0 && wanted.target_m.is_finite()) {
            return Err(LiveError::Target(wanted.target_m * 1e3));
        }
        let stop = Arc::new(AtomicBool::new(false));
        let (send, events) = sync_channel(QUEUE);
        let (growing, speed, source) = prepare(wanted, Arc::clone(&stop), send)?;
        // Everything else is known to be right before a file is begun.
        let recorder = wanted.record.as_deref().map(Recorder::create).transpose()?;
        std::thread::spawn(source);
        let mut engine = Engine::new(growing, speed, recorder, wanted.target_m);
        let view = Arc::new(engine.view(0.0));
        let (settings, is_taken) = (wanted.settings, true);
        let shown = Shown { view, settings, is_taken, ..Shown::default() };
        let shown = Arc::new(Mutex::new(shown));
        let progress = Arc::new(Progress::default());
        let intake = Intake {
            engine,
            events,
            shown: Arc::clone(&shown),
            progress: Arc::clone(&progress),
            begun: Instant::now(),
            calculates: wanted.calculates,
        };
        let intake = std::thread::spawn(move || intake.run());
        Ok(Self { shown, stop, progress, intake: Some(intake) })
    }

    /// All that is told now.
    pub fn view(&self) -> Arc<View> {
        Arc::clone(&lock(&self.shown).view)
    }

    /// The newest deployment that was made of the readings, once; the next is made when this one was taken.
    pub fn take_deployment(&self) -> Option<Arc<Deployment>> {
        let mut shown = lock(&self.shown);
        let taken = shown.deployment.take();
        shown.is_taken |= taken.is_some();
        taken
    }

    /// Hands in an answer to a deployment that was taken; `is_first` is the paper's, ahead of the one of the settings.
    pub fn answered(&self, deployment: Arc<Deployment>, analysis: Arc<Analysis>, is_first: bool) {
        lock(&self.shown).answered.push(Answered { deployment, analysis, is_first });
    }

    /// Sets another target (m).
    pub fn aim(&self, target_m: f64) {
        lock(&self.shown).target_m = Some(target_m);
    }

    /// Sets what is calculated with from now on.
    pub fn set(&self, settings: &Settings) {
        lock(&self.shown).settings = *settings;
    }

    /// Whether the source has said everything, and all of it was taken in.
    pub fn has_ended(&self) -> bool {
        self.intake.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Ends it: what has arrived is taken in, and the recording is ended as it should be.
    pub fn stop(mut self) -> Option<Finished> {
        self.leave();
        self.intake.take().and_then(|intake| intake.join().ok())
    }

    fn leave(&self) {
        self.stop.store(true, Relaxed);
        self.progress.cancel();
    }
}

impl Drop for Session {
    /// Whoever drops it loses nothing: the recording is ended first.
    fn drop(&mut self) {
        self.leave();
        if let Some(intake) = self.intake.take() {
            // A thread that panicked has nothing more to end.
            _ = intake.join();
        }
    }
}

fn lock(shown: &Mutex<Shown>) -> std::sync::MutexGuard<'_, Shown> {
    shown.lock().unwrap_or_else(PoisonError::into_inner)
}

type Work = Box<dyn FnOnce() + Send>;

/// What is known beforehand, how fast a replay goes, and what the listening thread does.
fn prepare(
    wanted: &Wanted,
    stop: Arc<AtomicBool>,
    send: SyncSender<Event>,
) -> Result<(Growing, Option<f64>, Work), LiveError> {
    let (folder, extras) = (wanted.deployment.as_deref(), &wanted.extras);
    let progress = Progress::default();
    match &wanted.feed {
        Feed::Url(url) => {
            let address = connect::address(url)?;
            let name = address.host().unwrap_or("live").to_owned();
            let growing = Growing::around(&name, folder, extras, &progress)?;
            let stations = wanted.instruments.clone();
            let expected = Expected { address, stations, added_m: growing.added_to_ranges_m() };
            Ok((growing, None, Box::new(move || connect::run(&expected, &stop, &send))))
        }
        Feed::Replay { source, speed } => {
            if !(*speed > 0.0 && speed.is_finite()) {
                return Err(LiveError::Speed(*speed));
            }
            let speed = *speed;
            let deployment = source.open(&progress)?;
            let growing = match folder {
                Some(_) => Growing::around(&deployment.name, folder, extras, &progress)?,
                None => Growing::of_readings_again(deployment.clone()),
            };
            let added_m = growing.added_to_ranges_m();
            let work = move || replay::run(&deployment, added_m, speed, &stop, &send);
            Ok((growing, Some(speed), Box::new(work)))
        }
    }
}

struct Intake {
    engine: Engine,
    events: Receiver<Event>,
    shown: Arc<Mutex<Shown>>,
    progress: Arc<Progress>,
    begun: Instant,
    calculates: bool,
}

impl Intake {
    /// Takes in all that comes, until the source has ended.
    fn run(mut self) -> Finished {
        let (outcomes, judged) = channel();
        let mut first = Calculating::start(true, &outcomes, &self.progress);
        let mut second = Calculating::start(false, &outcomes, &self.progress);
        let mut advising = Advising::start(&self.progress);
        let mut ticked = Instant::now();
        loop {
            let wait = Duration::from_secs_f64(TICK_S).saturating_sub(ticked.elapsed());
            let ended = match self.events.recv_timeout(wait) {
                Ok(event) => {
                    // How the connection is is told at once.
                    let is_news = matches!(event, Event::Connected(_) | Event::Lost { .. });
                    self.engine.take(event, self.begun.elapsed().as_secs_f64());
                    if is_news {
                        self.show();
                    }
                    false
                }
                Err(RecvTimeoutError::Timeout) => false,
                Err(RecvTimeoutError::Disconnected) => true,
            };
            while let Ok((outcome, Answered { deployment, analysis, is_first })) = judged.try_recv()
            {
                if is_first { &mut first } else { &mut second }.has_finished();
                self.engine.judged(outcome);
                if !is_first {
                    advising.offer(&deployment, &analysis, self.engine.target_m());
                }
            }
            let handed_in = std::mem::take(&mut lock(&self.shown).answered);
            for Answered { deployment, analysis, is_first } in handed_in {
                let known = self.engine.known();
                let outcome = judge(&deployment, &analysis, is_first, known.as_deref());
                self.engine.judged(outcome);
                if !is_first {
                    advising.offer(&deployment, &analysis, self.engine.target_m());
                }
            }
            if let Some(moves) = advising.found() {
                self.engine.advised(moves);
            }
            if ended {
                break;
            }
            if ticked.elapsed().as_secs_f64() >= TICK_S {
                ticked = Instant::now();
                self.tick(&mut first, &mut second);
            }
        }
        let recorded = self.engine.finish_recording();
        self.show();
        let mut view = (*lock(&self.shown).view).clone();
        if let Some(Ok(recorded)) = &recorded {
            view.recorded = Some(recorded.clone());
        }
        Finished { deployment: self.engine.deployment(), view, recorded }
    }

    fn tick(&mut self, first: &mut Calculating, second: &mut Calculating) {
        self.engine.flush();
        let (settings, target_m) = {
            let mut shown = lock(&self.shown);
            (shown.settings, shown.target_m.take())
        };
        if let Some(target_m) = target_m {
            self.engine.aim(target_m);
        }
        if self.calculates {
            self.calculate(&settings, first, second);
        } else if lock(&self.shown).is_taken
            && let Some(Ok(deployment)) = self.engine.snapshot()
        {
            let mut shown = lock(&self.shown);
            (shown.deployment, shown.is_taken) = (Some(Arc::new(deployment)), false);
        }
        self.show();
    }

    /// Gives the newest readings to whoever is free.
    fn calculate(
        &mut self,
        settings: &Settings,
        first: &mut Calculating,
        second: &mut Calculating,
    ) {
        // One that has no paper's answer beside it comes by the second alone.
        let is_joint = settings.calibration.method.unwrap_or_default() == Method::Joint;
        if (first.is_free() && is_joint) || second.is_free() {
            // What has no deployment yet is told in the view: there are no readings, or they cannot be any.
            if let Some(Ok(deployment)) = self.engine.snapshot() {
                let deployment = Arc::new(deployment);
                let known = self.engine.known();
                if is_joint {
                    first.offer(&deployment, settings, known.as_ref());
                }
                second.offer(&deployment, settings, known.as_ref());
            }
        }
    }

    fn show(&mut self) {
        let view = self.engine.view(self.begun.elapsed().as_secs_f64());
        lock(&self.shown).view = Arc::new(view);
    }
}

/// What is to be calculated.
struct Job {
    deployment: Arc<Deployment>,
    settings: Settings,
    known: Option<Arc<Judged>>,
}

/// A thread that calculates one snapshot at a time.
struct Calculating {
    jobs: Sender<Job>,
    /// Since when, and how long it takes at least until it is free again.
    busy_since: Option<Instant>,
    free_at: Instant,
}

impl Calculating {
    fn start(
        is_first: bool,
        outcomes: &Sender<(Outcome, Answered)>,
        progress: &Arc<Progress>,
    ) -> Self {
        let (jobs, waiting) = channel::<Job>();
        let (outcomes, progress) = (outcomes.clone(), Arc::clone(progress));
        std::thread::spawn(move || {
            for Job { deployment, settings, known } in waiting {
                let mut analyst = Analyst::new(Arc::clone(&deployment));
                let analysis = match is_first {
                    true => analyst.run_published_while(&settings, &progress),
                    false => analyst.run_while(&settings, &progress).map(Some),
                };
                // Cancelled: nobody waits for it.
                let Ok(Some(analysis)) = analysis else { return };
                let outcome = judge(&deployment, &analysis, is_first, known.as_deref());
                let analysis = Arc::new(analysis);
                if outcomes.send((outcome, Answered { deployment, analysis, is_first })).is_err() {
                    return;
                }
            }
        });
        Self { jobs, busy_since: None, free_at: Instant::now() }
    }

    fn is_free(&self) -> bool {
        self.busy_since.is_none() && Instant::now() >= self.free_at
    }

    fn has_finished(&mut self) {
        if let Some(since) = self.busy_since.take() {
            self.free_at = Instant::now() + since.elapsed().mul_f64(REST);
        }
    }

    /// Gives it a snapshot, unless it is busy.
    fn offer(
        &mut self,
        deployment: &Arc<Deployment>,
        settings: &Settings,
        known: Option<&Arc<Judged>>,
    ) {
        if self.is_free() {
            let job = Job {
                deployment: Arc::clone(deployment),
                settings: *settings,
                known: known.map(Arc::clone),
            };
            // A thread that is gone takes nothing, and is never free again.
            _ = self.jobs.send(job);
            self.busy_since = Some(Instant::now());
        }
    }
}
