use super::*;
use nalgebra::Matrix3;

/// Writes a file with this text; the folder is removed when dropped.
fn file(name: &str, text: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, text).expect("written");
    (folder, path)
}

fn of(name: &str, text: &str) -> Result<EstimatedTrajectory, OpenError> {
    let (_folder, path) = file(name, text);
    only(&path)
}

/// Reads the only trajectory of a file.
fn only(path: &Path) -> Result<EstimatedTrajectory, OpenError> {
    let mut all = read(path)?;
    assert_eq!(all.len(), 1);
    Ok(all.remove(0))
}

#[test]
fn the_same_pose_is_read_from_every_format() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let texts = [
        (
            "a.tum",
            format!("# timestamp tx ty tz qx qy qz qw\n1657543210.25 1 2 3 0 0 {half} {half}\n"),
        ),
        (
            "b.csv",
            format!(
                "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n1657543210250000000,1,2,3,{half},0,0,{half}\n"
            ),
        ),
        ("c.csv", format!("1657543210250000000,1,2,3,{half},0,0,{half},0,0,0,0,0,0,0,0,0\n")),
        (
            "d.csv",
            format!(
                "timestamp_s,x_m,y_m,z_m,qx,qy,qz,qw,sigma_x_m\n1657543210.25,1,2,3,0,0,{half},{half},0.01\n"
            ),
        ),
        (
            "e.csv",
            format!(
                "Time;pose.position.x;pose.position.y;pose.position.z;pose.orientation.x;pose.orientation.y;pose.orientation.z;pose.orientation.w\n1657543210.25;1;2;3;0;0;{half};{half}\n"
            ),
        ),
    ];
    for (name, text) in texts {
        let estimate = of(name, &text).expect(name);
        let pose = estimate.poses[0];
        assert!((pose.time_s - 1_657_543_210.25).abs() < 1e-6, "{name}: {}", pose.time_s);
        assert_eq!(pose.position_m, Vector3::new(1.0, 2.0, 3.0), "{name}");
        let turned = pose.orientation.expect("turned") * Vector3::x();
        assert!((turned - Vector3::y()).norm() < 1e-12, "{name}: {turned}");
    }
    for header in ["point,time,Easting [m],Northing [m],Elevation [m]", "id;t;e;n;h"] {
        let separator = if header.contains(';') { ";" } else { "," };
        let row = ["P7", "0.5", "1", "2", "3"].join(separator);
        let surveyed = of("points.csv", &format!("{header}\n{row}\n")).expect(header);
        assert_eq!(surveyed.poses[0].position_m, Vector3::new(1.0, 2.0, 3.0), "{header}");
    }
    let positions = of("f.txt", "0.5 1 2 3\n0.6 1 2 4\n").expect("positions");
    assert_eq!((positions.poses.len(), positions.poses[1].orientation), (2, None));
}

#[test]
fn tables_of_a_plane_are_read_and_say_so() {
    for (text, position_m, turn_rad) in [
        ("time,x,y,theta\n1,2,3,0.5\n", [2.0, 3.0, 0.0], Some(0.5)),
        ("t,x,y,yaw_deg\n1,2,3,-90\n", [2.0, 3.0, 0.0], Some(-std::f64::consts::FRAC_PI_2)),
        ("timestamp,x,y\n1,2,3\n", [2.0, 3.0, 0.0], None),
        ("timestamp,north,east,down\n1,3,2,4\n", [2.0, 3.0, -4.0], None),
        ("timestamp,x,y,height\n1,2,3,4\n", [2.0, 3.0, 4.0], None),
    ] {
        let estimate = of("plane.csv", text).expect(text);
        let pose = &estimate.poses[0];
        assert_eq!(pose.position_m, Vector3::from(position_m), "{text}");
        let turn = pose.orientation.map(|orientation| orientation.euler_angles().2);
        match (turn, turn_rad) {
            (Some(turn), Some(turn_rad)) => assert!((turn - turn_rad).abs() < 1e-9, "{text}"),
            // One orientation of all poses is unknown.
            (turn, turn_rad) => assert_eq!(turn, turn_rad, "{text}"),
        }
        let said = messages(&estimate);
        assert_eq!(said.contains("in the plane z = 0"), position_m[2] == 0.0, "{text}: {said}");
    }
}

#[test]
fn numbers_with_decimal_commas_between_blanks_are_read() {
    let text = "0,5 1,25 -2,5 3,0\n0,6 1,25 -2,5 4,0\n";
    let estimate = of("commas.tum", text).expect("read");
    assert_eq!(estimate.poses[1].position_m, Vector3::new(1.25, -2.5, 4.0));
}

#[test]
fn kitti_takes_its_times_from_the_file_beside_it() {
    let (folder, path) = file("poses.txt", "0 -1 0 1 1 0 0 2 0 0 1 3\n1 0 0 4 0 1 0 5 0 0 1 6\n");
    let why = read(&path).expect_err("no times").to_string();
    assert!(why.contains("poses_times.txt or times.txt"), "{why}");
    std::fs::write(folder.path().join("times.txt"), "10.0\n10.1\n").expect("written");
    let estimate = only(&path).expect("with times");
    let turned = estimate.poses[0].orientation.expect("turned") * Vector3::x();
    assert!((turned - Vector3::y()).norm() < 1e-12);
    assert_eq!((estimate.poses[1].time_s, estimate.poses[1].position_m.z), (10.1, 6.0));
    std::fs::write(folder.path().join("times.txt"), "10.0\n").expect("written");
    let why = read(&path).expect_err("a time is missing").to_string();
    assert!(why.contains("1 times for 2 poses"), "{why}");
}

#[test]
fn what_is_wrong_is_said_with_its_line_and_nothing_is_dropped_in_silence() {
    for (text, said) in [
        (
            "1 0 0 0 0 0 0 1\n2 0 x 0 0 0 0 1\n3 0 y 0 0 0 0 1\n",
            ":2: `x` is not a number; 2 rows of 3",
        ),
        ("1 0 0 0 0 0 0 0\n", ":1: the quaternion is zero"),
        ("1 0 nan 0 0 0 0 1\n", ":1: `nan` is not a number"),
        ("a,b,c\n1,2,3\n", ":1: the header `a,b,c` has no columns of poses"),
        ("# nothing\n", "no pose in this file"),
        ("1 2 3\n", ":1: 3 fields without a header do not form a pose"),
        ("1,2,3,4,0,0,0.1,0,0,0,1\n", ":1: 11 fields without a header"),
        ("1,2,3,4,0,0,0.1,0,0,0,1,0,0\n", ":1: 13 fields without a header"),
        ("1657543210250000000,1,2,3,0.5,0.1,0.2,0.3\n", "no unit quaternions"),
        ("t,x,y,z\n0,1,2,3,4\n", "a column of row numbers has no name"),
        ("t,x,y,z\n0,1,1,2,2,3,3,4\n", "numbers with decimal commas look like two"),
        (
            "1 0 0 0.6 0.8 5 6 7\n2 0 0 0.6 0.8 5 6 8\n",
            "orientation seems to come before the position",
        ),
        (
            "5 6 7 0 0 0.6 0.8 1\n4 6 7 0 0 0.6 0.8 2\n5 6 7 0 0 0.6 0.8 3\n",
            "time seems to come last",
        ),
        (
            "t,x,y,z,roll_rad,pitch_rad,yaw_rad\n1,0,0,0,0,0,179\n2,0,0,0,0,0,-179\n",
            "the angles are degrees",
        ),
        ("t,x,y,z,roll_rad,pitch_rad,yaw_rad\n1,0,0,0,0,9,20\n", "the angles are degrees"),
        (
            "t,x,y,z,roll_deg,pitch_deg,yaw_deg\n1,0,0,0,0,0,3.1\n2,0,0,0,0,0,-3.1\n",
            "the angles are radians",
        ),
    ] {
        let why = of("a.txt", text).expect_err(text).to_string();
        assert!(why.contains(said), "{why}");
    }
    let estimate =
        of("a.txt", "2 0 0 0 0 0 0 2\n1 0 0 0 0 0 0 1\n1 5 0 0 0 0 0 1\n").expect("read");
    let said: Vec<String> = estimate.findings.iter().map(ToString::to_string).collect();
    assert_eq!(estimate.poses.len(), 2);
    for (finding, part) in said.iter().zip(["unit length", "not in time order", "repeat a time"]) {
        assert!(finding.contains(part), "{finding}");
    }
    assert_eq!(said.len(), 3);
}

/// Poses of an estimate in the tables of other tools: the same as in TUM.
#[test]
fn tables_of_other_tools_are_read() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let echo = "%time,field.header.seq,field.header.stamp,field.pose.pose.position.x,field.pose.pose.position.y,\
                field.pose.pose.position.z,field.pose.pose.orientation.x,field.pose.pose.orientation.y,\
                field.pose.pose.orientation.z,field.pose.pose.orientation.w";
    let texts = [
        (
            "w first",
            format!("# timestamp tx ty tz qw qx qy qz\n1657543210.25 1 2 3 {half} 0 0 {half}\n"),
        ),
        (
            "rostopic echo -p",
            format!("{echo}\n1657543210999000000,7,1657543210250000000,1,2,3,0,0,{half},{half}\n"),
        ),
        ("ros2 topic echo --csv", format!("1657543210,250000000,map,1,2,3,0,0,{half},{half}\n")),
        (
            "of odometry",
            format!("1657543210,250000000,odom,base_link,1,2,3,0,0,{half},{half},0,0,0\n"),
        ),
        (
            "milliseconds",
            format!("1657543210250 1 2 3 0 0 {half} {half}\n1657543210350 1 2 3 0 0 0 1\n"),
        ),
        (
            "microseconds",
            format!("t,px,py,pz,qx,qy,qz,qw\n1657543210250000,1,2,3,0,0,{half},{half}\n"),
        ),
        ("trailing commas", format!("1657543210.25,1,2,3,0,0,{half},{half},\n")),
        (
            "index without a name",
            format!(",timestamp,x,y,z,qx,qy,qz,qw\n0,1657543210.25,1,2,3,0,0,{half},{half}\n"),
        ),
        ("num", format!("num,t,x,y,z,qx,qy,qz,qw\n0,1657543210.25,1,2,3,0,0,{half},{half}\n")),
        (
            "sec,nsec",
            format!("#sec,nsec,x,y,z,qx,qy,qz,qw\n1657543210,250000000,1,2,3,0,0,{half},{half}\n"),
        ),
        (
            "a date",
            format!("time,x,y,z,qx,qy,qz,qw\n2022-07-11T12:40:10.25Z,1,2,3,0,0,{half},{half}\n"),
        ),
        (
            "decimal commas",
            "time;x;y;z;qx;qy;qz;qw\n1657543210,25;1;2;3;0;0;0,7071068;0,7071068\n".to_owned(),
        ),
        (
            "more names than columns",
            format!("t,px,py,pz,qx,qy,qz,qw,vx,vx\n1657543210.25,1,2,3,0,0,{half},{half}\n"),
        ),
    ];
    for (name, text) in texts {
        let estimate = of("a.csv", &text).unwrap_or_else(|error| panic!("{name}: {error}"));
        let pose = estimate.poses[0];
        assert!((pose.time_s - 1_657_543_210.25).abs() < 1e-6, "{name}: {}", pose.time_s);
        assert_eq!(pose.position_m, Vector3::new(1.0, 2.0, 3.0), "{name}");
        let turned = pose.orientation.expect("turned") * Vector3::x();
        assert!((turned - Vector3::y()).norm() < 1e-7, "{name}: {turned}");
    }
}

#[test]
fn small_stamps_are_seconds_unless_poses_are_impossibly_far_apart() {
    let time_s = |text: &str| of("a.txt", text).expect("read").poses[1].time_s;
    assert_eq!(time_s("764.03 0 0 0 0 0 0 1\n764.13 1 0 0 0 0 0 1\n"), 764.13);
    // A stop every five minutes.
    assert_eq!(time_s("1630486029.98 0 0 0\n1630486329.5 1 0 0\n"), 1_630_486_329.5);
    // Nanoseconds since the start of a computer.
    assert_eq!(time_s("764030000000 0 0 0\n764130000000 1 0 0\n"), 764.13);
    // A wrong unit in the header.
    assert_eq!(
        time_s("timestamp_s,x,y,z\n1630486029000,0,0,0\n1630486029100,1,0,0\n"),
        1_630_486_029.1
    );
}

#[test]
fn rows_without_a_pose_are_counted() {
    let text =
        "1 0 0 0 0 0 0 1\n2 nan nan nan nan nan nan nan\n3 0 0 0 0 0 0 1\n4 0 0 0 0 0 0 1\n5 0 0";
    let estimate = of("a.txt", text).expect("read");
    assert_eq!(estimate.poses.len(), 3);
    let [finding] = &estimate.findings[..] else { panic!("{:?}", estimate.findings) };
    assert!(
        finding
            .to_string()
            .contains("2 rows are not valid and skipped (line 2: `nan` is not a number)"),
        "{finding}"
    );
}

/// Time (Unix, s), latitude and longitude (degrees), height above the ellipsoid (m) and σ (m) of fixes; the second is float.
const FIXES: [(f64, [f64; 3], f64); 3] = [
    (1_657_569_001.2, [46.78, -71.275, 67.7], 0.01),
    (1_657_569_001.4, [46.780_01, -71.275, 67.8], 0.3),
    (1_657_569_001.6, [46.780_02, -71.274_99, 67.9], 0.01),
];

/// The fixes in each format of a GNSS receiver, with the names of the files.
fn gnss_files() -> Vec<(&'static str, Vec<u8>)> {
    let mut pos = String::from(
        "%  GPST latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m) sdne(m) sdeu(m) sdun(m) age(s) ratio\n",
    );
    let mut csv = String::from("timestamp,lat,lon,alt,sde,sdn,sdu,Solution status\n");
    let mut nmea = String::new();
    for (index, (time_s, [latitude, longitude, height], sigma)) in FIXES.into_iter().enumerate() {
        let is_fixed = index != 1;
        pos += &format!(
            "2022/07/11 19:50:{:.3} {latitude:.9} {longitude:.9} {height:.4} {} 9 {sigma} {sigma} {sigma} 0 0 0 0 9\n",
            time_s - 1_657_568_982.0,
            if is_fixed { 1 } else { 2 },
        );
        let word = if is_fixed { "FIX" } else { "FLOAT" };
        csv += &format!(
            "{time_s:.3},{latitude:.9},{longitude:.9},{height},{sigma},{sigma},{sigma},{word}\n"
        );
        let minutes = |degrees: f64| 100.0 * degrees.trunc() + 60.0 * degrees.fract();
        let time = format!("19500{:.2}", time_s - 1_657_569_000.0);
        for content in [
            format!(
                "GNGGA,{time},{:.8},N,0{:.8},W,{},12,0.6,{:.4},M,-27.5,M,1,1",
                minutes(latitude),
                minutes(-longitude),
                if is_fixed { 4 } else { 5 },
                height + 27.5,
            ),
            format!("GNGST,{time},1,,,,{sigma},{sigma},{sigma}"),
            format!("GNRMC,{time},A,,,,,,,110722,,,R"),
        ] {
            let sum = content.bytes().fold(0, |sum, byte| sum ^ byte);
            nmea += &format!("${content}*{sum:02X}\r\n");
        }
    }
    vec![
        ("rover.pos", pos.into_bytes()),
        ("rover.csv", csv.into_bytes()),
        ("rover.nmea", nmea.into_bytes()),
    ]
}

/// An MCAP bag with the fixes as `NavSatFix`, whose status does not distinguish fixed from float.
fn gnss_bag() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let options = mcap::WriteOptions::new().compression(None);
    let mut writer = options.create(&mut bytes).expect("a bag");
    let schema = writer.add_schema("sensor_msgs/msg/NavSatFix", "ros2msg", b"").expect("a schema");
    let channel_id =
        writer.add_channel(schema, "/gps/fix", "cdr", &Default::default()).expect("a topic");
    for (sequence, (time_s, degrees_and_height, sigma)) in (0..).zip(FIXES) {
        let mut message = vec![0, 1, 0, 0];
        let nanoseconds = (time_s.fract() * 1e9).round() as u32;
        for word in [time_s as u32, nanoseconds, 4] {
            message.extend(word.to_le_bytes());
        }
        // The frame, status 2 of GBAS, padding, and GPS with GLONASS.
        message.extend(b"gps\0\x02\0\x03\0\0\0\0\0");
        for number in degrees_and_height {
            message.extend(number.to_le_bytes());
        }
        let variance = sigma * sigma;
        for number in [variance, 0.0, 0.0, 0.0, variance, 0.0, 0.0, 0.0, variance] {
            message.extend(number.to_le_bytes());
        }
        message.push(2);
        let log_time = (time_s * 1e9) as u64;
        let header =
            mcap::records::MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        writer.write_to_known_channel(&header, &message).expect("written");
    }
    writer.finish().expect("written");
    drop(writer);
    bytes.into_inner()
}

#[test]
fn a_receiver_is_read_alike_from_every_format() {
    let folder = tempfile::tempdir().expect("a folder");
    let north_m = 1.1117;
    for (name, bytes) in gnss_files().into_iter().chain([("rover.mcap", gnss_bag())]) {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("written");
        // An estimate has all solutions, with their errors.
        let estimate = only(&path).expect(name);
        assert_eq!((estimate.poses.len(), estimate.covariances.len()), (3, 3), "{name}");
        for (pose, (time_s, _, sigma)) in estimate.poses.iter().zip(FIXES) {
            assert!((pose.time_s - time_s).abs() < 1e-6, "{name}: {}", pose.time_s);
            let index = estimate.poses.iter().position(|other| other == pose).expect("itself");
            let variance = estimate.covariances[index].position_m2[(2, 2)];
            assert!((variance - sigma * sigma).abs() < 1e-9, "{name}: {variance}");
        }
        let second_m = estimate.poses[1].position_m;
        assert!((second_m - Vector3::new(0.0, north_m, 0.1)).norm() < 1e-3, "{name}: {second_m}");
        let is_bag = name == "rover.mcap";
        let truth = |solutions| read_truth(&path, None, solutions).expect(name).poses.len();
        assert_eq!(truth(SolutionChoice::Best), if is_bag { 3 } else { 2 }, "{name}");
        assert_eq!(truth(SolutionChoice::Float), 3, "{name}");
    }
}

/// Messages of a trajectory's findings.
fn messages(estimate: &EstimatedTrajectory) -> String {
    estimate.findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

#[test]
fn orientations_are_read_by_the_names_of_their_columns() {
    let turn = UnitQuaternion::from_euler_angles(0.1, -0.2, 2.5);
    let [roll, pitch, yaw] = [0.1, -0.2, 2.5];
    let [droll, dpitch, dyaw] = [0.1_f64, -0.2, 2.5].map(f64::to_degrees);
    let (x, y, z, w) = (turn.i, turn.j, turn.k, turn.w);
    for (header, row, said) in [
        ("t,x,y,z,roll,pitch,yaw", format!("1,2,3,{roll},{pitch},{yaw}"), "read as radians"),
        ("t,x,y,z,roll,pitch,yaw", format!("1,2,3,{droll},{dpitch},{dyaw}"), "read as degrees"),
        ("t,x,y,z,roll [deg],pitch [deg],yaw [deg]", format!("1,2,3,{droll},{dpitch},{dyaw}"), ""),
        ("t,x,y,z,roll_rad,pitch_rad,yaw_rad", format!("1,2,3,{roll},{pitch},{yaw}"), ""),
        ("t,x,y,z,Yaw(°),Roll(°),Pitch(°)", format!("1,2,3,{dyaw},{droll},{dpitch}"), ""),
        ("t,x,y,z,q0,q1,q2,q3", format!("1,2,3,{w},{x},{y},{z}"), "q0 is read as w"),
        (
            "t,x,y,z,quat_0,quat_1,quat_2,quat_3",
            format!("1,2,3,{w},{x},{y},{z}"),
            "q0 is read as w",
        ),
        ("t,x,y,z,qw,qx,qy,qz", format!("1,2,3,{w},{x},{y},{z}"), ""),
        ("t,tx,ty,tz,w,x,y,z", format!("1,2,3,{w},{x},{y},{z}"), ""),
        ("t,x,y,z,x,y,z,w", format!("1,2,3,{x},{y},{z},{w}"), ""),
    ] {
        let estimate = of("a.csv", &format!("{header}\n1,{row}\n2,{row}\n")).expect(header);
        let pose = &estimate.poses[0];
        assert_eq!(pose.position_m, Vector3::new(1.0, 2.0, 3.0), "{header}");
        assert!(pose.orientation.expect(header).angle_to(&turn) < 1e-9, "{header}");
        let messages = messages(&estimate);
        assert_eq!(messages.is_empty(), said.is_empty(), "{header}: {messages}");
        assert!(messages.contains(said), "{header}: {messages}");
    }
}

#[test]
fn stated_units_are_obeyed_or_refused() {
    let header = "t,x [mm],y_cm,z (m),sigma_x [mm],sigma_y [cm],sigma_z";
    let estimate = of("a.csv", &format!("{header}\n1,1000,200,3,5,0.5,0.005\n")).expect(header);
    assert!((estimate.poses[0].position_m - Vector3::new(1.0, 2.0, 3.0)).norm() < 1e-12);
    let covariance_m2 = estimate.covariances[0].position_m2;
    assert!((covariance_m2 - 25e-6 * Matrix3::<f64>::identity()).norm() < 1e-12, "{covariance_m2}");
    let header =
        "t,x,y,z,qx,qy,qz,qw,sigma_x,sigma_y,sigma_z,sigma_rx [deg],sigma_ry [deg],sigma_rz [deg]";
    let estimate = of("a.csv", &format!("{header}\n1,1,2,3,0,0,0,1,1,1,1,1,1,1\n")).expect(header);
    let rotation_rad2 = estimate.covariances[0].rotation_rad2.expect("stated");
    assert!((rotation_rad2.trace() - 3.0 * 1_f64.to_radians().powi(2)).abs() < 1e-12);
    let header = "t,x,y,z,cov_xx [mm^2],cov_xy [mm^2],cov_xz [mm^2],cov_yy [mm^2],cov_yz [mm^2],cov_zz [mm^2]";
    let estimate = of("a.csv", &format!("{header}\n1,1,2,3,4,0,0,4,0,4\n")).expect(header);
    assert!((estimate.covariances[0].position_m2.trace() - 12e-6).abs() < 1e-12);
    for header in [
        "t,x [furlong],y,z",
        "t,x [deg],y,z",
        "time [min],x,y,z",
        "t,x,y,z,roll [m],pitch,yaw",
        "t,x,y,z,roll_deg,pitch_deg,yaw_rad",
        "t,x,y,z,sigma_x [parsec],sigma_y,sigma_z",
    ] {
        let columns = header.split(',').count();
        let row = vec!["1"; columns].join(",");
        let why = of("a.csv", &format!("{header}\n{row}\n")).expect_err(header).to_string();
        assert!(why.contains(":1: ") && why.contains("unit"), "{header}: {why}");
    }
}

#[test]
fn columns_of_an_orientation_that_are_not_read_are_named() {
    for (columns, named) in [
        ("yaw", "column yaw is not read"),
        ("qx,qy,qz", "columns qx, qy, qz are not read"),
        ("q1,q2,q3,q4", "columns q1, q2, q3, q4 are not read"),
        ("heading", "column heading is not read"),
        ("sigma_x,sigma_y", "columns sigma_x, sigma_y are not read"),
    ] {
        let row = vec!["1"; 4 + columns.split(',').count()].join(",");
        let estimate = of("a.csv", &format!("t,x,y,z,{columns}\n{row}\n")).expect(columns);
        let messages = messages(&estimate);
        assert!(messages.contains(named), "{columns}: {messages}");
        assert!(estimate.poses[0].orientation.is_none());
    }
    for columns in ["vx,vy,vz", "yaw_rate", "quality,satellites", "qx,qy,qz,qw,roll,pitch,yaw"] {
        let row = vec!["1"; 4 + columns.split(',').count()].join(",");
        let messages =
            messages(&of("a.csv", &format!("t,x,y,z,{columns}\n{row}\n")).expect(columns));
        assert!(!messages.contains("not read"), "{columns}: {messages}");
    }
}
