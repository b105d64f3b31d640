//! A live deployment and its threads, behind one handle: one listens, one processes events, two calculate answers, one
//! searches for manoeuvres.
//!
//! ```text
//! source ──events──▶ intake (engine) ──snapshot──▶ the paper's answer ─┐
//!                      ▲  │      └──────snapshot──▶ the settings' answer ─┤
//!                      │  └─▶ view, newest deployment                    │
//!                      └────────────────outcomes────────────────────────┘
//! ```
//! Queues are short: a fast producer waits for its consumer. A snapshot is made only when a calculator is free, so
//! every answer uses the newest readings.

use resect_core::network::{PerStation, Station};
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
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;
use resect_io::error::OpenError;
use resect_io::growing::Growing;
use resect_io::source::{Extras, Source};

/// Capacity of the queue of events.
const QUEUE: usize = 1024;
/// Interval of views, flushes of the recording, and snapshots (s).
const TICK_S: f64 = 1.0;
/// Poll interval of the stop flag.
const NAP: Duration = Duration::from_millis(100);
/// Time that a source has to stop. Sources notice late while they look up a name or wait for a computer to answer.
const LEAVES_WITHIN: Duration = Duration::from_millis(300);

/// Source of readings.
#[derive(Clone, Debug, PartialEq)]
pub enum Feed {
    /// Address of a stream.
    Url(String),
    /// A deployment, replayed at `speed` times the speed of the drive.
    Replay { source: Box<Source>, speed: f64 },
}

/// Configuration of a live deployment.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    pub feed: Feed,
    /// Folder with the rig, control points and `deployment.toml`.
    pub deployment: Option<PathBuf>,
    pub extras: Extras,
    /// Instruments of stations 1, 2, …, if messages name instruments.
    pub instruments: Option<PerStation<String>>,
    pub settings: Settings,
    pub record: Option<PathBuf>,
    /// True if the session calculates answers itself; otherwise its owner hands them in ([`Session::answered`]).
    pub calculates: bool,
    /// Target for σ at the far end of the track (m).
    pub target_m: f64,
}

/// Reason why a session cannot start.
#[derive(Debug, thiserror::Error)]
pub enum LiveError {
    #[error(transparent)]
    Address(#[from] AddressError),
    #[error(transparent)]
    Open(#[from] OpenError),
    #[error(transparent)]
    Record(#[from] RecordError),
    #[error("{0} is not a speed; give a number above 0 (1 is real time)")]
    Speed(f64),
    #[error("{0} mm is not a target; give a number above 0")]
    Target(f64),
}

/// Result of a live deployment that has ended.
pub struct Finished {
    pub deployment: Result<Deployment, OpenError>,
    pub view: View,
    pub recorded: Option<Result<Recorded, RecordError>>,
    /// State that is needed to describe the answer to all readings.
    pub closing: Closing,
}

/// Data shared by the session's owner and its threads.
#[derive(Default)]
struct Shown {
    view: Arc<View>,
    deployment: Option<Arc<Deployment>>,
    target_m: Option<f64>,
    settings: Settings,
    /// Replacement for everything but the readings.
    around: Option<Box<Growing>>,
    /// True if the newest deployment was taken, so the next is wanted.
    is_taken: bool,
    /// Answers that were handed in.
    answered: Vec<Answered>,
}

/// An answer, with the deployment that it belongs to.
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
    /// Starts to listen.
    pub fn start(wanted: &Wanted) -> Result<Self, LiveError> {
        if !(wanted.target_m > 0.0 && wanted.target_m.is_finite()) {
            return Err(LiveError::Target(wanted.target_m * 1e3));
        }
        let stop = Arc::new(AtomicBool::new(false));
        let (send, events) = sync_channel(QUEUE);
        let (growing, speed, source) = prepare(wanted, Arc::clone(&stop), send)?;
        // The recording is created last, when everything else is valid.
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

    /// Returns the current view.
    pub fn view(&self) -> Arc<View> {
        Arc::clone(&lock(&self.shown).view)
    }

    /// Returns the newest deployment, once; the next is made after this one was taken.
    pub fn take_deployment(&self) -> Option<Arc<Deployment>> {
        let mut shown = lock(&self.shown);
        let taken = shown.deployment.take();
        shown.is_taken |= taken.is_some();
        taken
    }

    /// Hands in an answer to a deployment that was taken; `is_first` is true for the paper's method.
    pub fn answered(&self, deployment: Arc<Deployment>, analysis: Arc<Analysis>, is_first: bool) {
        lock(&self.shown).answered.push(Answered { deployment, analysis, is_first });
    }

    /// Sets the target (m).
    pub fn aim(&self, target_m: f64) {
        lock(&self.shown).target_m = Some(target_m);
    }

    /// Sets the settings of the next calculations.
    pub fn set(&self, settings: &Settings) {
        lock(&self.shown).settings = *settings;
    }

    /// Re-reads all readings, past and future, with the result of [`around`].
    pub fn read_with(&self, around: Growing) {
        lock(&self.shown).around = Some(Box::new(around));
    }

    /// Returns true if the source has ended and all of it was processed.
    pub fn has_ended(&self) -> bool {
        self.intake.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Stops the session: processes the events that have arrived, and finishes the recording.
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
    /// Finishes the recording first, so that nothing is lost.
    fn drop(&mut self) {
        self.leave();
        if let Some(intake) = self.intake.take() {
            // A thread that panicked has nothing to finish.
            _ = intake.join();
        }
    }
}

fn lock(shown: &Mutex<Shown>) -> std::sync::MutexGuard<'_, Shown> {
    shown.lock().unwrap_or_else(PoisonError::into_inner)
}

type Work = Box<dyn FnOnce() + Send>;

/// Returns the deployment without readings, the speed of a replay, and the work of the listening thread.
fn prepare(
    wanted: &Wanted,
    stop: Arc<AtomicBool>,
    send: SyncSender<Event>,
) -> Result<(Growing, Option<f64>, Work), LiveError> {
    match &wanted.feed {
        Feed::Url(url) => {
            let address = connect::address(url)?;
            let mut growing = around(wanted, &wanted.extras)?;
            let stations = wanted.instruments.clone();
            growing.expect_stations(stations.as_ref().map_or(0, PerStation::len));
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
            let work = move || replay::run(&deployment, &added_m, speed, &stop, &send);
            Ok((growing, Some(speed), Box::new(work)))
        }
    }
}

/// Reads everything but the readings, with other extras: the user's corrections during the drive.
pub fn around(wanted: &Wanted, extras: &Extras) -> Result<Growing, LiveError> {
    let progress = Progress::default();
    let folder = wanted.deployment.as_deref();
    let name = match &wanted.feed {
        Feed::Url(url) => connect::address(url)?.host().unwrap_or("live").to_owned(),
        Feed::Replay { source, .. } if folder.is_none() => {
            let deployment = beside_readings(source, extras)?;
            return Ok(Growing::of_readings_again(deployment, &extras.corrections));
        }
        Feed::Replay { source, .. } => source.open(&progress)?.name,
    };
    Ok(Growing::around(&name, folder, extras, &progress)?)
}

/// Opens a replayed deployment with the corrections that do not concern its readings; the readings come again from the replay.
fn beside_readings(source: &Source, extras: &Extras) -> Result<Deployment, OpenError> {
    let progress = Progress::default();
    let mut corrections = extras.corrections.beside_readings();
    if let Some(numbers) = &extras.corrections.stations {
        // Stations of a replay have the numbers with which they were read; control points have those of their files.
        let own = source.open(&progress)?.station_numbers();
        let number = |read: i64| Station::numbered(usize::try_from(read).ok()?);
        let number = |read: i64| number(read).and_then(|station| own.get(station)).copied();
        corrections.stations = Some(numbers.map(|read| number(*read).unwrap_or(*read)));
    }
    let mut all = source.extras.clone();
    all.add(Extras { corrections, ..extras.clone() });
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
    /// Processes all events, until the source ends or the session stops.
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
                    // Changes of the connection are shown at once.
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
            // The waiting deployment was read with the former overrides.
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

    /// Passes the newest readings to the free calculators.
    fn calculate(&mut self, settings: &Settings, first: &Sender<Job>, second: &Sender<Job>) {
        // Only a joint estimate has the paper's answer beside it.
        let is_joint = settings.calibration.method.unwrap_or_default() == Method::Joint;
        let Some(due) = self.engine.due(is_joint, self.clock_s()) else { return };
        let deployment = Arc::new(due.deployment);
        for (_, jobs) in [(due.first, first), (due.second, second)].iter().filter(|(is, _)| *is) {
            let known = self.engine.known();
            // A thread that has ended accepts no job and never becomes free.
            _ = jobs.send(Job { deployment: Arc::clone(&deployment), settings: *settings, known });
        }
    }

    fn show(&mut self) {
        let view = self.engine.view(self.clock_s());
        lock(&self.shown).view = Arc::new(view);
    }
}

/// Task of a calculating thread.
struct Job {
    deployment: Arc<Deployment>,
    settings: Settings,
    known: Option<Arc<Judged>>,
}

/// Starts a thread that analyses one snapshot after the other.
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
            // The session was cancelled.
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

    /// Simulates a source that looks up a name, or waits for a computer that does not answer.
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
            // The blocked source does not notice the stop.
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
