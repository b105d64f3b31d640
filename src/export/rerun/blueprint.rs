//! How the Rerun viewer opens a recording: scene, distance errors, rates and verdict, each where one looks for it.

use rerun::blueprint::{
    Blueprint, Horizontal, SelectionPanel, Spatial3DView, Tabs, TextDocumentView, TimePanel,
    TimeSeriesView, Vertical,
};

/// Entity of the verdict and its reasons.
pub const VERDICT: &str = "verdict";
/// Entity above the pillars. They may stand hundreds of metres away: with them in it, the view would show nothing else.
pub const PILLARS: &str = "world/pillars";
/// Entity above the distance errors of the three pairs.
pub const DISTANCE_ERRORS: &str = "distance_error_mm";

/// One of the rates that the outlier filter looks at.
pub struct RateView {
    /// Entity above one for each station.
    pub entity: &'static str,
    title: &'static str,
}

/// Range, azimuth and zenith angle, in the order of [`crate::pipeline::outlier_filter::Rates`].
pub const RATES: [RateView; 3] = [
    RateView { entity: "rates/range_m_per_s", title: "range rate (m/s)" },
    RateView { entity: "rates/azimuth_deg_per_s", title: "azimuth rate (°/s)" },
    RateView { entity: "rates/zenith_deg_per_s", title: "zenith rate (°/s)" },
];

/// The scene over the distance errors on the left, the verdict over the rates on the right.
pub fn blueprint() -> Blueprint {
    use rerun::blueprint::components::PanelState;
    let scene = Spatial3DView::new("scene")
        .with_origin("world")
        .with_contents(["$origin/**".to_owned(), format!("- {PILLARS}/**")]);
    let errors =
        TimeSeriesView::new("inter-prism distance errors (mm)").with_origin(DISTANCE_ERRORS);
    let verdict = TextDocumentView::new("verdict").with_origin(VERDICT);
    let rates = RATES.map(|rate| TimeSeriesView::new(rate.title).with_origin(rate.entity).into());
    let left = Vertical::new([scene.into(), errors.into()]).with_row_shares([2.0, 1.0]);
    let right =
        Vertical::new([verdict.into(), Tabs::new(rates).into()]).with_row_shares([2.0, 1.0]);
    Blueprint::new(Horizontal::new([left.into(), right.into()]).with_column_shares([1.0, 1.0]))
        .with_selection_panel(SelectionPanel::from_state(PanelState::Collapsed))
        .with_time_panel(TimePanel::new().with_state(PanelState::Collapsed))
}
