//! Explanations of the fates of readings: the explanation of every reading of whole deployments agrees with the pipeline's own output.

use crate::common::of_field;
use resect_core::deployment::Deployment;
use resect_core::pipeline;
use resect_core::pipeline::explanation::{Place, Rate, explain};
use resect_core::pipeline::{Interval, PipelineSettings, SampleFate};
use resect_io::open::open;
use resect_io::sample::Sample;

/// Returns the numbers of readings that were rejected, in no interval, in a short interval, and kept.
fn explain_all(deployment: &Deployment, settings: &PipelineSettings) -> [usize; 4] {
    let output = pipeline::run(deployment, settings);
    let start_s = deployment.start_s().expect("not empty");
    let thresholds = &settings.thresholds;
    let mut counts = [0; 4];
    for station in 0..3 {
        for (index, fate) in output.fates[station].each.iter().enumerate() {
            let explanation =
                explain(deployment, &output, settings, station, index).expect("a reading");
            let words = explanation.in_words(start_s);
            let over = explanation.step.iter().flat_map(|step| step.rates).find(Rate::exceeds);
            let time_s = explanation.reading.time_s;
            let holds = |interval: &Interval| (interval.start_s..=interval.end_s).contains(&time_s);
            match (fate, &explanation.place) {
                (SampleFate::Rejected(reason), Place::Rejected) => {
                    counts[0] += 1;
                    assert_eq!(over.map(|rate| rate.of), Some(*reason));
                    assert!(words.starts_with("Rejected by"), "{words}");
                }
                (SampleFate::InNoInterval, Place::InNone(silences)) => {
                    counts[1] += 1;
                    assert!(words.starts_with("In no interval"), "{words}");
                    assert!(!output.intervals.iter().any(holds));
                    for silence in silences {
                        let length_s = silence.length_s();
                        assert!(length_s.is_none_or(|s| s > thresholds.tau_s_seconds), "{words}");
                        // No other reading within passed module 1.
                        let within = output.filtered[silence.station].time_s.iter().filter(|t| {
                            silence.from_s.is_none_or(|from_s| **t > from_s)
                                && silence.to_s.is_none_or(|to_s| **t < to_s)
                        });
                        assert_eq!(within.count(), usize::from(silence.alone), "{words}");
                    }
                }
                (SampleFate::IntervalTooShort, Place::In { interval, kept: None, .. }) => {
                    counts[2] += 1;
                    assert!(interval.length_s() <= thresholds.tau_l_seconds, "{words}");
                    assert!(words.contains("τ_l requires more"), "{words}");
                }
                (SampleFate::Kept, Place::In { interval, kept: Some(number), beside }) => {
                    counts[3] += 1;
                    assert!(words.starts_with("Kept: "), "{words}");
                    assert_eq!(*interval, output.kept_intervals[*number]);
                    assert_eq!(*beside, !holds(interval));
                }
                (fate, place) => panic!("{fate:?}, but {place:?}"),
            }
            assert_eq!(over.is_some(), matches!(fate, SampleFate::Rejected(_)));
            assert!(*fate != SampleFate::Kept || explanation.remedy().is_none());
        }
    }
    let readings: usize = deployment.tracks.iter().map(|track| track.measurements.len()).sum();
    assert_eq!(counts.iter().sum::<usize>(), readings);
    counts
}

#[test]
fn every_reading_of_the_samples_is_explained() {
    for sample in Sample::ALL {
        let deployment = sample.open().expect("built in");
        let counts = explain_all(&deployment, &PipelineSettings::default());
        assert!(sample != Sample::Warthog || counts.iter().all(|count| *count > 0), "{counts:?}");
        let all = PipelineSettings { outlier_filter: false, ..PipelineSettings::default() };
        let [rejected, ..] = explain_all(&deployment, &all);
        assert_eq!(rejected, 0);
        let mut strict = PipelineSettings::default();
        strict.thresholds.tau_s_seconds = 0.45;
        strict.thresholds.tau_a_deg_per_s = 0.3;
        explain_all(&deployment, &strict);
    }
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn every_reading_of_the_field_data_is_explained() {
    let folder = of_field("2022-07-11-2");
    let deployment = open(&folder).expect("the field data");
    let counts = explain_all(&deployment, &PipelineSettings::default());
    assert!(counts.iter().all(|count| *count > 0), "{counts:?}");
}
