//! Explanations of every fate on small tracks, and of all readings of a sample.

use super::*;
use crate::deployment::{Deployment, Measurement, Track};
use crate::pipeline;
use crate::pipeline::{OutlierReason, PipelineSettings, SampleFate};
use crate::simulated_drives::{Preset, simulated};

/// Readings of one station at times (s), all of the same point.
fn track(times_s: impl IntoIterator<Item = f64>) -> Track {
    let still = |time_s| Measurement { time_s, range_m: 10.0, azimuth_rad: 0.1, zenith_rad: 1.5 };
    Track {
        measurements: times_s.into_iter().map(still).collect(),
        prism_constant_m: 0.01,
        ..Track::default()
    }
}

/// Times every half second from one to another (s after 1000 s), both included.
fn every_half_second(from: u32, to: u32) -> impl Iterator<Item = f64> {
    (2 * from..=2 * to).map(|half| 1000.0 + f64::from(half) / 2.0)
}

fn deployment(tracks: [Track; 3]) -> Deployment {
    Deployment {
        name: "test".to_owned(),
        tracks: tracks.into(),
        control_points: Vec::new(),
        rig: None,
        prisms: None,
        gnss: None,
        ingredients: Vec::new(),
        findings: Vec::new(),
        time_corrections: Default::default(),
        track_frame: Default::default(),
        as_read: Default::default(),
        overrides: Default::default(),
        ground_truth: None,
        restarts_s: Vec::new(),
    }
}

/// Explains one reading with the paper's settings, and returns the text with times from 1000 s on.
fn explained(deployment: &Deployment, station: usize, index: usize) -> (Explanation, String) {
    let settings = PipelineSettings::default();
    let output = pipeline::run(deployment, &settings);
    let explanation =
        explain(deployment, &output, &settings, station, index).expect("there is such a reading");
    let words = explanation.in_words(1000.0);
    (explanation, words)
}

#[test]
fn a_kept_reading_names_its_interval() {
    let all = || track(every_half_second(0, 20));
    let (explanation, words) = explained(&deployment([all(), all(), all()]), 1, 7);
    assert_eq!(explanation.fate, SampleFate::Kept);
    assert_eq!(words, "Kept: in interval 1 (0.0–20.0 s, 20.0 s).");
    assert_eq!((explanation.gap_before_s, explanation.gap_after_s), (Some(0.5), Some(0.5)));
    assert!(explanation.remedy().is_none());
}

#[test]
fn a_reading_beside_an_interval_says_which_end_needs_it() {
    let all = || track(every_half_second(0, 20));
    let late = track(every_half_second(0, 20).map(|t| t + 0.2).skip(1));
    let (_, words) = explained(&deployment([all(), all(), late]), 0, 1);
    assert_eq!(
        words,
        "Kept: just outside interval 1 (0.7–20.0 s), whose first triplet is interpolated from it."
    );
}

#[test]
fn a_rejected_reading_names_the_rate_the_time_and_the_threshold() {
    let all = || track(every_half_second(0, 20));
    let mut jumping = all();
    jumping.measurements[6].azimuth_rad += 1.71_f64.to_radians();
    let deployment = deployment([all(), jumping, all()]);
    let (explanation, words) = explained(&deployment, 1, 6);
    assert_eq!(
        words,
        "Rejected by the azimuth rate: 3.42 °/s from the previous reading (0.50 s earlier), τ_a allows 1.00."
    );
    let remedy = explanation.remedy().expect("a threshold");
    assert_eq!(remedy.thresholds.tau_a_deg_per_s, 3.5);
    let (_, words) = explained(&deployment, 1, 7);
    assert!(words.ends_with("the return from a jump is also a jump."), "{words}");
}

#[test]
fn a_value_and_its_limit_never_read_the_same() {
    let all = || track(every_half_second(0, 20));
    let mut jumping = all();
    for reading in &mut jumping.measurements[6..] {
        reading.range_m += 1.000_4;
    }
    let (_, words) = explained(&deployment([jumping, all(), all()]), 0, 6);
    assert!(words.contains("2.001 m/s") && words.contains("allows 2.000"), "{words}");
}

#[test]
fn all_rates_that_are_too_high_are_named_and_the_first_decides() {
    let all = || track(every_half_second(0, 20));
    let mut jumping = all();
    for reading in &mut jumping.measurements[6..] {
        reading.range_m += 2.0;
        reading.zenith_rad += 0.1;
    }
    let (explanation, words) = explained(&deployment([all(), all(), jumping]), 2, 6);
    assert_eq!(explanation.fate, SampleFate::Rejected(OutlierReason::Range));
    assert!(words.contains("by the range rate: 4.00 m/s"), "{words}");
    assert!(words.contains("The zenith rate is too high as well: 11.46 °/s"), "{words}");
    let remedy = explanation.remedy().expect("thresholds").thresholds;
    assert_eq!((remedy.tau_r_m_per_s, remedy.tau_e_deg_per_s), (4.0, 12.0));
}

#[test]
fn a_reading_in_no_interval_names_who_was_silent() {
    let all = || track(every_half_second(0, 20));
    let gap = track(every_half_second(0, 20).filter(|t| !(1008.1..1011.7).contains(t)));
    let (explanation, words) = explained(&deployment([all(), all(), gap]), 0, 20);
    assert_eq!(
        words,
        "In no interval: station 3 was silent from 8.0 s to 12.0 s (4.0 s); τ_s allows 1.0 s."
    );
    let Place::InNone(silences) = &explanation.place else { panic!("{explanation:?}") };
    assert_eq!(silences[0].length_s(), Some(4.0));
    assert_eq!(explanation.remedy().expect("a threshold").thresholds.tau_s_seconds, 4.0);
}

#[test]
fn rejected_readings_in_a_silence_are_counted() {
    let all = || track(every_half_second(0, 20));
    let mut jumping = all();
    // Jumps up and down, each step too fast.
    for (index, reading) in jumping.measurements[16..=22].iter_mut().enumerate() {
        reading.range_m += if index % 2 == 0 { 5.0 } else { 0.0 };
    }
    let (_, words) = explained(&deployment([all(), all(), jumping]), 0, 20);
    assert!(
        words.contains(
            "station 3 was silent from 7.5 s to 12.0 s (4.5 s; 8 readings in between were rejected)"
        ),
        "{words}"
    );
}

#[test]
fn a_station_that_starts_late_or_stops_early_is_named() {
    let all = || track(every_half_second(0, 30));
    let late = track(every_half_second(10, 30));
    let early = track(every_half_second(0, 20));
    let deployment = deployment([all(), late, early]);
    let (explanation, words) = explained(&deployment, 0, 4);
    assert_eq!(words, "In no interval: station 2 was silent until 10.0 s; τ_s allows 1.0 s.");
    assert!(explanation.remedy().is_none());
    let (_, words) = explained(&deployment, 0, 58);
    assert_eq!(words, "In no interval: station 3 was silent from 20.0 s on; τ_s allows 1.0 s.");
}

#[test]
fn a_reading_alone_is_its_own_silence() {
    let all = || track(every_half_second(0, 20));
    let alone = track([1000.0, 1000.5, 1004.0, 1006.5, 1007.0]);
    let (explanation, words) = explained(&deployment([all(), alone, all()]), 1, 2);
    assert_eq!(
        words,
        "In no interval: station 2 itself has this reading alone (3.5 s after the last, 2.5 s before the next); τ_s \
         allows 1.0 s."
    );
    assert_eq!(explanation.remedy().expect("a threshold").thresholds.tau_s_seconds, 2.5);
}

#[test]
fn a_reading_in_a_short_interval_names_both_lengths() {
    let all = || track(every_half_second(0, 20));
    let gap = track(every_half_second(0, 20).filter(|t| !(1003.6..1007.4).contains(t)));
    let (explanation, words) = explained(&deployment([all(), gap, all()]), 2, 3);
    assert_eq!(words, "Interval too short: 0.0–3.5 s lasts 3.5 s, τ_l requires more than 6.0 s.");
    assert_eq!(explanation.remedy().expect("a threshold").thresholds.tau_l_seconds, 3.4);
}

#[test]
fn what_is_not_there_is_not_explained() {
    let all = || track(every_half_second(0, 20));
    let deployment = deployment([all(), all(), all()]);
    let settings = PipelineSettings::default();
    let output = pipeline::run(&deployment, &settings);
    assert!(explain(&deployment, &output, &settings, 0, 41).is_none());
    assert!(explain(&deployment, &output, &settings, 3, 0).is_none());
}

/// Repeated remedies lead to a kept reading, or to a gap that should stay open.
#[test]
fn remedies_keep_what_they_promise() {
    let deployment = simulated(Preset::Warthog, 1);
    let paper = PipelineSettings::default();
    let first = pipeline::run(&deployment, &paper);
    let stopped = |station: usize| {
        let each = first.fates[station].each.iter().enumerate();
        each.filter(|(_, fate)| **fate != SampleFate::Kept).map(|(index, _)| index)
    };
    let mut kept = 0;
    for (station, index) in
        (0..3).flat_map(|station| stopped(station).step_by(7).map(move |index| (station, index)))
    {
        let mut settings = paper;
        let mut steps = 0;
        loop {
            let output = pipeline::run(&deployment, &settings);
            let explanation =
                explain(&deployment, &output, &settings, station, index).expect("a reading");
            let Some(next) = explanation.remedy() else {
                kept += usize::from(explanation.fate == SampleFate::Kept);
                if let Place::InNone(silences) = &explanation.place {
                    let closable = |s| explanation.gap_s(s).is_some_and(|gap_s| gap_s <= 10.0);
                    assert!(!silences.iter().all(closable), "{}", explanation.in_words(0.0));
                }
                break;
            };
            assert_ne!(next, settings, "{}", explanation.in_words(0.0));
            settings = next;
            steps += 1;
            assert!(steps <= 8, "no end: {}", explanation.in_words(0.0));
        }
    }
    assert!(kept > 50, "{kept}");
}
