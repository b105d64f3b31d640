//! Validation of one open deployment's calibration on the others, in the window.

use egui::Theme;
use egui_kittest::kittest::Queryable;
use resect::app::{AngleUnit, DeploymentCommand, Pane, ResultsCommand, Units, WorkspaceCommand};
use resect_tools::simulation::Preset;
use resect_tools::validation::{Cause, Outcome};

use crate::common::{knock, two_runs};
use crate::harness::{LARGE, Window, click, open, send, set, settle, window};

/// Button of the second of two deployments with one name, since both are simulated from one preset.
const APPLY: &str = "Apply warthog (simulated) (2)'s calibration to the others";

fn outcomes(harness: &Window) -> Vec<Outcome> {
    harness.state().state.validations().map(|found| found.outcome.clone()).collect()
}

#[test]
fn a_calibration_is_applied_to_the_other_open_deployments() {
    let mut harness = window(LARGE, Theme::Dark);
    let turned = knock(1, 1e-3, [0.0; 3]);
    for run in two_runs(Preset::Warthog.scenario(), 3, &[turned]) {
        open(&mut harness, resect_io::simulation_files::open(&run).expect("valid"));
    }
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::SideBySide));
    assert_eq!(outcomes(&harness), []);
    assert!(harness.query_by_label("does not hold").is_none());

    click(&mut harness, APPLY);
    let moved = [Outcome::DoesNotHold(Cause::Station(1))];
    assert_eq!(outcomes(&harness), moved);
    assert!(harness.query_by_label_contains("does not hold").is_some());
    assert!(harness.query_by_label_contains("station 2 turned by").is_some());
    assert!(harness.query_by_label("explains it alone").is_some());
    let units = Units { angle: AngleUnit::Gon, ..Units::default() };
    send(&mut harness, WorkspaceCommand::SetUnits(units));
    assert!(harness.query_by_label_contains("mgon and moved by").is_some(), "in the unit chosen");
    send(&mut harness, WorkspaceCommand::SetUnits(Units::default()));

    // Validations belong to the active deployment, and expire when its calibration changes.
    let ids: Vec<u64> = harness.state().state.deployments.open.iter().map(|open| open.id).collect();
    send(&mut harness, DeploymentCommand::Activate(ids[0]));
    assert_eq!(outcomes(&harness), []);
    send(&mut harness, DeploymentCommand::Activate(ids[1]));
    assert_eq!(outcomes(&harness), moved);
    set(&mut harness, |settings| settings.pipeline.thresholds.tau_l_seconds = 5.0);
    assert_eq!(outcomes(&harness), []);
    click(&mut harness, APPLY);
    assert_eq!(outcomes(&harness), moved);
    send(&mut harness, DeploymentCommand::Close(ids[0]));
    assert_eq!(outcomes(&harness), []);
    assert!(
        harness.query_by_label_contains("calibration to the others").is_none(),
        "there is no other"
    );
}

#[test]
fn it_can_be_cancelled_and_asked_again() {
    let mut harness = window(LARGE, Theme::Light);
    for run in two_runs(Preset::Warthog.scenario(), 3, &[]) {
        open(&mut harness, resect_io::simulation_files::open(&run).expect("valid"));
    }
    let ctx = harness.ctx.clone();
    harness.state_mut().send(ResultsCommand::ValidateOthers, &ctx);
    let state = &harness.state().state;
    assert!(!state.can_validate() && state.is_busy());
    state.results.validations.running.as_ref().expect("it runs").1.cancel();
    settle(&mut harness);
    assert_eq!(outcomes(&harness), []);
    send(&mut harness, ResultsCommand::ValidateOthers);
    assert_eq!(outcomes(&harness), [Outcome::Holds]);
}
