//! The keys of `deployment.toml`, which the window can set as well.

use serde::{Deserialize, Serialize};

use super::ColumnMapping;
use super::stated_prisms::{FollowedPrisms, StatedPrismChange};
use crate::network::{MOST_STATIONS, Pair, PerPair, PerPrism, PerStation, Station, USUAL_STATIONS};

/// Subject of a key: the data that it applies to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum KeySubject {
    /// The readings of one drive.
    Readings,
    /// Other files of one drive, and its name.
    Files,
    /// The notation of the readings, in each drive.
    Writing,
    /// The vehicle, in each drive.
    Vehicle,
}

/// A key of [`Overrides`] with its name and value in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OverrideInWords {
    pub key: &'static str,
    /// Name of the key in the window.
    pub name: &'static str,
    /// `None` if only the files determine it.
    pub value: Option<String>,
}

/// Returns the station numbers of files without an override.
pub fn as_numbered(stations: usize) -> PerStation<i64> {
    (1..).take(stations).collect()
}

/// Defines [`Overrides`] and its methods from one table. A row has the key, its type, its subject, its name in the window, the
/// default value, and the value in words.
macro_rules! override_keys {
    ($($(#[$doc:meta])+ $key:ident: $type:ty, $subject:ident, $name:literal, $silent:expr, $words:expr;)+) => {
        /// Overrides with which a deployment is read; an absent key leaves the automatic recognition unchanged. File names are
        /// relative to the folder.
        #[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
        #[serde(default, deny_unknown_fields)]
        pub struct Overrides {
            $($(#[$doc])+ #[serde(skip_serializing_if = "Option::is_none")] pub $key: Option<$type>,)+
        }

        impl Overrides {
            /// Returns these overrides, with those of `base` for the keys that are absent here.
            #[must_use]
            pub fn over(self, base: Self) -> Self {
                Self { $($key: self.$key.or(base.$key),)+ }
            }

            /// Returns the overrides that differ from those of the folder, `as_read`.
            #[must_use]
            pub fn beyond(self, as_read: &Self) -> Self {
                Self { $($key: {
                    let silent: Option<$type> = $silent;
                    differing(self.$key, as_read.$key.as_ref(), silent.as_ref())
                },)+ }
            }

            /// Returns the keys with an accepted subject.
            fn about(&self, accepts: impl Fn(KeySubject) -> bool) -> Self {
                Self { $($key: self.$key.clone().filter(|_| accepts(KeySubject::$subject)),)+ }
            }

            /// Returns all keys with their values in words.
            pub fn in_words(&self) -> Vec<OverrideInWords> {
                vec![$(OverrideInWords {
                    key: stringify!($key),
                    name: $name,
                    value: self.$key.clone().or($silent).map($words),
                },)+]
            }
        }
    };
}

/// Returns the value unless it equals that of the folder, or the default if the folder has none.
fn differing<T: PartialEq>(own: Option<T>, as_read: Option<&T>, silent: Option<&T>) -> Option<T> {
    own.filter(|own| as_read.or(silent) != Some(own))
}

override_keys! {
    /// Name of the deployment.
    name: String, Files, "name", None, |name| name;
    /// Files with the stations' tracks, if a folder has several.
    tracks: OneOrMany, Readings, "tracks", None, |files| files.as_slice().join(", ");
    /// Topics of stations 1, 2, … in a bag whose messages do not name their station.
    topics: PerStation<String>, Writing, "topics", None, |topics| topics.as_slice().join(", ");
    /// Numbers of stations 1, 2, … in the files: `[2, 1, 3]` exchanges the first two.
    stations: PerStation<i64>, Writing, "station numbers", Some(as_numbered(USUAL_STATIONS)),
        |numbers| numbers.map(ToString::to_string).as_slice().join(" ");
    /// Names of stations 1, 2, …, shown beside their numbers.
    station_names: PerStation<String>, Writing, "station names", None,
        |names| names.as_slice().join(", ");
    /// Direction in which azimuths of the tracks increase, seen from above; clockwise if absent.
    azimuth: AzimuthSense, Writing, "azimuth", Some(AzimuthSense::Clockwise),
        |sense| sense.title().to_owned();
    /// Prism constant, added to every range of tracks, control points and rig reading (m).
    prism_constant_m: PrismConstants, Writing, "prism constant", Some(PrismConstants::default()),
        |constants| constants.in_words();
    /// True if the ranges of the tracks contain the prism constant already.
    ranges_include_prism_constant: bool, Writing, "ranges", None, |include| {
        let what = if include { "contain" } else { "do not contain" };
        format!("{what} the prism constant")
    };
    /// Inter-prism distances 12, 13, 23, 14, 24, 34, … (m); of three prisms α, β, γ.
    inter_prism_m: PerPair<f64>, Vehicle, "inter-prism distances", None,
        |distances_m| metres(distances_m.as_slice());
    /// The prisms that the stations follow; recognised if absent.
    prisms: FollowedPrisms, Vehicle, "prisms", None, |prisms| prisms.in_words();
    /// Changes of the prisms that stations follow.
    prism_changes: Vec<StatedPrismChange>, Readings, "changes of prisms", Some(Vec::new()),
        |changes| changes.iter().map(StatedPrismChange::in_words).collect::<Vec<_>>().join("; ");
    /// Prisms 1, 2, … in the vehicle's frame (m). Trajectories refer to the origin of this frame.
    prisms_m: PerPrism<[f64; 3]>, Vehicle, "prisms in the vehicle", None,
        |prisms| prisms.map(|prism_m| metres(prism_m)).as_slice().join("; ");
    /// RTKLIB solution files of antennas 1, 2, 3, if their names do not identify the antenna.
    gnss: [String; 3], Files, "GNSS", None, |files| files.join(", ");
    /// The control-point files to use.
    control_points: Vec<String>, Files, "control points", None,
        |files| if files.is_empty() { "none".to_owned() } else { files.join(", ") };
    /// Files with the readings of the instruments of stations 1, 2, … (GSI, JobXML), if their names do not identify the
    /// station.
    surveys: PerStation<String>, Files, "surveys", None, |files| files.as_slice().join(", ");
    /// Files that describe the rig. In a file of readings (GSI, JobXML) the first points are prisms 1, 2, ….
    rig: OneOrMany, Vehicle, "rig", None, |files| files.as_slice().join(", ");
    /// Span of the measurements to use (s, as stamped).
    span_s: [f64; 2], Readings, "span of time", None, |[from_s, to_s]| format!("{from_s:.1} to {to_s:.1} s");
    /// Single readings to leave out.
    masked: Vec<MaskedReading>, Readings, "readings left out", Some(Vec::new()),
        |masked| masked.len().to_string();
    /// Meaning of the columns of the tracks' table.
    columns: ColumnMapping, Writing, "columns", None, |columns| columns.names().join(" ");
}

/// Formats numbers as a list of `deployment.toml`: "[1, 3]".
pub fn list_of(numbers: impl Iterator<Item = i64>) -> String {
    let numbers: Vec<String> = numbers.map(|number| number.to_string()).collect();
    format!("[{}]", numbers.join(", "))
}

/// Formats three lengths: "0.8712 0.9954 1.1032 m".
fn metres(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|value| format!("{value:.4}")).collect();
    values.join(" ") + " m"
}

/// Direction in which azimuths increase, seen from above.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AzimuthSense {
    #[default]
    Clockwise,
    CounterClockwise,
}

/// A prism constant for all stations, or one for each (m). Two values are equal if all stations have the same constants.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(untagged)]
pub enum PrismConstants {
    All(f64),
    Each(PerStation<f64>),
}

impl PartialEq for PrismConstants {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::All(own_m), Self::All(other_m)) => own_m == other_m,
            (Self::Each(own_m), Self::Each(other_m)) => own_m == other_m,
            (Self::All(all_m), Self::Each(each_m)) | (Self::Each(each_m), Self::All(all_m)) => {
                each_m.iter().all(|own_m| own_m == all_m)
            }
        }
    }
}

impl Default for PrismConstants {
    /// The prism constant of the MT1000 prism.
    fn default() -> Self {
        Self::All(0.010)
    }
}

impl PrismConstants {
    /// Returns the prism constants of some stations (m). A list that is too short continues with its last value.
    pub fn each_m(&self, stations: usize) -> PerStation<f64> {
        PerStation::from_fn(stations, |station| self.of_station_m(station))
    }

    /// Returns the prism constant of a station (m).
    pub fn of_station_m(&self, station: Station) -> f64 {
        match self {
            Self::All(constant_m) => *constant_m,
            Self::Each(constants_m) => {
                let last_m = constants_m.iter().next_back();
                constants_m.get(station).or(last_m).copied().unwrap_or_default()
            }
        }
    }
}

/// One name, or a list of them.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum OneOrMany {
    One(String),
    Many(Vec<String>),
}

impl OneOrMany {
    pub fn as_slice(&self) -> &[String] {
        match self {
            Self::One(name) => std::slice::from_ref(name),
            Self::Many(names) => names,
        }
    }
}

/// A reading that the user leaves out, identified by its station and stamp.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaskedReading {
    /// The station's number from 1, in the deployment's numbering.
    pub station: u8,
    /// The stamp of the reading (s).
    pub time_s: f64,
}

impl Overrides {
    /// Returns true if azimuths of the tracks increase counter-clockwise.
    pub fn is_counter_clockwise(&self) -> bool {
        self.azimuth == Some(AzimuthSense::CounterClockwise)
    }

    /// Returns the keys that apply to every drive with these stations and this vehicle.
    #[must_use]
    pub fn of_any_drive(&self) -> Self {
        self.about(|subject| matches!(subject, KeySubject::Writing | KeySubject::Vehicle))
    }

    /// Returns the keys that do not change the reading of the tracks.
    #[must_use]
    pub fn beside_readings(&self) -> Self {
        self.about(|subject| matches!(subject, KeySubject::Files | KeySubject::Vehicle))
    }

    /// Sets other station numbers in the files, and renumbers masked readings and changes of prisms so that they stay the same ones.
    pub fn renumber(&mut self, before: &PerStation<i64>, after: PerStation<i64>) {
        let masked = self.masked.iter_mut().flatten().map(|mask| &mut mask.station);
        let changed = self.prism_changes.iter_mut().flatten().map(|change| &mut change.station);
        for station_number in masked.chain(changed) {
            let station = Station::numbered(usize::from(*station_number));
            let number = station.and_then(|station| before.get(station));
            let index = number.and_then(|number| after.iter().position(|new| new == number));
            if let Some(index) = index {
                *station_number = index as u8 + 1;
            }
        }
        self.stations = Some(after);
    }

    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Checks what is stated about single readings and instants.
    fn check_readings(&self) -> Result<(), (String, &'static str)> {
        let is_station = |number: u8| (1..=MOST_STATIONS).contains(&usize::from(number));
        if let Some(masked) = self.masked.iter().flatten().find(|m| !is_station(m.station)) {
            return Err((
                format!("masked names station {}", masked.station),
                "stations are numbered from 1",
            ));
        }
        if let Some(masked) = self.masked.iter().flatten().find(|m| !m.time_s.is_finite()) {
            return Err((
                format!("masked names the time {}", masked.time_s),
                "give the stamp of the reading, in seconds",
            ));
        }
        let changes = || self.prism_changes.iter().flatten();
        if let Some(invalid) = changes().find(|change| {
            !is_station(change.station) || !is_station(change.prism) || !change.time_s.is_finite()
        }) {
            return Err((
                format!("prism_changes has {}", invalid.in_words()),
                "stations and prisms are numbered from 1, and the time is a stamp in seconds",
            ));
        }
        Ok(())
    }

    /// Checks the values.
    ///
    /// # Errors
    /// The first invalid value, and the remedy.
    pub fn check(&self) -> Result<(), (String, &'static str)> {
        self.check_lists_by_station()?;
        if let Some([from_s, to_s]) = self.span_s
            && (from_s >= to_s || !from_s.is_finite() || !to_s.is_finite())
        {
            return Err((
                format!("span_s is [{from_s}, {to_s}]"),
                "give the first and the last time to use, in seconds as stamped",
            ));
        }
        self.check_readings()?;
        if let Some(distances_m) = &self.inter_prism_m
            && !(distances_m.iter().all(|d| d.is_finite() && *d > 0.0)
                && Pair::prisms_of(distances_m.len()).is_some())
        {
            return Err((
                format!("inter_prism_m is {:?}", distances_m.as_slice()),
                "give the distances 12, 13, 23, 14, 24, 34, … of all pairs in metres",
            ));
        }
        if let Some(columns) = &self.columns
            && !(-14.0..=14.0).contains(&columns.utc_offset_hours)
        {
            return Err((
                format!("utc_offset_hours is {}", columns.utc_offset_hours),
                "time zones are up to 14 hours from UTC",
            ));
        }
        Ok(())
    }

    /// Checks the keys that list a value for each station.
    fn check_lists_by_station(&self) -> Result<(), (String, &'static str)> {
        let constants_m = match &self.prism_constant_m {
            Some(PrismConstants::All(constant_m)) => std::slice::from_ref(constant_m),
            Some(PrismConstants::Each(constants_m)) => constants_m.as_slice(),
            None => &[],
        };
        if let Some(constant_m) = constants_m.iter().find(|own_m| !(-1.0..=1.0).contains(*own_m)) {
            return Err((
                format!("prism_constant_m is {constant_m}"),
                "prism constants are a few hundredths of a metre",
            ));
        }
        if let Some(prisms) = &self.prisms
            && !prisms.is_valid()
        {
            return Err((
                format!("prisms is {}", prisms.in_words()),
                "give 1 (all stations follow one prism), the number of stations (each its own), or the prism of \
                 each station: prisms = [1, 2, 2]; omit it for automatic recognition",
            ));
        }
        if let Some(numbers) = self.stations.as_ref().map(PerStation::as_slice)
            && (1..numbers.len()).any(|place| numbers[..place].contains(&numbers[place]))
        {
            return Err((
                format!("stations is {numbers:?}"),
                "give the different numbers of stations 1, 2, … in the files",
            ));
        }
        let lengths = [
            ("stations", self.stations.as_ref().map(PerStation::len)),
            ("station_names", self.station_names.as_ref().map(PerStation::len)),
            ("topics", self.topics.as_ref().map(PerStation::len)),
            ("surveys", self.surveys.as_ref().map(PerStation::len)),
            ("prism_constant_m", self.prism_constant_m.as_ref().and_then(PrismConstants::listed)),
            ("prisms_m", self.prisms_m.as_ref().map(PerPrism::len)),
        ];
        for (key, length) in lengths {
            if length.is_some_and(|length| !(1..=MOST_STATIONS).contains(&length)) {
                return Err((
                    format!("{key} lists {} values", length.unwrap_or_default()),
                    "give 1 to 8 values",
                ));
            }
        }
        Ok(())
    }
}

impl AzimuthSense {
    pub const ALL: [Self; 2] = [Self::Clockwise, Self::CounterClockwise];

    pub fn title(self) -> &'static str {
        match self {
            Self::Clockwise => "clockwise",
            Self::CounterClockwise => "counter-clockwise",
        }
    }
}

impl PrismConstants {
    /// Returns "+10.0 mm", or one value for each station.
    pub fn in_words(&self) -> String {
        let mm = |constant_m: &f64| format!("{:+.1}", constant_m * 1e3);
        match self {
            Self::All(constant_m) => mm(constant_m) + " mm",
            Self::Each(each_m) => match each_m.as_slice() {
                [first_m, others @ ..] if others.iter().all(|other_m| other_m == first_m) => {
                    mm(first_m) + " mm"
                }
                each_m => each_m.iter().map(mm).collect::<Vec<_>>().join(" ") + " mm",
            },
        }
    }

    /// Returns the number of listed values; `None` for one value of all stations.
    fn listed(&self) -> Option<usize> {
        match self {
            Self::All(_) => None,
            Self::Each(constants_m) => Some(constants_m.len()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_reads_back() {
        let overrides = Overrides {
            tracks: Some(OneOrMany::Many(vec!["a.bag".into(), "b.bag".into()])),
            stations: Some([2, 1, 3].into()),
            azimuth: Some(AzimuthSense::CounterClockwise),
            prism_constant_m: Some(PrismConstants::Each([0.01, 0.0, -0.0345].into())),
            span_s: Some([1657569001.0, 1657569431.5]),
            masked: Some(vec![MaskedReading { station: 2, time_s: 1657569100.123456 }]),
            ..Overrides::default()
        };
        let text = toml::to_string(&overrides).expect("plain data");
        assert_eq!(toml::from_str::<Overrides>(&text).expect("own text"), overrides, "{text}");
        let one: Overrides =
            toml::from_str("tracks = \"a.csv\"\nprism_constant_m = 0.01\n").expect("valid");
        assert_eq!(one.tracks.expect("given").as_slice(), ["a.csv"]);
        assert_eq!(one.prism_constant_m.expect("given").each_m(3), [0.01; 3].into());
    }

    #[test]
    fn what_the_folder_says_already_is_not_corrections() {
        let as_read = Overrides { stations: Some([1, 3, 2].into()), ..Overrides::default() };
        let own = Overrides {
            stations: Some([1, 3, 2].into()),
            azimuth: Some(AzimuthSense::Clockwise),
            prism_constant_m: Some(PrismConstants::Each([0.010; 3].into())),
            masked: Some(Vec::new()),
            ..Overrides::default()
        };
        assert!(own.clone().beyond(&as_read).is_empty());
        // The numbers of the files differ from those of this folder.
        let back = Overrides { stations: Some([1, 2, 3].into()), ..own }.beyond(&as_read);
        assert_eq!(back.stations, Some([1, 2, 3].into()));
    }

    #[test]
    fn a_masked_reading_stays_masked_when_stations_are_renumbered() {
        let mask = |station| MaskedReading { station, time_s: 7.5 };
        let mut overrides =
            Overrides { masked: Some(vec![mask(1), mask(2)]), ..Overrides::default() };
        overrides.renumber(&[1, 2, 3].into(), [1, 3, 2].into());
        assert_eq!(overrides.masked, Some(vec![mask(1), mask(3)]));
        overrides.renumber(&[1, 3, 2].into(), [2, 3, 1].into());
        assert_eq!(overrides.masked, Some(vec![mask(3), mask(1)]));
    }

    #[test]
    fn keys_of_any_drive_and_keys_beside_the_readings_part_all_keys() {
        let all = Overrides {
            name: Some("a".into()),
            tracks: Some(OneOrMany::One("b".into())),
            prism_constant_m: Some(PrismConstants::All(0.0)),
            inter_prism_m: Some([1.0; 3].into()),
            ..Overrides::default()
        };
        let names = |some: &Overrides| {
            let Overrides { name, tracks, prism_constant_m, inter_prism_m, .. } = some;
            [name.is_some(), tracks.is_some(), prism_constant_m.is_some(), inter_prism_m.is_some()]
        };
        assert_eq!(names(&all.of_any_drive()), [false, false, true, true]);
        assert_eq!(names(&all.beside_readings()), [true, false, false, true]);
    }

    #[test]
    fn the_users_word_wins_and_the_rest_stays() {
        let base = Overrides {
            name: Some("folder".into()),
            stations: Some([2, 1, 3].into()),
            ..Overrides::default()
        };
        let user = Overrides { stations: Some([1, 2, 3].into()), ..Overrides::default() };
        let both = user.over(base);
        assert_eq!((both.name.as_deref(), both.stations), (Some("folder"), Some([1, 2, 3].into())));
    }
}
