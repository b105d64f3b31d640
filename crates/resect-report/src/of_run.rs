//! What of an output is the run's and not the input's: its date, and how long it took.
//!
//! `SOURCE_DATE_EPOCH` asks for outputs that are compared byte by byte: it gives the date, and nothing says how long
//! anything took. <https://reproducible-builds.org/specs/source-date-epoch/>

use jiff::Timestamp;

/// The date of this run: now, or what `SOURCE_DATE_EPOCH` says.
pub fn date() -> Timestamp {
    given_date().unwrap_or_else(Timestamp::now)
}

/// Whether outputs say how long things took.
pub fn tells_durations() -> bool {
    given_date().is_none()
}

fn given_date() -> Option<Timestamp> {
    let seconds = std::env::var("SOURCE_DATE_EPOCH").ok()?.parse().ok()?;
    Timestamp::from_second(seconds).ok()
}
