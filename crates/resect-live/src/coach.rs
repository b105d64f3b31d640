//! Decides if the drive is long enough, and advises what to drive: compares σ at the far end of the track with a target.
//!
//! "Enough" is decided late rather than early. Several consecutive answers over several seconds of the drive must be
//! good, with every direction constrained and σ at most the target. No warning may contradict the readings meanwhile.

use super::judged::{Judged, NoAnswer, Outcome};
use super::next;
use resect_core::calibration::Verdict;
use resect_tools::planning::NextMove;

/// Number of consecutive answers that must meet the target, and the span of the drive that they must cover (s).
const IN_A_ROW: usize = 3;
const APART_S: f64 = 10.0;
/// Largest number of points of the curve; at this number every other point is dropped.
const MOST_POINTS: usize = 2048;

/// σ at the far end of the track, from one answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// Stamp of the newest reading of the answer (s).
    pub time_s: f64,
    pub sigma_m: f64,
}

/// σ over the drive, thinned out if the drive is long.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    pub points: Vec<CurvePoint>,
    /// Smallest interval between points (s).
    apart_s: f64,
}

impl Default for Curve {
    fn default() -> Self {
        Self { points: Vec::new(), apart_s: 0.0 }
    }
}

impl Curve {
    fn push(&mut self, point: CurvePoint) {
        if let [.., before, last] = &mut self.points[..]
            && last.time_s - before.time_s < self.apart_s
        {
            // The newest point is always kept, however close to the one before.
            *last = point;
            return;
        }
        self.points.push(point);
        if self.points.len() == MOST_POINTS {
            let mut index = 0;
            self.points.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            let span_s = point.time_s - self.points[0].time_s;
            self.apart_s = 2.0 * span_s / MOST_POINTS as f64;
        }
    }
}

/// Decides from the answers if the drive is long enough.
#[derive(Clone, Debug)]
pub struct Coach {
    /// Target for σ at the far end of the track (m).
    pub target_m: f64,
    /// Curves by the paper's method and with the chosen settings.
    pub curves: [Curve; 2],
    /// Stamp of the first of the consecutive answers that meet the target (s), and their number.
    met: Option<(f64, usize)>,
    enough: bool,
    newest_s: Option<f64>,
}

impl Coach {
    pub fn new(target_m: f64) -> Self {
        Self { target_m, curves: Default::default(), met: None, enough: false, newest_s: None }
    }

    /// Adds an outcome; `amiss` is true if a warning contradicts the readings.
    pub fn take(&mut self, outcome: &Outcome, amiss: bool) {
        if let Ok(judged) = &outcome.judged
            && let Some(far_end) = judged.far_end
        {
            let point = CurvePoint { time_s: judged.up_to_s, sigma_m: far_end.sigma_m };
            self.curves[usize::from(!outcome.is_first)].push(point);
        }
        // The paper's method does not model instrument errors, so its answer does not decide.
        if outcome.is_first {
            return;
        }
        let meets = outcome.judged.as_ref().is_ok_and(|judged| self.meets(judged)) && !amiss;
        let up_to_s = outcome.judged.as_ref().ok().map(|judged| judged.up_to_s);
        match up_to_s.filter(|_| meets) {
            None => self.met = None,
            // Another answer to the same readings does not count.
            Some(up_to_s) if self.newest_s == Some(up_to_s) => {}
            Some(up_to_s) => {
                let (_, count) = self.met.get_or_insert((up_to_s, 0));
                *count += 1;
            }
        }
        self.newest_s = up_to_s;
        self.enough = self.met.is_some_and(|(since_s, count)| {
            count >= IN_A_ROW && up_to_s.is_some_and(|up_to_s| up_to_s - since_s >= APART_S)
        });
    }

    /// Starts the count again, because a warning contradicts the readings.
    pub fn doubt(&mut self) {
        (self.met, self.enough) = (None, false);
    }

    /// Sets the target (m); a new target starts the count again.
    pub fn aim(&mut self, target_m: f64) {
        if target_m != self.target_m {
            self.target_m = target_m;
            self.doubt();
        }
    }

    fn meets(&self, judged: &Judged) -> bool {
        judged.verdict == Verdict::Good
            && judged.open.is_empty()
            && judged.stepped.is_empty()
            && judged.far_end.is_some_and(|far_end| far_end.sigma_m <= self.target_m)
    }

    pub fn is_enough(&self) -> bool {
        self.enough
    }

    /// Returns the state and the next order, for the driver, as one or two sentences.
    pub fn sentence(&self, latest: Option<&Outcome>, moves: &[NextMove]) -> String {
        let (state, order) = self.state_and_order(latest, moves);
        let sentences = [Some(state), order].into_iter().flatten();
        sentences.map(|one| as_sentence(&one)).collect::<Vec<_>>().join(" ")
    }

    fn state_and_order(
        &self,
        latest: Option<&Outcome>,
        moves: &[NextMove],
    ) -> (String, Option<String>) {
        let judged = match latest.map(|outcome| &outcome.judged) {
            None => {
                let state = "no answer yet: drive where all stations see their prisms";
                return (state.to_owned(), None);
            }
            Some(Err(NoAnswer { why, drive })) => {
                return (format!("no answer yet: {}", drive.unwrap_or(why)), None);
            }
            Some(Ok(judged)) => judged,
        };
        let order = next::sentence(moves, judged);
        let Some(far_end) = judged.far_end else {
            let state = match judged.open.first() {
                Some(open) => open_in_words(open),
                None => format!("the answer is {}", judged.verdict_and_reason()),
            };
            return (state, order);
        };
        let at = format!(
            "{:.1} mm (1 σ) at the far end of station {}'s track, target {:.1} mm",
            far_end.sigma_m * 1e3,
            far_end.station + 1,
            self.target_m * 1e3
        );
        if self.enough {
            return (format!("enough: {at}"), None);
        }
        if let Some(open) = judged.open.first() {
            return (open_in_words(open), order);
        }
        if let Some(stepped) = judged.stepped.first() {
            return (stepped.to_string(), None);
        }
        if judged.verdict != Verdict::Good {
            return (format!("the answer is {}; {at}", judged.verdict_and_reason()), order);
        }
        if far_end.sigma_m <= self.target_m {
            let order = "drive a little further to confirm it".to_owned();
            return (format!("target reached: {at}"), Some(order));
        }
        let order = match next::gain_little(moves) {
            true => Some(format!(
                "no manoeuvre from here gains {:.0} %: set stations nearer if the place allows, or accept a larger target",
                1e2 * next::LITTLE
            )),
            false => order,
        };
        (format!("not yet: {at}"), order)
    }
}

/// Returns a text with a capital letter and a full stop.
fn as_sentence(text: &str) -> String {
    let mut characters = text.chars();
    let first: String = characters.next().into_iter().flat_map(char::to_uppercase).collect();
    let end = if text.ends_with('.') { "" } else { "." };
    format!("{first}{}{end}", characters.as_str())
}

fn open_in_words(open: &str) -> String {
    format!("not determined yet: {open}")
}

#[cfg(test)]
mod tests {
    use resect_core::network::PerStation;

    use std::sync::Arc;

    use nalgebra::Vector3;

    use super::*;
    use crate::findings::clock_stepped;
    use resect_core::calibration::Estimate;
    use resect_core::calibration::Method;
    use resect_core::deployment::Finding;
    use resect_core::evaluation::far_end::FarEnd;
    use resect_core::geometry::RigidTransform;

    fn outcome(up_to_s: f64, sigma_mm: f64, change: impl FnOnce(&mut Judged)) -> Outcome {
        let position_m = Vector3::new(60.0, 0.0, 0.0);
        let mut judged = Judged {
            method: Method::Joint,
            up_to_s,
            readings: 1000,
            took_ms: 1.0,
            verdict: Verdict::Good,
            verdict_in_words: "good".to_owned(),
            reason: None,
            far_end: Some(FarEnd { station: 2, position_m, sigma_m: sigma_mm * 1e-3 }),
            open: Vec::new(),
            advice: Some("turn more"),
            plan: None,
            late_s: None,
            stepped: Vec::new(),
            station1_from_station: PerStation::repeat(3, RigidTransform::IDENTITY),
            sigma: None,
            inter_prism_mm: Some(1.0),
        };
        change(&mut judged);
        Outcome { is_first: false, judged: Ok(Arc::new(judged)), lately_off_m: None }
    }

    #[test]
    fn it_is_enough_after_several_good_answers_in_a_row_and_seconds() {
        let mut coach = Coach::new(2e-3);
        for (up_to_s, enough) in [(0.0, false), (4.0, false), (8.0, false), (12.0, true)] {
            coach.take(&outcome(up_to_s, 1.5, |_| ()), false);
            assert_eq!(coach.is_enough(), enough, "{up_to_s}");
        }
        let said = coach.sentence(Some(&outcome(12.0, 1.5, |_| ())), &[]);
        assert!(said.starts_with("Enough: 1.5 mm"), "{said}");
        // Repeated answers to the same readings count as one.
        let mut again = Coach::new(2e-3);
        (0..9).for_each(|_| again.take(&outcome(20.0, 1.5, |_| ()), false));
        assert!(!again.is_enough());
    }

    fn a_step() -> Finding {
        let by_s = Estimate { value: 0.1, sigma: 0.01 };
        clock_stepped(1, &by_s, "20 s into the drive")
    }

    #[test]
    fn one_answer_that_is_not_good_enough_begins_it_again() {
        type Change = fn(&mut Judged);
        let worse: [(&str, Change); 4] = [
            ("far end", |judged| judged.far_end.as_mut().expect("there").sigma_m = 2.1e-3),
            ("verdict", |judged| judged.verdict = Verdict::Weak),
            ("direction", |judged| judged.open.push("station 2 can slide (weak)".to_owned())),
            ("step", |judged| judged.stepped.push(a_step())),
        ];
        for (what, change) in worse {
            let mut coach = Coach::new(2e-3);
            for k in 0..4 {
                coach.take(&outcome(f64::from(k) * 5.0, 1.5, |_| ()), false);
            }
            assert!(coach.is_enough(), "{what}");
            coach.take(&outcome(20.0, 1.5, change), false);
            assert!(!coach.is_enough(), "{what}");
            coach.take(&outcome(25.0, 1.5, |_| ()), false);
            assert!(!coach.is_enough(), "{what}");
        }
        // A warning in the field also starts the count again; the paper's answer does not count at all.
        let mut coach = Coach::new(2e-3);
        (0..5).for_each(|k| coach.take(&outcome(f64::from(k) * 5.0, 1.5, |_| ()), true));
        assert!(!coach.is_enough());
        for k in 0..5 {
            let first = Outcome { is_first: true, ..outcome(f64::from(k) * 5.0, 1.5, |_| ()) };
            coach.take(&first, false);
        }
        assert!(!coach.is_enough() && coach.curves[0].points.len() == 5);
    }

    #[test]
    fn what_is_open_goes_before_what_is_large() {
        let coach = Coach::new(2e-3);
        let said = |outcome: &Outcome| coach.sentence(Some(outcome), &[]);
        let open = outcome(1.0, 9.0, |judged| {
            judged.open.push("station 2 can slide along the track (weak)".to_owned());
        });
        assert_eq!(
            said(&open),
            "Not determined yet: station 2 can slide along the track (weak). Turn more."
        );
        let large = said(&outcome(1.0, 9.0, |_| ()));
        assert!(
            large.starts_with("Not yet: 9.0 mm") && large.ends_with("mm. Turn more."),
            "{large}"
        );
        assert!(coach.sentence(None, &[]).starts_with("No answer yet"));
        // At the beginning of a drive the advice replaces the reason for the missing answer.
        let none = |drive| Outcome {
            judged: Err(NoAnswer { why: "no triplets".to_owned(), drive }),
            ..outcome(1.0, 9.0, |_| ())
        };
        assert_eq!(said(&none(Some("turn around"))), "No answer yet: turn around.");
        assert_eq!(said(&none(None)), "No answer yet: no triplets.");
    }

    #[test]
    fn where_driving_on_gains_little_the_target_is_said_to_be_far() {
        let coach = Coach::new(2e-3);
        let one = |before_m: Option<f64>, after_m: f64| NextMove {
            sentence: format!("drive a circle: {:.1} mm foreseen", after_m * 1e3),
            waypoints_m: Vec::new(),
            before_m,
            after_m,
            takes_s: 40.0,
            open: 0,
            gain_per_m2_s: 1.0,
        };
        let said = |moves: &[NextMove]| coach.sentence(Some(&outcome(1.0, 5.0, |_| ())), moves);
        assert!(said(&[one(Some(5e-3), 4.9e-3)]).contains("No manoeuvre from here gains 5 %"));
        let worth_it = [one(Some(5e-3), 4.9e-3), one(Some(5e-3), 3e-3)];
        assert!(said(&worth_it).ends_with("Drive a circle: 3.0 mm foreseen."));
        // Advice for an earlier answer is omitted if its σ has been reached meanwhile.
        assert!(said(&[one(Some(11e-3), 4.9e-3)]).ends_with("Turn more."));
        assert!(said(&[one(None, 4e-3)]).ends_with("Drive a circle: 4.0 mm foreseen."));
    }

    #[test]
    fn a_verdict_is_told_with_what_speaks_against_the_answer() {
        let coach = Coach::new(2e-3);
        let weak = outcome(1.0, 1.5, |judged| {
            judged.verdict = Verdict::Weak;
            judged.verdict_in_words = "weak".to_owned();
            judged.reason = Some("station 2's clock seems late".to_owned());
        });
        let said = coach.sentence(Some(&weak), &[]);
        assert!(
            said.starts_with("The answer is weak: station 2's clock seems late; 1.5 mm"),
            "{said}"
        );
        // One advice: that of the doubt is left out.
        let weak = outcome(1.0, 1.5, |judged| {
            judged.verdict = Verdict::Weak;
            judged.verdict_in_words = "weak".to_owned();
            judged.reason = Some("station 2 can slide; next, turn more".to_owned());
        });
        let said = coach.sentence(Some(&weak), &[]);
        assert_eq!(said.matches("Turn more").count(), 1, "{said}");
        assert!(said.starts_with("The answer is weak: station 2 can slide; 1.5 mm"), "{said}");
    }

    #[test]
    fn the_curve_of_a_day_stays_short_and_keeps_its_ends() {
        let mut coach = Coach::new(2e-3);
        for second in 0..86_400 {
            coach.take(&outcome(f64::from(second), 1.5, |_| ()), false);
        }
        let points = &coach.curves[1].points;
        assert!((500..MOST_POINTS).contains(&points.len()), "{}", points.len());
        assert_eq!(points[0].time_s, 0.0);
        assert!(points[points.len() - 1].time_s > 86_398.0);
        assert!(points.windows(2).all(|w| w[0].time_s < w[1].time_s));
    }
}
