//! The report as its reader sees it: complete content, well-formed, and safe against any name.

use resect_io::findings::kinds;
use std::path::Path;
use std::process::{Command, Output};

use crate::common::{of_field, sample_folder};
use resect_core::analysis::{Analysis, Settings};
use resect_core::deployment::{Deployment, Finding};
use resect_core::evaluation::trajectory::Pose;
use resect_core::evaluation::vehicle::{Instants, PoseLimits, trajectory_by};
use resect_io::file_mark::FileMark;
use resect_io::sample::Sample;
use resect_report::report::{Chapter, page};
use resect_tools::estimates::{
    EstimatedPose, EstimatedTrajectory, EstimatesJudgement, GroundTruth, Options, judge,
};
use resvg::usvg::roxmltree::{Document, Node};
use sha2::Digest;

/// 2026-07-14 00:00 UTC: the date of every compared report.
const DATE: i64 = 1_783_987_200;

fn resect(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_resect"));
    command.env("SOURCE_DATE_EPOCH", DATE.to_string());
    command.args(arguments).output().expect("resect starts")
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

/// Returns the page that a run writes; asserts its confirmation in one line.
#[track_caller]
fn report(arguments: &[&str]) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("report.html");
    let mut all = vec!["report", "--out", text(&file)];
    all.extend(arguments);
    let output = resect(&all);
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {complaint}");
    let said = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(said.starts_with(text(&file)) && said.lines().count() == 1, "{said}");
    let left: Vec<_> = std::fs::read_dir(folder.path()).expect("readable").collect();
    assert_eq!(left.len(), 1, "nothing is left beside the report: {left:?}");
    std::fs::read_to_string(&file).expect("written")
}

/// Returns the body, for parsing as a tree. It is well-formed XML as well, so a misplaced or unescaped `<` fails.
#[track_caller]
fn body(html: &str) -> String {
    assert!(html.starts_with("<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\">"));
    assert!(html.ends_with("</body></html>"), "cut off");
    let from = html.find("<body>").expect("a body");
    html[from..html.len() - "</html>".len()].to_owned()
}

/// Returns all text in reading order.
fn words(node: Node) -> String {
    let texts = node.descendants().filter(Node::is_text).filter_map(|node| node.text());
    texts.collect::<Vec<_>>().join(" ")
}

fn sections<'a>(document: &'a Document) -> Vec<Node<'a, 'a>> {
    document.descendants().filter(|node| node.has_tag_name("section")).collect()
}

/// Returns the cells of the row with this heading, in the first table that has one.
#[track_caller]
fn row(document: &Document, heading: &str) -> Vec<String> {
    rows(document, heading).next().unwrap_or_else(|| panic!("no row {heading}"))
}

fn last_row(document: &Document, heading: &str) -> Vec<String> {
    rows(document, heading).last().unwrap_or_else(|| panic!("no row {heading}"))
}

fn rows<'a>(document: &'a Document, heading: &'a str) -> impl Iterator<Item = Vec<String>> + 'a {
    let is_it = move |node: &Node| {
        node.has_tag_name("tr") && node.first_element_child().is_some_and(|th| words(th) == heading)
    };
    let found = document.descendants().filter(is_it);
    found.map(|row| row.children().skip(1).map(words).collect())
}

#[test]
fn it_holds_what_calibrate_says() {
    let path = sample_folder("warthog");
    let html = report(&[text(&path)]);
    let body = body(&html);
    let document = Document::parse(&body).expect("well-formed");
    let all = words(document.root_element());

    let output = resect(&["calibrate", text(&path), "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let verdict = json["diagnosis"]["verdict"].as_str().expect("a verdict").to_uppercase();
    let place = |what: &str| all.find(what).unwrap_or_else(|| panic!("{what} is not in:\n{all}"));
    assert!(place(&verdict) < place("Transforms"), "the verdict comes first");
    for finding in json["diagnosis"]["findings"].as_array().expect("findings") {
        place(finding["message"].as_str().expect("a line"));
    }
    for (axis, name) in ["x (m)", "y (m)", "z (m)"].into_iter().enumerate() {
        let cells = row(&document, name);
        for (station, transform) in json["transforms"].as_array().expect("two").iter().enumerate() {
            let metres = transform["translation_m"][axis].as_f64().expect("a number");
            let sigma_mm = transform["sigma"]["translation_m"][axis].as_f64().expect("σ") * 1e3;
            assert_eq!(cells[2 * station], format!("{metres:.4}"));
            let written = cells[2 * station + 1].trim_matches(['±', ' ', 'm']);
            let written: f64 = written.parse().expect("a number of mm");
            assert!((written - sigma_mm).abs() <= 0.05, "{name}: {written} for {sigma_mm}");
        }
    }
    assert!(row(&document, "yaw (rad)")[1].ends_with(" mrad"));
    assert!(row(&document, "yaw (deg)")[1].ends_with(" deg"));
    let raw = row(&document, "raw");
    let kept = row(&document, "kept");
    for station in 0..3 {
        assert_eq!(raw[station], json["pipeline"]["raw"][station].to_string());
        assert_eq!(kept[station], json["pipeline"]["kept"][station].to_string());
    }
    let metric = &json["metrics"]["inter_prism_mm"];
    let median = metric["median"].as_f64().expect("a number");
    // The variance budget names them as well, before the metrics.
    assert_eq!(last_row(&document, "inter-prism distances")[0], format!("{median:.2}"));
    place(&format!("{} triplets", json["pipeline"]["triplets"]));
    for expected in
        [env!("CARGO_PKG_VERSION"), "Resolved by the rig", "GCP_raw_1.txt", "inter_prism.csv"]
    {
        place(expected);
    }
    assert_eq!(row(&document, "z T13")[6], "+1.00", "the diagonal of the correlations");
    let pictures: Vec<_> = document.descendants().filter(|n| n.has_attribute("viewBox")).collect();
    assert_eq!(pictures.len(), 2, "plan view and residuals");
}

#[test]
fn the_reliability_is_that_of_calibrate() {
    let path = sample_folder("warthog");
    let html = report(&[text(&path)]);
    let body = body(&html);
    let document = Document::parse(&body).expect("well-formed");
    let output = resect(&["calibrate", text(&path), "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let groups = json["details"]["joint"]["reliability"].as_array().expect("groups");
    // Four groups a station in the drive, three at control points, and three distances of the rig.
    assert_eq!(groups.len(), 24);
    for (code, heading, bias) in [
        ("station-2-ranges", "station 2, ranges", "minimal_detectable_bias_m"),
        ("station-3-vertical-angles", "station 3, vertical angles", "minimal_detectable_bias_rad"),
        (
            "station-3-control-point-ranges",
            "station 3, control points, ranges",
            "minimal_detectable_bias_m",
        ),
        ("rig-23-distance", "rig, prisms 2 and 3, distance", "minimal_detectable_bias_m"),
    ] {
        let group = groups.iter().find(|group| group["group"] == code).expect(code);
        let cells = row(&document, heading);
        let redundancy = group["redundancy"].as_f64().expect("a number");
        assert!((0.0..=1.0).contains(&redundancy), "{code}: {redundancy}");
        assert_eq!(cells[0], format!("{redundancy:.2}"), "{code}");
        let Some(size) = group[bias].as_f64() else {
            assert_eq!((&*cells[2], &*cells[3]), ("not determined", "–"), "{code}");
            continue;
        };
        assert!(size > 0.0 && !cells[2].starts_with("not"), "{code}: {size}");
        let position_m = group["effect"][0]["position_m"].as_f64().expect("a number");
        assert_eq!(cells[3], format!("{:.2}", position_m * 1e3), "{code}");
    }
    let of_points = groups.iter().find(|group| group["group"] == "station-1-control-point-angles");
    let of_points = of_points.expect("station 1 measured them");
    let readings = of_points["readings"].as_array().expect("readings");
    assert!(readings.len() > 10, "two angles a reading: {}", readings.len());
    let largest = &of_points["largest_normalised_residual"];
    let is_it = |reading: &&serde_json::Value| {
        ["file", "marker"].iter().all(|key| reading[key] == largest[key])
            && reading["normalised_residual"] == largest["value"]
    };
    assert!(readings.iter().any(|reading| is_it(&reading)), "{largest}");
    let rms = groups.iter().filter_map(|group| group["normalised_residual_rms"].as_f64());
    let rms: Vec<f64> = rms.collect();
    assert_eq!(rms.len(), 9);
    assert!(rms.iter().all(|rms| (0.2..3.0).contains(rms)), "{rms:?}");
}

#[test]
fn nothing_is_fetched_or_run_and_the_same_input_gives_the_same_bytes() {
    let path = sample_folder("hd2-tunnel");
    let html = report(&[text(&path)]);
    assert!(html == report(&[text(&path), "--robust"]), "two runs differ");
    let schema = "xmlns=\"http://www.w3.org/2000/svg\"";
    let without = html.replace(schema, "");
    for banned in ["<script", "http:", "https:", "src=", "url(", "@import", "<link"] {
        assert!(!without.contains(banned), "{banned} is in it");
    }
}

#[test]
fn the_page_says_when_by_what_and_from_which_files_and_numbers_its_pages() {
    let path = sample_folder("warthog");
    let html = report(&[text(&path)]);
    let body = body(&html);
    let document = Document::parse(&body).expect("well-formed");
    let head = document.descendants().find(|node| node.has_tag_name("header")).expect("a header");
    let said = format!("by resect {} , 2026-07-14 00:00 UTC", env!("CARGO_PKG_VERSION"));
    let plain = |text: &str| text.split_whitespace().collect::<String>();
    assert!(plain(&words(head)).contains(&plain(&said)), "{}", words(head));
    let tracks = path.join("inter_prism.csv");
    let bytes = std::fs::read(&tracks).expect("readable");
    let hash: String = sha2::Sha256::digest(&bytes).iter().map(|b| format!("{b:02x}")).collect();
    assert_eq!(row(&document, text(&tracks)), [bytes.len().to_string(), hash]);
    assert!(html.contains("counter(page) \" / \" counter(pages)"), "numbers of pages");
    let all = words(document.root_element());
    assert!(all.contains("not used") && all.contains("unused readings"), "{all}");
}

#[test]
fn settings_that_are_not_the_defaults_stand_out() {
    let path = sample_folder("warthog");
    let chosen = ["--method", "inter-prism", "--prior", "search"];
    let html = report(&[&[text(&path), "--tau-s", "1.5"], &chosen[..]].concat());
    let body = body(&html);
    let document = Document::parse(&body).expect("well-formed");
    let chosen = document.descendants().filter(|node| node.attribute("class") == Some("chosen"));
    let names: Vec<String> =
        chosen.filter_map(|row| row.first_element_child()).map(words).collect();
    assert_eq!(
        names,
        ["calibration.method", "calibration.prior", "pipeline.thresholds.tau_s_seconds"]
    );
    assert_eq!(row(&document, "pipeline.thresholds.tau_l_seconds"), ["6.0", "6.0"]);
}

#[test]
fn files_that_flags_put_aside_are_not_called_used() {
    let path = sample_folder("warthog");
    let gcp = path.join("GCP_raw_2.txt");
    let html = report(&[text(&path), "--gcp", text(&gcp)]);
    let body = body(&html);
    let document = Document::parse(&body).expect("well-formed");
    let fate = |file: &str| row(&document, file)[1].clone();
    assert_eq!(fate("GCP_raw_1.txt"), "ignored");
    assert_eq!(fate("pillars.csv"), "ignored");
    assert_eq!(fate("inter_prism.csv"), "used");
    assert_eq!(fate(text(&gcp)), "used");
}

/// Returns the deployment's own poses, in the form of another system's estimate.
fn own_poses(deployment: &Deployment, analysis: &Analysis) -> Vec<EstimatedPose> {
    let calibration = &analysis.answer.as_ref().expect("an answer").calibration;
    let (triplets, followed) = (analysis.triplets(), &analysis.offer.followed);
    let wanted = Instants::Rate(2.0);
    let found =
        trajectory_by(deployment, triplets, followed, calibration, wanted, &PoseLimits::NONE);
    let pose = |pose: &Pose| EstimatedPose {
        time_s: pose.time_s,
        position_m: pose.position_m,
        orientation: Some(pose.orientation),
    };
    found.expect("poses").0.poses.iter().map(pose).collect()
}

#[test]
fn no_name_can_break_the_page() {
    let hostile = "<script>alert(\"x\")</script>&amp;' ]]> --> \u{1b}[31m \u{0}\u{202e}";
    let mut deployment = Sample::Warthog.open().expect("built in");
    deployment.name = hostile.to_owned();
    deployment.ingredients[0].file = hostile.to_owned();
    deployment.control_points[0].file = hostile.to_owned();
    deployment.findings.push(Finding::new(kinds::FILE_UNREADABLE, hostile));
    let analysis = Box::new(crate::common::analyse(&deployment, &Settings::default()));
    let unopened = Chapter::Unopened { path: hostile.to_owned(), error: hostile.to_owned() };
    let files = vec![FileMark { path: hostile.into(), bytes: 1, sha256: hostile.to_owned() }];
    let mut estimate = EstimatedTrajectory {
        name: hostile.to_owned(),
        path: hostile.into(),
        topic: None,
        frames: None,
        poses: Vec::new(),
        covariances: Vec::new(),
        origin: None,
        findings: Vec::new(),
    };
    let few = judge(
        &GroundTruth::of(&deployment, &analysis, None),
        vec![(estimate.clone(), Options::default())],
    );
    assert_eq!(few.unjudged.len(), 1);
    estimate.poses = own_poses(&deployment, &analysis);
    let all = vec![(estimate, Options::default()); 2];
    let judgement = judge(&GroundTruth::of(&deployment, &analysis, None), all);
    assert_eq!(judgement.judged.len(), 2);
    let judgement = Some(EstimatesJudgement { unjudged: few.unjudged, ..judgement }.into());
    let chapter = Chapter::Analysed { deployment: deployment.into(), analysis, files, judgement };
    let html = page(&[chapter, unopened], jiff::Timestamp::UNIX_EPOCH);
    assert!(!html.contains("<script"));
    let body = body(&html);
    let document = Document::parse(&body).expect("well-formed");
    let shown = "<script>alert(\"x\")</script>&amp;' ]]> --> \u{fffd}[31m \u{fffd}\u{202e}";
    let headings: Vec<String> =
        document.descendants().filter(|node| node.has_tag_name("h2")).map(words).collect();
    assert_eq!(headings, ["Summary", shown, shown]);
    assert!(words(document.root_element()).matches(shown).count() >= 8);
}

#[test]
fn one_bad_deployment_does_not_keep_the_others_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let made = folder.path().join("line");
    let output = resect(&["simulate", "--preset", "straight-line", "--out", text(&made)]);
    assert!(output.status.success());
    for points in ["GCP_raw_1.txt", "GCP_raw_2.txt", "Two_points.txt"] {
        std::fs::remove_file(made.join(points)).expect("control points");
    }
    let html = report(&[text(&sample_folder("warthog")), "/nowhere/at/all", text(&made)]);
    let body = body(&html);
    let document = Document::parse(&body).expect("well-formed");
    let sections = sections(&document);
    assert_eq!(sections.len(), 3);
    let [good, none, line] = [0, 1, 2].map(|index| words(sections[index]));
    assert!(good.contains("GOOD") && good.contains("± "), "{good}");
    assert!(none.contains("NO ANSWER") && none.contains("/nowhere/at/all: No such file"), "{none}");
    assert!(
        line.contains("DEGENERATE") && line.contains("No covariance: this data leaves"),
        "{line}"
    );
    let rows: Vec<Node> = document
        .descendants()
        .find(|node| node.attribute("class") == Some("summary"))
        .and_then(|table| table.descendants().find(|node| node.has_tag_name("tbody")))
        .map(|rows| rows.children().collect())
        .expect("a summary");
    assert_eq!(rows.len(), 3);
    for (row, section) in rows.into_iter().zip(sections) {
        let link = row.descendants().find_map(|node| node.attribute("href")).expect("a link");
        assert_eq!(Some(&link[1..]), section.attribute("id"));
    }
}

#[test]
fn without_any_answer_the_page_says_why_and_the_exit_code_is_1() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("report.html");
    std::fs::write(&file, "GOOD, says an older report").expect("writable");
    for paths in [&["/nowhere/at/all"][..], &["/nowhere/at/all", "/nor/here"]] {
        let mut all = vec!["report", "--out", text(&file)];
        all.extend(paths);
        let output = resect(&all);
        let line = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0), "{line}");
        assert_eq!(line.lines().count(), 1, "{line}");
        assert!(line.contains("/nowhere/at/all"), "{line}");
        let html = std::fs::read_to_string(&file).expect("readable");
        let body = body(&html);
        let document = Document::parse(&body).expect("well-formed");
        assert_eq!(sections(&document).len(), paths.len());
        assert!(!html.contains("GOOD"), "an older report must not pass for this one");
    }
}

#[test]
fn a_file_that_cannot_be_written_is_one_line_and_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = sample_folder("hd2-tunnel");
    let missing = folder.path().join("not/there.html");
    for out in [missing.as_path(), folder.path()] {
        let output = resect(&["report", text(&path), "--out", text(out)]);
        let line = String::from_utf8(output.stderr).expect("UTF-8");
        assert_eq!((output.status.code(), output.stdout.len()), (Some(1), 0), "{line}");
        assert_eq!(line.lines().count(), 1, "{line}");
        assert!(line.contains(&format!("{}: cannot be written", out.display())), "{line}");
        assert_eq!(line.matches("os error").count(), 1, "the cause is told once: {line}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).expect("readable").count(), 0);
    let output = resect(&["report", text(&path)]);
    assert_eq!(output.status.code(), Some(2), "--out is needed");
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn the_report_of_the_field_data_names_the_station_that_turned() {
    let path = of_field("2022-07-11-2");
    let html = report(&[text(&path)]);
    let body = body(&html);
    let document = Document::parse(&body).expect("well-formed");
    let all = words(document.root_element());
    assert!(all.contains("Station 2 turned by") && all.contains("yaw survey − drive"), "{all}");
    assert!(!all.contains("control points contradict"), "{all}");
    assert_eq!(row(&document, "raw")[..3], ["1040", "1041", "1041"]);
    assert_eq!(row(&document, "rejected: azimuth rate")[0], "342");
    assert!(all.contains("11 of them kept; 2032 triplets"));
}
