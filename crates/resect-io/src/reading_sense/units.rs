//! Columns that cannot be in radians, metres or seconds: their probable unit, and a remedy.

use resect_core::network::PerStation;
use std::f64::consts::{FRAC_PI_2, PI};

use super::impossible::{LARGEST_AZIMUTH_RAD, LATEST_STAMP_S};
use super::station_sense::{Column, FEWEST, StationSense};
use crate::error::OpenError;
use crate::findings::readings::{short_number, station_list};

/// Steepest zenith angle at which a vehicle is tracked (rad); steeper ones are angles of elevation.
const STEEPEST_RAD: f64 = 0.3;
/// Longest range at which an instrument tracks a moving prism (m); longer ones are in millimetres.
const LONGEST_TRACKING_M: f64 = 2_000.0;
/// Longest step of stamps (s): a tracking station measures several times a second.
const LONGEST_STEP_S: f64 = 20.0;

/// Returns an error if a column of any station cannot be in its unit.
///
/// `is_table` is true if `[columns]` of `deployment.toml` can correct it.
pub fn check(
    all: &PerStation<&StationSense>,
    files: &str,
    is_table: bool,
) -> Result<(), OpenError> {
    let judged = Judged::all(all);
    let whats: Vec<_> = judged.iter().filter_map(Judged::what).collect();
    if whats.is_empty() {
        return Ok(());
    }
    Err(OpenError::file(files, whats.join(", and "), remedy(all, &judged, is_table)))
}

impl StationSense {
    fn zenith(&self) -> Option<Suspicion> {
        let column = self.column(|s| s.measurement.zenith_rad);
        let median = column.median()?;
        let looks = match median {
            _ if column.share(|v| v < 0.0) > 0.2 => LooksLike::Elevation,
            m if m.abs() < STEEPEST_RAD => LooksLike::Elevation,
            m if m <= PI => return None,
            m if (57.0..95.0).contains(&m) => LooksLike::Degrees,
            m if (95.0..130.0).contains(&m) => LooksLike::Gon,
            _ => LooksLike::NotRadians,
        };
        Some(Suspicion { looks, value: median })
    }

    fn azimuth(&self) -> Option<Suspicion> {
        let column = self.column(|s| s.measurement.azimuth_rad.abs());
        if column.share(|v| v > LARGEST_AZIMUTH_RAD) <= 0.05 {
            return None;
        }
        let largest = column.0.iter().copied().fold(0.0, f64::max);
        // Azimuths of less than a full turn do not show their unit; the zenith angles do, if they are wrong as well.
        let looks = match self.zenith().map(|zenith| zenith.looks) {
            Some(LooksLike::Degrees) if largest <= 360.0 => LooksLike::Degrees,
            Some(LooksLike::Gon) if largest <= 400.0 => LooksLike::Gon,
            _ if largest <= 360.0 => LooksLike::DegreesOrGon,
            _ if largest <= 400.0 => LooksLike::Gon,
            _ => LooksLike::NotRadians,
        };
        Some(Suspicion { looks, value: largest })
    }

    fn range(&self) -> Option<Suspicion> {
        let median = self.column(|s| s.measurement.range_m).median()?;
        (median > LONGEST_TRACKING_M)
            .then_some(Suspicion { looks: LooksLike::Millimetres, value: median })
    }

    fn stamps(&self) -> Option<Suspicion> {
        let median = self.column(|s| s.measurement.time_s).median()?;
        let looks = match median.abs() {
            m if m <= LATEST_STAMP_S => return None,
            m if m < 1e14 => LooksLike::Milliseconds,
            m if m < 1e17 => LooksLike::Microseconds,
            _ => LooksLike::Nanoseconds,
        };
        Some(Suspicion { looks, value: median })
    }

    fn steps(&self) -> Option<Suspicion> {
        let steps = Column(self.sample.iter().filter_map(|s| s.step_s).collect());
        let median = steps.median()?;
        let looks = match median {
            m if m <= LONGEST_STEP_S || self.stamps().is_some() => return None,
            m if m < 1e4 => LooksLike::Milliseconds,
            m if m < 1e7 => LooksLike::Microseconds,
            _ => LooksLike::Nanoseconds,
        };
        Some(Suspicion { looks, value: median })
    }
}

/// The probable unit of a column, and the value that shows it.
#[derive(Clone, Copy, Debug)]
struct Suspicion {
    looks: LooksLike,
    value: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LooksLike {
    Degrees,
    Gon,
    DegreesOrGon,
    NotRadians,
    Elevation,
    Millimetres,
    Milliseconds,
    Microseconds,
    Nanoseconds,
}

impl LooksLike {
    fn words(self) -> &'static str {
        match self {
            Self::Degrees => "degrees?",
            Self::Gon => "gon?",
            Self::DegreesOrGon => "degrees or gon?",
            Self::NotRadians => "not radians",
            Self::Elevation => "elevation angles, or divided by 57.3 once too often?",
            Self::Millimetres => "millimetres?",
            Self::Milliseconds => "milliseconds?",
            Self::Microseconds => "microseconds?",
            Self::Nanoseconds => "nanoseconds?",
        }
    }

    /// Returns the line under `[columns]` that corrects the unit; `None` if no line does.
    fn key(self) -> Option<&'static str> {
        match self {
            Self::Degrees => Some("angle_unit = \"degrees\""),
            Self::Gon => Some("angle_unit = \"gon\""),
            Self::Elevation => Some("vertical_angle = \"elevation\""),
            Self::Millimetres => Some("length_unit = \"millimetres\""),
            Self::Milliseconds => Some("time_format = \"milliseconds\""),
            Self::Microseconds => Some("time_format = \"microseconds\""),
            Self::Nanoseconds => Some("time_format = \"nanoseconds\""),
            Self::DegreesOrGon | Self::NotRadians => None,
        }
    }
}

/// A column, with its suspicions by station and the words of its message.
struct Judged {
    suspicions: PerStation<Option<Suspicion>>,
    /// Name of the column, as in "zenith angles of station 2 lie about".
    name: &'static str,
    verb: &'static str,
    expected: String,
    unit: &'static str,
}

impl Judged {
    fn all(stations: &PerStation<&StationSense>) -> [Self; 5] {
        let of = |judge: fn(&StationSense) -> Option<Suspicion>| stations.map(|own| judge(own));
        [
            Self {
                suspicions: of(StationSense::zenith),
                name: "zenith angles",
                verb: "lie about",
                expected: format!(
                    "in radians they lie about {FRAC_PI_2:.2}, in degrees 90, in gon 100"
                ),
                unit: "radians",
            },
            Self {
                suspicions: of(StationSense::azimuth),
                name: "azimuths",
                verb: "go up to",
                expected: "in radians a full turn is 6.28, in degrees 360, in gon 400".to_owned(),
                unit: "radians",
            },
            Self {
                suspicions: of(StationSense::range),
                name: "ranges",
                verb: "lie about",
                expected: format!("no prism is tracked beyond {LONGEST_TRACKING_M} m"),
                unit: "metres",
            },
            Self {
                suspicions: of(StationSense::stamps),
                name: "stamps",
                verb: "lie about",
                expected: "Unix seconds are about 1.7e9".to_owned(),
                unit: "seconds",
            },
            Self {
                suspicions: of(StationSense::steps),
                name: "stamps",
                verb: "step by",
                expected: "a station measures several times a second".to_owned(),
                unit: "seconds",
            },
        ]
    }

    fn first(&self) -> Option<Suspicion> {
        self.suspicions.iter().copied().flatten().next()
    }

    /// Returns the message: "zenith angles of station 2 lie about 91.3: degrees? (in radians …)".
    fn what(&self) -> Option<String> {
        let first = self.first()?;
        let with_suspicion = self.suspicions.each().filter(|(_, suspicion)| suspicion.is_some());
        let numbers: Vec<_> = with_suspicion.map(|(station, _)| station.number()).collect();
        let values = self.suspicions.iter().flatten().map(|s| short_number(s.value));
        let values = values.collect::<Vec<_>>().join(", ");
        let Self { name, verb, expected, .. } = self;
        let looks = first.looks.words();
        Some(format!("{name} of {} {verb} {values}: {looks} ({expected})", station_list(&numbers)))
    }
}

/// Returns the remedy: a line for each unit if one corrects all stations alike, otherwise a conversion by the user.
fn remedy(all: &PerStation<&StationSense>, judged: &[Judged], is_table: bool) -> String {
    let with_data = all.map(|own| own.sample.len() >= FEWEST);
    let mut keys = Vec::new();
    let mut units = Vec::new();
    let mut one_key_each = is_table;
    for column in judged {
        let Some(first) = column.first() else { continue };
        units.push(column.unit);
        let alike = column.suspicions.map(|own| own.map(|s| s.looks == first.looks));
        one_key_each &= (0..all.len()).all(|k| alike[k] == with_data[k].then_some(true));
        one_key_each &= first.looks.key().is_some();
        keys.extend(first.looks.key());
    }
    // Both columns of angles share one unit.
    let angles = judged.iter().filter(|column| column.unit == "radians");
    let looks: Vec<_> = angles.map(|column| column.first().map(|s| s.looks)).collect();
    if looks.contains(&Some(LooksLike::Degrees)) || looks.contains(&Some(LooksLike::Gon)) {
        one_key_each &= looks.iter().all(|own| *own == looks[0]);
    }
    units.dedup();
    keys.sort_unstable();
    keys.dedup();
    let convert = format!("convert them to {}", units.join(" and "));
    if one_key_each {
        format!("{convert}, or set under [columns] in deployment.toml: {}", keys.join(", "))
    } else {
        convert
    }
}
