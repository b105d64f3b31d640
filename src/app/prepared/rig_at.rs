//! Positions of the prisms at any time: together by a triplet, or each at its last reading.

use nalgebra::Vector3;

use resect_core::analysis::Analysis;
use resect_core::deployment::{Deployment, Track};
use resect_core::network::PerStation;
use resect_core::pipeline::{SampleFate, Triplets};

/// Age up to which a reading represents its prism (s): after a few seconds the vehicle is elsewhere.
pub const LAST_READ_S: f64 = 3.0;

/// The stations' prisms at a time, each in its station's frame.
#[derive(Clone, Debug, PartialEq)]
pub enum RigAt {
    /// At one instant, of a triplet or between two.
    Together(Triplets),
    /// Without a triplet: the last reading of each prism; `None` if it is too old.
    LastRead(PerStation<Option<LastRead>>),
}

/// The newest reading of a prism that is not later than the time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LastRead {
    /// Position of the prism (m, station's frame).
    pub position_m: Vector3<f64>,
    /// Age of the reading (s).
    pub age_s: f64,
    /// True if the outlier filter or the user rejected it.
    pub rejected: bool,
}

/// Returns the prisms at a time (s, in the stations' clock), by binary search. Between
/// triplets they are interpolated across gaps no longer than those that the pipeline bridges.
pub fn rig_at(deployment: &Deployment, analysis: &Analysis, time_s: f64) -> RigAt {
    match analysis.triplets().at(time_s, longest_s(analysis)) {
        Some(triplet) => RigAt::Together(triplet),
        None => {
            RigAt::LastRead((deployment.tracks).zip(&analysis.pipeline.fates, |track, fates| {
                last_read(track, &fates.each, time_s)
            }))
        }
    }
}

/// Returns true if the prisms are known together at a time (s, in the stations' clock): by a triplet, or between two.
pub fn are_together_at(analysis: &Analysis, time_s: f64) -> bool {
    analysis.triplets().at(time_s, longest_s(analysis)).is_some()
}

fn longest_s(analysis: &Analysis) -> f64 {
    analysis.settings.pipeline.thresholds.tau_s_seconds
}

fn last_read(track: &Track, fates: &[SampleFate], time_s: f64) -> Option<LastRead> {
    let index = track.measurements.partition_point(|m| m.time_s <= time_s).checked_sub(1)?;
    let reading = &track.measurements[index];
    let age_s = time_s - reading.time_s;
    let fate = fates.get(index);
    (age_s <= LAST_READ_S).then(|| LastRead {
        position_m: track.position_m(reading),
        age_s,
        rejected: matches!(fate, Some(SampleFate::Rejected(_) | SampleFate::LeftOut)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::analysis::{Analyst, Settings};
    use resect_core::pipeline::OutlierReason;
    use resect_io::sample::Sample;

    fn analysed() -> (Deployment, Analysis) {
        let deployment = Sample::Warthog.open().expect("built in");
        let analysis = Analyst::new(deployment.clone().into()).run(&Settings::default());
        (deployment, analysis)
    }

    #[test]
    fn inside_an_interval_the_prisms_move_on_between_triplets() {
        let (deployment, analysis) = analysed();
        let triplets = analysis.triplets();
        for index in (1..triplets.len()).step_by(50) {
            if triplets.interval[index] != triplets.interval[index - 1] {
                continue;
            }
            let time_s = 0.5 * (triplets.time_s[index - 1] + triplets.time_s[index]);
            let RigAt::Together(now) = rig_at(&deployment, &analysis, time_s) else {
                panic!("a triplet on either side of {time_s}")
            };
            assert!(are_together_at(&analysis, time_s));
            for station in 0..3 {
                let points_m = &triplets.points_m[station];
                let middle = 0.5 * (points_m[index - 1] + points_m[index]);
                // Stamps have a resolution of a quarter of a microsecond.
                assert!((now.triplet_m(0)[station] - middle).norm() < 1e-6);
            }
        }
    }

    #[test]
    fn in_a_gap_each_prism_is_where_it_was_last_read_unless_that_is_long_ago() {
        let (deployment, analysis) = analysed();
        let times_s = &analysis.triplets().time_s;
        let intervals = &analysis.triplets().interval;
        let mut seen = [0; 2];
        for last in (1..times_s.len()).filter(|i| intervals[*i] != intervals[i - 1]) {
            let [from_s, to_s] = [times_s[last - 1], times_s[last]];
            for time_s in (1..20).map(|step| from_s + (to_s - from_s) * f64::from(step) / 20.0) {
                assert!(!are_together_at(&analysis, time_s));
                let RigAt::LastRead(prisms) = rig_at(&deployment, &analysis, time_s) else {
                    panic!("a pose across a gap at {time_s}")
                };
                for (track, prism) in deployment.tracks.iter().zip(prisms) {
                    // Brute force.
                    let mut before = track.measurements.iter().filter(|m| m.time_s <= time_s);
                    let newest = before.next_back().expect("in the middle of the drive");
                    let expected = (time_s - newest.time_s <= LAST_READ_S)
                        .then(|| (track.position_m(newest), time_s - newest.time_s));
                    assert_eq!(prism.map(|it| (it.position_m, it.age_s)), expected);
                    seen[usize::from(prism.is_some())] += 1;
                }
            }
        }
        assert!(seen.iter().all(|count| *count > 0), "both come: {seen:?}");
    }

    #[test]
    fn before_the_first_reading_nothing_is_anywhere() {
        let (deployment, analysis) = analysed();
        let start_s = deployment.start_s().expect("readings");
        let at = rig_at(&deployment, &analysis, start_s - 0.1);
        assert_eq!(at, RigAt::LastRead([None; 3].into()));
        let end_s = deployment.end_s().expect("readings");
        let at = rig_at(&deployment, &analysis, end_s + LAST_READ_S + 0.1);
        assert_eq!(at, RigAt::LastRead([None; 3].into()));
    }

    #[test]
    fn a_rejected_reading_says_so() {
        let (deployment, _) = analysed();
        let track = &deployment.tracks[0];
        let time_s = track.measurements[3].time_s;
        let mut fates = vec![SampleFate::InNoInterval; 4];
        let rejected =
            |fates: &[SampleFate]| last_read(track, fates, time_s).expect("just read").rejected;
        assert!(!rejected(&fates));
        for fate in [SampleFate::Rejected(OutlierReason::Range), SampleFate::LeftOut] {
            fates[3] = fate;
            assert!(rejected(&fates), "{fate:?}");
        }
    }
}
