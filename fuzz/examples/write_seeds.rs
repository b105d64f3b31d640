//! Writes the seeds of the fuzz targets into the folder of its argument, or into `fuzz/corpus`: a simulated drive in every format
//! that the program writes, the test fixtures, and a few lines of every other format.

use std::path::{Path, PathBuf};

use resect::app::persist::session::{Files, SavedDeployment, Session};
use resect_core::analysis::Settings;
use resect_io::simulation_files::write_folder;
use resect_io::source::Source;
use resect_tools::simulation::{Preset, simulate};

/// Longest seed; longer ones slow the fuzzer down and find nothing more.
const LONGEST_SEED_BYTES: usize = 8 << 10;

fn main() {
    let argument = std::env::args_os().nth(1).map(PathBuf::from);
    let corpus = argument.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus"));
    let folder = tempfile::tempdir().expect("a folder");
    let drive = folder.path().join("drive");
    write_folder(&simulate(Preset::Warthog, 1), &drive).expect("written");
    let write = |target: &str, name: &str, bytes: &[u8]| {
        let into = corpus.join(target);
        std::fs::create_dir_all(&into).expect("a folder");
        std::fs::write(into.join(name), bytes).expect("written");
    };
    let seed = |target: &str, from: &Path| {
        let mut bytes = std::fs::read(from).expect("a seed");
        if target != "ros2_sqlite" {
            bytes.truncate(LONGEST_SEED_BYTES);
        }
        write(target, &from.file_name().expect("a file").to_string_lossy(), &bytes);
    };
    for (target, name) in [
        ("polar_csv", "inter_prism.csv"),
        ("mapped_csv", "inter_prism.csv"),
        ("control_points", "GCP_raw_1.txt"),
        ("control_points", "pillars.csv"),
        ("rig", "calibration_raw.csv"),
        ("rig", "calibration_results.csv"),
        ("rtklib_pos", "gnss_1.pos"),
        ("deployment_toml", "deployment.toml"),
    ] {
        seed(target, &drive.join(name));
    }
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/fixtures");
    let mut folders = vec![fixtures];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            let path = entry.path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
            let target = match name.rsplit('.').next() {
                _ if path.is_dir() => {
                    folders.push(path);
                    continue;
                }
                Some("bag" | "active") => "ros1_bag",
                Some("zstd") if name.contains(".db3") => {
                    let packed = std::fs::read(&path).expect("a seed");
                    let database = zstd::decode_all(&packed[..]).expect("a database");
                    write("ros2_sqlite", "sqlite.db3", &database);
                    "compressed_bag"
                }
                Some("mcap") => "mcap",
                Some("zstd") => "compressed_bag",
                _ => continue,
            };
            seed(target, &path);
        }
    }
    for (target, name, text) in TEXTS {
        write(target, name, text.as_bytes());
    }
    let deployments = vec![SavedDeployment {
        source: Source::at("drive"),
        settings: Settings::default(),
        cursor_s: Some(12.5),
        window_s: None,
        selection_s: Some([10.0, 20.0]),
        files: Files::marked(Vec::new()),
        estimates: Vec::new(),
    }];
    let session = Session { deployments, ..Session::default() };
    let text = session.text(&corpus, &Default::default()).expect("text");
    write("session", "one.resect.toml", text.as_bytes());
}

/// Target, name and content of formats that the program does not write.
const TEXTS: [(&str, &str, &str); 16] = [
    (
        "trajectory",
        "gt.txt",
        "# t x y z qx qy qz qw\n1 1 2 3 0 0 0 1\n1.1 1 2.1 3 0 0 0 1\n\x0c1,1e-6,0,0,0,1e-6,0,0,0,1e-6\n1.1,1e-6,0,0,0,1e-6,0,0,0,1e-6\n",
    ),
    (
        "trajectory",
        "rover.nmea",
        "$GNGGA,195001.20,4646.9,N,07116.5,W,4,12,0.6,95.2,M,-27.5,M,,\n$GNGST,195001.20,1,,,,0.01,0.01,0.02\n\
         $GNRMC,195001.20,A,,,,,,,110722,,,R\n$GNGGA,195001.40,4646.9,N,07116.4,W,5,12,0.6,95.2,M,-27.5,M,,\n",
    ),
    (
        "trajectory",
        "rover.csv",
        "date,time,lat_deg,lon [rad],alt (mm),sde,sdn,sdu,Solution status\n2022-07-11,19:50:01.2,46.78,-1.2,95000,0.01,0.01,0.02,FIX\n\
         2022-07-11,19:50:01.4,46.79,-1.2,95000,0.01,0.01,0.02,FLOAT\n",
    ),
    (
        "trajectory",
        "rover.pos",
        "%  GPST x-ecef(m) y-ecef(m) z-ecef(m) Q ns sdx(m) sdy(m) sdz(m) sdxy(m) sdyz(m) sdzx(m) age(s) ratio\n\
         2218 157819.2 1404310.2 -4142876.1 4625329.6 1 9 0.01 0.01 0.02 0.001 -0.001 0 0 9\n\
         2218 157819.4 1404310.3 -4142876.1 4625329.6 2 9 0.3 0.3 0.6 0.1 -0.1 0 0 1\n",
    ),
    (
        "mcap_json",
        "fix.json",
        "{\"header\":{\"stamp\":{\"sec\":1,\"nanosec\":2}},\"status\":{\"status\":2},\"latitude\":46.78,\"longitude\":-71.2,\
         \"altitude\":null,\"position_covariance\":[1,0,0,0,1,0,0,0,4],\"position_covariance_type\":3}",
    ),
    (
        "mcap_json",
        "pose.json",
        "{\"timestamp\":{\"sec\":1,\"nsec\":2},\"pose\":{\"position\":{\"x\":1,\"y\":2,\"z\":3},\
         \"orientation\":{\"x\":0,\"y\":0,\"z\":0,\"w\":1}}}",
    ),
    (
        "bonn_csv",
        "raw.csv",
        "ref_time, ts_time, h_angle, v_angle, distance, num_chars, geocom_return_code, rpc_return_code\n\
         1700000000.004,4321000.0,0.5,1.55,20.25,87,0,0\n1700000000.055,4321050.0,0.5,1.55,20.25,87,0,0\n\
         1700000000.103,4321100.0,0.5,1.55,20.25,87,0,1284\n",
    ),
    (
        "gsi",
        "both_lengths.gsi",
        "410001+0000CODE 42....+00000001\n\
         110002+00000P01 21.324+35545100 22.324+09117510 31..00+00013825 51....+0017-034\n\
         *110005+0000000000000P04 21.022+0000000020000000 22.022+0000000010000000 31..08+0000000001382511\n",
    ),
    (
        "jobxml",
        "job.jxl",
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<JOBFile jobName=\"x\" version=\"5.72\"><FieldBook>\n\
         <AtmosphereRecord ID=\"1\"><PPM>10</PPM><ApplyPPMToRawDistances>true</ApplyPPMToRawDistances></AtmosphereRecord>\n\
         <StationRecord ID=\"2\"><StationName>S</StationName><AtmosphereID>1</AtmosphereID></StationRecord>\n\
         <TargetRecord ID=\"3\"><PrismConstant>0.0100</PrismConstant></TargetRecord>\n\
         <PointRecord ID=\"9\"><Name>A</Name><Circle><HorizontalCircle>223.5</HorizontalCircle>\
         <VerticalCircle>92.25</VerticalCircle><EDMDistance>100.0</EDMDistance><Face>Face1</Face></Circle>\
         <StationID>2</StationID><TargetID>3</TargetID></PointRecord>\n\
         <PointRecord><Name>K</Name><Grid><North>2</North><East>1</East><Elevation>3</Elevation></Grid></PointRecord>\n\
         </FieldBook></JOBFile>\n",
    ),
    (
        "mapped_csv",
        "calendar.csv",
        "t,s,sd,hz,v\n2022-07-11T12:30:01.25Z,1,10.5,355 45 10.0,91-17-51.0\n\
         2022-07-11 12:30:01.50+02:00,2,10.5,10\u{b0}0'1.5\",91.5\n11/07/2022 12:30:02,3,9,1,90\n",
    ),
    (
        "mapped_csv",
        "semicolons.csv",
        "# a comment\nTime [ms];Station;Slope distance (m);Hz (gon);V (gon)\n1657569001000;1;10,5;100,25;99,5\n",
    ),
    (
        "cartesian_track",
        "three.csv",
        "1657569001.5 -5.25 -17.0 -0.5\n1657569001.9 -5.24 -17.1 -0.5\n1657569002.3 -5.2 -17.2 -0.5\n\
         1657569001.6 5.25 -7.0 -0.4\n1657569001.8 5.24 -7.1 -0.4\n1657569002.2 5.2 -7.2 -0.4\n\n\
         1657569001.5 0.25 -1.0 -0.3\n1657569001.9 0.24 -1.1 -0.3\n1657569002.3 0.2 -1.2 -0.3\n",
    ),
    (
        "control_points",
        "two_stations.txt",
        "1 ; 1 ; 10.0 ; 0.1 ; 1.5 ; 0 ; 0\n1 ; 2 ; 11.0 ; 0.2 ; 1.5 ; 0 ; 0\n2 ; 1 ; 12.0 ; 0.3 ; 1.5 ; 0 ; 0\n",
    ),
    (
        "rig",
        "sensor_positions.csv",
        "0.1 0.2 0.3 1.0 0 0 0 0 0 0 0 0 0\n0.8 0.2 0.3 1.0 0 0 0 0 0 0 0 0 0\n0.4 0.9 0.5 1.0 0 0 0 0 0 0 0 0 0\n",
    ),
    ("rig", "distances.csv", "0.7290 0.8740 1.0490\n"),
    (
        "deployment_toml",
        "all.toml",
        "name = \"d\"\ntracks = [\"inter_prism.csv\"]\nstations = [1, 2, 3]\nazimuth = \"counter-clockwise\"\n\
         prism_constant_m = [0.01, 0.02, 0.03]\ninter_prism_m = [0.7, 0.9, 1.0]\nspan_s = [0.0, 2e9]\n\
         masked = [{ station = 1, time_s = 1657569001.0 }]\nranges_include_prism_constant = true\n\
         [columns]\ntime = \"timestamp\"\nrange = \"distance\"\n",
    ),
];
