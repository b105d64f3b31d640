//! Short deployments of every kind, so that every verdict occurs.

use resect_core::calibration::Method;
use resect_core::deployment::Deployment;
use resect_tools::simulation::{Preset, Scenario, simulate_scenario};

use super::told::{Answered, tell};
use Method::{DynamicGcp, InterPrism, Joint, StaticGcp, TwoPoint};

/// A deployment, its name, and the methods that it allows.
pub struct Case {
    pub name: &'static str,
    pub deployment: Deployment,
    pub methods: &'static [Method],
}

/// Returns a preset's drive, shortened.
fn short(preset: Preset, duration_s: f64, seed: u64) -> Deployment {
    let scenario = Scenario { duration_s, ..preset.scenario() };
    let mut deployment =
        resect_io::simulation_files::open(&simulate_scenario(&scenario, seed)).expect("valid");
    // Stamps that a shift by 1.6e9 s does not round.
    let grid = 2.0_f64.powi(20);
    for track in &mut deployment.tracks {
        track.measurements.iter_mut().for_each(|m| m.time_s = (m.time_s * grid).round() / grid);
    }
    deployment
}

pub fn cases() -> Vec<Case> {
    let mut unknown = short(Preset::FlatFloor, 90.0, 3);
    unknown.control_points.clear();
    unknown.rig.as_mut().expect("a rig").prisms_m = None;
    let case = |name, methods, deployment| Case { name, deployment, methods };
    vec![
        case(
            "winding",
            &[TwoPoint, StaticGcp, InterPrism, Joint],
            short(Preset::Warthog, 120.0, 1),
        ),
        case("field errors", &[StaticGcp, InterPrism, Joint], short(Preset::FieldErrors, 150.0, 2)),
        case("eights", &[InterPrism, Joint], short(Preset::FigureEight, 150.0, 4)),
        case("flat and nothing known", &[InterPrism, Joint], unknown),
        case("straight", &[InterPrism, Joint], short(Preset::StraightLine, 60.0, 5)),
        case("one prism", &[DynamicGcp, Joint], short(Preset::SinglePrism, 90.0, 6)),
    ]
}

/// Returns the violations in each method's results for each case, after a change of the deployment.
pub fn complaints(
    change: impl Fn(&mut Deployment),
    each: impl Fn(&Answered, &Answered, Method) -> Vec<String>,
) -> Vec<String> {
    let mut all = Vec::new();
    for case in cases() {
        let mut changed = case.deployment.clone();
        change(&mut changed);
        let before = tell(&case.deployment, case.methods);
        let after = tell(&changed, case.methods);
        for ((method, before), after) in case.methods.iter().zip(before).zip(after) {
            let wrong = match (&before, &after) {
                (Ok(before), Ok(after)) => each(before, after, *method),
                (Err(before), Err(after)) if before == after => Vec::new(),
                _ => vec![format!("{after:?}, not {before:?}")],
            };
            all.extend(wrong.iter().map(|what| format!("{} by {method:?}: {what}", case.name)));
        }
    }
    all
}
