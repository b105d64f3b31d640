//! Text of the explanation of a reading, in one or two sentences.

use super::explanation::{Explanation, Place, Rate, Silence, Step};
use crate::pipeline::{Interval, SampleFate};

impl Explanation {
    /// Returns the fate of the reading and its reason. Times count from `start_s` (s, stations' clock), as in the plots.
    pub fn in_words(&self, start_s: f64) -> String {
        match (&self.place, self.fate) {
            (Place::Rejected, SampleFate::Rejected(_)) => {
                self.step.as_ref().map_or_else(String::new, rejected)
            }
            (Place::In { interval, kept: None, .. }, _) => {
                let tau_l = self.settings.thresholds.tau_l_seconds;
                let [length, limit] = apart(interval.length_s(), tau_l, 1);
                format!(
                    "Interval too short: {} lasts {length} s, τ_l requires more than {limit} s.",
                    span(interval, start_s)
                )
            }
            (Place::In { interval, beside, kept: Some(number) }, _) => {
                let (span, length) = (span(interval, start_s), interval.length_s());
                if *beside {
                    let end = if self.reading.time_s < interval.start_s { "first" } else { "last" };
                    format!(
                        "Kept: just outside interval {} ({span}), whose {end} triplet is interpolated from it.",
                        number + 1
                    )
                } else {
                    format!("Kept: in interval {} ({span}, {length:.1} s).", number + 1)
                }
            }
            (Place::InNone(silences), _) => self.in_none(silences, start_s),
            (Place::LeftOut, _) => {
                "Left out by hand: masked, or outside the time span in use.".to_owned()
            }
            (Place::Rejected, _) => self.fate.label().to_owned(),
        }
    }

    fn in_none(&self, silences: &[Silence], start_s: f64) -> String {
        if silences.is_empty() {
            return "In no interval: the stations measured together at this instant only."
                .to_owned();
        }
        let tau_s = self.settings.thresholds.tau_s_seconds;
        let why: Vec<String> =
            silences.iter().map(|silence| self.silence(silence, start_s)).collect();
        // Enough decimals to show that the shortest gap is longer than τ_s.
        let shortest_s = silences.iter().filter_map(|silence| self.gap_s(silence));
        let [_, limit] = apart(shortest_s.fold(f64::INFINITY, f64::min), tau_s, 1);
        format!("In no interval: {}; τ_s allows {limit} s.", why.join(", and "))
    }

    fn silence(&self, silence: &Silence, start_s: f64) -> String {
        let own = silence.station == self.station;
        let who = format!("station {}{}", silence.station + 1, if own { " itself" } else { "" });
        let at = |time_s: f64| format!("{:.1} s", time_s - start_s);
        let tau_s = self.settings.thresholds.tau_s_seconds;
        let length = |from_s: f64, to_s: f64| apart(to_s - from_s, tau_s, 1)[0].clone();
        let rejected = match silence.rejected {
            0 => String::new(),
            1 => "; 1 reading in between was rejected".to_owned(),
            many => format!("; {many} readings in between were rejected"),
        };
        if silence.alone {
            let time_s = self.reading.time_s;
            let before = silence.from_s.map_or("nothing before".to_owned(), |from_s| {
                format!("{} s after the last", length(from_s, time_s))
            });
            let after = silence.to_s.map_or("nothing after".to_owned(), |to_s| {
                format!("{} s before the next", length(time_s, to_s))
            });
            return format!("{who} has this reading alone ({before}, {after}{rejected})");
        }
        match (silence.from_s, silence.to_s) {
            (Some(from_s), Some(to_s)) => format!(
                "{who} was silent from {} to {} ({} s{rejected})",
                at(from_s),
                at(to_s),
                length(from_s, to_s)
            ),
            (None, Some(to_s)) => format!("{who} was silent until {}{rejected}", at(to_s)),
            (Some(from_s), None) => format!("{who} was silent from {} on{rejected}", at(from_s)),
            (None, None) => format!("{who} was silent all the time{rejected}"),
        }
    }

    /// Returns the smallest τ_s (s) that would bridge the gap.
    pub(super) fn gap_s(&self, silence: &Silence) -> Option<f64> {
        let time_s = self.reading.time_s;
        if silence.alone {
            let gaps = [silence.from_s.map(|t| time_s - t), silence.to_s.map(|t| t - time_s)];
            return gaps.into_iter().flatten().min_by(f64::total_cmp);
        }
        Some(silence.to_s? - silence.from_s?)
    }
}

fn rejected(step: &Step) -> String {
    let mut over = step.rates.iter().filter(|rate| rate.exceeds());
    let Some(first) = over.next() else { return String::new() };
    let limit = |rate: &Rate| apart(rate.value.abs(), rate.threshold.unwrap_or(f64::NAN), 2);
    let [value, threshold] = limit(first);
    let mut text = format!(
        "Rejected by the {} rate: {value} {} from the previous reading ({:.2} s earlier), {} allows {threshold}.",
        first.name(),
        first.unit,
        step.elapsed_s,
        first.threshold_name(),
    );
    for rate in over {
        let [value, threshold] = limit(rate);
        text += &format!(
            " The {} rate is too high as well: {value} {}, {} allows {threshold}.",
            rate.name(),
            rate.unit,
            rate.threshold_name()
        );
    }
    if step.previous_rejected {
        text += " The previous reading was rejected too: the return from a jump is also a jump.";
    }
    text
}

fn span(interval: &Interval, start_s: f64) -> String {
    format!("{:.1}–{:.1} s", interval.start_s - start_s, interval.end_s - start_s)
}

/// Formats a value and its limit with enough decimals to distinguish them.
fn apart(value: f64, limit: f64, fewest_decimals: usize) -> [String; 2] {
    let texts = |decimals: usize| [value, limit].map(|number| format!("{number:.decimals$}"));
    (fewest_decimals..9).map(texts).find(|[a, b]| a != b).unwrap_or_else(|| texts(fewest_decimals))
}
