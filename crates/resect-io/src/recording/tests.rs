use super::*;

fn record(station: i64, place: usize, time_s: f64) -> RawRecord {
    let measurement = Measurement { time_s, range_m: 10.0, azimuth_rad: 0.1, zenith_rad: 1.5 };
    RawRecord { station, status: 0, place, measurement, own_clock_s: None }
}

fn assemble(records: &[RawRecord]) -> (PerStation<Track>, Vec<Finding>) {
    let mut recording = Recording::new(None, false);
    recording.begin_file("x.csv", "line");
    records.iter().for_each(|record| recording.push(record));
    recording.finish("x.csv").expect("readings")
}

#[test]
fn what_cannot_be_a_reading_is_left_out_and_said() {
    let mut records: Vec<_> = (0..9).map(|i| record(i % 3 + 1, i as usize + 2, i as f64)).collect();
    records.push(record(1, 11, 6.0)); // duplicate of the third reading of station 1
    records.push(record(2, 12, 0.5)); // late
    records.push(record(4, 13, 1.0));
    records.push(RawRecord { status: 3, ..record(3, 14, 9.0) });
    let mut broken = record(3, 15, 10.0);
    broken.measurement.range_m = f64::NAN;
    records.push(broken);
    let (tracks, findings) = assemble(&records);
    assert_eq!(tracks.map(|t| t.measurements.len()), [3, 4, 3].into());
    assert!(tracks[1].measurements.windows(2).all(|w| w[0].time_s < w[1].time_s));
    let text = findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
    for expected in [
        "status 3",
        "not a number",
        "duplicate",
        "out-of-order",
        "other than 1, 2, 3",
        "line 13 of x.csv",
    ] {
        assert!(text.contains(expected), "missing `{expected}` in:\n{text}");
    }
}

#[test]
fn what_was_counted_goes_with_its_station() {
    let mut recording = Recording::new(None, false);
    recording.begin_file("x.csv", "line");
    (0..6).for_each(|i| recording.push(&record(i % 3 + 1, i as usize + 2, i as f64)));
    recording.push(&RawRecord { status: 3, ..record(2, 8, 9.0) });
    recording.push(&record(3, 9, 5.0));
    let from = recording.count_as(Some(&[1, 3, 2].into()), true);
    assert_eq!(from, [Some(0), Some(2), Some(1)].into());
    assert_eq!(recording.late_and_repeated(), [[0, 0], [0, 1], [0, 0]].into());
    let second = recording.tracks().nth(1).expect("a station");
    assert_eq!(second.measurements[0].time_s, 2.0);
    // Number 4 had no station so far; the readings of number 2 are lost.
    let from = recording.count_as(Some(&[1, 3, 4].into()), true);
    assert_eq!(from, [Some(0), Some(1), None].into());
    recording.push(&record(4, 10, 9.0));
    let (tracks, findings) = recording.finish("x.csv").expect("readings");
    assert_eq!(tracks.map(|track| track.measurements.len()), [2, 2, 1].into());
    assert!(tracks.iter().all(|track| track.measurements[0].azimuth_rad == -0.1));
    let said: Vec<String> = findings.iter().map(ToString::to_string).collect();
    assert!(said.iter().any(|line| line.contains("status 3")), "{said:?}");
    assert!(!said.iter().any(|line| line.contains("station 2: status 3")), "{said:?}");
}

#[test]
fn a_clock_that_was_set_back_is_told_from_late_readings() {
    let set_back_s = |times_s: &[f64]| {
        let readings = times_s.iter().map(|time_s| record(1, 2, *time_s).measurement);
        largest_set_back_s(&readings.collect::<Vec<_>>())
    };
    let steady: Vec<f64> = (0..100).map(|k| f64::from(k) * 0.4).collect();
    assert_eq!(set_back_s(&steady), 0.0);
    // The second half is stamped 3 s too early, between the stamps of the first.
    let back: Vec<f64> = steady.iter().map(|t| if *t > 20.0 { t - 3.1 } else { *t }).collect();
    assert!((set_back_s(&back) - 2.7).abs() < 1e-9, "{}", set_back_s(&back));
    // Some readings of ten seconds arrive after the others.
    let is_late = |t: &f64| (20.0..30.0).contains(t) && (t / 0.4).round() % 3.0 != 0.0;
    let (late, mut in_time): (Vec<f64>, Vec<f64>) = steady.iter().partition(|t| is_late(t));
    let end = in_time.partition_point(|t| *t < 30.0);
    in_time.splice(end..end, late);
    assert_eq!(set_back_s(&in_time), 0.0);
    let mut twice = steady.clone();
    twice.extend(&steady);
    assert_eq!(set_back_s(&twice), 0.0);
}

#[test]
fn a_silent_station_is_a_problem() {
    let (_, findings) = assemble(&[record(3, 2, 0.0)]);
    let problems =
        findings.iter().filter(|f| f.severity == resect_core::deployment::Severity::Problem);
    assert_eq!(problems.count(), 2);
}

#[test]
fn the_records_determine_the_number_of_stations() {
    for count in 1..=8 {
        let records: Vec<_> =
            (0..4 * count).map(|i| record(i % count + 1, i as usize + 2, i as f64)).collect();
        let (tracks, findings) = assemble(&records);
        assert_eq!(tracks.len() as i64, count);
        assert_eq!(findings, []);
    }
    let mut recording = Recording::new(None, false);
    recording.begin_file("x.csv", "line");
    recording.expect_stations(2);
    recording.push(&record(1, 2, 0.0));
    let (tracks, findings) = recording.finish("x.csv").expect("readings");
    assert_eq!((tracks.len(), findings.len()), (2, 1));
}

#[test]
fn other_numbers_than_one_to_eight_are_stations_in_ascending_order() {
    let numbers_of = |numbers: &[i64]| {
        let mut recording = Recording::new(None, false);
        for number in numbers.repeat(FEWEST_OF_A_STATION) {
            recording.push(&record(number, 1, 0.0));
        }
        recording.other_numbers()
    };
    assert_eq!(numbers_of(&[2, 0, 1, 3]), Some([0, 1, 2, 3].into()));
    assert_eq!(numbers_of(&[883, 882]), Some([882, 883].into()));
    assert_eq!(numbers_of(&[1, 2, 4]), Some([1, 2, 4].into()));
    // A gap is a station without readings.
    assert_eq!(numbers_of(&[1, 3]), None);
    assert_eq!(numbers_of(&[2]), None);
    assert_eq!(numbers_of(&[1, 2, 3, 4, 5]), None);
}

#[test]
fn a_name_of_a_station_is_kept_if_it_is_not_its_number() {
    let numbers = PerStation::from([7, 2, 9]);
    let mut recording = Recording::new(Some(&numbers), false);
    recording.name_by_numbers(&numbers);
    let names = |recording: &Recording| -> Vec<Option<String>> {
        recording.tracks().map(|track| track.name.clone()).collect()
    };
    assert_eq!(names(&recording), [Some("7".into()), None, Some("9".into())]);
    recording.name_station(0, "/rts1");
    recording.name_station(1, "/tower");
    assert_eq!(names(&recording), [Some("7".into()), Some("/tower".into()), Some("9".into())]);
}

#[test]
fn no_reading_at_all_is_an_error_that_says_why() {
    let mut recording = Recording::new(None, false);
    recording.begin_file("x.csv", "line");
    for row in 0..10 {
        let mut broken = record(row % 2 + 1, row as usize + 2, row as f64);
        broken.measurement.range_m = f64::NAN;
        recording.push(&broken);
    }
    let error = recording.finish("x.csv").expect_err("nothing").to_string();
    for expected in ["no usable measurement", "5 times (first at line 2", "not a number"] {
        assert!(error.contains(expected), "missing `{expected}` in: {error}");
    }
}
