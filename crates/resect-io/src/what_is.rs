//! Recognition, by content, of a path that the user dropped on the window or chose in a dialog.

use std::path::{Path, PathBuf};

use crate::extras::Extras;
use crate::format::kitti::times_beside;
use crate::format::pose_covariance::file_beside as covariances_beside;
use crate::format::{Format, SESSION_KEY, deployment_toml::parse_toml};
use crate::open::{FoundFile, list_folder};
use resect_core::progress::Progress;

/// Tables of a settings file (`--config`).
const SETTINGS_KEYS: [&str; 2] = ["pipeline", "calibration"];
/// Largest size of a TOML file of the program.
const LARGEST_TOML_BYTES: u64 = 4 << 20;

/// Use of a path by the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Dropped {
    /// A folder, a file of tracks, or a `deployment.toml`, which represents its folder.
    Deployment,
    /// Readings, pillars or coordinates.
    ControlPoints,
    /// A file that describes the rig, or a folder of such files without tracks.
    Rig,
    /// A folder that contains only a rig or control points: true for a rig, and the files of control points.
    FolderOfExtras {
        rig: bool,
        gcp: Vec<PathBuf>,
    },
    /// A GNSS solution of one antenna.
    Gnss,
    Session,
    Settings,
    /// A trajectory that another system estimated.
    Estimate,
    /// An unusable path, and the reason.
    Unknown(String),
}

impl Dropped {
    /// Short name of the kind.
    pub fn label(&self) -> &'static str {
        match self {
            Self::Deployment => "deployment",
            Self::ControlPoints => "control points",
            Self::Rig => "rig",
            Self::FolderOfExtras { rig: true, gcp } if gcp.is_empty() => "rig",
            Self::FolderOfExtras { rig: true, .. } => "rig and control points",
            Self::FolderOfExtras { .. } => "control points",
            Self::Gnss => "GNSS",
            Self::Session => "session",
            Self::Settings => "settings",
            Self::Estimate => "trajectory",
            Self::Unknown(_) => "",
        }
    }
}

/// Recognises a file, or a folder by all files in it.
pub fn what_is(path: &Path) -> Dropped {
    if path.is_dir() {
        return what_folder_is(path);
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let file = match FoundFile::at(path, name) {
        Ok(file) => file,
        Err(error) => return Dropped::Unknown(error.to_string()),
    };
    match file.format {
        Format::PolarCsv
        | Format::BonnCsv
        | Format::UnknownTable
        | Format::CartesianTrack
        | Format::Ros1Bag
        | Format::Ros2Sqlite
        | Format::Mcap
        | Format::RosbagMetadata
        | Format::DeploymentToml => Dropped::Deployment,
        Format::ControlPoints
        | Format::Gsi
        | Format::JobXml
        | Format::Pillars
        | Format::SurveyedPoints => Dropped::ControlPoints,
        Format::RigReading | Format::SensorPositions | Format::RigDistances => Dropped::Rig,
        // Poses of KITTI have the same columns, and a file of times in the same folder.
        Format::AppliedTransforms if times_beside(path).is_some() => Dropped::Estimate,
        Format::AppliedTransforms => Dropped::Unknown(format!(
            "{}: {}; open the folder with the transformed tracks",
            file.file,
            file.format.describe()
        )),
        Format::RtklibPos => Dropped::Gnss,
        Format::Estimate => Dropped::Estimate,
        Format::Unreadable => {
            Dropped::Unknown(format!("{}: {}", file.file, file.format.describe()))
        }
        Format::Ignored(why) => {
            let is_toml = path.extension().is_some_and(|extension| extension == "toml");
            match what_toml_is(&file) {
                _ if file.file == "truth.toml" => Dropped::Unknown(format!("{}: {why}", file.file)),
                // A session can have any file name.
                found @ (Dropped::Session | Dropped::Settings) => found,
                other if is_toml => other,
                _ => Dropped::Unknown(format!("{}: {why}", file.file)),
            }
        }
    }
}

fn what_folder_is(path: &Path) -> Dropped {
    // Opening the folder reports its errors; a folder with many deployments is not searched.
    if crate::open::holds_many(path) {
        return Dropped::Deployment;
    }
    let files = list_folder(path, crate::open::FOLDER_DEPTH, &Progress::default());
    let files: Vec<FoundFile> = files.into_iter().flatten().collect();
    let is_rig = |f: &FoundFile| {
        matches!(f.format, Format::RigReading | Format::SensorPositions | Format::RigDistances)
    };
    let rig = files.iter().any(is_rig);
    let of_points = |f: &&FoundFile| {
        matches!(
            f.format,
            Format::ControlPoints
                | Format::Gsi
                | Format::JobXml
                | Format::Pillars
                | Format::SurveyedPoints
        )
    };
    let gcp: Vec<PathBuf> = files.iter().filter(of_points).map(|f| path.join(&f.file)).collect();
    let deployment =
        files.iter().any(|f| f.format.is_track() || f.format == Format::DeploymentToml);
    if deployment || (!rig && gcp.is_empty()) {
        Dropped::Deployment
    } else {
        Dropped::FolderOfExtras { rig, gcp }
    }
}

fn what_toml_is(file: &FoundFile) -> Dropped {
    let remedy = "it is neither a session nor settings of resect";
    if file.bytes > LARGEST_TOML_BYTES {
        return Dropped::Unknown(format!("{}: too large; {remedy}", file.file));
    }
    let table = file.uncounted_text().and_then(|text| parse_toml::<toml::Table>(&file.file, &text));
    match table {
        Ok(table) if table.contains_key(SESSION_KEY) => Dropped::Session,
        Ok(table) if SETTINGS_KEYS.iter().any(|key| table.contains_key(*key)) => Dropped::Settings,
        Ok(_) => Dropped::Unknown(format!("{}: {remedy}", file.file)),
        Err(error) => Dropped::Unknown(error.to_string()),
    }
}

/// Several paths, sorted by their use.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sorted {
    /// Deployments to open, each with the extras.
    pub deployments: Vec<PathBuf>,
    /// Extras of the deployments; without a deployment, they are added to the one that is open.
    pub extras: Extras,
    /// Folders that contain only some of these extras, and might be meant as deployments.
    pub folders: Vec<PathBuf>,
    pub sessions: Vec<PathBuf>,
    pub settings: Vec<PathBuf>,
    /// Trajectories of other systems, to be compared with the deployment.
    pub estimates: Vec<PathBuf>,
    /// Messages about unusable paths.
    pub unknown: Vec<String>,
}

pub fn sort<'a>(paths: impl IntoIterator<Item = &'a Path>) -> Sorted {
    let mut sorted = Sorted::default();
    let mut unknown = Vec::new();
    for path in paths {
        let own = path.to_owned();
        match what_is(path) {
            Dropped::Deployment => sorted.deployments.push(own),
            Dropped::ControlPoints => sorted.extras.gcp.push(own),
            Dropped::Rig => sorted.extras.rig = Some(own),
            Dropped::FolderOfExtras { rig, gcp } => {
                sorted.extras.gcp.extend(gcp);
                if rig {
                    sorted.extras.rig = Some(own.clone());
                }
                sorted.folders.push(own);
            }
            Dropped::Gnss => sorted.extras.gnss.push(own),
            Dropped::Session => sorted.sessions.push(own),
            Dropped::Settings => sorted.settings.push(own),
            Dropped::Estimate => sorted.estimates.push(own),
            Dropped::Unknown(why) => unknown.push((own, why)),
        }
    }
    // Times and covariances of a trajectory are read with it.
    let estimates = sorted.estimates.iter();
    let beside: Vec<PathBuf> = estimates
        .flat_map(|path| [times_beside(path), covariances_beside(path)])
        .flatten()
        .collect();
    unknown.retain(|(path, _)| !beside.contains(path));
    sorted.unknown = unknown.into_iter().map(|(_, why)| why).collect();
    // The window system passes the paths in arbitrary order; antennas are numbered by their names.
    sorted.extras.gnss.sort();
    sorted.estimates.sort();
    sorted
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes files into a folder; returns their paths.
    fn written<const N: usize>(folder: &Path, files: [(&str, &str); N]) -> [PathBuf; N] {
        files.map(|(name, text)| {
            let path = folder.join(name);
            std::fs::create_dir_all(path.parent().expect("inside")).expect("writable");
            std::fs::write(&path, text).expect("writable");
            path
        })
    }

    #[test]
    fn paths_are_known_by_what_is_in_them() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |name: &str, text: &str| {
            let [path] = written(folder.path(), [(name, text)]);
            path
        };
        let cases = [
            ("x.txt", "timestamp,id,distance,ha,va\n1,1,2,3,1.5\n", Dropped::Deployment),
            ("y.csv", "theodolite_number , marker_number , status\n", Dropped::ControlPoints),
            ("z.csv", "marker_number,distance_m,height_m\n", Dropped::ControlPoints),
            ("rig/d.txt", "0.7 0.9 1.0\n", Dropped::Rig),
            ("a.pos", "% GPST latitude(deg) longitude(deg) height(m) Q\n", Dropped::Gnss),
            ("s.toml", "# saved\nresect_session = 1\n", Dropped::Session),
            ("c.toml", "[pipeline]\nrate_hz = 5\n", Dropped::Settings),
            ("deployment.toml", "name = \"x\"\n", Dropped::Deployment),
            ("slam.txt", "1.5 1 2 3 0 0 0.6 0.8\n", Dropped::Estimate),
        ];
        for (name, text, expected) in cases {
            assert_eq!(what_is(&write(name, text)), expected, "{name}");
        }
        let kitti = write("kitti/poses.txt", "1 0 0 5 0 1 0 6 0 0 1 7\n");
        assert!(matches!(what_is(&kitti), Dropped::Unknown(_)), "without times it is none");
        write("kitti/times.txt", "0.1\n");
        assert_eq!(what_is(&kitti), Dropped::Estimate);
        for (name, text, why) in [
            ("notes.txt", "it rained\n", "notes.txt: not recognised"),
            ("other.toml", "[package]\n", "other.toml: it is neither"),
            ("bad.toml", "\n= 3\n", "bad.toml:2: "),
            ("truth.toml", "[pipeline]\n", "truth of a simulation"),
        ] {
            let Dropped::Unknown(said) = what_is(&write(name, text)) else { panic!("{name}") };
            assert!(said.contains(why), "{said}");
        }
        let rig = Dropped::FolderOfExtras { rig: true, gcp: Vec::new() };
        assert_eq!(what_is(&folder.path().join("rig")), rig);
        assert_eq!(what_is(folder.path()), Dropped::Deployment);
        assert!(matches!(what_is(&folder.path().join("absent")), Dropped::Unknown(_)));
    }

    #[test]
    fn times_and_covariances_belong_to_their_trajectory() {
        let folder = tempfile::tempdir().expect("a folder");
        let paths = written(
            folder.path(),
            [
                ("times.txt", "0.1\n"),
                ("gt_covariance.csv", "1.5,1,0,0,0,1,0,0,0,1\n"),
                ("gt.txt", "1.5 1 2 3 0 0 0.6 0.8\n"),
                ("poses.txt", "1 0 0 5 0 1 0 6 0 0 1 7\n"),
            ],
        );
        let sorted = sort(paths.iter().map(PathBuf::as_path));
        let [_, covariances, truth, poses] = &paths;
        assert_eq!(sorted.estimates, [truth.clone(), poses.clone()]);
        assert_eq!(sorted.unknown, Vec::<String>::new());
        let alone = sort([covariances.as_path()]);
        assert_eq!(alone.unknown, ["gt_covariance.csv: not recognised"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_is_not_waited_for() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("tracks.csv");
        let made = std::process::Command::new("mkfifo").arg(&path).status();
        assert!(made.expect("a tool of every Unix").success());
        let (send, receive) = std::sync::mpsc::channel();
        std::thread::spawn(move || send.send(what_is(&path)));
        let patience = std::time::Duration::from_secs(10);
        let Ok(Dropped::Unknown(said)) = receive.recv_timeout(patience) else {
            panic!("it is waited for")
        };
        assert!(said.starts_with("tracks.csv: a pipe"), "{said}");
    }

    #[test]
    fn several_are_sorted_by_what_is_done_with_them() {
        let folder = tempfile::tempdir().expect("a folder");
        let paths = written(
            folder.path(),
            [
                ("gcp.txt", "theodolite_number , marker_number , status\n"),
                ("note", "hello\n"),
                ("p.csv", "timestamp,id,distance,ha,va\n"),
                ("rig.txt", "0.7 0.9 1.0\n"),
            ],
        );
        let sorted = sort(paths.iter().map(PathBuf::as_path));
        let [points, _, tracks, rig] = paths;
        assert_eq!(sorted.deployments, [tracks]);
        assert_eq!(sorted.extras.gcp, [points]);
        assert_eq!(sorted.extras.rig, Some(rig));
        assert_eq!(sorted.unknown, ["note: not recognised"]);
    }
}
