//! Updates of the scene after changes of the state.

use std::sync::Arc;

use super::SceneContent;
use super::trail::Trail;
use super::view::{Built, SceneView};
use crate::app::model::{OpenDeployment, View, ViewPreset};
use crate::app::prepared::time_origin_s;
use crate::app::prepared::way::Way;
use crate::app::state::State;
use crate::app::theme;
use resect_core::analysis::Analysis;
use resect_core::network::Number;
use resect_tools::estimates::EstimatesJudgement;

impl SceneView {
    /// Rebuilds the content whose state has changed.
    pub(super) fn refresh(&mut self, ui: &egui::Ui, state: &State, view: &mut View) {
        let dark = ui.visuals().dark_mode;
        let Some((open, analysis)) = state.analysed() else {
            if self.built.take().is_some() {
                self.content = SceneContent::default();
                (self.coloured, self.cursor, self.hover) = (None, None, None);
                (self.judgement, self.tube, self.beside) = (None, None, None);
            }
            return;
        };
        let rebuilt = self.refresh_tracks(state, (open, analysis), view, dark);
        self.refresh_overlays(state, open);
        self.refresh_advised(state, open, analysis);
        self.refresh_times(state, (open, analysis), dark, rebuilt);
    }

    /// Updates the tracks, the residuals and their colours; returns true if they were rebuilt.
    fn refresh_tracks(
        &mut self,
        state: &State,
        (open, analysis): (&OpenDeployment, &Analysis),
        view: &mut View,
        dark: bool,
    ) -> bool {
        let run = open.analysis_run;
        let wanted = Built {
            deployment: open.id,
            analysis: run,
            visibility: state.scene.visibility,
            scales: (state.scene.options.ellipsoid_scale, state.scene.options.residual_scale),
            dark,
        };
        let rebuilt = self.built.as_ref() != Some(&wanted);
        if rebuilt {
            let before = self.built.as_ref().map(|built| built.deployment);
            if before != Some(open.id) {
                view.look(ViewPreset::Slanted);
                view.flight = None;
            }
            if let Some(look) = view.last_look.filter(|look| look.early) {
                view.look_again(look);
            }
            self.content.set_clouds(&open.clouds);
            let (visibility, options) = (&state.scene.visibility, &state.scene.options);
            self.content.rebuild(&open.deployment, analysis, visibility, options);
            self.built = Some(wanted);
        }
        let wanted = Some((open.id, run, state.scene.colouring));
        if self.coloured != wanted {
            self.content.colour(&open.deployment, analysis, state.scene.colouring);
            self.coloured = wanted;
        }
        rebuilt
    }

    /// Updates the tube of the vehicle's uncertainty, the tracks of other runs, and trajectories of other systems.
    fn refresh_overlays(&mut self, state: &State, open: &OpenDeployment) {
        let way = open.way.newest.clone().filter(|_| state.scene.visibility.tube);
        let wanted = way.map(|way| (way, state.scene.options.ellipsoid_scale));
        let of = |tube: &Option<(Arc<Way>, u32)>| {
            tube.as_ref().map(|(way, scale)| (Arc::as_ptr(way), *scale))
        };
        if of(&self.tube) != of(&wanted) {
            let way = wanted.as_ref().map(|(way, _)| &**way);
            self.content.set_tube(way, f64::from(state.scene.options.ellipsoid_scale));
            self.tube = wanted;
        }
        let wanted = open.beside.newest.clone().filter(|_| state.scene.visibility.runs_beside);
        if self.beside.as_ref().map(Arc::as_ptr) != wanted.as_ref().map(Arc::as_ptr) {
            self.content.set_beside(wanted.as_ref().map_or(&[], |runs| runs));
            self.beside = wanted;
        }
        let wanted =
            open.judging.judgement.newest.clone().filter(|_| state.scene.visibility.estimates);
        let wanted = wanted.map(|judgement| (open.judging.drawn(&judgement), judgement));
        let of = |drawn: &Option<(Vec<Option<usize>>, Arc<EstimatesJudgement>)>| {
            drawn.as_ref().map(|(colours, judgement)| (colours.clone(), Arc::as_ptr(judgement)))
        };
        if of(&self.judgement) != of(&wanted) {
            let drawn = wanted.iter().flat_map(|(colours, judgement)| {
                let each = colours.iter().zip(&judgement.judged);
                each.filter_map(|(colour, judged)| Some(((*colour)?, judged)))
            });
            self.content.set_estimates(&drawn.collect::<Vec<_>>());
            self.judgement = wanted;
        }
    }

    /// Updates the advised move of a live drive.
    fn refresh_advised(&mut self, state: &State, open: &OpenDeployment, analysis: &Analysis) {
        let live = state.live.view.as_deref().filter(|_| state.live.id == Some(open.id));
        let best = live.and_then(|view| view.moves.first());
        let wanted =
            (best.map_or_else(Vec::new, |best| best.waypoints_m.clone()), open.analysis_run);
        if self.advised != wanted {
            let last_m = analysis.triplets().points_m[0].last();
            self.content.set_advised(&wanted.0, last_m.map_or(0.0, |last_m| last_m.z));
            self.advised = wanted;
        }
    }

    /// Updates the selection, the trail, the cursor, the hovered instant and the ruler.
    fn refresh_times(
        &mut self,
        state: &State,
        (open, analysis): (&OpenDeployment, &Analysis),
        dark: bool,
        rebuilt: bool,
    ) {
        let run = open.analysis_run;
        let origin_s = time_origin_s(&open.deployment);
        self.content.set_selection(open.timeline.selection_s, origin_s);
        let cursor_s = open.timeline.cursor_s;
        // The trail is independent of the visibility of the tracks themselves.
        let trailing = self.content.station1_from_tracks.map_each(|station, transform| {
            state.scene.visibility.stations[station.index()] && transform.is_some()
        });
        let length_s = state.scene.options.trail_s;
        let trail_end_s = cursor_s.filter(|_| length_s > 0).map(|time_s| time_s - origin_s);
        self.content.trail = trail_end_s.map_or_else(Trail::default, |time_s| {
            Trail::behind(time_s, length_s, &self.content.clouds.tracks, &trailing)
        });
        let colour = theme::cursor(dark);
        let wanted = cursor_s.map(|time_s| (run, time_s));
        if rebuilt || self.cursor != wanted {
            self.content.set_cursor(&open.deployment, analysis, cursor_s, colour);
            self.cursor = wanted;
        }
        let instant = |time_s: Option<f64>| time_s.and_then(|t| analysis.triplets().nearest(t));
        // At the cursor itself there is a triangle already.
        let at = instant(state.time.hover_s).filter(|hovered| Some(*hovered) != instant(cursor_s));
        let wanted = at.map(|instant| (run, instant));
        if rebuilt || self.hover != wanted {
            self.content.set_hover(analysis, at, colour);
            self.hover = wanted;
        }
        self.content.set_ruler(&state.scene.ruler, colour);
    }
}
