use super::*;

/// A log of these sentences, with their checksums.
fn log(sentences: &[&str]) -> String {
    let with_checksum = |content: &&str| {
        let sum = content.bytes().fold(0, |sum, byte| sum ^ byte);
        format!("${content}*{sum:02X}\r\n")
    };
    sentences.iter().map(with_checksum).collect()
}

fn gga(time: &str, quality: u8) -> String {
    format!("GNGGA,{time},4646.9000,N,07116.5000,W,{quality},12,0.6,95.2,M,-27.5,M,1.0,0001")
}

#[test]
fn an_epoch_has_position_date_and_sigma() {
    let text = log(&[
        &gga("195001.20", 4),
        "GNGST,195001.20,0.5,,,,0.012,0.008,0.021",
        "GNRMC,195001.20,A,4646.9,N,07116.5,W,0.1,,110722,,,R",
    ]);
    assert!(looks_like(&text));
    let track = read("rover.nmea", &text).expect("a log");
    let [solution] = &track.solutions[..] else { panic!("{track:?}") };
    assert!((solution.time_s - 1_657_569_001.2).abs() < 1e-6, "{}", solution.time_s);
    assert_eq!(solution.kind, SolutionKind::Fixed);
    let SolutionPosition::Geodetic(geodetic) = solution.position else { panic!() };
    assert!((geodetic.latitude_rad.to_degrees() - 46.781_666_667).abs() < 1e-8);
    assert!((geodetic.longitude_rad.to_degrees() + 71.275).abs() < 1e-8);
    assert!((geodetic.height_m - 67.7).abs() < 1e-9, "the ellipsoid is below the sea");
    let covariance = solution.covariance_m2.expect("GST");
    let sigma_m = covariance.diagonal().map(f64::sqrt);
    assert!((sigma_m - nalgebra::Vector3::new(0.008, 0.012, 0.021)).norm() < 1e-12, "{sigma_m}");
    assert!(track.findings.is_empty(), "{:?}", track.findings);
}

#[test]
fn the_date_changes_at_midnight_also_if_it_follows_the_position() {
    let text = log(&[
        &gga("235959.00", 4),
        "GPZDA,235959.00,31,12,2021,00,00",
        &gga("000000.00", 5),
        "GPZDA,000000.00,01,01,2022,00,00",
        &gga("000001.00", 4),
    ]);
    let track = read("rover.nmea", &text).expect("a log");
    let times_s: Vec<f64> = track.solutions.iter().map(|solution| solution.time_s).collect();
    assert_eq!(times_s, [1_640_995_199.0, 1_640_995_200.0, 1_640_995_201.0]);
    assert_eq!(track.solutions[1].kind, SolutionKind::Float);
    assert_eq!(track.solutions[1].covariance_m2, None, "HDOP is not σ");
}

#[test]
fn times_without_a_date_count_from_midnight_and_it_is_said() {
    let text = log(&[
        &gga("235959.00", 4),
        // A receiver without a fix does not know the date.
        "GNRMC,235959.00,V,,,,,,,060180,,,N",
        &gga("000001.00", 4),
    ]);
    let track = read("rover.nmea", &text).expect("a log");
    let times_s: Vec<f64> = track.solutions.iter().map(|solution| solution.time_s).collect();
    assert_eq!(times_s, [86_399.0, 86_401.0]);
    let said = track.findings[0].to_string();
    assert!(said.contains("no sentence has a date (RMC or ZDA)"), "{said}");
}

#[test]
fn sentences_that_are_not_valid_are_counted() {
    let mut text = log(&[
        &gga("195001.00", 4),
        &gga("195002.00", 0),
        &gga("195003.00", 1),
        "PUBX,00,195003.00,4646.9,N",
        "GNVTG,,T,,M,0.1,N,0.2,K,D",
    ]);
    text += &log(&[&gga("195004.00", 4)]).replace("95.2", "95.3");
    text += "[info] started\n1657569005.1 $GNGGA,195005.00,4646.9\n";
    let track = read("rover.nmea", &text).expect("a log");
    assert_eq!((track.solutions.len(), track.without_fix), (2, 1));
    let said = track.findings[0].to_string();
    assert!(said.contains("2 rows are not valid") && said.contains("line 6"), "{said}");
    for (sentence, why) in [
        ("GNGGA,195001.00,4660.9,N,07116.5,W,4,12,0.6,95.2,M,,M,,", "`4660.9 N` is not an angle"),
        ("GNGGA,195001.00,4646.9,X,07116.5,W,4,12,0.6,95.2,M,,M,,", "`4646.9 X` is not an angle"),
        ("GNGGA,255001.00,4646.9,N,07116.5,W,4,12,0.6,95.2,M,,M,,", "`255001.00` is not a time"),
        ("GNGGA,195001.00,4646.9,N,07116.5,W,4,12,0.6,,M,,M,,", "`` is not an altitude"),
        ("GNRMC,195001.00,A,4646.9,N,07116.5,W,0.1,,311322,,,R", "`311322` is not a date"),
    ] {
        let error = read("rover.nmea", &log(&[sentence])).expect_err(why).to_string();
        assert!(error.contains(why), "{error}");
    }
    let error = read("rover.nmea", &log(&["GNVTG,,T,,M,0.1,N,0.2,K,D"])).expect_err("none");
    assert!(error.to_string().contains("no position (GGA)"), "{error}");
}

#[test]
fn the_geoid_counts_only_if_every_position_has_its_separation() {
    let without = gga("195002.00", 4).replace("-27.5", "");
    let track = read("rover.nmea", &log(&[&gga("195001.00", 4), &without])).expect("a log");
    for solution in track.solutions {
        let SolutionPosition::Geodetic(geodetic) = solution.position else { panic!() };
        assert!((geodetic.height_m - 95.2).abs() < 1e-9, "{}", geodetic.height_m);
    }
}
