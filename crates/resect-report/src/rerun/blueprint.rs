//! Blueprint of a recording: scene, distance errors, rates and verdict in the viewer's layout.
//!
//! [`rerun::blueprint`] gives its views and containers random names, so the blueprint is logged here with given names.

use rerun::components::Name;
use rerun::datatypes::{Float32, Uuid};
use rerun::external::re_sdk_types::blueprint::archetypes::{
    ContainerBlueprint, PanelBlueprint, TimePanelBlueprint, ViewBlueprint, ViewContents,
    ViewportBlueprint,
};
use rerun::external::re_sdk_types::blueprint::components::{
    ColumnShare, ContainerKind, IncludedContent, PanelState, QueryExpression, RootContainer,
    RowShare, ViewClass,
};
use rerun::log::ChunkResult;
use rerun::{AsComponents, TimePoint, Timeline};

use super::chunks::Chunks;

/// Entity of the verdict and its reasons.
pub const VERDICT: &str = "verdict";
/// Entity above the pillars. The 3D view excludes them: hundreds of metres away, they would shrink everything else.
pub const PILLARS: &str = "world/pillars";
/// Entity above the distance errors of the three pairs.
pub const DISTANCE_ERRORS: &str = "distance_error_mm";

/// View of a rate that the outlier filter tests.
pub struct RateView {
    /// Entity above those of the stations.
    pub entity: &'static str,
    title: &'static str,
}

/// Range, azimuth and zenith angle, in the order of [`resect_core::pipeline::outlier_filter::Rates`].
pub const RATES: [RateView; 3] = [
    RateView { entity: "rates/range_m_per_s", title: "range rate (m/s)" },
    RateView { entity: "rates/azimuth_deg_per_s", title: "azimuth rate (°/s)" },
    RateView { entity: "rates/zenith_deg_per_s", title: "zenith rate (°/s)" },
];

/// Returns the blueprint: scene over distance errors on the left, verdict over rates on the right.
pub fn blueprint() -> ChunkResult<Chunks> {
    let mut layout = Layout::default();
    let all = || vec!["$origin/**".to_owned()];
    let but_pillars = vec!["$origin/**".to_owned(), format!("- {PILLARS}/**")];
    let scene = layout.view("3D", "scene", "world", but_pillars)?;
    let title = "inter-prism distance errors (mm)";
    let errors = layout.view("TimeSeries", title, DISTANCE_ERRORS, all())?;
    let verdict = layout.view("TextDocument", "verdict", VERDICT, all())?;
    let mut rates = Vec::new();
    for rate in &RATES {
        rates.push(layout.view("TimeSeries", rate.title, rate.entity, all())?);
    }
    let rates = layout.container(ContainerKind::Tabs, &rates, [])?;
    let left = layout.container(ContainerKind::Vertical, &[scene, errors], [2.0, 1.0])?;
    let right = layout.container(ContainerKind::Vertical, &[verdict, rates], [2.0, 1.0])?;
    let root = layout.container(ContainerKind::Horizontal, &[left, right], [1.0, 1.0])?;
    let root = RootContainer(Uuid { bytes: root.id.to_be_bytes() });
    layout.log("viewport", &ViewportBlueprint::new().with_root_container(root))?;
    layout.log("selection_panel", &PanelBlueprint::new().with_state(PanelState::Collapsed))?;
    layout.log("time_panel", &TimePanelBlueprint::new().with_state(PanelState::Collapsed))?;
    Ok(layout.chunks)
}

/// View or container that was logged.
struct BlueprintNode {
    id: u128,
    path: String,
}

#[derive(Default)]
struct Layout {
    chunks: Chunks,
    nodes: u128,
}

impl Layout {
    fn log(&mut self, path: &str, archetype: &dyn AsComponents) -> ChunkResult<()> {
        // The viewer's undo uses this timeline.
        let time = TimePoint::default().with(Timeline::new_sequence("blueprint"), 0);
        self.chunks.log(path, time, archetype)
    }

    fn new_node(&mut self, kind: &str) -> BlueprintNode {
        self.nodes += 1;
        let id = 0x7e5e_c700_0000_4000_8000_0000_0000_0000 + self.nodes;
        let digits = format!("{id:032x}");
        let parts = [&digits[..8], &digits[8..12], &digits[12..16], &digits[16..20], &digits[20..]];
        BlueprintNode { id, path: format!("{kind}/{}", parts.join("-")) }
    }

    fn view(
        &mut self,
        class: &str,
        name: &str,
        origin: &str,
        contents: Vec<String>,
    ) -> ChunkResult<BlueprintNode> {
        let view = self.new_node("view");
        let contents = contents.into_iter().map(|query| QueryExpression(query.into()));
        self.log(&format!("{}/ViewContents", view.path), &ViewContents::new(contents))?;
        let blueprint = ViewBlueprint::new(ViewClass(class.into()))
            .with_display_name(Name(name.into()))
            .with_space_origin(origin);
        self.log(&view.path, &blueprint)?;
        Ok(view)
    }

    fn container<const N: usize>(
        &mut self,
        kind: ContainerKind,
        contents: &[BlueprintNode],
        shares: [f32; N],
    ) -> ChunkResult<BlueprintNode> {
        let container = self.new_node("container");
        let contents = contents.iter().map(|node| IncludedContent(node.path.as_str().into()));
        let mut blueprint = ContainerBlueprint::new(kind).with_contents(contents);
        if kind == ContainerKind::Horizontal {
            blueprint = blueprint.with_col_shares(shares.map(|share| ColumnShare(Float32(share))));
        } else if N > 0 {
            blueprint = blueprint.with_row_shares(shares.map(|share| RowShare(Float32(share))));
        }
        self.log(&container.path, &blueprint)?;
        Ok(container)
    }
}
