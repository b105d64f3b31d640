//! The panes.

/// A pane, which can be docked, tabbed and closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Pane {
    Deployment,
    Pipeline,
    Scene,
    Result,
    Findings,
    Residuals,
    Histogram,
    PriorSearch,
    SideBySide,
    Studies,
    /// Rates of range, azimuth and zenith angle, with their thresholds.
    Rates,
    /// Intervals in which each station measured, and which of them are used.
    Intervals,
    /// Offsets of the stations' own clocks as recorded, and as estimated by the calibration.
    Clocks,
    /// Channels over time or against another one: readings, prisms, the vehicle with σ; errors of other trajectories.
    Channels,
    /// Explanation of the picked reading.
    Reading,
    /// Earlier runs and pinned results.
    Runs,
    /// Step-by-step guide.
    Guide,
    /// Residuals at the control points.
    ControlPoints,
    /// Steps of the joint estimate's solver, with its status.
    Solver,
    /// Ranking of estimated trajectories: which is better, by how much, and at which times they are wrong.
    Evaluation,
    /// The plan in numbers.
    PlanNumbers,
    /// Map of the plan, with handles.
    PlanMap,
    /// Prediction for the plan.
    Prediction,
    /// Progress of a live deployment: sufficient, or what else to drive.
    Live,
}

impl Pane {
    /// All panes in menu order.
    pub const ALL: [Self; 24] = [
        Self::Deployment,
        Self::Pipeline,
        Self::Scene,
        Self::Studies,
        Self::SideBySide,
        Self::Result,
        Self::Runs,
        Self::Residuals,
        Self::Rates,
        Self::Intervals,
        Self::Clocks,
        Self::Channels,
        Self::Evaluation,
        Self::Histogram,
        Self::Findings,
        Self::Reading,
        Self::PriorSearch,
        Self::Solver,
        Self::Guide,
        Self::ControlPoints,
        Self::PlanMap,
        Self::PlanNumbers,
        Self::Prediction,
        Self::Live,
    ];

    pub fn title(self) -> &'static str {
        match self {
            Self::Deployment => "Deployment",
            Self::Pipeline => "Pipeline",
            Self::Scene => "Scene",
            Self::Result => "Result",
            Self::Findings => "Findings",
            Self::Residuals => "Distance errors over time",
            Self::Histogram => "Histogram",
            Self::PriorSearch => "Prior search",
            Self::SideBySide => "Side by side",
            Self::Studies => "Studies",
            Self::Rates => "Rates",
            Self::Intervals => "Intervals",
            Self::Clocks => "Clocks",
            Self::Channels => "Channels",
            Self::Reading => "Reading",
            Self::Runs => "Runs",
            Self::Guide => "Guide",
            Self::ControlPoints => "Control points",
            Self::Solver => "Solver",
            Self::Evaluation => "Evaluation",
            Self::PlanNumbers => "Plan in numbers",
            Self::PlanMap => "Plan",
            Self::Prediction => "Prediction",
            Self::Live => "Live",
        }
    }

    /// Returns the pane's name in files; never changes, unlike the title.
    pub fn name(self) -> &'static str {
        match self {
            Self::Deployment => "deployment",
            Self::Pipeline => "pipeline",
            Self::Scene => "scene",
            Self::Result => "result",
            Self::Findings => "findings",
            Self::Residuals => "residuals",
            Self::Histogram => "histogram",
            Self::PriorSearch => "prior-search",
            Self::SideBySide => "side-by-side",
            Self::Studies => "studies",
            Self::Rates => "rates",
            Self::Intervals => "intervals",
            Self::Clocks => "clocks",
            Self::Channels => "channels",
            Self::Reading => "reading",
            Self::Runs => "runs",
            Self::Guide => "guide",
            Self::ControlPoints => "control-points",
            Self::Solver => "solver",
            Self::Evaluation => "evaluation",
            Self::PlanNumbers => "plan-numbers",
            Self::PlanMap => "plan",
            Self::Prediction => "prediction",
            Self::Live => "live",
        }
    }

    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|pane| pane.name() == name)
    }
}
