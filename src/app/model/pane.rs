//! The panes there are.

/// What can be docked, tabbed and closed.
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
    /// When each station measured, and what of it is used.
    Intervals,
    /// What the stations' own clocks said, and what the calibration estimates of them.
    Clocks,
    /// Channels over time or against another one: readings, prisms, the vehicle with σ; errors of other trajectories.
    Channels,
    /// The picked reading, explained.
    Reading,
    /// Earlier runs and pinned results.
    Runs,
    /// What to do, step by step.
    Guide,
    /// What the answer leaves at each control point.
    ControlPoints,
    /// Which of the trajectories of other systems is better, by how much, and where they are wrong.
    Evaluation,
    /// The numbers of a plan.
    PlanNumbers,
    /// A plan from above, with its handles.
    PlanMap,
    /// What is foreseen of a plan.
    Prediction,
    /// A live deployment: is it enough, and if not what to drive.
    Live,
}

impl Pane {
    /// All panes in the order of the menu.
    pub const ALL: [Self; 23] = [
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
            Self::Evaluation => "Evaluation",
            Self::PlanNumbers => "Plan in numbers",
            Self::PlanMap => "Plan",
            Self::Prediction => "Prediction",
            Self::Live => "Live",
        }
    }

    /// The pane's name in files; never changes, unlike the title.
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
