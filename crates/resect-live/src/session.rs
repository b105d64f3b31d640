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

use super::closing::Closing;
use super::connect::{self, AddressError, Expected};
use super::engine::Engine;
use super::event::Event;
use super::judged::{Judged, Outcome, judge};
use super::next::Advising;
use super::recorder::{RecordError, Recorded, Recorder};
use super::replay;
use super::view::View;
use resect_core::analysis::{Analysis, Analyst, Settings};
use resect_core::calibration::Method;
use resect_core::deployment::{AS_NUMBERED, Deployment};
use resect_core::progress::Progress;
use resect_io::error::OpenError;
use resect_io::growing::Growing;
use resect_io::source::{Extras, Source};

/// Events that wait to be taken in, at most.
const QUEUE: usize = 1024;
/// How often a view is made, what was recorded is flushed, and the paper's answer is asked for.
const TICK_S: f64 = 1.0;
/// How often it is looked whether it is to end.
const NAP: Duration = Duration::from_millis(100);
/// When it is to end, the source is waited for so long: one that looks up a name or waits for a computer to answer notices late.
const LEAVES_WITHIN: Duration = Duration::from_millis(300);

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
    /// What the answer to all readings is told by.
    pub closing: Closing,
}

/// What others see of it while it runs.
#[derive(Default)]
struct Shown {
    view: Arc<View>,
    deployment: Option<Arc<Deployment>>,
    target_m: Option<f64>,
    settings: Settings,
    /// All but the readings, where it is to be another.
    around: Option<Box<Growing>>,
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
        let engine = Engine::new(growing, speed, recorder, wanted.target_m);
        Ok(Self::listening(engine, events, stop, wanted.settings, wanted.calculates))
    }

    fn listening(
        mut engine: Engine,
        events: Receiver<Event>,
        stop: Arc<AtomicBool>,
        settings: Settings,
        calculates: bool,
    ) -> Self {
        let view = Arc::new(engine.view(0.0));
        let shown = Shown { view, settings, is_taken: true, ..Shown::default() };
        let shown = Arc::new(Mutex::new(shown));
        let progress = Arc::new(Progress::default());
        let intake = Intake {
            engine,
            events,
            stop: Arc::clone(&stop),
            shown: Arc::clone(&shown),
            progress: Arc::clone(&progress),
            begun: Instant::now(),
            calculates,
        };
        let intake = std::thread::spawn(move || intake.run());
        Self { shown, stop, progress, intake: Some(intake) }
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

    /// Has all readings, those that came already too, read with what [`around`] found.
    pub fn read_with(&self, around: Growing) {
        lock(&self.shown).around = Some(Box::new(around));
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
    match &wanted.feed {
        Feed::Url(url) => {
            let address = connect::address(url)?;
            let growing = around(wanted, &wanted.extras)?;
            let stations = wanted.instruments.clone();
            let expected = Expected { address, stations, added_m: growing.added_to_ranges_m() };
            Ok((growing, None, Box::new(move || connect::run(&expected, &stop, &send))))
        }
        Feed::Replay { source, speed } => {
            if !(*speed > 0.0 && speed.is_finite()) {
                return Err(LiveError::Speed(*speed));
            }
            let speed = *speed;
            let deployment = source.open(&Progress::default())?;
            let growing = around(wanted, &wanted.extras)?;
            let added_m = growing.added_to_ranges_m();
            let work = move || replay::run(&deployment, added_m, speed, &stop, &send);
            Ok((growing, Some(speed), Box::new(work)))
        }
    }
}

/// Reads all but the readings of what is wanted, with other extras: what the user puts right while it is driven.
pub fn around(wanted: &Wanted, extras: &Extras) -> Result<Growing, LiveError> {
    let progress = Progress::default();
    let folder = wanted.deployment.as_deref();
    let name = match &wanted.feed {
        Feed::Url(url) => connect::address(url)?.host().unwrap_or("live").to_owned(),
        Feed::Replay { source, .. } if folder.is_none() => {
            let deployment = beside_readings(source, extras)?;
            return Ok(Growing::of_readings_again(deployment, &extras.put_right));
        }
        Feed::Replay { source, .. } => source.open(&progress)?.name,
    };
    Ok(Growing::around(&name, folder, extras, &progress)?)
}

/// A deployment that is replayed, with what is put right beside its readings, which come again.
fn beside_readings(source: &Source, extras: &Extras) -> Result<Deployment, OpenError> {
    let progress = Progress::default();
    let mut put_right = extras.put_right.beside_readings();
    if let Some(numbers) = extras.put_right.stations {
        // Replayed stations are numbered as they were read; control points are as their files number them.
        let own = source.open(&progress)?.overrides.stations.unwrap_or(AS_NUMBERED);
        let number = |read: i64| usize::try_from(read - 1).ok().and_then(|at| own.get(at)).copied();
        put_right.stations = Some(numbers.map(|read| number(read).unwrap_or(read)));
    }
    let mut all = source.extras.clone();
    all.add(Extras { put_right, ..extras.clone() });
    source.clone().with(all).open(&progress)
}

struct Intake {
    engine: Engine,
    events: Receiver<Event>,
    stop: Arc<AtomicBool>,
    shown: Arc<Mutex<Shown>>,
    progress: Arc<Progress>,
    begun: Instant,
    calculates: bool,
}

impl Intake {
    /// Takes in all that comes, until the source has ended, or nobody wants more.
    fn run(mut self) -> Finished {
        let (outcomes, judged) = channel();
        let first = calculating(true, &outcomes, &self.progress);
        let second = calculating(false, &outcomes, &self.progress);
        let advising = Advising::start(&self.progress);
        let mut ticked = Instant::now();
        let mut leaves_at = None;
        loop {
            let tick_in = Duration::from_secs_f64(TICK_S).saturating_sub(ticked.elapsed());
            let ended = match self.events.recv_timeout(tick_in.min(NAP)) {
                Ok(event) => {
                    // How the connection is is told at once.
                    let is_news = matches!(event, Event::Connected(_) | Event::Lost { .. });
                    self.engine.take(event, self.clock_s());
                    if is_news {
                        self.show();
                    }
                    false
                }
                Err(RecvTimeoutError::Timeout) => {
                    let is_wanted = !self.stop.load(Relaxed);
                    let now = Instant::now();
                    !is_wanted && now >= *leaves_at.get_or_insert(now + LEAVES_WITHIN)
                }
                Err(RecvTimeoutError::Disconnected) => true,
            };
            while let Ok((outcome, answered)) = judged.try_recv() {
                self.judged(outcome, &answered, &advising);
            }
            let handed_in = std::mem::take(&mut lock(&self.shown).answered);
            for answered in handed_in {
                let known = self.engine.known();
                let Answered { deployment, analysis, is_first } = &answered;
                let outcome = judge(deployment, analysis, *is_first, known.as_deref());
                self.judged(outcome, &answered, &advising);
            }
            if let Some(moves) = advising.found() {
                self.engine.advised(moves, self.clock_s());
            }
            if ended {
                break;
            }
            if ticked.elapsed().as_secs_f64() >= TICK_S {
                ticked = Instant::now();
                self.tick(&first, &second);
            }
        }
        if let Some(around) = lock(&self.shown).around.take() {
            self.engine.read_with(*around);
        }
        let recorded = self.engine.finish_recording();
        self.show();
        let mut view = (*lock(&self.shown).view).clone();
        if let Some(Ok(recorded)) = &recorded {
            view.recorded = Some(recorded.clone());
        }
        let closing = Closing::new(self.engine.coach().clone());
        Finished { deployment: self.engine.deployment(), view, recorded, closing }
    }

    fn clock_s(&self) -> f64 {
        self.begun.elapsed().as_secs_f64()
    }

    fn judged(&mut self, outcome: Outcome, answered: &Answered, advising: &Advising) {
        let clock_s = self.clock_s();
        self.engine.judged(outcome, clock_s);
        let Answered { deployment, analysis, is_first } = answered;
        if !is_first && analysis.answer.is_ok() && self.engine.begins_to_advise(clock_s) {
            advising.think(deployment, analysis, self.engine.target_m());
        }
    }

    fn tick(&mut self, first: &Sender<Job>, second: &Sender<Job>) {
        self.engine.flush();
        let (settings, target_m, around) = {
            let mut shown = lock(&self.shown);
            (shown.settings, shown.target_m.take(), shown.around.take())
        };
        if let Some(target_m) = target_m {
            self.engine.aim(target_m);
        }
        if let Some(around) = around {
            self.engine.read_with(*around);
            // What waits to be taken was read otherwise.
            let mut shown = lock(&self.shown);
            (shown.deployment, shown.is_taken) = (None, true);
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
    fn calculate(&mut self, settings: &Settings, first: &Sender<Job>, second: &Sender<Job>) {
        // One that has no paper's answer beside it comes by the second alone.
        let is_joint = settings.calibration.method.unwrap_or_default() == Method::Joint;
        let Some(due) = self.engine.due(is_joint, self.clock_s()) else { return };
        let deployment = Arc::new(due.deployment);
        for (_, jobs) in [(due.first, first), (due.second, second)].iter().filter(|(is, _)| *is) {
            let known = self.engine.known();
            // A thread that is gone takes nothing, and is never free again.
            _ = jobs.send(Job { deployment: Arc::clone(&deployment), settings: *settings, known });
        }
    }

    fn show(&mut self) {
        let view = self.engine.view(self.clock_s());
        lock(&self.shown).view = Arc::new(view);
    }
}

/// What is to be calculated.
struct Job {
    deployment: Arc<Deployment>,
    settings: Settings,
    known: Option<Arc<Judged>>,
}

/// Starts a thread that calculates one snapshot after the other.
fn calculating(
    is_first: bool,
    outcomes: &Sender<(Outcome, Answered)>,
    progress: &Arc<Progress>,
) -> Sender<Job> {
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
    jobs
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As one that looks up a name, or waits for a computer that does not answer.
    #[test]
    fn who_stops_does_not_wait_for_a_source_that_does_not_notice() {
        let growing = Growing::around("live", None, &Extras::default(), &Progress::default());
        let engine = Engine::new(growing.expect("nothing is read"), None, None, 2e-3);
        let (send, events) = sync_channel(QUEUE);
        let (release, released) = channel::<()>();
        let has_left = Arc::new(AtomicBool::new(false));
        let left = Arc::clone(&has_left);
        let source = std::thread::spawn(move || {
            send.send(Event::Connected("robot".to_owned())).expect("somebody listens");
            // What holds it up for so long notices nothing.
            _ = released.recv_timeout(Duration::from_secs(60));
            left.store(true, Relaxed);
            send.send(Event::Ended).is_err()
        });
        let stop = Arc::new(AtomicBool::new(false));
        let session = Session::listening(engine, events, stop, Settings::default(), true);
        let finished = session.stop().expect("it does not panic");
        assert!(!has_left.load(Relaxed), "it was waited for");
        assert_eq!(finished.view.connections, 1, "what had arrived is taken in");
        release.send(()).expect("it waits");
        assert!(source.join().expect("it does not panic"), "nobody listens any more");
    }
}
