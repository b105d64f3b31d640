use super::*;
use crate::app::model::new_findings::forget_past;
use resect_core::deployment::Subject;
use resect_core::deployment::kinds;
use resect_io::findings::kinds as file_kinds;

fn texts(toasts: &Toasts) -> Vec<&str> {
    toasts.shown().iter().map(|toast| toast.text.as_str()).collect()
}

#[test]
fn what_is_done_goes_and_errors_stay() {
    let mut toasts = Toasts::default();
    toasts.done("saved");
    toasts.error("a.csv:1: no column `id`; the header must name it");
    assert_eq!(toasts.advance(100.0), Some(105.0));
    assert_eq!(texts(&toasts), ["saved", "a.csv:1: no column `id`"]);
    assert_eq!(toasts.errors().next().expect("one").1, "the header must name it");
    // The pointer restarts its lifetime.
    toasts.hold(toasts.shown()[0].id);
    toasts.advance(106.0);
    assert_eq!(toasts.shown().len(), 2);
    assert_eq!(toasts.advance(111.0), None);
    assert_eq!(texts(&toasts), ["a.csv:1: no column `id`"]);
    toasts.dismiss(toasts.shown()[0].id);
    assert!(toasts.shown().is_empty());
}

#[test]
fn what_no_longer_holds_is_taken_away() {
    let (mut toasts, mut told) = (Toasts::default(), BTreeSet::new());
    let late =
        |ms: f64| Finding::new(kinds::CLOCK_OFFSET_SUSPECTED, format!("station 3 is {ms} ms late"));
    let jump = Finding::new(kinds::CLOCK_STEPPED, "the clocks jump");
    toasts.findings((1, "drive"), &[late(2.7)], &mut told);
    toasts.findings((2, "other"), &[late(1.0)], &mut BTreeSet::new());
    toasts.update((1, "drive"), &[late(3.1)].iter());
    // Shows the present number.
    assert_eq!(texts(&toasts)[0], "drive: station 3 is 3.1 ms late");
    toasts.update((1, "drive"), &[jump].iter());
    assert_eq!(texts(&toasts), ["other: station 3 is 1 ms late"]);
    toasts.closed(2);
    let place = Place::Path("/day/broken.csv".into());
    toasts.not_opened(&place, "broken.csv:1: semicolons; save the table with commas");
    toasts.settled(&Place::Path("/day/other.csv".into()));
    assert_eq!(toasts.errors().count(), 1);
    toasts.settled(&place);
    assert!(toasts.shown().is_empty());
}

#[test]
fn angles_are_told_in_the_unit_that_is_chosen_while_they_are_shown() {
    use super::super::AngleUnit;
    use resect_core::deployment::{AngleFormat, Message, MessageAngle};
    let turned = MessageAngle::signed(1e-3, AngleFormat::Milliradians, 2);
    let message = Message::from("station 2 turned by ").angle(turned);
    let finding = Finding::new(kinds::STATION_MOVED, message);
    let mut toasts = Toasts::default();
    toasts.findings((1, "drive"), &[finding], &mut BTreeSet::new());
    let told = |angle| {
        let [text, _] = toasts.shown()[0].lines(Units { angle, ..Units::default() });
        text.trim_start_matches("drive: station 2 turned by ").to_owned()
    };
    assert_eq!(AngleUnit::ALL.map(told), ["+1.0 mrad", "+206 ″", "+64 mgon"].map(str::to_owned));
}

#[test]
fn the_same_is_counted_and_another_remedy_is_another_thing() {
    let mut toasts = Toasts::default();
    toasts.error("a.csv: not readable; check its permissions");
    toasts.error("a.csv: not readable; check its permissions");
    toasts.error("a.csv: not readable; mount the disk");
    let counts: Vec<usize> = toasts.shown().iter().map(|toast| toast.count).collect();
    assert_eq!(counts, [2, 1]);
}

#[test]
fn they_never_flood_the_window() {
    let mut toasts = Toasts::default();
    toasts.error("first");
    for number in 0..9 {
        toasts.done(format!("saved {number}"));
    }
    toasts.done("saved 8");
    assert_eq!(texts(&toasts), ["first", "saved 6", "saved 7", "saved 8"]);
}

#[test]
fn each_finding_is_told_once_and_several_in_one_toast() {
    let (mut toasts, mut told) = (Toasts::default(), BTreeSet::new());
    let repeated = |station: usize, count: usize| {
        let message = format!("station {}: {count} duplicate stamps", station + 1);
        Finding::new(file_kinds::STAMPS_REPEATED, message).about(Subject::Station(station))
    };
    let findings = [
        Finding::new(file_kinds::BAGS_JOINED, "all is well"),
        repeated(1, 14),
        Finding::new(file_kinds::STATION_WITHOUT_READINGS, "station 3 has no measurement"),
    ];
    let short = Finding::new(kinds::FEW_TIME_BLOCKS, "the drive is short");
    toasts.findings((1, "day 1"), &findings, &mut told);
    assert_eq!(texts(&toasts), ["2 warnings about day 1"]);
    assert_eq!(toasts.shown()[0].detail, "station 3 has no measurement");
    assert_eq!(toasts.shown()[0].level, ToastLevel::Error);
    toasts.dismiss(toasts.shown()[0].id);
    toasts.findings((1, "day 1"), &findings, &mut told);
    toasts.findings((1, "day 1"), &[repeated(1, 15)], &mut told);
    assert!(toasts.shown().is_empty());
    toasts.findings((1, "day 1"), &[repeated(0, 15)], &mut told);
    assert_eq!(texts(&toasts), ["day 1: station 1: 15 duplicate stamps"]);
    forget_past([].iter(), &mut told);
    toasts.update((1, "day 1"), &[].iter());
    toasts.findings((1, "day 1"), &[short], &mut told);
    assert_eq!(texts(&toasts), ["day 1: the drive is short"]);
}
