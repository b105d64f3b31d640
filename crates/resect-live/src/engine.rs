//! State of a live deployment, without threads and without a clock: takes events and outcomes, returns snapshots and views.

use crate::kinds;
use resect_core::network::PerStation;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

use super::coach::Coach;
use super::event::{Channel, Event, LeftOut, Sent};
use super::judged::{Judged, Outcome};
use super::next;
use super::pace::Pace;
use super::recorder::{RecordError, Recorded, Recorder};
use super::status::{StationStatus, Watch};
use super::view::{Left, Link, View};
use super::warnings::{Seen, Told, Warning, amiss, speaks_against_readings};
use resect_core::deployment::printable::printable;
use resect_core::deployment::{Deployment, Track};
use resect_io::error::OpenError;
use resect_io::format::bag::stream::{Heard, Subscription};
use resect_io::format::bag::wire::Encoding;
use resect_io::growing::Growing;
use resect_tools::planning::NextMove;

/// Longest time for which an answer remains the reference of later readings (s).
const LONGEST_KNOWN_S: f64 = 60.0;

/// The newest readings, for the free calculators.
pub struct Due {
    pub deployment: Deployment,
    /// True if the answer by the paper's method (`first`), and that with the chosen settings (`second`), is due.
    pub first: bool,
    pub second: bool,
}

/// Processes the events of a source and the outcomes of calculations.
pub struct Engine {
    growing: Growing,
    /// Speed of the source, in multiples of the drive's speed.
    speed: f64,
    is_live: bool,
    subscriptions: HashMap<u64, Subscription>,
    recorder: Option<Recorder>,
    /// Reason why the recording stopped, with its content until then.
    not_recorded: Option<(String, Recorded)>,
    link: Link,
    connections: u64,
    messages: u64,
    watches: PerStation<Watch>,
    left_out: BTreeMap<LeftOut, (u64, String)>,
    /// Time at which the newest message was sent (s, the source's clock), and of its arrival (s, our clock).
    newest_sent_s: Option<(f64, f64)>,
    coach: Coach,
    /// Next manoeuvres, the best first.
    moves: Vec<NextMove>,
    /// Time at which they were found (s, the source's clock).
    moves_since_s: f64,
    told: Told,
    warnings: Vec<Warning>,
    first: Option<Arc<Judged>>,
    answer: Option<Arc<Judged>>,
    /// Reference answer for later readings.
    known: Option<Arc<Judged>>,
    latest: [Option<Outcome>; 2],
    /// Paces of the answers by the paper's method and with the chosen settings, and of the search for manoeuvres.
    paces: [Pace; 2],
    advising: Pace,
    /// Number of messages in the newest snapshot.
    snapshot_of: u64,
}

impl Engine {
    /// `replay_speed` is in multiples of the drive's speed; `None` for a live source.
    pub fn new(
        growing: Growing,
        replay_speed: Option<f64>,
        recorder: Option<Recorder>,
        target_m: f64,
    ) -> Self {
        let stations = growing.late_and_repeated().len();
        Self {
            growing,
            speed: replay_speed.unwrap_or(1.0),
            is_live: replay_speed.is_none(),
            subscriptions: HashMap::new(),
            recorder,
            not_recorded: None,
            link: Link::default(),
            connections: 0,
            messages: 0,
            watches: PerStation::repeat(stations, Watch::default()),
            left_out: BTreeMap::new(),
            newest_sent_s: None,
            coach: Coach::new(target_m),
            moves: Vec::new(),
            moves_since_s: 0.0,
            told: Told::default(),
            warnings: Vec::new(),
            first: None,
            answer: None,
            known: None,
            latest: [None, None],
            paces: Default::default(),
            advising: Pace::default(),
            snapshot_of: 0,
        }
    }

    /// Processes an event at an instant of our own clock (s, from any start).
    pub fn take(&mut self, event: Event, clock_s: f64) {
        match event {
            Event::Connected(to) => {
                self.link = Link::Connected(printable(&to));
                self.connections += 1;
                self.subscriptions.clear();
                if let Some(recorder) = &mut self.recorder {
                    recorder.forget_channels();
                }
            }
            Event::Lost { why, again_in_s } => self.link = Link::Lost { why, again_in_s },
            Event::Ended => self.link = Link::Ended,
            Event::Channel(channel) => self.channel(&channel),
            Event::Message(sent) => self.message(&sent, clock_s),
            Event::LeftOut { what, count, first } => self.leave_out(what, count, &first),
        }
    }

    fn leave_out(&mut self, what: LeftOut, count: u64, first: &str) {
        let (known, _) = self.left_out.entry(what).or_insert_with(|| (0, printable(first)));
        *known += count;
    }

    fn channel(&mut self, channel: &Channel) {
        let encoding = match channel.encoding.as_str() {
            "ros1" => Encoding::Ros1,
            "json" => Encoding::Json,
            _ => Encoding::Cdr,
        };
        let wanted = self.growing.topic(&channel.topic, &channel.message_type, encoding);
        let Some(subscription) = wanted else { return };
        self.subscriptions.insert(channel.id, subscription);
        self.record(|recorder| recorder.channel(channel));
    }

    /// Records something. A failure ends the recording, and nothing else.
    fn record(&mut self, what: impl FnOnce(&mut Recorder) -> Result<(), RecordError>) {
        let Some(recorder) = &mut self.recorder else { return };
        if let Err(error) = what(recorder) {
            self.not_recorded = Some((error.to_string(), recorder.recorded()));
            self.recorder = None;
        }
    }

    fn message(&mut self, sent: &Sent, clock_s: f64) {
        let Some(subscription) = self.subscriptions.get(&sent.channel).copied() else { return };
        self.messages += 1;
        self.record(|recorder| recorder.message(sent));
        let sent_s = sent.sent_ns as f64 * 1e-9;
        if self.newest_sent_s.is_none_or(|(newest_s, _)| sent_s > newest_s) {
            self.newest_sent_s = Some((sent_s, clock_s));
        }
        match self.growing.message(subscription, sent_s, &sent.payload) {
            Ok(Heard::Record(record)) => {
                if let Some(station) = self.growing.station_of(record.station) {
                    self.watch(station).take(&record, sent);
                }
            }
            Ok(Heard::Correction { station: Some(station), correction }) => {
                self.watch(station).correct(correction.offset_s);
            }
            Ok(
                Heard::Correction { station: None, .. }
                | Heard::Pose { .. }
                | Heard::Transforms(_)
                | Heard::Fix { .. }
                | Heard::NotTaken,
            ) => {}
            Err(why) => self.leave_out(LeftOut::Malformed, 1, &why),
        }
    }

    /// Returns the watch of a station, which may be new.
    fn watch(&mut self, station: usize) -> &mut Watch {
        if self.watches.len() <= station {
            self.watches.resize_with(station + 1, Watch::default);
        }
        &mut self.watches[station]
    }

    /// Adds the outcome of an analysis of a snapshot, at an instant of our own clock (s).
    pub fn judged(&mut self, outcome: Outcome, clock_s: f64) {
        self.paces[usize::from(!outcome.is_first)].end(clock_s);
        let is_amiss = self.warnings.iter().any(|one| speaks_against_readings(one.finding.kind));
        self.coach.take(&outcome, is_amiss);
        if let Ok(judged) = &outcome.judged {
            let kept = if outcome.is_first { &mut self.first } else { &mut self.answer };
            *kept = Some(Arc::clone(judged));
            // An answer from readings of a wrong prism does not become the reference. If that lasts long, the earlier
            // reference may be the wrong one.
            let is_right = !outcome.wrong_pairs().iter().any(|is_off| *is_off);
            let is_old = |known: &Arc<Judged>| judged.up_to_s - known.up_to_s > LONGEST_KNOWN_S;
            if judged.is_sure() && (is_right || self.known.as_ref().is_none_or(is_old)) {
                self.known = Some(Arc::clone(judged));
            }
        }
        let place = usize::from(!outcome.is_first);
        self.latest[place] = Some(outcome);
    }

    /// Begins a search for manoeuvres, if one is due; returns true if the caller has to run it.
    pub fn begins_to_advise(&mut self, clock_s: f64) -> bool {
        self.advising.begin(clock_s)
    }

    /// Adds the next manoeuvres, the best first. They do not replace others that the driver may be driving.
    pub fn advised(&mut self, moves: Vec<NextMove>, clock_s: f64) {
        self.advising.end(clock_s);
        let now_s = self.newest_sent_s.map_or(0.0, |(sent_s, _)| sent_s);
        let far_end = self.answer.as_ref().and_then(|answer| answer.far_end);
        let sigma_m = far_end.map(|far_end| far_end.sigma_m);
        if next::replaces(&moves, &self.moves, now_s - self.moves_since_s, sigma_m) {
            (self.moves, self.moves_since_s) = (moves, now_s);
        }
    }

    pub fn coach(&self) -> &Coach {
        &self.coach
    }

    pub fn target_m(&self) -> f64 {
        self.coach.target_m
    }

    /// Replaces everything but the readings, and re-reads all of them with it. Earlier answers become invalid.
    pub fn read_with(&mut self, around: Growing) {
        let from = self.growing.read_with(around);
        let mut before = std::mem::take(&mut self.watches);
        self.watches = from.map(|from| {
            let watch = from.and_then(|own| before.as_mut_slice().get_mut(own));
            watch.map(std::mem::take).unwrap_or_default()
        });
        self.coach.doubt();
        (self.first, self.answer, self.known) = (None, None, None);
        (self.latest, self.moves) = ([None, None], Vec::new());
        // Forces a new snapshot, even without new messages.
        self.snapshot_of = u64::MAX;
    }

    /// Returns the reference answer for later readings.
    pub fn known(&self) -> Option<Arc<Judged>> {
        self.known.clone()
    }

    /// Returns the deployment so far; `None` if nothing came since the last snapshot.
    pub fn snapshot(&mut self) -> Option<Result<Deployment, OpenError>> {
        if self.snapshot_of == self.messages {
            return None;
        }
        self.snapshot_of = self.messages;
        Some(self.growing.deployment())
    }

    /// Returns the deployment so far for the free calculators, and marks them as busy. `None` if none is free, or
    /// nothing new came. The answer by the paper's method is due only beside a joint estimate.
    pub fn due(&mut self, is_joint: bool, clock_s: f64) -> Option<Due> {
        let wanted = [is_joint, true];
        let is_free = |of: usize| wanted[of] && self.paces[of].is_free(clock_s);
        if !is_free(0) && !is_free(1) {
            return None;
        }
        // An error means that there are no readings, or only invalid ones; the view reports it.
        let deployment = self.snapshot()?.ok()?;
        let [first, second] = [0, 1].map(|of| wanted[of] && self.paces[of].begin(clock_s));
        Some(Due { deployment, first, second })
    }

    /// Flushes the recording, so that it outlives this process.
    pub fn flush(&mut self) {
        self.record(Recorder::flush);
    }

    /// Sets the target (m).
    pub fn aim(&mut self, target_m: f64) {
        self.coach.aim(target_m);
    }

    /// Ends the recording.
    pub fn finish_recording(&mut self) -> Option<Result<Recorded, RecordError>> {
        self.recorder.take().map(Recorder::finish)
    }

    /// Returns the final deployment; an error without usable readings.
    pub fn deployment(&mut self) -> Result<Deployment, OpenError> {
        self.growing.deployment()
    }

    /// Returns the state at an instant of our own clock (s).
    pub fn view(&mut self, clock_s: f64) -> View {
        let now_s = self.newest_sent_s.map(|(sent_s, at_s)| match self.link {
            Link::Ended => sent_s,
            _ => sent_s + (clock_s - at_s).max(0.0) * self.speed,
        });
        let at_s = now_s.unwrap_or(0.0);
        let mut stations = self.watches.map(|watch| watch.status(at_s, self.is_live));
        if let Some(late_s) = self.answer.as_ref().and_then(|judged| judged.late_s.as_ref()) {
            for (station, late_s) in stations.iter_mut().zip(late_s).skip(1) {
                station.late_s = Some(*late_s);
            }
        }
        self.warn(at_s, &stations);
        let tracks: Vec<&Track> = self.growing.tracks().collect();
        let firsts = tracks.iter().filter_map(|track| Some(track.measurements.first()?.time_s));
        let lasts = tracks.iter().filter_map(|track| Some(track.measurements.last()?.time_s));
        let (start_s, end_s) = (firsts.min_by(f64::total_cmp), lasts.max_by(f64::total_cmp));
        let is_read_by_all = tracks.iter().all(|track| !track.measurements.is_empty());
        let age_s = self.answer.as_ref().zip(end_s).map(|(judged, end_s)| end_s - judged.up_to_s);
        let late_and_repeated = self.growing.late_and_repeated();
        let sum = |which: usize| late_and_repeated.iter().map(|counts| counts[which]).sum();
        let deciding = self.latest[1].as_ref().or(self.latest[0].as_ref());
        let sentence = match deciding {
            None if is_read_by_all => "Calculating the first answer.".to_owned(),
            _ => self.coach.sentence(deciding, &self.moves),
        };
        View {
            now_s,
            driven_s: start_s.zip(end_s).map_or(0.0, |(start_s, end_s)| end_s - start_s),
            link: self.link.clone(),
            connections: self.connections,
            messages: self.messages,
            stations,
            late: sum(0),
            repeated: sum(1),
            dropped: self.growing.dropped(),
            left_out: self
                .left_out
                .iter()
                .map(|(what, (count, first))| Left {
                    what: what.name(),
                    count: *count,
                    first: first.clone(),
                })
                .collect(),
            warnings: self.warnings.clone(),
            first: self.first.clone(),
            answer: self.answer.clone(),
            answer_age_s: age_s,
            target_m: self.coach.target_m,
            enough: self.coach.is_enough(),
            sentence,
            moves: self.moves.clone(),
            curves: self.coach.curves.clone(),
            recorded: match (&self.recorder, &self.not_recorded) {
                (Some(recorder), _) => Some(recorder.recorded()),
                (None, stopped) => stopped.as_ref().map(|(_, recorded)| recorded.clone()),
            },
        }
    }

    fn warn(&mut self, now_s: f64, stations: &PerStation<StationStatus>) {
        let lost = match &self.link {
            Link::Lost { why, .. } => Some(why.as_str()),
            _ => None,
        };
        let topics = self.growing.topics_of_no_station();
        let no_station = match self.left_out.get(&LeftOut::NoStation) {
            Some((_, first)) => Some(first.clone()),
            None if topics.is_empty() => None,
            None => Some(format!(
                "positions of {} are not read: their stations are unknown; give the topics of stations 1, 2, …",
                topics.join(", ")
            )),
        };
        let seen = Seen {
            lost,
            stations,
            clock_jumps: self.watches.map(Watch::clock_jump),
            deciding: self.answer.as_deref(),
            latest: self.latest[0].as_ref().or(self.latest[1].as_ref()),
            has_rig: self.growing.known_beforehand().rig.is_some()
                || self.growing.known_beforehand().prisms == Some(1),
            no_station: no_station.as_deref(),
            not_recorded: self.not_recorded.as_ref().map(|(why, _)| why.as_str()),
        };
        let mut amiss = amiss(&seen);
        if self.link == Link::Ended {
            // A lost lock cannot be corrected after the end.
            amiss.retain(|finding| finding.kind != kinds::LIVE_LOST_LOCK);
        }
        self.warnings = self.told.update(now_s, amiss);
        if self.warnings.iter().any(|one| speaks_against_readings(one.finding.kind)) {
            self.coach.doubt();
        }
    }
}
