use crate::app::model::kinds;
use proptest::prelude::*;

use std::sync::{Arc, OnceLock};

use super::*;
use crate::app::layout::Layout;
use crate::app::model::ChannelPlots;
use crate::app::model::Colouring;
use crate::app::model::LayoutPreset;
use crate::app::model::SavedEstimate;
use crate::app::model::SceneOptions;
use crate::app::model::channel_plots::Horizontal;
use crate::app::model::{Planning, StudyKind, StudyOptions};
use crate::app::persist::hashes::used_files;
use crate::app::persist::session::{SavedDeployment, SavedPin, SavedView};
use crate::app::prepared::channels::Channel;
use resect_core::analysis::Analyst;
use resect_core::analysis::Settings;
use resect_core::calibration::Method;
use resect_core::progress::Progress;
use resect_io::sample::Sample;
use resect_io::source::Extras;
use resect_io::source::Source;
use resect_report::summary::ResultSummary;
use resect_tools::estimates::{Body, Options, TrajectoryAlignment};

fn session(folder: &Path) -> Session {
    let deployment = Sample::Hd2Tunnel.open().expect("built in");
    let analysis = Analyst::new(Arc::new(deployment.clone())).run(&Settings::default());
    let answer = analysis.answer.clone().expect("an answer");
    let mut settings = Settings::default();
    settings.pipeline.thresholds.tau_s_seconds = 1.25;
    let extras = Extras { gcp: vec![folder.join("beside/gcp.txt")], ..Extras::default() };
    let below = SavedDeployment {
        source: Source::at(folder.join("data")).with(extras),
        settings,
        cursor_s: Some(1_657_543_210.125),
        window_s: Some([1_657_543_200.0, 1_657_543_300.5]),
        selection_s: None,
        files: Files::marked(
            HashCache::default().mark(&folder.join("data/tracks.csv")).into_iter().collect(),
        ),
        estimates: vec![
            SavedEstimate {
                path: folder.join("data/slam.tum"),
                topic: None,
                options: Options {
                    alignment: TrajectoryAlignment::Similarity,
                    ..Options::default()
                },
                shown: true,
            },
            SavedEstimate {
                path: folder.join("data/other.bag"),
                topic: Some("/odom".to_owned()),
                options: Options { time_offset_s: Some(-0.125), ..Options::default() },
                shown: false,
            },
        ],
    };
    let sample = SavedDeployment {
        source: Source::sample(Sample::Hd2Tunnel),
        settings: Settings::default(),
        cursor_s: None,
        window_s: None,
        selection_s: Some([1.0, 2.0]),
        files: Files::default(),
        estimates: Vec::new(),
    };
    let result = ResultSummary::of(&deployment, &analysis, &answer);
    Session {
        plan: Some(Planning::default().plan.into()),
        deployments: vec![below, sample],
        active: 1,
        view: SavedView {
            colouring: Colouring::Speed,
            plots: ChannelPlots {
                against: Some(Horizontal { channel: Channel::Range, index: Some(2) }),
                ..ChannelPlots::of(&[Channel::Height, Channel::Speed])
                    .joined(1, 0)
                    .expect("two units")
            },
            study: StudyOptions {
                kind: StudyKind::Sensitivity,
                reference: Some(Method::StaticGcp),
                split: true,
                ..StudyOptions::default()
            },
            scene: SceneOptions { trail_s: 30, follow: true, ..SceneOptions::default() },
            ..SavedView::default()
        },
        layout: Some(Layout::from(LayoutPreset::Compare).describe()),
        pins: vec![SavedPin { name: "A".to_owned(), shown: false, result }],
    }
}

fn with_data() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("data")).expect("created");
    std::fs::write(folder.path().join("data/tracks.csv"), "abc").expect("written");
    folder
}

#[test]
fn a_session_comes_back_as_it_was_and_moves_with_its_data() {
    let (old, new) = (with_data(), with_data());
    let path = old.path().join("a.resect.toml");
    let saved = session(old.path());
    saved.save(&path, &HashCache::default()).expect("saved");
    let text = std::fs::read_to_string(&path).expect("written");
    assert!(text.starts_with(resect_io::format::SESSION_KEY), "known by its first word: {text}");
    assert!(
        text.contains("path = \"data\"") && text.contains("path = \"data/tracks.csv\""),
        "{text}"
    );
    assert_eq!(load(&path).expect("read"), (saved, vec![]));
    let moved = new.path().join("b.resect.toml");
    std::fs::copy(&path, &moved).expect("copied");
    let (moved, _) = load(&moved).expect("read");
    let folder = new.path().canonicalize().expect("there");
    assert_eq!(moved.deployments[0].source.path(), Some(folder.join("data").as_path()));
    assert_eq!(moved.deployments[0].source.extras.gcp, [folder.join("beside/gcp.txt")]);
}

#[test]
fn files_that_changed_since_are_named() {
    let folder = with_data();
    let path = folder.path().join("a.resect.toml");
    session(folder.path()).save(&path, &HashCache::default()).expect("saved");
    let (back, _) = load(&path).expect("read");
    let cache = HashCache::default();
    let files = &back.deployments[0].files;
    assert_eq!(cache.changed(files.marks(&cache)), []);
    std::fs::write(folder.path().join("data/tracks.csv"), "abcd").expect("written");
    let findings = cache.changed(files.marks(&cache));
    assert_eq!(findings.len(), 1);
    assert_eq!(findings[0].kind, kinds::SESSION_FILE_CHANGED, "{findings:?}");
    // Saving again keeps the marks of the original files.
    back.save(&path, &cache).expect("saved");
    assert!(std::fs::read_to_string(&path).expect("there").contains("bytes = 3"));
}

#[test]
fn used_files_are_those_that_were_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let tracks =
        "timestamp,id,distance,ha,va\n0.0,1,10,0.1,1.5\n0.1,2,11,0.1,1.5\n0.2,3,12,0.1,1.5\n";
    for (name, text) in
        [("data/a.csv", tracks), ("data/notes.md", "x"), ("rig/d.txt", "0.7 0.9 1.0")]
    {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("created");
        std::fs::write(path, text).expect("written");
    }
    for rig in ["rig", "rig/d.txt"] {
        let extras = Extras { rig: Some(folder.path().join(rig)), ..Extras::default() };
        for place in ["data", "data/a.csv"] {
            let source = Source::at(folder.path().join(place)).with(extras.clone());
            let deployment = source.open(&Progress::default()).expect("opens");
            let mut used: Vec<_> = used_files(&deployment).collect();
            used.sort();
            let expected = ["data/a.csv", "rig/d.txt"].map(|name| folder.path().join(name));
            assert_eq!(used, expected, "{rig}, {place}: {:?}", deployment.ingredients);
        }
    }
}

#[test]
fn the_files_of_further_drives_are_used_files_too() {
    let folder = tempfile::tempdir().expect("a folder");
    let place = |name: &str| folder.path().join(name);
    for (drive, start_s) in [("run1/data", 0.0), ("run2/data", 100.0)] {
        std::fs::create_dir_all(place(drive)).expect("created");
        let readings = (1..4).map(|station| format!("{},{station},10,0.1,1.5\n", start_s + 0.1));
        let tracks = format!("timestamp,id,distance,ha,va\n{}", readings.collect::<String>());
        std::fs::write(place(drive).join("a.csv"), tracks).expect("written");
    }
    let extras = Extras { drives: vec![place("run2/data")], ..Extras::default() };
    let source = Source::at(place("run1/data")).with(extras);
    let deployment = source.open(&Progress::default()).expect("opens");
    let used: Vec<_> = used_files(&deployment).collect();
    assert_eq!(used, [place("run1/data/a.csv"), place("run2/data/a.csv")]);
}

#[test]
fn what_cannot_be_read_is_one_line_with_place_and_remedy() {
    let folder = with_data();
    let path = folder.path().join("a.resect.toml");
    let good = session(folder.path()).text(folder.path(), &HashCache::default()).expect("text");
    let error = |text: &str| {
        std::fs::write(&path, text).expect("written");
        load(&path).expect_err(text).to_string()
    };
    let typo = good.replacen("tau_s_seconds", "tau_s_second", 1);
    for (text, expected) in [
        (typo.as_str(), "unknown field"),
        ("resect_session = 1\n[[deployment]]\npath = 3\n", ":2:"),
        ("resect_session = 4\nresect = \"9.1.0\"\nwhat = 1\n", "newer resect (9.1.0)"),
        ("[pipeline]\n", "resect_session"),
        (&good.replacen("tau_s_seconds = 1.25", "tau_s_seconds = -1.0", 1), "tau_s_seconds is -1"),
    ] {
        let line = error(text);
        assert!(line.contains("a.resect.toml") && line.contains(expected), "{line}");
        assert!(line.contains("; ") && !line.contains('\n'), "{line}");
    }
    let missing = load(&folder.path().join("none")).expect_err("missing").to_string();
    assert!(missing.contains("check the path"), "{missing}");
}

#[test]
fn an_odd_view_layout_or_pin_costs_only_itself() {
    let folder = with_data();
    let path = folder.path().join("a.resect.toml");
    let good = session(folder.path()).text(folder.path(), &HashCache::default()).expect("text");
    for (from, to, said) in [
        ("\"speed\"", "\"by the weather\"", "view"),
        ("follows_window = true", "follows_window = \"perhaps\"", "layout"),
        ("[pin.result]\n", "[pin.result]\nreadings = \"many\"\n", ""),
        ("name = \"A\"", "name = [1]", "pinned"),
    ] {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{from}");
        std::fs::write(&path, &text).expect("written");
        match load(&path) {
            Ok((back, findings)) => {
                assert_eq!(back.deployments.len(), 2);
                assert!(findings.iter().any(|it| it.to_string().contains(said)), "{findings:?}");
            }
            // A duplicate key is invalid TOML.
            Err(error) => assert!(said.is_empty(), "{error}"),
        }
    }
}

/// Older sessions have one clock and body for all trajectories instead of one each.
#[test]
fn what_an_older_session_asked_of_all_trajectories_it_asks_of_each() {
    let folder = with_data();
    let path = folder.path().join("a.resect.toml");
    let old = "resect_session = 1\n[[deployment]]\npath = \"data\"\nestimates = [\"a.tum\", \"b.bag\"]\n\
               [deployment.judging]\nalignment = \"none\"\ntime_offset_s = 0.5\nbody = \"same\"\n";
    std::fs::write(&path, old).expect("written");
    let (back, findings) = load(&path).expect("an old session opens");
    assert_eq!(findings, vec![]);
    let folder = folder.path().canonicalize().expect("there");
    let options = Options {
        alignment: TrajectoryAlignment::None,
        time_offset_s: Some(0.5),
        body: Body::Same,
        ..Options::default()
    };
    let of =
        |file: &str| SavedEstimate { path: folder.join(file), topic: None, options, shown: true };
    assert_eq!(back.deployments[0].estimates, [of("a.tum"), of("b.bag")]);
    // Other options or trajectories are other work; a different view is not.
    let mut other = back.clone();
    other.deployments[0].estimates[0].shown = false;
    other.deployments[0].estimates.reverse();
    other.deployments[0].estimates[0].topic = Some("/odometry".to_owned());
    assert!(other.is_same_work(&back));
    other.deployments[0].estimates[0].options = Options::default();
    assert!(!other.is_same_work(&back));
    other.deployments[0].estimates.clear();
    assert!(!other.is_same_work(&back));
    // A trajectory with options of a newer version is still evaluated, with a finding.
    std::fs::write(&path, old.replace("\"none\"", "\"by the weather\"")).expect("written");
    let (back, findings) = load(&path).expect("opens");
    assert_eq!(back.deployments[0].estimates[1].options, Options::default());
    assert!(findings[0].to_string().contains("the evaluation of a trajectory"), "{findings:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn a_damaged_file_is_an_error_or_a_session_but_never_a_panic(at in 0.0..1.0, by: u8) {
        let folder = with_data();
        let path = folder.path().join("a.resect.toml");
        let good = session_text(folder.path());
        let mut bytes = good.into_bytes();
        let at = (at * bytes.len() as f64) as usize;
        if by % 2 == 0 { bytes.truncate(at) } else { bytes[at] = by }
        std::fs::write(&path, &bytes).expect("written");
        if let Ok((session, _)) = load(&path)
            && let Some(layout) = &session.layout
        {
            let (layout, _) = Layout::of_description(layout);
            prop_assert!(crate::app::Pane::ALL.into_iter().any(|pane| layout.holds(pane)));
        }
    }
}

/// Text of a session, computed once.
fn session_text(folder: &Path) -> String {
    static TEXT: OnceLock<String> = OnceLock::new();
    TEXT.get_or_init(|| session(folder).text(folder, &HashCache::default()).expect("text")).clone()
}
