//! Conversion of the records of files into tracks of stations: impossible measurements are counted and left out.

use super::reading_sense::{self, Impossible, StationSense};
use crate::error::OpenError;
use crate::findings::readings::{
    clock_set_back, readings_in_face_right, records_dropped, stamps_out_of_order, stamps_repeated,
    station_without_readings,
};
use resect_core::deployment::printable::printable;
use resect_core::deployment::{
    Finding, Measurement, RawRecord, TimeCorrection, Track, as_numbered, list_of,
};
use resect_core::geometry::Polar;
use resect_core::network::{MOST_STATIONS, PerStation, USUAL_STATIONS};
use resect_core::statistics::median;

/// Number of different station numbers that are remembered: more are no stations.
const MOST_NUMBERS: usize = MOST_STATIONS + 1;
/// Records of a number that is a station's, and not a slip.
const FEWEST_OF_A_STATION: usize = 10;
/// A number with fewer records is a station's as well if it has this share of those of the most frequent number.
const SHARE_OF_A_STATION: f64 = 0.5;
/// Reason for dropping a record, before the station numbers are known.
const UNKNOWN_NUMBER: &str = "a station number other than";
/// Shortest step of a clock that is reported (s): recorders write readings a little out of order.
const LEAST_SET_BACK_S: f64 = 0.5;
/// Readings of a time that the clock showed twice are this many times denser than elsewhere, at least.
const DENSER: f64 = 1.5;
/// Number of steps of a track that are examined.
const MOST_SET_BACKS: usize = 20;
/// Number of reasons named in the error about a recording without a reading.
const REASONS_IN_AN_ERROR: usize = 3;

/// The readings of one station, and what was seen of the others.
#[derive(Clone, Debug, Default)]
struct StationRecording {
    track: Track,
    late: usize,
    /// Number of readings in face right, converted to face left.
    face_right: usize,
    /// Largest time by which stamps go back into a time with other readings (s); 0 if none does.
    set_back_s: f64,
    /// True if the track contains late readings and is not sorted yet.
    is_unsorted: bool,
    /// Number of repeated stamps, and the place of the first.
    duplicates: (usize, Option<String>),
    sense: StationSense,
    time_corrections: Vec<TimeCorrection>,
    /// Place of the first record.
    first_place: Option<String>,
}

/// Collects the readings of tracks, file by file: usable ones, and counts of the others by reason.
#[derive(Clone, Debug)]
pub struct Recording {
    file: String,
    place_word: &'static str,
    /// Numbers that the files give to stations 1, 2, ….
    numbers: Option<PerStation<i64>>,
    /// Number of stations that the names of files or topics state; 0 without.
    stated: usize,
    counter_clockwise: bool,
    stations: PerStation<StationRecording>,
    dropped: DropCounts,
    /// Different station numbers of the records, up to [`MOST_NUMBERS`], and how often they occur.
    numbers_seen: Vec<(i64, usize)>,
    /// True if the ranges contain the prism constant already, as coordinates do.
    pub ranges_include_prism_constant: bool,
    /// Findings about the readings.
    pub findings: Vec<Finding>,
}

impl Recording {
    /// Returns an empty recording; `numbers` are the files' numbers of stations 1, 2, …, and the sense applies to azimuths.
    ///
    /// Without numbers, the records determine the number of stations.
    pub fn new(numbers: Option<&PerStation<i64>>, counter_clockwise: bool) -> Self {
        let count = numbers.map_or(USUAL_STATIONS, PerStation::len);
        Self {
            file: String::new(),
            place_word: "",
            numbers: numbers.cloned(),
            stated: 0,
            counter_clockwise,
            stations: (0..count).map(|_| StationRecording::default()).collect(),
            dropped: DropCounts::default(),
            numbers_seen: Vec::new(),
            ranges_include_prism_constant: false,
            findings: Vec::new(),
        }
    }

    /// Begins a file, to which the next records belong; a place in it is called `place_word` ("line", "message").
    pub fn begin_file(&mut self, file: &str, place_word: &'static str) {
        (self.file, self.place_word) = (file.to_owned(), place_word);
    }

    /// States that there are at least this many stations, even without records.
    pub fn expect_stations(&mut self, count: usize) {
        self.stated = self.stated.max(count);
        let is_empty = self.numbers_seen.is_empty() && self.stated > 0;
        if self.numbers.is_none() && (self.stations.len() < count || is_empty) {
            self.stations.resize_with(self.stated, StationRecording::default);
        }
    }

    /// Calls stations without a name by their numbers in the files.
    pub fn name_by_numbers(&mut self, numbers: &PerStation<i64>) {
        for (station, number) in numbers.iter().enumerate() {
            if self.tracks().nth(station).is_some_and(|track| track.name.is_none()) {
                self.name_station(station, &number.to_string());
            }
        }
    }

    /// States how the files call a station (from 0). A name that is only its number, like "/rts2" of station 2, says nothing.
    pub fn name_station(&mut self, station: usize, name: &str) {
        let digits: String = name.chars().filter(char::is_ascii_digit).collect();
        let is_number = digits.parse() == Ok(station + 1);
        if let Some(own) = self.stations.as_mut_slice().get_mut(station).filter(|_| !is_number) {
            own.track.name = Some(printable(name));
        }
    }

    /// Adds a record, or counts the reason why it cannot be a reading.
    pub fn push(&mut self, record: &RawRecord) {
        self.count_number(record.station);
        let mut m = record.measurement;
        let Measurement { range_m, azimuth_rad, zenith_rad, .. } = m;
        let (polar, is_face_right) = Polar { range_m, azimuth_rad, zenith_rad }.in_face_left();
        (m.azimuth_rad, m.zenith_rad) = (polar.azimuth_rad, polar.zenith_rad);
        let Some(station) = self.station_of(record.station) else {
            self.drop(None, UNKNOWN_NUMBER.to_owned(), record);
            return;
        };
        if self.stations.len() <= station {
            self.stations.resize_with(station + 1, StationRecording::default);
        }
        let (word, file) = (self.place_word, &self.file);
        let first_place = &mut self.stations[station].first_place;
        first_place.get_or_insert_with(|| format!("first at {word} {} of {file}", record.place));
        if record.status != 0 {
            let why = format!("status {} (no valid reading)", record.status);
            self.drop(Some(station), why, record);
            return;
        }
        let impossible = Impossible::of(&m);
        self.stations[station].sense.take(&m, impossible);
        match impossible {
            Some(impossible) => self.drop(Some(station), impossible.words().to_owned(), record),
            None => {
                self.stations[station].face_right += usize::from(is_face_right);
                if self.counter_clockwise {
                    m.azimuth_rad = -m.azimuth_rad;
                }
                self.keep(station, m, record);
            }
        }
    }

    /// Changes the numbers of stations 1, 2, … and the sense of azimuths, also for the readings so far. Returns the former index of
    /// each station. Readings of numbers that had no station are lost, and remain counted as dropped.
    pub fn count_as(
        &mut self,
        numbers: Option<&PerStation<i64>>,
        counter_clockwise: bool,
    ) -> PerStation<Option<usize>> {
        let usual = as_numbered(self.stations.len().max(USUAL_STATIONS));
        let from = numbers.unwrap_or(&usual).map(|number| self.station_of(*number));
        self.numbers = numbers.cloned();
        let mut before = std::mem::take(&mut self.stations);
        // A station without a former index has no readings.
        self.stations = from.map(|from| {
            let recording = from.and_then(|own| before.as_mut_slice().get_mut(own));
            recording.map(std::mem::take).unwrap_or_default()
        });
        self.dropped.renumber(&from);
        if std::mem::replace(&mut self.counter_clockwise, counter_clockwise) != counter_clockwise {
            for m in self.stations.iter_mut().flat_map(|own| &mut own.track.measurements) {
                m.azimuth_rad = -m.azimuth_rad;
            }
        }
        from
    }

    /// Returns the index of the station with this number in the files; `None` for an unknown number.
    pub fn station_of(&self, number: i64) -> Option<usize> {
        match &self.numbers {
            Some(numbers) => numbers.iter().position(|own| *own == number),
            None => station_index(number),
        }
    }

    fn count_number(&mut self, number: i64) {
        let known = self.numbers_seen.iter().position(|(seen, _)| *seen == number);
        if let Some(index) = known {
            self.numbers_seen[index].1 += 1;
        } else if self.numbers_seen.len() < MOST_NUMBERS {
            self.numbers_seen.push((number, 1));
        }
    }

    /// Returns the station numbers of the records in ascending order, if they are others than 1, 2, ….
    ///
    /// A gap among small numbers is a station without readings, unless there are three numbers.
    pub fn other_numbers(&self) -> Option<PerStation<i64>> {
        let are_stations = self.numbers_seen.iter().all(|(_, count)| *count >= FEWEST_OF_A_STATION);
        let mut numbers: Vec<i64> = self.numbers_seen.iter().map(|(number, _)| *number).collect();
        numbers.sort_unstable();
        let (first, last) = (*numbers.first()?, *numbers.last()?);
        let is_numbering = first >= 1 && last <= MOST_STATIONS as i64;
        let are_others =
            !is_numbering || (numbers.len() == USUAL_STATIONS && last != USUAL_STATIONS as i64);
        let is_whole = are_stations && numbers.len() <= MOST_STATIONS && are_others;
        is_whole.then(|| numbers.into_iter().collect())
    }

    /// Returns the number of stations that the records, or the names of files, show.
    fn count_stations(&self) -> usize {
        if let Some(numbers) = &self.numbers {
            return numbers.len();
        }
        let most = self.numbers_seen.iter().map(|(_, count)| *count).max().unwrap_or_default();
        let is_station = |number: i64, count: usize| {
            number <= USUAL_STATIONS as i64
                || count >= FEWEST_OF_A_STATION
                || count as f64 >= SHARE_OF_A_STATION * most as f64
        };
        let seen = self.numbers_seen.iter().filter(|(number, count)| is_station(*number, *count));
        let last = seen.filter_map(|(number, _)| station_index(*number)).max();
        last.map_or(0, |last| last + 1).max(self.stated).max(1)
    }

    /// Removes the stations that do not exist; the records of their numbers are slips.
    pub fn remove_absent_stations(&mut self) {
        let count = self.count_stations();
        for absent in self.stations.as_mut_slice().iter_mut().skip(count) {
            let records = absent.track.measurements.len() + absent.duplicates.0;
            if let Some(place) = absent.first_place.take().filter(|_| records > 0) {
                self.dropped.add_several((None, UNKNOWN_NUMBER.to_owned()), records, || place);
            }
        }
        self.stations.resize_with(count, StationRecording::default);
    }

    fn keep(&mut self, station: usize, measurement: Measurement, record: &RawRecord) {
        let StationRecording { track, late, is_unsorted, duplicates, .. } =
            &mut self.stations[station];
        match track.measurements.last() {
            Some(last) if measurement.time_s == last.time_s => {
                let (count, first) = duplicates;
                *count += 1;
                let (word, file) = (self.place_word, &self.file);
                first.get_or_insert_with(|| {
                    format!(" (first at {word} {} of {file})", record.place)
                });
                return;
            }
            Some(last) if measurement.time_s < last.time_s => {
                *late += 1;
                *is_unsorted = true;
            }
            _ => {}
        }
        if let Some(own_clock_s) = record.own_clock_s {
            // Earlier readings without the station's clock get NaN.
            track.own_clock_s.resize(track.measurements.len(), f64::NAN);
            track.own_clock_s.push(own_clock_s);
        }
        track.measurements.push(measurement);
    }

    fn drop(&mut self, station: Option<usize>, why: String, record: &RawRecord) {
        let (word, file) = (self.place_word, &self.file);
        self.dropped.add((station, why), || format!("first at {word} {} of {file}", record.place));
    }

    /// Adds a correction of a station's clock; `number` is the station's number in the files.
    pub fn push_correction(&mut self, number: i64, correction: TimeCorrection) {
        if let Some(station) = self.station_of(number) {
            self.stations[station].time_corrections.push(correction);
        }
    }

    /// Returns findings about units, clocks and the share of impossible readings; an error if a column cannot be in its unit.
    pub fn check_sense(&self, files: &str) -> Result<Vec<Finding>, OpenError> {
        reading_sense::check(
            &self.stations.iter().map(|own| &own.sense).collect(),
            files,
            self.place_word == "line",
        )
    }

    /// Sorts the readings so far by time, and removes repeated stamps; the first reading of each stays.
    pub fn settle(&mut self) {
        for StationRecording { track, set_back_s, is_unsorted, duplicates, .. } in
            &mut self.stations
        {
            if !track.own_clock_s.is_empty() {
                track.own_clock_s.resize(track.measurements.len(), f64::NAN);
            }
            if std::mem::take(is_unsorted) {
                *set_back_s = set_back_s.max(largest_set_back_s(&track.measurements));
                duplicates.0 += sort_by_time(track);
            }
        }
    }

    /// Tracks so far; in order of time after [`Self::settle`].
    pub fn tracks(&self) -> impl ExactSizeIterator<Item = &Track> {
        self.stations.iter().map(|own| &own.track)
    }

    /// Removes the corrections of the stations' clocks, and returns them.
    pub fn take_time_corrections(&mut self) -> PerStation<Vec<TimeCorrection>> {
        let take = |own: &mut StationRecording| std::mem::take(&mut own.time_corrections);
        self.stations.iter_mut().map(take).collect()
    }

    /// Number of late and of repeated readings, for each station.
    pub fn late_and_repeated(&self) -> PerStation<[usize; 2]> {
        self.stations.map(|own| [own.late, own.duplicates.0])
    }

    /// Number of records that cannot be readings.
    pub fn dropped(&self) -> usize {
        self.dropped.0.iter().map(|(_, count, _)| count).sum()
    }

    /// Returns the tracks in order of time, and all findings; `files` names the source in errors.
    ///
    /// Without any usable reading, an error with the reasons why the records were dropped.
    pub fn finish(mut self, files: &str) -> Result<(PerStation<Track>, Vec<Finding>), OpenError> {
        self.remove_absent_stations();
        self.settle();
        let numbers = self.numbers.clone().unwrap_or_else(|| as_numbered(self.stations.len()));
        let Self { stations, mut dropped, mut findings, .. } = self;
        dropped.complete_unknown_numbers(&numbers);
        if stations.iter().all(|own| own.track.measurements.is_empty()) {
            return Err(OpenError::file(
                files,
                format!("no usable measurement of any station{}", dropped.in_words()),
                "stations are numbered from 1 and a valid reading has status 0",
            ));
        }
        let with_readings = stations.iter().zip(&numbers);
        let with_readings = with_readings.filter(|(own, _)| !own.track.measurements.is_empty());
        let others = list_of(with_readings.map(|(_, number)| *number));
        findings.extend(dropped.into_findings());
        findings.extend(clock_set_back(&stations.map(|own| own.set_back_s)));
        for (station, own) in stations.iter().enumerate().filter(|(_, own)| own.face_right > 0) {
            let count = own.track.measurements.len();
            findings.push(readings_in_face_right(station, own.face_right, count));
        }
        let tracks = stations
            .into_iter()
            .enumerate()
            .map(|(station, own)| {
                let StationRecording { track, late, duplicates: (repeated, first), .. } = own;
                if late > 0 {
                    findings.push(stamps_out_of_order(station, late, files));
                }
                if repeated > 0 {
                    let first = first.unwrap_or_default();
                    findings.push(stamps_repeated(station, repeated, &first));
                }
                if track.measurements.is_empty() {
                    findings.push(station_without_readings(station, files, &others));
                }
                track
            })
            .collect();
        Ok((tracks, findings))
    }
}

/// Returns the largest time by which stamps go back (s), if readings before and after the step share a time in which they are denser
/// than elsewhere: the clock was set back. Readings that arrive late, and parts of a file in another order, are not denser.
fn largest_set_back_s(readings: &[Measurement]) -> f64 {
    let ahead_s = readings.windows(2).map(|pair| pair[1].time_s - pair[0].time_s);
    let Some(interval_s) = median(ahead_s.filter(|ahead_s| *ahead_s > 0.0)) else { return 0.0 };
    let steps = (1..readings.len())
        .map(|index| (index, readings[index - 1].time_s - readings[index].time_s))
        .filter(|(_, back_s)| *back_s > LEAST_SET_BACK_S)
        .take(MOST_SET_BACKS);
    let is_set_back = |(index, _): &(usize, f64)| {
        let parts: [Vec<f64>; 2] = [&readings[..*index], &readings[*index..]].map(|part| {
            let mut times_s: Vec<f64> = part.iter().map(|m| m.time_s).collect();
            times_s.sort_by(f64::total_cmp);
            times_s
        });
        let from_s = parts[0][0].max(parts[1][0]);
        let to_s =
            parts.iter().filter_map(|part| part.last()).copied().fold(f64::INFINITY, f64::min);
        let within = |time_s: &&f64| (from_s..=to_s).contains(*time_s);
        let is_new =
            |time_s: &&f64| parts[0].binary_search_by(|own| own.total_cmp(time_s)).is_err();
        let new = parts[1].iter().filter(within).filter(is_new).count();
        let all = parts[0].iter().filter(within).count() + new;
        new > 1 && all as f64 > DENSER * ((to_s - from_s) / interval_s + 1.0)
    };
    steps.filter(is_set_back).map(|(_, back_s)| back_s).fold(0.0, f64::max)
}

/// Sorts a track by time and removes repeated stamps; returns the number removed.
fn sort_by_time(track: &mut Track) -> usize {
    let readings = &track.measurements;
    let mut order: Vec<usize> = (0..readings.len()).collect();
    order.sort_by(|a, b| readings[*a].time_s.total_cmp(&readings[*b].time_s));
    let before = order.len();
    order.dedup_by(|later, kept| readings[*later].time_s == readings[*kept].time_s);
    let measurements = order.iter().map(|index| readings[*index]).collect();
    if !track.own_clock_s.is_empty() {
        track.own_clock_s = order.iter().map(|index| track.own_clock_s[*index]).collect();
    }
    track.measurements = measurements;
    before - order.len()
}

/// Returns the place of a station number from 1 to 8 in a list; `None` for other numbers.
pub fn station_index(number: i64) -> Option<usize> {
    (1..=MOST_STATIONS as i64).contains(&number).then(|| number as usize - 1)
}

/// Counts of left-out records by station (if known) and reason, each with its first place.
#[derive(Clone, Debug, Default)]
struct DropCounts(Vec<(Reason, usize, String)>);

type Reason = (Option<usize>, String);

fn reason_in_words((station, why): &Reason) -> String {
    match station {
        Some(station) => format!("station {}: {why}", station + 1),
        None => why.clone(),
    }
}

impl DropCounts {
    fn add(&mut self, reason: Reason, place: impl FnOnce() -> String) {
        self.add_several(reason, 1, place);
    }

    fn add_several(&mut self, reason: Reason, more: usize, place: impl FnOnce() -> String) {
        match self.0.iter_mut().find(|(known, _, _)| *known == reason) {
            Some((_, count, _)) => *count += more,
            None => self.0.push((reason, more, place())),
        }
    }

    /// Names the known numbers in the reason of unknown ones.
    fn complete_unknown_numbers(&mut self, known: &PerStation<i64>) {
        let list = known.map(ToString::to_string).as_slice().join(", ");
        for ((_, why), _, _) in self.0.iter_mut().filter(|((_, why), ..)| why == UNKNOWN_NUMBER) {
            *why = format!("{UNKNOWN_NUMBER} {list}");
        }
    }

    /// Renumbers the stations of the reasons; `from[i]` is the former index of station i. Stations without a new index become `None`.
    fn renumber(&mut self, from: &PerStation<Option<usize>>) {
        for ((station, _), _, _) in &mut self.0 {
            *station = station.and_then(|own| from.iter().position(|before| *before == Some(own)));
        }
    }

    /// Returns ": " and the reasons, the most frequent first; empty if nothing was dropped.
    fn in_words(&self) -> String {
        let mut reasons: Vec<_> = self.0.iter().collect();
        reasons.sort_by_key(|(_, count, _)| std::cmp::Reverse(*count));
        let (named, others) = reasons.split_at(reasons.len().min(REASONS_IN_AN_ERROR));
        let named = named.iter().map(|(reason, count, place)| {
            format!("{}, {count} times ({place})", reason_in_words(reason))
        });
        let named = named.collect::<Vec<_>>().join("; ");
        match (named.as_str(), others.len()) {
            ("", _) => String::new(),
            (named, 0) => format!(": {named}"),
            (named, more) => format!(": {named}; and {more} other reasons"),
        }
    }

    fn into_findings(self) -> impl Iterator<Item = Finding> {
        self.0
            .into_iter()
            .map(|((station, why), count, place)| records_dropped(station, &why, count, &place))
    }
}

#[cfg(test)]
mod tests;
