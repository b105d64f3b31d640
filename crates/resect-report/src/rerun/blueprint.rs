//! How the Rerun viewer opens a recording: scene, distance errors, rates and verdict, each where one looks for it.

use re_chunk::ChunkResult;
use re_log_types::{TimePoint, Timeline};
use re_sdk_types::AsComponents;
use re_sdk_types::blueprint::archetypes::{
    ContainerBlueprint, PanelBlueprint, TimePanelBlueprint, ViewBlueprint, ViewContents,
    ViewportBlueprint,
};
use re_sdk_types::blueprint::components::{
    ColumnShare, ContainerKind, IncludedContent, PanelState, QueryExpression, RootContainer,
    RowShare, ViewClass,
};
use re_sdk_types::components::Name;
use re_sdk_types::datatypes::{Float32, Uuid};

use super::chunks::Chunks;

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

/// Range, azimuth and zenith angle, in the order of [`resect_core::pipeline::outlier_filter::Rates`].
pub const RATES: [RateView; 3] = [
    RateView { entity: "rates/range_m_per_s", title: "range rate (m/s)" },
    RateView { entity: "rates/azimuth_deg_per_s", title: "azimuth rate (°/s)" },
    RateView { entity: "rates/zenith_deg_per_s", title: "zenith rate (°/s)" },
];

/// The scene over the distance errors on the left, the verdict over the rates on the right.
///
/// Written out, because the SDK's own layouts have names by chance.
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

/// A view or a container of views that was logged.
struct Placed {
    id: u128,
    path: String,
}

#[derive(Default)]
struct Layout {
    chunks: Chunks,
    placed: u128,
}

impl Layout {
    fn log(&mut self, path: &str, what: &dyn AsComponents) -> ChunkResult<()> {
        // Layouts have a time of their own, by which the viewer undoes what is done to them.
        let at = TimePoint::default().with(Timeline::new_sequence("blueprint"), 0);
        self.chunks.log(path, at, what)
    }

    fn place(&mut self, kind: &str) -> Placed {
        self.placed += 1;
        let id = 0x7e5e_c700_0000_4000_8000_0000_0000_0000 + self.placed;
        let digits = format!("{id:032x}");
        let parts = [&digits[..8], &digits[8..12], &digits[12..16], &digits[16..20], &digits[20..]];
        Placed { id, path: format!("{kind}/{}", parts.join("-")) }
    }

    fn view(
        &mut self,
        class: &str,
        name: &str,
        origin: &str,
        contents: Vec<String>,
    ) -> ChunkResult<Placed> {
        let view = self.place("view");
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
        contents: &[Placed],
        shares: [f32; N],
    ) -> ChunkResult<Placed> {
        let container = self.place("container");
        let contents = contents.iter().map(|placed| IncludedContent(placed.path.as_str().into()));
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
