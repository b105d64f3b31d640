//! What the user knows better than any guess: the keys of `deployment.toml`, which the window can set as well.

use serde::{Deserialize, Serialize};

use super::ColumnMapping;

/// What a deployment is read with; a key that is absent leaves the guess alone. Names of files are relative to the folder.
#[derive(Clone, Debug, Default, Deserialize, Serialize, PartialEq)]
#[serde(default, deny_unknown_fields)]
pub struct Overrides {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The files with the stations' tracks, where a folder holds several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tracks: Option<OneOrMany>,
    /// Topics of stations 1, 2, 3 in a bag whose messages do not name their station.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub topics: Option<[String; 3]>,
    /// Which numbers of the files are stations 1, 2, 3: `[2, 1, 3]` exchanges the first two.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stations: Option<[i64; 3]>,
    /// Which way azimuths of the tracks turn, seen from above; clockwise if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub azimuth: Option<AzimuthSense>,
    /// Added to every range of tracks, control points and rig reading (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prism_constant_m: Option<PrismConstants>,
    /// Whether the ranges of the tracks contain the prism constant already.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ranges_include_prism_constant: Option<bool>,
    /// α, β, γ (m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inter_prism_m: Option<[f64; 3]>,
    /// How many prisms the stations follow: 1 (all the same) or 3 (each its own); recognised if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prisms: Option<u8>,
    /// Prisms 1, 2, 3 in the vehicle's frame (m): what a trajectory is the trajectory of.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prisms_m: Option<[[f64; 3]; 3]>,
    /// RTKLIB solution files of antennas 1, 2, 3, where their names do not tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gnss: Option<[String; 3]>,
    /// The control-point files to use.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub control_points: Option<Vec<String>>,
    /// The files with what the instruments of stations 1, 2, 3 read (GSI, JobXML), where their names do not tell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surveys: Option<[String; 3]>,
    /// The files that describe the rig; of a file of readings (GSI, JobXML) the first three points are prisms 1, 2, 3.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rig: Option<OneOrMany>,
    /// Only measurements within this span count (s, as stamped).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub span_s: Option<[f64; 2]>,
    /// Single readings that do not count.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub masked: Option<Vec<MaskedReading>>,
    /// Which column of the tracks' table is what.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub columns: Option<ColumnMapping>,
}

/// Which way azimuths grow, seen from above.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AzimuthSense {
    #[default]
    Clockwise,
    CounterClockwise,
}

/// A prism constant for all stations, or one each (m).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum PrismConstants {
    All(f64),
    Each([f64; 3]),
}

impl Default for PrismConstants {
    /// The prism constant of the MT1000 prism.
    fn default() -> Self {
        Self::All(0.010)
    }
}

impl PrismConstants {
    /// The prism constants of stations 1, 2, 3 (m).
    pub fn each_m(self) -> [f64; 3] {
        match self {
            Self::All(constant_m) => [constant_m; 3],
            Self::Each(constants_m) => constants_m,
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

/// A reading that the user leaves out, by what identifies it in its file.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaskedReading {
    /// 1, 2 or 3, as the deployment numbers its stations.
    pub station: u8,
    /// The stamp of the reading (s).
    pub time_s: f64,
}

impl Overrides {
    /// Whether azimuths of the tracks turn against the clock.
    pub fn is_counter_clockwise(&self) -> bool {
        self.azimuth == Some(AzimuthSense::CounterClockwise)
    }

    /// What these overrides say, and where they say nothing, what `base` says.
    #[must_use]
    pub fn over(self, base: Self) -> Self {
        Self {
            name: self.name.or(base.name),
            tracks: self.tracks.or(base.tracks),
            topics: self.topics.or(base.topics),
            stations: self.stations.or(base.stations),
            azimuth: self.azimuth.or(base.azimuth),
            prism_constant_m: self.prism_constant_m.or(base.prism_constant_m),
            ranges_include_prism_constant: self
                .ranges_include_prism_constant
                .or(base.ranges_include_prism_constant),
            inter_prism_m: self.inter_prism_m.or(base.inter_prism_m),
            prisms: self.prisms.or(base.prisms),
            prisms_m: self.prisms_m.or(base.prisms_m),
            gnss: self.gnss.or(base.gnss),
            control_points: self.control_points.or(base.control_points),
            surveys: self.surveys.or(base.surveys),
            rig: self.rig.or(base.rig),
            span_s: self.span_s.or(base.span_s),
            masked: self.masked.or(base.masked),
            columns: self.columns.or(base.columns),
        }
    }

    /// What is said of stations, rig and the way that files are written, and not of single files or readings.
    #[must_use]
    pub fn of_any_drive(&self) -> Self {
        Self {
            name: None,
            tracks: None,
            gnss: None,
            control_points: None,
            surveys: None,
            span_s: None,
            masked: None,
            ..self.clone()
        }
    }

    /// What is said of rig and control points, and not of how the tracks are read.
    #[must_use]
    pub fn beside_readings(&self) -> Self {
        Self {
            tracks: None,
            topics: None,
            stations: None,
            azimuth: None,
            prism_constant_m: None,
            ranges_include_prism_constant: None,
            span_s: None,
            masked: None,
            columns: None,
            ..self.clone()
        }
    }

    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The first thing that makes no sense, and what to do about it.
    pub fn check(&self) -> Result<(), (String, &'static str)> {
        if let Some(constant_m) = self
            .prism_constant_m
            .and_then(|all| all.each_m().into_iter().find(|own| !(-1.0..=1.0).contains(own)))
        {
            return Err((
                format!("prism_constant_m is {constant_m}"),
                "prism constants are a few hundredths of a metre",
            ));
        }
        if self.prisms.is_some_and(|prisms| prisms != 1 && prisms != 3) {
            return Err((
                "prisms must be 1 (all stations follow one) or 3".to_owned(),
                "leave it out to have it recognised",
            ));
        }
        if let Some([a, b, c]) = self.stations
            && (a == b || a == c || b == c)
        {
            return Err((
                format!("stations is [{a}, {b}, {c}]"),
                "give three different numbers of the files, those of stations 1, 2, 3",
            ));
        }
        if let Some([from_s, to_s]) = self.span_s
            && (from_s >= to_s || !from_s.is_finite() || !to_s.is_finite())
        {
            return Err((
                format!("span_s is [{from_s}, {to_s}]"),
                "give the first and the last time to use, in seconds as stamped",
            ));
        }
        if let Some(masked) = self.masked.iter().flatten().find(|m| !(1..=3).contains(&m.station)) {
            return Err((
                format!("masked names station {}", masked.station),
                "stations are 1, 2, 3",
            ));
        }
        if let Some(masked) = self.masked.iter().flatten().find(|m| !m.time_s.is_finite()) {
            return Err((
                format!("masked names the time {}", masked.time_s),
                "give the stamp of the reading, in seconds",
            ));
        }
        if let Some(distances_m) = self.inter_prism_m
            && !distances_m.iter().all(|d| d.is_finite() && *d > 0.0)
        {
            return Err((
                format!("inter_prism_m is {distances_m:?}"),
                "give the distances 12, 13, 23 in metres",
            ));
        }
        if let Some(columns) = &self.columns
            && !(-14.0..=14.0).contains(&columns.utc_offset_hours)
        {
            return Err((
                format!("utc_offset_hours is {}", columns.utc_offset_hours),
                "zones are up to 14 hours from UTC",
            ));
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
    /// "+10.0 mm", or one for each station.
    pub fn in_words(self) -> String {
        match self.each_m() {
            [a, b, c] if a == b && a == c => format!("{:+.1} mm", a * 1e3),
            each => each.map(|own| format!("{:+.1}", own * 1e3)).join(" ") + " mm",
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
            stations: Some([2, 1, 3]),
            azimuth: Some(AzimuthSense::CounterClockwise),
            prism_constant_m: Some(PrismConstants::Each([0.01, 0.0, -0.0345])),
            span_s: Some([1657569001.0, 1657569431.5]),
            masked: Some(vec![MaskedReading { station: 2, time_s: 1657569100.123456 }]),
            ..Overrides::default()
        };
        let text = toml::to_string(&overrides).expect("plain data");
        assert_eq!(toml::from_str::<Overrides>(&text).expect("own text"), overrides, "{text}");
        let one: Overrides =
            toml::from_str("tracks = \"a.csv\"\nprism_constant_m = 0.01\n").expect("valid");
        assert_eq!(one.tracks.expect("given").as_slice(), ["a.csv"]);
        assert_eq!(one.prism_constant_m.expect("given").each_m(), [0.01; 3]);
    }

    #[test]
    fn the_users_word_wins_and_the_rest_stays() {
        let base = Overrides {
            name: Some("folder".into()),
            stations: Some([2, 1, 3]),
            ..Overrides::default()
        };
        let user = Overrides { stations: Some([1, 2, 3]), ..Overrides::default() };
        let both = user.over(base);
        assert_eq!((both.name.as_deref(), both.stations), (Some("folder"), Some([1, 2, 3])));
    }
}
