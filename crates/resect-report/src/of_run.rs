//! Properties of a run, not of the input, in an output: the date, and durations.
//!
//! `SOURCE_DATE_EPOCH` requests outputs that can be compared byte by byte: it sets the date, and no output has
//! durations. <https://reproducible-builds.org/specs/source-date-epoch/>

use jiff::Timestamp;

/// Returns the date of this run: the present, or that of `SOURCE_DATE_EPOCH`.
pub fn date() -> Timestamp {
    given_date().unwrap_or_else(Timestamp::now)
}

/// Returns true if outputs have durations.
pub fn tells_durations() -> bool {
    given_date().is_none()
}

fn given_date() -> Option<Timestamp> {
    let seconds = std::env::var("SOURCE_DATE_EPOCH").ok()?.parse().ok()?;
    Timestamp::from_second(seconds).ok()
}
