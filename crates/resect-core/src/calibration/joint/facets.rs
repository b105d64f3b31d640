//! Errors of prisms that repeat with the incidence, block by block.
//!
//! An error that repeats does not average out where a vehicle drives to and fro. It is not estimated but considered: a linear function of the
//! states changes by `Sᵀ H ε_F` for an error `ε_F` of the sights (Schmidt 1966, "Application of state-space methods to navigation
//! problems"). S is the solution for its Jacobian, and H the normal matrix of the data. `ε_F` is a Fourier series of the incidence, the
//! azimuth of a station in the frame of the rig. The search for steps takes the means of blocks, the covariance each reading
//! ([`super::facet_covariance`]).

use nalgebra::{DVector, Vector3};

use super::chain::ChainVector;
use super::drive::{Drive, Segment};
use super::state_vector::{Layout, StateVector};
use super::station_model::StationModel;
use crate::network::{Number, PerStation, Station};

/// Root mean squares of errors that repeat with the incidence: along the sight, across it and upward (m). Measured: on the
/// published drives.
pub const FACETS_M: [f64; 3] = [0.001, 0.0005, 0.0005];
/// Orders of the Fourier series of the incidence. Field: 360° prisms have six to eight facets.
pub const ORDERS: [f64; 3] = [6.0, 7.0, 8.0];
/// Instants of a block at which the incidence is taken.
const INSTANTS: usize = 8;

/// Cosine and sine of the incidence on a station's prism by order, as means over a block.
pub type IncidenceTerms = [[f64; 2]; ORDERS.len()];

/// Effects on a linear function of the states by one σ of each coefficient of the errors; `information` is H S for it.
pub fn facet_effects(
    drive: &Drive,
    terms: &[PerStation<IncidenceTerms>],
    information: &ChainVector,
) -> DVector<f64> {
    let layout = &drive.layout;
    let mut effects = Vec::new();
    for station in (0..layout.stations()).map(Station::at) {
        for (row, rms_m) in slow_errors(layout, station).into_iter().zip(FACETS_M) {
            let sigma_m = rms_m / (ORDERS.len() as f64).sqrt();
            for term in 0..2 * ORDERS.len() {
                let of_block = |block: usize| terms[block][station].as_flattened()[term];
                let slow = information.slow.iter().enumerate();
                effects.push(
                    slow.map(|(block, slow)| slow[row] * (sigma_m * of_block(block))).sum::<f64>(),
                );
            }
        }
    }
    effects.into()
}

/// Indices of a station's slow errors along the sight, across it and upward.
fn slow_errors(layout: &Layout, station: Station) -> [usize; 3] {
    let across = layout.slow_across() + 2 * station.index();
    [layout.slow_ranges() + station.index(), across, across + 1]
}

/// The terms of all blocks by station.
pub fn incidence_terms(drive: &Drive, state: &StateVector) -> Vec<PerStation<IncidenceTerms>> {
    let stations = StationModel::all(&drive.layout, &state.constants).into_iter();
    let stations_m: PerStation<Vector3<f64>> = stations.map(|model| model.position_m).collect();
    let mut terms = Vec::new();
    for (segment, coefficients_m) in drive.segments.iter().zip(&state.coefficients_m) {
        for block in 0..segment.grid.blocks {
            terms.push(of_block(segment, coefficients_m, block, &stations_m));
        }
    }
    terms
}

fn of_block(
    segment: &Segment,
    coefficients_m: &[f64],
    block: usize,
    stations_m: &PerStation<Vector3<f64>>,
) -> PerStation<IncidenceTerms> {
    let (grid, local) = (&segment.grid, segment.prisms.coordinates());
    let block_s = (grid.end_s - grid.start_s) / grid.blocks as f64;
    let mut terms = stations_m.map(|_| IncidenceTerms::default());
    // A single prism has no axis.
    if segment.prisms.count() < 2 {
        return terms;
    }
    for instant in 0..INSTANTS {
        let along = (instant as f64 + 0.5) / INSTANTS as f64;
        let weights = grid.weights(grid.start_s + (block as f64 + along) * block_s);
        let prism_m = |prism: usize| -> Vector3<f64> {
            let at = |knot: usize| {
                let first = local * (weights.first + knot) + 3 * prism;
                Vector3::from_column_slice(&coefficients_m[first..first + 3])
            };
            (0..4).map(|knot| at(knot) * weights.position[knot]).sum()
        };
        let axis = prism_m(1) - prism_m(0);
        for (station, station_m) in stations_m.each() {
            let Some(prism) = segment.prisms.of_station[station] else { continue };
            let incidence_rad = incidence_rad(&(station_m - prism_m(prism)), &axis);
            for (term, order) in terms[station].iter_mut().zip(ORDERS) {
                let (sin, cos) = (order * incidence_rad).sin_cos();
                term[0] += cos / INSTANTS as f64;
                term[1] += sin / INSTANTS as f64;
            }
        }
    }
    terms
}

/// Azimuth in the frame of the rig of the direction to a station, by an axis of the rig (rad).
pub fn incidence_rad(to_station_m: &Vector3<f64>, axis: &Vector3<f64>) -> f64 {
    to_station_m.y.atan2(to_station_m.x) - axis.y.atan2(axis.x)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::knot_grid::segment_grids;
    use super::super::segment_prisms::SegmentPrisms;
    use super::super::spans::Span;
    use super::super::state_vector::Constants;
    use super::super::state_vector::tests::layout;
    use super::*;

    /// Variance of the first pose by errors of station 1's ranges (m²), each of which moves it by the same amount in every block, for
    /// a rig that turns at this rate; and the number of blocks.
    fn variance_m2(rate_rad_per_s: f64) -> (f64, usize) {
        let span = Span { start_s: 0.0, end_s: 39.9, prisms: vec![0, 1, 2] };
        let grid = segment_grids(&span, 0.4, 6.0).remove(0);
        let rig_m = |angle_rad: f64| {
            let at = |angle_rad: f64| [20.0 + angle_rad.cos(), 5.0 + angle_rad.sin(), 1.0];
            [0.0, 2.1, 4.2].map(|beyond_rad| at(angle_rad + beyond_rad))
        };
        let coefficients_m =
            (0..grid.knots).flat_map(|knot| rig_m(rate_rad_per_s * grid.knot_time_s(knot)));
        let coefficients_m: Vec<f64> = coefficients_m.flatten().collect();
        let blocks = grid.blocks;
        let layout = layout(3);
        let mut drive = Drive {
            layout: layout.clone(),
            segments: Vec::new(),
            mean_sights: Vec::new(),
            block_times_s: Vec::new(),
            coupled_to_next: Vec::new(),
            spans_s: Vec::new(),
            excess_jerk: Arc::default(),
        };
        let prisms = Arc::new(SegmentPrisms::new(&layout, layout.followed_at(0.0), &span.prisms));
        let (readings, excess_jerks, middle_s) = (Default::default(), Vec::new(), 0.0);
        drive.segments.push(Segment { grid, prisms, readings, excess_jerks, middle_s });
        let state = StateVector {
            constants: Constants::zeros(layout.constants),
            slow: Vec::new(),
            coefficients_m: vec![coefficients_m],
        };
        let mut information = ChainVector::zeros(&layout, blocks);
        information.slow.iter_mut().for_each(|slow| slow[layout.slow_ranges()] = 1.0);
        let effects = facet_effects(&drive, &incidence_terms(&drive, &state), &information);
        (effects.norm_squared(), blocks)
    }

    #[test]
    fn errors_of_a_rig_that_keeps_its_heading_add_up_and_those_of_one_that_turns_cancel() {
        let (standing_m2, blocks) = variance_m2(0.0);
        let expected_m2 = (blocks as f64 * FACETS_M[0]).powi(2);
        assert!((standing_m2 / expected_m2 - 1.0).abs() < 1e-9, "{standing_m2} m²");
        let (turning_m2, _) = variance_m2(0.3);
        assert!(turning_m2 < 0.1 * standing_m2, "{turning_m2} m² of {standing_m2} m²");
    }
}
