use super::*;
use nalgebra::Vector3;
use proptest::prelude::*;

/// 2019/06/08 08:03:55.5 of GPS is week 2056, 547435.5 s; UTC is 18 s behind.
const STAMP_S: f64 = 1_559_981_017.5;

const DEGREES: &str = "\
% program   : RTKLIB ver.demo5 b31
% inp file  : rover_2019-06-08_08-03-52.obs
% obs start : 2019/06/08 08:03:55.5 GPST (week2056 547435.5s)
% ref pos   : 47.060027749  -1.350495019   84.8600
%
% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,3:sbas,4:dgps,5:single,6:ppp,ns=# of satellites)
%  GPST                  latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio
2019/06/08 08:03:55.500   47.060100000   -0.350500000    85.1234   1   9   0.0100   0.0100   0.0200   0.0010      nan   0.0010  -0.50    4.2
2019/06/08 08:03:55.700   47.060100000   -0.350500000    85.1234   2   9   0.0100   0.0100   0.0200   0.0010   0.0010   0.0010  -0.30    1.2
";

fn position_m() -> Vector3<f64> {
    Geodetic {
        latitude_rad: 47.0601_f64.to_radians(),
        longitude_rad: -0.3505_f64.to_radians(),
        height_m: 85.1234,
    }
    .to_ecef()
}

/// Reads a file of one line, below a header with these columns.
fn one(columns: &str, line: &str) -> Result<GnssFix, OpenError> {
    let text = format!("% program   : RTKLIB ver.2.4.2\r\n%  {columns}   Q  ns\r\n{line}\r\n");
    assert!(looks_like(&text), "{columns}");
    read("a.pos", &text).map(|(fixes, findings)| {
        assert_eq!((fixes.len(), findings), (1, vec![]));
        fixes[0]
    })
}

#[test]
fn a_file_of_rtkpost() {
    assert!(looks_like(DEGREES));
    let (fixes, findings) = read("a.pos", DEGREES).expect("well-formed");
    assert_eq!(findings, []);
    assert_eq!(fixes.iter().map(|fix| fix.quality).collect::<Vec<_>>(), [1, 2]);
    assert!((fixes[0].time_s - STAMP_S).abs() < 1e-6);
    assert!((fixes[1].time_s - fixes[0].time_s - 0.2).abs() < 1e-6);
    assert!((fixes[0].position_m - position_m()).norm() < 1e-6);
}

#[test]
fn coordinates_scales_and_separators_are_the_user_s_choice() {
    let degrees = "latitude(deg) longitude(deg)  height(m)";
    let p = position_m();
    let ecef = format!("x-ecef(m) {:.4} {:.4} {:.4}", p.x, p.y, p.z);
    let ecef = ecef.trim_start_matches("x-ecef(m) ");
    let cases = [
        // 47.0601° = 47° 3′ 36.36″; −0.3505° = −0° 21′ 1.8″.
        (
            "GPST  latitude(d'\")   longitude(d'\")  height(m)".to_owned(),
            "2019/06/08 08:03:55.500  47 03 36.36000   -0 21 01.80000    85.1234   1   9"
                .to_owned(),
        ),
        (
            "GPST      x-ecef(m)      y-ecef(m)      z-ecef(m)".to_owned(),
            format!("2056 547435.500 {ecef} 1 9"),
        ),
        (
            format!("UTC   {degrees}"),
            "2019/06/08 08:03:37.500 47.0601 -0.3505 85.1234 1 9".to_owned(),
        ),
        (format!("UTC   {degrees}"), "2056 547417.500 47.0601 -0.3505 85.1234 1 9".to_owned()),
        (
            format!("JST   {degrees}"),
            "2019/06/08 17:03:37.500 47.0601 -0.3505 85.1234 1 9".to_owned(),
        ),
    ];
    for (columns, line) in &cases {
        for separator in [" ", ",", "\t", ";", " , "] {
            let columns = columns.split_whitespace().collect::<Vec<_>>().join(separator);
            // A date and a time of day remain one column with a space in it.
            let line = line.split_whitespace().collect::<Vec<_>>().join(separator);
            let line = if line.contains('/') { line.replacen(separator, " ", 1) } else { line };
            let fix = one(&columns, &line).expect("well-formed");
            assert!((fix.time_s - STAMP_S).abs() < 1e-6, "{columns}\n{line}\n{fix:?}");
            let apart_m = (fix.position_m - position_m()).norm();
            assert!(apart_m < 1e-3, "{apart_m} m: {columns}\n{line}");
            assert_eq!(fix.quality, 1);
        }
    }
    let baseline = "GPST   e-baseline(m)  n-baseline(m)  u-baseline(m)";
    let fix = one(baseline, "2056 547435.500 -12.3456 7.8901 0.1234 2 9").expect("well-formed");
    assert_eq!((fix.position_m, fix.quality), (Vector3::new(-12.3456, 7.8901, 0.1234), 2));
}

#[test]
fn leap_seconds_come_at_midnight_of_utc() {
    // The last leap second so far: GPS was 17 s ahead, then 18 s.
    let midnight_s = 1_483_228_800.0;
    assert_eq!(unix_from_gpst_s(midnight_s + 16.0), midnight_s - 1.0);
    assert_eq!(unix_from_gpst_s(midnight_s + 18.0), midnight_s);
    assert_eq!(gpst_from_unix_s(midnight_s - 1.0), midnight_s + 16.0);
    assert_eq!(gpst_from_unix_s(midnight_s), midnight_s + 18.0);
    // The number of leap seconds in 2006, and none when GPS began.
    assert_eq!(gpst_from_unix_s(1_136_073_600.0) - 1_136_073_600.0, 14.0);
    assert_eq!(clock_s("0", "0").map(unix_from_gpst_s), Some(315_964_800.0));
}

#[test]
fn what_is_wrong_is_said_with_its_line() {
    let columns = "GPST latitude(deg) longitude(deg) height(m)";
    for (line, expected) in [
        ("2019/06/08 08:03:55.5 47.1 -0.3 85.1", "a.pos:3: 5 fields where the header asks for 7"),
        // A decimal comma.
        ("2019/06/08 08:03:55.5 47,1 -0,3 85,1 1 9", "10 fields"),
        ("2019/02/29 08:03:55.5 47.1 -0.3 85.1 1 9", "`2019/02/29 08:03:55.5` is not a time"),
        ("19/06/08 08:03:55.5 47.1 -0.3 85.1 1 9", "not a time"),
        ("2019/06/08 24:03:55.5 47.1 -0.3 85.1 1 9", "not a time"),
        ("2019/06/08 08:03 47.1 -0.3 85.1 1 9", "not a time"),
        ("2056 604800.0 47.1 -0.3 85.1 1 9", "not a time"),
        ("2056 nan 47.1 -0.3 85.1 1 9", "not a time"),
        ("2056 1.0 nan -0.3 85.1 1 9", "`nan` is not a number"),
        ("2056 1.0 47.1 -0.3 85.1x 1 9", "`85.1x` is not a number"),
        ("2056 1.0 47.1 -0.3 85.1 1.5 9", "1.5 in column `Q` is not a quality"),
        ("2056 1.0 47.1 -0.3 85.1 12 9", "12 in column `Q` is not a quality"),
        ("2056 1.0 97.1 -0.3 85.1 1 9", "latitude, longitude or height"),
        ("", "a.pos: has no GNSS fix"),
    ] {
        let error = one(columns, line).expect_err(line).to_string();
        assert!(error.contains(expected), "`{line}` gives: {error}");
    }
    let bare = read("a.pos", "2056 1.0 47.1 -0.3 85.1 1 9\n").expect_err("no header");
    assert!(bare.to_string().starts_with("a.pos:1: no `%` line"), "{bare}");
}

#[test]
fn stamps_are_put_in_order_and_duplicates_dropped() {
    let text = "% GPST e-baseline(m) n-baseline(m) u-baseline(m) Q\n\
        2056 2.0 2 0 0 1\n\
        2056 1.0 1 0 0 1\n\
        2056 2.0 9 0 0 1\n\
        2056 3.0 3 0 0 1\n";
    let (fixes, findings) = read("a.pos", text).expect("well-formed");
    assert_eq!(fixes.iter().map(|fix| fix.position_m.x).collect::<Vec<_>>(), [1.0, 2.0, 3.0]);
    assert!(fixes.windows(2).all(|w| w[0].time_s < w[1].time_s));
    let said = findings.iter().map(ToString::to_string).collect::<Vec<_>>();
    assert_eq!(
        said,
        [
            "1 out-of-order stamps in a.pos; the fixes were sorted by time",
            "1 duplicate stamps dropped (first at line 4 of a.pos)",
        ]
    );
}

#[test]
fn a_header_in_the_middle_counts_from_there() {
    let text = "% UTC x-ecef(m) y-ecef(m) z-ecef(m) Q\n2056 1.0 1 2 3 1\n\
        % a remark changes nothing\n2056 2.0 1 2 3 1\n\
        % GPST x-ecef(m) y-ecef(m) z-ecef(m) Q ns\n2056 30.0 1 2 3 1 9\n";
    let (fixes, _) = read("a.pos", text).expect("well-formed");
    assert_eq!(fixes[2].time_s - fixes[0].time_s, 11.0);
}

#[test]
fn other_files_do_not_look_like_it() {
    assert!(looks_like("\n% inp file  : rover.obs\n% inp fi"));
    assert!(looks_like("%  GPST , latitude(deg),longitude(deg), height(m),  Q\n"));
    for other in [
        "",
        "% a LaTeX file about GPST\n\\documentclass{article}\n",
        "timestamp,id,distance,ha,va\n1,1,2,3,1.5\n",
        "2019/06/08 08:03:55.500 47.06 -0.35 85.12 1 9\n",
        "a note\n% program   : RTKLIB\n",
    ] {
        assert!(!looks_like(other), "{other}");
    }
}

proptest! {
    #[test]
    fn what_is_written_is_read(
        // From before the start of GPS to 2099.
        stamps_ms in proptest::collection::btree_set(-1_000_000_000..4_100_000_000_000_i64, 1..20),
        latitude_rad in -1.57..1.57f64,
        longitude_rad in -3.1..3.1f64,
        height_m in -400.0..9000.0f64,
        quality in 0..=7u8,
    ) {
        let position_m = Geodetic { latitude_rad, longitude_rad, height_m }.to_ecef();
        let fixes: Vec<_> = stamps_ms
            .iter()
            .map(|ms| GnssFix { time_s: *ms as f64 / 1e3, position_m, quality })
            .collect();
        let text = write(&fixes);
        prop_assert!(looks_like(&text));
        let (back, findings) = read("a.pos", &text).expect("well-formed");
        prop_assert_eq!(findings, vec![]);
        prop_assert_eq!(back.len(), fixes.len());
        for (back, fix) in back.iter().zip(&fixes) {
            prop_assert!((back.time_s - fix.time_s).abs() < 1e-5);
            prop_assert!((back.position_m - fix.position_m).norm() < 1e-4);
            prop_assert_eq!(back.quality, fix.quality);
        }
    }

    #[test]
    fn no_text_panics(text in "[%0-9/:., \\-\nGPSTQxyz()aemnurc]{0,200}") {
        let _ = looks_like(&text);
        let _ = read("a.pos", &format!("% GPST x-ecef(m) y-ecef(m) z-ecef(m) Q\n{text}"));
    }
}

/// Standard deviations in each kind of coordinates, of one error: σ of 0.01 m east, 0.02 m north, 0.03 m up, and a covariance of east and north.
#[test]
fn standard_deviations_are_along_east_north_and_up() {
    let read = |names: &str, line: &str| {
        let text =
            format!("%  GPST {names} age(s) ratio\n2022/07/11 19:50:19.200 {line} 0.0 9.9\n");
        read_track("rover.pos", &text).expect("a solution").solutions.remove(0)
    };
    let degrees = read(
        "latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) sdun(m)",
        "0.0 90.0 95.0 1 9 0.0200 0.0100 0.0300 -0.0050 0.0000 0.0070",
    );
    let baseline = read(
        "e-baseline(m) n-baseline(m) u-baseline(m) Q ns sde(m) sdn(m) sdu(m) sden(m) sdnu(m) sdue(m)",
        "1.0 2.0 3.0 2 9 0.0100 0.0200 0.0300 -0.0050 0.0070 0.0000",
    );
    // At the equator and 90° of longitude, x is west, y up and z north.
    let ecef = read(
        "x-ecef(m) y-ecef(m) z-ecef(m) Q ns sdx(m) sdy(m) sdz(m) sdxy(m) sdyz(m) sdzx(m)",
        "0.0 6378232.0 0.0 5 9 0.0100 0.0300 0.0200 0.0000 0.0070 0.0050",
    );
    let expected = Matrix3::new(1e-4, -2.5e-5, 0.0, -2.5e-5, 4e-4, 4.9e-5, 0.0, 4.9e-5, 9e-4);
    for solution in [&degrees, &baseline, &ecef] {
        let covariance_m2 = solution.covariance_m2.expect("stated");
        assert!((covariance_m2 - expected).norm() < 1e-12, "{covariance_m2}");
        assert!((solution.time_s - 1_657_569_001.2).abs() < 1e-6);
    }
    let kinds = [degrees.kind, baseline.kind, ecef.kind];
    assert_eq!(kinds, [SolutionKind::Fixed, SolutionKind::Float, SolutionKind::Single]);
    let track = read_track("rover.pos", &DEGREES.replace("   2   9 ", "   0   9 ")).expect("one");
    assert_eq!((track.solutions.len(), track.without_fix), (1, 1));
    let covariance_m2 = track.solutions[0].covariance_m2.expect("a missing covariance is zero");
    assert_eq!(covariance_m2, Matrix3::from_diagonal(&Vector3::new(1e-4, 1e-4, 4e-4)));
}
