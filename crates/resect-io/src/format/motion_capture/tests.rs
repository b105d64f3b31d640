use super::*;

const MOTIVE: &str = "\
Format Version,1.23,Take Name,Take 1,Capture Start Time,2022-07-11 03.50.01.135 PM,Rotation Type,Quaternion,Length Units,Millimeters
\n\
,Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body Marker,Rigid Body Marker,Rigid Body Marker
,Name,Robot,Robot,Robot,Robot,Robot,Robot,Robot,Robot,Robot:Marker1,Robot:Marker1,Robot:Marker1
,ID,1,1,1,1,1,1,1,1,2,2,2
,,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error,Position,Position,Position
Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,,X,Y,Z
0,0.000000,0.0,0.0,0.6,0.8,1000.0,2000.0,3000.0,0.1,1,2,3
1,0.008333,,,,,,,,,,,
2,0.016667,0.0,0.0,0.6,0.8,1001.0,2000.0,3000.0,0.1,1,2,3
";

const NEXUS: &str = "\
Trajectories
100
,,Robot:Front,,,Robot:Back,,
Frame,Sub Frame,X,Y,Z,X,Y,Z
,,mm,mm,mm,mm,mm,mm
101,0,1000,2000,3000,-1000,2000,3000
102,0,1001,2000,3000,,,
";

#[test]
fn rigid_bodies_of_motive_are_poses() {
    assert!(looks_like(MOTIVE));
    let bodies = read("take.csv", MOTIVE).expect("a capture");
    let [robot] = &bodies[..] else { panic!("{bodies:?}") };
    assert_eq!((robot.name.as_str(), robot.poses.len(), robot.has_angles), ("Robot", 2, false));
    let last = robot.poses[1];
    assert_eq!(last.time_s, 0.016_667);
    assert!((last.position_m - Vector3::new(1.001, 2.0, 3.0)).norm() < 1e-12, "{last:?}");
    let turned = last.orientation.expect("a quaternion") * Vector3::x();
    assert!((turned - Vector3::new(0.28, 0.96, 0.0)).norm() < 1e-12, "{turned}");
    assert_eq!(robot.skipped.first, Some((9, "Robot is not tracked".to_owned())));
    // Angles about axes have no stated order.
    let angles = "\
Format Version,1.23,Rotation Type,XYZ,Length Units,Meters
,Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body
,Name,Robot,Robot,Robot,Robot,Robot,Robot
,,Rotation,Rotation,Rotation,Position,Position,Position
Frame,Time (Seconds),X,Y,Z,X,Y,Z
0,0.0,0.0,0.0,36.9,1.0,2.0,3.0
";
    let bodies = read("take.csv", angles).expect("a capture");
    assert_eq!((bodies[0].has_angles, bodies[0].poses[0].orientation), (true, None));
    assert_eq!(bodies[0].poses[0].position_m, Vector3::new(1.0, 2.0, 3.0));
}

#[test]
fn markers_of_vicon_have_the_unit_below_and_the_rate_above() {
    assert!(looks_like(NEXUS));
    let bodies = read("walk.csv", NEXUS).expect("a capture");
    let names: Vec<&str> = bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["Robot:Front", "Robot:Back"]);
    let front = &bodies[0].poses[1];
    assert_eq!(front.time_s, 1.02);
    assert!((front.position_m - Vector3::new(1.001, 2.0, 3.0)).norm() < 1e-12, "{front:?}");
    assert_eq!((bodies[1].poses.len(), bodies[1].skipped.count), (1, 1));
    let segments = NEXUS.replace("X,Y,Z,X,Y,Z", "RX,RY,RZ,TX,TY,TZ").replace("Robot:Back", "");
    let segments = segments.replace("102,0,1001,2000,3000,,,", "");
    let bodies = read("walk.csv", &segments).expect("a capture");
    assert!(bodies[0].has_angles);
    assert_eq!(bodies[0].poses[0].position_m, Vector3::new(-1.0, 2.0, 3.0));
}

#[test]
fn what_is_missing_is_said() {
    for (text, why) in [
        (NEXUS.replace("100\n", ""), "walk.csv:3: no row above has the rate"),
        (NEXUS.replace("mm", "yd"), "the unit of lengths `yd` is not known"),
        (MOTIVE.replace(",Length Units,Millimeters", ""), "the unit of lengths `` is not known"),
        (MOTIVE.replace(",Name,", ",Alias,"), "no row above has the names"),
        (
            NEXUS.replace("1000,2000,3000", ",,").replace("1001,2000,3000", ",,").replace('-', ""),
            "no body or marker",
        ),
    ] {
        let error = read("walk.csv", &text).expect_err(why).to_string();
        assert!(error.contains(why), "{error}");
    }
    assert!(!looks_like("frame,time,x,y\n1,2,3,4\n"), "two axes are no positions");
}
