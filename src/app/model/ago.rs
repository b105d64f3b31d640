//! Elapsed time in words.

use std::time::Duration;

/// Returns an elapsed time as "5 min", "3 h" or "2 days"; `None` below one minute.
pub fn ago(since: Duration) -> Option<String> {
    let (count, unit) = match since.as_secs() {
        0..60 => return None,
        seconds @ 60..3600 => (seconds / 60, "min"),
        seconds @ 3600..172_800 => (seconds / 3600, "h"),
        seconds => (seconds / 86_400, "days"),
    };
    Some(format!("{count} {unit}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_span_has_its_unit() {
        let words = |seconds| ago(Duration::from_secs(seconds)).unwrap_or_default();
        let spans = [59, 60, 3599, 3600, 172_799, 172_800];
        assert_eq!(spans.map(words), ["", "1 min", "59 min", "1 h", "47 h", "2 days"]);
    }
}
