//! Corrections of a growing deployment apply to earlier and to later readings.

use resect_core::deployment::{AzimuthSense, Deployment, Overrides, PrismConstants};
use resect_core::progress::Progress;
use resect_io::growing::Growing;
use resect_io::source::Extras;
use resect_live::event::{Event, Sent};
use resect_live::{Engine, bonn, replay};

use crate::common::sample_folder;

fn around(corrections: &Overrides) -> Growing {
    let extras = Extras { corrections: corrections.clone(), ..Extras::default() };
    let folder = sample_folder("hd2-tunnel");
    Growing::around("live", Some(&folder), &extras, &Progress::default()).expect("a folder")
}

/// Returns the deployment of some messages, with overrides at the beginning, and others after some messages.
fn heard(sent: &[Sent], first: &Overrides, then: Option<(usize, &Overrides)>) -> Deployment {
    let mut engine = Engine::new(around(first), Some(1.0), None, 2e-3);
    engine.take(Event::Connected("robot".to_owned()), 0.0);
    engine.take(Event::Channel(bonn::BonnProtocol::channel()), 0.0);
    for (k, one) in sent.iter().enumerate() {
        if let Some((_, then)) = then.filter(|(from, _)| *from == k) {
            engine.read_with(around(then));
            let view = engine.view(0.0);
            assert!(
                view.answer.is_none() && view.first.is_none(),
                "answers were to other readings"
            );
        }
        engine.take(Event::Message(one.clone()), 0.0);
    }
    engine.deployment().expect("readings")
}

#[test]
fn it_is_as_if_it_had_been_said_in_the_beginning() {
    let deployment = resect_io::open::open(&sample_folder("hd2-tunnel")).expect("a sample");
    let sent: Vec<Sent> = replay::messages(&deployment, &[0.01; 3].into()).collect();
    let nothing = Overrides::default();
    let last_s = deployment.end_s().expect("readings");
    for corrections in [
        Overrides { stations: Some([2, 3, 1].into()), ..nothing.clone() },
        Overrides { azimuth: Some(AzimuthSense::CounterClockwise), ..nothing.clone() },
        Overrides {
            prism_constant_m: Some(PrismConstants::Each([0.0, 0.01, 0.02].into())),
            inter_prism_m: Some([0.4, 0.41, 0.42].into()),
            span_s: Some([0.0, last_s]),
            ..nothing.clone()
        },
    ] {
        let expected = heard(&sent, &corrections, None);
        for from in [1, sent.len() / 2, sent.len() - 1] {
            let found = heard(&sent, &nothing, Some((from, &corrections)));
            assert_eq!(found.tracks, expected.tracks, "{corrections:?}");
            assert_eq!(found.rig, expected.rig);
            let said = |of: &Deployment| -> Vec<String> {
                of.findings.iter().map(ToString::to_string).collect()
            };
            assert_eq!(said(&found), said(&expected));
            // Undoing the correction restores the readings.
            let back = heard(&sent, &corrections, Some((from, &nothing)));
            assert_eq!(back.tracks, heard(&sent, &nothing, None).tracks);
        }
    }
}
