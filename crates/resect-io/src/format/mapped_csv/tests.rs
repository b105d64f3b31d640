use super::*;
use resect_core::deployment::{TableAngle, TableLength, TimeFormat};

/// One reading, 12.5 m away at azimuth 1 rad and zenith angle 1.6 rad, in formats of other programs.
const TABLES: [&str; 8] = [
    "time_s,station,slope_distance,azimuth,zenith\n1657569001.5,2,12.5,1.0,1.6\n",
    "Stamp;RTS;Range [mm];Hz;V\n1657569001500;2;12500,0;63,661977236758;101,859163578813\n",
    "date\tinstrument\tdist\tbearing\televation angle\n2022-07-11T19:50:01.5Z\tS2\t12.5\t57.29577951308232\t-1.6732472\n",
    "timestamp,id,distance_ft,h_angle,v_angle\n1657569001.5,2,41.01049868766404,57°17'44.8062\",91°40'23.6899\"\n",
    "status|t|id|x|y|z\n0|1657569001.5|2|6.75089903|-10.51390230|-0.36499403\n",
    "\u{feff}\"timestamp\",\"id\",\"range\",\"ha\",\"va\"\r\n\"1657569001.5\",\"2\",\"12.5\",\"1.0\",\"1.6\"\r\n",
    "Zeit;Standpunkt;Schrägstrecke (m);Richtung [gon];Zenit [gon];Bemerkung\n1657569001,5;2;12,5;63,661977236758;101,859163578813;x\n",
    "Time (s);Station;Dist_m;Hz_deg;V_deg\n1657569001.5;2;12.5;57.29577951308232;91.6732472209\n",
];

#[test]
fn what_is_suggested_reads_the_same_reading_from_every_table() {
    for text in TABLES {
        let mapping = suggest(text);
        let preview = preview(text, &mapping);
        let record =
            preview.read[0].as_ref().unwrap_or_else(|what| panic!("{text}\n{mapping:?}\n{what}"));
        let m = record.measurement;
        assert_eq!((record.station, record.status, record.place), (2, 0, 2), "{text}");
        let off =
            [m.time_s - 1657569001.5, m.range_m - 12.5, m.azimuth_rad - 1.0, m.zenith_rad - 1.6];
        assert!(off.iter().all(|off| off.abs() < 1e-6), "{text}\n{mapping:?}\n{off:?}");
        assert!(looks_like(text), "{text}");
        let mut recording = Recording::new(None, false);
        let progress = Progress::default();
        read("x", text.as_bytes(), &mapping, None, &progress, &mut recording).expect(text);
        assert_eq!(progress.done(), text.trim_start_matches('\u{feff}').len() as u64);
        assert_eq!(recording.ranges_include_prism_constant, mapping.x.is_some());
        let (tracks, _) = recording.finish("x").expect("readings");
        assert_eq!(tracks[1].measurements.len(), 1);
    }
}

#[test]
fn what_is_suggested_says_the_units() {
    let [_, gon, calendar, dms, xyz, _, german, _] = TABLES.map(suggest);
    assert_eq!(
        (gon.time_format, gon.length_unit),
        (TimeFormat::Milliseconds, TableLength::Millimetres)
    );
    assert_eq!((gon.angle_unit, calendar.time_format), (TableAngle::Gon, TimeFormat::Calendar));
    assert_eq!(calendar.vertical_angle, VerticalAngle::Elevation);
    assert_eq!(
        (dms.angle_unit, dms.length_unit),
        (TableAngle::DegreesMinutesSeconds, TableLength::Feet)
    );
    assert_eq!((german.angle_unit, german.length_unit), (TableAngle::Gon, TableLength::Metres));
    // A steep downward sight; the numbers alone could be gon.
    let down = suggest("t,id,sd,hz_deg,v_deg\n1,2,12.5,57.0,96.5\n");
    assert_eq!(down.angle_unit, TableAngle::Degrees);
    assert_eq!((xyz.status.as_deref(), xyz.range), (Some("status"), None));
}

#[test]
fn naming_a_column_suggests_its_unit_and_leaves_the_others_as_they_are() {
    let text = "a;b [mm];c;d\n1657569001,5;12500;63,66;101,86\n";
    let before =
        ColumnMapping { time: "a".into(), time_format: TimeFormat::TimeOfDay, ..suggest("") };
    let mut mapping = ColumnMapping { azimuth: Some("c".into()), ..before.clone() };
    mapping.vertical = Some("d".into());
    suggest_meanings(text, &before, &mut mapping);
    assert_eq!(mapping.angle_unit, TableAngle::Gon);
    let units = (mapping.time_format, mapping.length_unit);
    assert_eq!(units, (TimeFormat::TimeOfDay, TableLength::Metres));
    let before = mapping.clone();
    mapping.range = Some("b [mm]".into());
    suggest_meanings(text, &before, &mut mapping);
    assert_eq!(mapping.length_unit, TableLength::Millimetres);
}

#[test]
fn a_preview_shows_angles_in_the_wrong_unit() {
    let mapping = ColumnMapping { angle_unit: TableAngle::Radians, ..suggest(TABLES[6]) };
    let said = preview(TABLES[6], &mapping).read[0].clone().expect_err("5000 degrees");
    assert!(said.contains("more than a turn"), "{said}");
}

fn polar() -> ColumnMapping {
    suggest(TABLES[0])
}

#[test]
fn a_preview_says_what_is_wrong_with_each_row() {
    let text = "time_s,station,slope_distance,azimuth,zenith\n1,1,2,3,4\n1,x,2,3,4\n1,2,3\n1,2,,3,4\n1,2,3";
    let cut = text.to_owned() + &" ".repeat(2000);
    let preview = preview(&cut, &polar());
    assert_eq!(preview.header.len(), 5);
    // The last line is cut off.
    assert_eq!(preview.rows.len(), 4);
    assert!(preview.read[0].is_ok());
    let what = |row: usize| preview.read[row].clone().expect_err("wrong");
    assert!(what(1).contains("`x` in column `station`"), "{}", what(1));
    assert!(what(2).contains("3 fields where the header has 5"), "{}", what(2));
    assert!(preview.read[3].as_ref().expect("no reading").measurement.range_m.is_nan());
    let unknown = ColumnMapping { range: Some("length".into()), ..polar() };
    let said = super::preview(text, &unknown).read[0].clone().expect_err("no such column");
    assert!(said.contains("no column `length`"), "{said}");
    assert!(super::preview("", &unknown).rows.is_empty());
}

#[test]
fn errors_name_file_line_and_remedy() {
    let mapping = polar();
    let header = "time_s,station,slope_distance,azimuth,zenith\n";
    let cartesian = ColumnMapping { x: Some("zenith".into()), ..polar() };
    let no_station = ColumnMapping { station: None, ..polar() };
    for (mapping, rows, expected) in [
        (&mapping, "", "x.csv: has a header but no measurement"),
        (&mapping, "1,1,two,3,4\n", "x.csv:2: `two` in column `slope_distance` is not a number"),
        (&mapping, "1,1,2,3\n", "x.csv:2: 4 fields where the header has 5"),
        (&mapping, ",1,2,3,4\n", "x.csv:2: `` in column `time_s` is not a time"),
        (&cartesian, "1,1,2,3,4\n", "x.csv:1: give the columns of range, azimuth and vertical"),
        (&no_station, "1,1,2,3,4\n", "x.csv:2: no station column"),
        (&ColumnMapping::default(), "1,1,2,3,4\n", "x.csv:1: no time column"),
    ] {
        let text = header.to_owned() + rows;
        let progress = Progress::default();
        let read = read(
            "x.csv",
            text.as_bytes(),
            mapping,
            None,
            &progress,
            &mut Recording::new(None, false),
        );
        let error = read.expect_err(expected).to_string();
        assert!(error.contains(expected), "expected `{expected}`, got `{error}`");
        assert!(error.contains("; "), "no remedy in `{error}`");
    }
}

#[test]
fn only_a_header_of_names_above_numbers_looks_like_a_table() {
    for text in [
        "it rained, and rained, and rained, and rained\nand stopped, at, last, so\n",
        "1657 1.0 2.0 3.0\n",
        "a,b,c\n1,2,3\n",
        "a,b,c,d\n",
        "a,b,c,d\n1,2,3\n",
        "1,2,3,4\n1,2,3,4\n",
        "name = \"x\"\n",
        "",
    ] {
        assert!(!looks_like(text), "{text}");
    }
}
