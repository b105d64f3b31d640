//! Tests of the messages about instruments.

use super::*;

#[test]
fn a_change_of_a_set_up_states_what_is_significant() {
    let estimate = |value, sigma| Estimate { value, sigma };
    let (turned, unturned) = (estimate(8.52e-4, 5.1e-5), estimate(1e-5, 5.1e-5));
    let (moved, unmoved) = (estimate(0.0041, 0.0009), estimate(0.0011, 0.0009));
    let event = |turned_rad: &Estimate, moved_m: &Estimate| {
        let message = set_up_changed(1, turned_rad, moved_m).to_string();
        let event = message.split_once(" between the survey and the drive. ");
        event.map(|(event, _)| event.to_owned()).expect("an event")
    };
    let both = "Station 2 turned by +0.852 ± 0.051 mrad and moved by 4.10 ± 0.90 mm";
    assert_eq!(event(&turned, &unmoved), "Station 2 turned by +0.852 ± 0.051 mrad");
    assert_eq!(event(&unturned, &moved), "Station 2 moved by 4.10 ± 0.90 mm");
    assert_eq!(event(&turned, &moved), both);
    let neither = "Station 2 turned by +0.010 ± 0.051 mrad and moved by 1.10 ± 0.90 mm";
    assert_eq!(event(&unturned, &unmoved), neither);
}

#[test]
fn an_implausible_error_states_what_the_readings_give_without_its_prior() {
    let arcsec = |arcsec: f64| (arcsec / 3600.0).to_radians();
    let (mean, prior, read, sigma) = (3.0, 2.0, -36.0, 7.0);
    // Two independent observations of one quantity, by their information.
    let [by_prior, by_readings] = [prior, sigma].map(|sigma: f64| sigma.powi(-2));
    let posterior = Estimate {
        value: arcsec((mean * by_prior + read * by_readings) / (by_prior + by_readings)),
        sigma: arcsec((by_prior + by_readings).powf(-0.5)),
    };
    let error = NamedError {
        sentence: "station 1 leans about y by",
        station: Some(0),
        quantity: Quantity::Angle,
        estimate: posterior,
        prior_sigma: arcsec(prior),
    };
    let message =
        |error: &NamedError<'_>| instrument_error_implausible(error, arcsec(mean), 5.4).to_string();
    let stated = message(&error);
    assert!(
        stated.starts_with("station 1 leans about y by -36.0 ± 7.0″ without its prior"),
        "{stated}"
    );
    let unread = NamedError { estimate: Estimate { sigma: arcsec(prior), ..posterior }, ..error };
    assert!(!message(&unread).contains("without its prior"));
}
