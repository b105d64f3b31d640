//! Linearisation and elimination of single segments at a state.

use std::ops::Range;

use super::block_jacobians::BlockJacobians;
use super::drive::{Drive, Segment};
use super::equations::{
    BlockUnknowns, ResidualSquares, RobustWeights, SegmentEquations, SegmentWeighting, equations,
};
use super::motion_band::Rows;
use super::residuals::{LinearisationPoint, NoiseLevels};
use super::state_vector::{BlockVector, StateVector};
use super::station_model::StationModel;
use super::unknown::DISTANCE;

/// Noise levels and robust weights of all equations.
#[derive(Clone, Debug)]
pub struct Weighting {
    pub levels: NoiseLevels,
    /// Mean redundancy number of a reading.
    pub redundancy: f64,
    /// Fixed robust weights by segment; `None` while they are re-estimated.
    pub fixed: Option<Vec<RobustWeights>>,
    /// Squared residuals of the step that fixed the weights; zeros before.
    pub squares: ResidualSquares,
}

impl Weighting {
    /// The weighting of one segment of the drive.
    pub fn of_segment(&self, index: usize) -> SegmentWeighting<'_> {
        self.with_fixed(self.fixed.as_ref().map(|fixed| &fixed[index]))
    }

    /// The weighting of any segment, with these robust weights.
    pub fn with_fixed<'a>(&self, fixed: Option<&'a RobustWeights>) -> SegmentWeighting<'a> {
        SegmentWeighting { levels: self.levels, redundancy: self.redundancy, fixed }
    }
}

/// Linearises a segment and eliminates its motion; `None` if its normal matrix is not positive definite. Reuses the memory of `rows`.
pub fn eliminate_motion(
    segment: &Segment,
    point: &LinearisationPoint<'_>,
    weighting: &SegmentWeighting<'_>,
    unknowns: BlockUnknowns<'_>,
    rows: Rows,
) -> Option<SegmentEquations> {
    let mut eliminated = equations(segment, point, weighting, unknowns, rows);
    let is_definite = eliminated.band.eliminate();
    eliminated.squares.absorbed = eliminated.band.absorbed;
    is_definite.then_some(eliminated)
}

/// The state of a whole drive, from which each segment takes its linearisation point.
pub struct Linearisation<'a> {
    pub drive: &'a Drive,
    pub state: &'a StateVector,
    stations: Vec<StationModel>,
    distances_m: Vec<f64>,
    slow: Vec<BlockVector>,
    pub first_blocks: Vec<usize>,
}

impl<'a> Linearisation<'a> {
    pub fn new(state: &'a StateVector, jacobians: &'a BlockJacobians) -> Self {
        let drive = jacobians.drive();
        let (layout, blocks) = (&drive.layout, state.slow.iter().enumerate());
        Self {
            drive,
            state,
            stations: StationModel::all(layout, &state.constants),
            distances_m: layout.indices(&DISTANCE).map(|index| state.constants[index]).collect(),
            // (3), (5)
            slow: blocks.map(|(block, slow)| jacobians.of_block(block).1 * slow).collect(),
            first_blocks: drive.first_blocks(),
        }
    }

    /// A segment with its linearisation point.
    pub fn segment(&self, index: usize) -> (&Segment, LinearisationPoint<'_>) {
        self.segment_with(index, &self.state.coefficients_m[index])
    }

    /// A segment with its linearisation point at other coefficients (m).
    pub fn segment_with<'b>(
        &'b self,
        index: usize,
        coefficients_m: &'b [f64],
    ) -> (&'b Segment, LinearisationPoint<'b>) {
        let segment = &self.drive.segments[index];
        let point = self.point(segment, self.blocks(index), coefficients_m);
        (segment, point)
    }

    /// The blocks of a segment.
    pub fn blocks(&self, index: usize) -> Range<usize> {
        self.first_blocks[index]..self.first_blocks[index + 1]
    }

    /// The linearisation point of any segment, whose blocks are these of the drive.
    pub fn point<'b>(
        &'b self,
        segment: &'b Segment,
        blocks: Range<usize>,
        coefficients_m: &'b [f64],
    ) -> LinearisationPoint<'b> {
        LinearisationPoint {
            layout: &self.drive.layout,
            prisms: &segment.prisms,
            stations: &self.stations,
            distances_m: &self.distances_m,
            middle_s: segment.middle_s,
            slow: &self.slow[blocks],
            coefficients_m,
        }
    }
}
