//! Limits the load of calculations: each is followed by a rest as long as it took. A drive of a day thus keeps no laptop busy.

/// Duration of a rest, in multiples of the calculation before it.
const REST: f64 = 1.0;

/// State of one calculator: busy, resting or free. Times are of a monotonic clock that starts at 0 (s).
#[derive(Clone, Copy, Debug, Default)]
pub struct Pace {
    busy_since_s: Option<f64>,
    rests_until_s: f64,
}

impl Pace {
    pub fn is_free(&self, now_s: f64) -> bool {
        self.busy_since_s.is_none() && now_s >= self.rests_until_s
    }

    /// Begins a calculation if free; returns true if it began.
    pub fn begin(&mut self, now_s: f64) -> bool {
        let is_free = self.is_free(now_s);
        if is_free {
            self.busy_since_s = Some(now_s);
        }
        is_free
    }

    /// Ends the calculation, if there is one, and begins the rest.
    pub fn end(&mut self, now_s: f64) {
        if let Some(since_s) = self.busy_since_s.take() {
            self.rests_until_s = now_s + REST * (now_s - since_s);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_calculates_rests_for_as_long_as_it_took() {
        let mut pace = Pace::default();
        assert!(pace.begin(3.0) && !pace.is_free(100.0), "busy until it ends");
        assert!(!pace.begin(4.0), "one at a time");
        pace.end(5.0);
        assert!(!pace.is_free(6.9) && pace.is_free(7.0), "two seconds of work, two of rest");
        // An end without a beginning does not extend the rest.
        pace.end(7.5);
        assert!(pace.begin(7.5));
    }
}
