//! The layout presets, written as descriptions.

use super::layout_description::{Node, column, row, tabs};
use super::pane::Pane::{
    Channels, Clocks, ControlPoints, Deployment, Evaluation, Findings, Guide, Histogram, Intervals,
    Live, Pipeline, PlanMap, PlanNumbers, Prediction, PriorSearch, Rates, Reading, Residuals,
    Result, Runs, Scene, SideBySide, Solver, Studies,
};

/// A layout preset for one kind of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayoutPreset {
    /// Inspecting the measurements.
    Inspect,
    /// Adjusting thresholds and observing their effect.
    Tune,
    /// Comparing deployments, methods and runs.
    Compare,
    /// Planning the stations and the drive beforehand.
    Plan,
    /// Watching a live deployment.
    Live,
    /// Evaluating trajectories of other systems.
    Evaluate,
}

impl LayoutPreset {
    pub const ALL: [Self; 6] =
        [Self::Inspect, Self::Tune, Self::Compare, Self::Plan, Self::Live, Self::Evaluate];

    pub fn title(self) -> &'static str {
        match self {
            Self::Inspect => "Inspect",
            Self::Tune => "Tune",
            Self::Compare => "Compare",
            Self::Plan => "Plan",
            Self::Live => "Live",
            Self::Evaluate => "Evaluate",
        }
    }

    /// Returns a one-line description of its purpose.
    pub fn hint(self) -> &'static str {
        match self {
            Self::Inspect => "A large scene, the picked reading, and what was measured over time",
            Self::Tune => "The pipeline, with the rates and intervals that its thresholds limit",
            Self::Compare => "Deployments, studies and runs beside each other",
            Self::Plan => "Stations and path from above, with the predicted accuracy",
            Self::Live => "Progress towards the target σ during the drive, with the growing tracks",
            Self::Evaluate => {
                "Trajectories beside their ground truth, their errors over time, and the verdict"
            }
        }
    }

    pub fn root(self) -> Node {
        match self {
            Self::Inspect => row([
                (0.2, column([(0.4, tabs(&[Deployment])), (0.6, tabs(&[Reading, Pipeline]))])),
                (
                    0.6,
                    column([
                        (0.68, tabs(&[Scene])),
                        (0.32, tabs(&[Rates, Intervals, Residuals, Histogram])),
                    ]),
                ),
                (0.2, tabs(&[Result, Findings, Runs])),
            ]),
            Self::Tune => row([
                (0.2, column([(0.3, tabs(&[Deployment])), (0.7, tabs(&[Pipeline]))])),
                (
                    0.6,
                    column([
                        (0.4, tabs(&[Scene])),
                        (0.36, tabs(&[Rates])),
                        (0.24, tabs(&[Intervals])),
                    ]),
                ),
                (
                    0.4,
                    column([
                        (0.58, tabs(&[Result, Runs, Findings])),
                        (0.42, tabs(&[Residuals, Histogram, PriorSearch, Solver])),
                    ]),
                ),
            ]),
            Self::Plan => row([
                (0.22, tabs(&[PlanNumbers, Deployment])),
                (0.53, tabs(&[PlanMap, Scene])),
                (0.25, tabs(&[Prediction, Result])),
            ]),
            Self::Compare => row([
                (
                    0.7,
                    column([
                        (0.56, tabs(&[SideBySide, Studies])),
                        (
                            0.44,
                            row([(0.55, tabs(&[Scene])), (0.45, tabs(&[Residuals, Histogram]))]),
                        ),
                    ]),
                ),
                (0.3, column([(0.6, tabs(&[Result, Findings])), (0.4, tabs(&[Runs, Deployment]))])),
            ]),
            Self::Live => row([
                (0.45, tabs(&[Live])),
                (
                    0.55,
                    column([
                        (0.7, tabs(&[Scene, Result, Findings])),
                        (0.3, tabs(&[Residuals, Intervals, Clocks])),
                    ]),
                ),
            ]),
            Self::Evaluate => row([
                (0.56, column([(0.62, tabs(&[Scene])), (0.38, tabs(&[Channels]))])),
                (0.44, tabs(&[Evaluation, Deployment, Findings])),
            ]),
        }
    }
}

/// Layout of the first window, with the panes for a deployment that was driven. Tuning, planning and live deployments have presets.
pub fn first() -> Node {
    row([
        (0.2, column([(0.3, tabs(&[Deployment])), (0.7, tabs(&[Pipeline]))])),
        (
            0.6,
            column([
                (0.68, tabs(&[Scene, Studies, SideBySide])),
                (
                    0.32,
                    row([
                        (0.66, tabs(&[Residuals, Rates, Intervals, Clocks, Channels, PriorSearch])),
                        (0.34, tabs(&[Histogram, Findings, Reading, ControlPoints])),
                    ]),
                ),
            ]),
        ),
        (0.2, tabs(&[Result, Runs, Evaluation, Guide])),
    ])
}
