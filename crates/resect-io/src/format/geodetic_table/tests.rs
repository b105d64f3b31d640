use super::*;

fn track(text: &str) -> GnssTrack {
    assert!(looks_like(text), "{text}");
    read("rover.csv", text).expect("a table")
}

/// Latitude, longitude (degrees) and height (m) of the first solution.
fn first(track: &GnssTrack) -> [f64; 3] {
    let SolutionPosition::Geodetic(geodetic) = track.solutions[0].position else { panic!() };
    [geodetic.latitude_rad.to_degrees(), geodetic.longitude_rad.to_degrees(), geodetic.height_m]
}

fn said(track: &GnssTrack) -> String {
    track.findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

#[test]
fn the_same_position_is_read_under_every_name_and_unit() {
    let texts = [
        "timestamp,latitude,longitude,altitude\n1657569001.2,46.78,-71.275,95.25\n",
        "time;lat_deg;lon_deg;height_m\n1657569001.2;46.78;-71.275;95.25\n",
        "# stamp lat lon ellipsoidal_height\n1657569001.2 46.78 -71.275 95.25\n",
        "Time [ms]\tLatitude (degrees)\tLongitude (degrees)\tAlt (mm)\n1657569001200\t46.78\t-71.275\t95250\n",
        "t,lat [rad],lon [rad],h\n1657569001.2,0.8164650240829474,-1.2439834243589585,95.25\n",
        "timestamp,lat_e7,lng_e7,antenna_height,hgt_mm\n1657569001.2,467800000,-712750000,1.8,95250\n",
        "date,time,gps/fix/latitude,gps/fix/longitude,gps/fix/altitude\n2022-07-11,19:50:01.2,46.78,-71.275,95.25\n",
        "gps_week,gps_tow,latitude,longitude,height\n2218,157819.2,46.78,-71.275,95.25\n",
        "GPST,latitude(deg),longitude(deg),height(m)\n2022/07/11 19:50:19.2,46.78,-71.275,95.25\n",
        "%time,field.header.stamp,field.status.status,field.latitude,field.longitude,field.altitude\n\
         1657569009200000000,1657569001200000000,2,46.78,-71.275,95.25\n",
    ];
    for text in texts {
        let track = track(text);
        assert!((track.solutions[0].time_s - 1_657_569_001.2).abs() < 1e-6, "{text}");
        let [latitude, longitude, height] = first(&track);
        let apart = (latitude - 46.78).abs() + (longitude + 71.275).abs() + (height - 95.25).abs();
        assert!(apart < 1e-8, "{text}: {latitude} {longitude} {height}");
        assert!(track.findings.is_empty(), "{text}: {}", said(&track));
    }
}

#[test]
fn standard_deviations_and_covariances_are_read_in_their_units() {
    for (columns, values) in [
        ("sde,sdn,sdu", "0.01,0.02,0.03"),
        ("sigma_lon [mm],sigma_lat [mm],sigma_alt [mm]", "10,20,30"),
        ("Easting RMS,Northing RMS,Elevation RMS", "0.01,0.02,0.03"),
    ] {
        let text = format!("timestamp,lat,lon,alt,{columns}\n1,46.78,-71.275,95,{values}\n");
        let sigma_m = track(&text).solutions[0].covariance_m2.expect(columns).diagonal();
        let sigma_m = sigma_m.map(f64::sqrt);
        assert!((sigma_m - nalgebra::Vector3::new(0.01, 0.02, 0.03)).norm() < 1e-12, "{sigma_m}");
    }
    let names: String = (0..9).map(|index| format!(",field.position_covariance{index}")).collect();
    let message = |covariance_type: u8| {
        let head = "%time,field.latitude,field.longitude,field.altitude";
        format!(
            "{head}{names},field.position_covariance_type\n1,46.78,-71.275,95,1e-4,1e-5,0,1e-5,1e-4,0,0,0,4e-4,{covariance_type}\n"
        )
    };
    assert_eq!(track(&message(3)).solutions[0].covariance_m2.expect("known")[(0, 1)], 1e-5);
    let approximated = track(&message(1));
    assert_eq!(approximated.solutions[0].covariance_m2, None);
    assert!(said(&approximated).contains("dilution of precision"));
}

#[test]
fn words_of_receivers_are_kinds_and_numbers_are_not_guessed() {
    let rows = ["FIX", "FLOAT", "SINGLE", "NARROW_INT", "3D Fix", "DGPS", "no fix", "?"];
    let rows: String =
        rows.iter().enumerate().map(|(t, word)| format!("{t},46.78,-71.275,95,{word}\n")).collect();
    let words = track(&format!("timestamp,lat,lon,alt,Solution status\n{rows}"));
    let kinds: Vec<_> = words.solutions.iter().map(|solution| solution.kind).collect();
    use SolutionKind::{Differential, Fixed, Float, Single, Unstated};
    assert_eq!(kinds, [Fixed, Float, Single, Fixed, Single, Differential, Unstated]);
    assert_eq!(words.without_fix, 1);
    let numbers = track("timestamp,lat,lon,alt,quality,heading\n1,46.78,-71.275,95,4,0.1\n");
    assert_eq!(numbers.solutions[0].kind, Unstated);
    let said = said(&numbers);
    assert!(said.contains("`quality` is not read: the numbers of qualities differ"), "{said}");
    assert!(said.contains("`heading` is not read"), "{said}");
}

#[test]
fn what_is_missing_or_not_on_earth_is_said_with_its_line() {
    for (text, why) in [
        ("timestamp,lat,lon\n1,46.78,-71.275\n", "rover.csv:1: the header has no column height"),
        ("lat,lon,alt\n46.78,-71.275,95\n", "the header has no column of times"),
        (
            "t,lat [arcmin],lon [arcmin],alt\n1,46.78,-71.275,95\n",
            "the unit of column `lat [arcmin]` is not one of",
        ),
        (
            "t,lat,lon,alt\n1,467800000,-712750000,95\n",
            "not on the Earth in the units of the header",
        ),
        (
            "gps_time,lat,lon,alt\n1341604219,46.78,-71.275,95\n",
            "`1341604219` is not a date and time",
        ),
    ] {
        let error = read("rover.csv", text).expect_err(why).to_string();
        assert!(error.contains(why), "{error}");
    }
    let rows = "1,46.78,-71.275,95\n2,,,\n3,x,-71.275,95\n4,46.78,-71.275,95\n";
    let some = track(&format!("t,lat,lon,alt\n{rows}"));
    assert_eq!((some.solutions.len(), some.without_fix), (2, 1));
    assert!(said(&some).contains("line 4: `x` is not a number"), "{}", said(&some));
    // Positions in metres are a table of poses.
    assert!(!looks_like("timestamp,x,y,z,latitude,longitude\n"));
}
