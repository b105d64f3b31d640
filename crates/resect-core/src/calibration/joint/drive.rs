//! The readings of a drive by segment, and the mean sights of its blocks.

use super::knot_grid::{KnotGrid, segment_grids};
use super::segment_prisms::SegmentPrisms;
use super::sight::Sight;
use super::state_vector::{Constants, Layout, Slow, StateVector};
use super::station_model::{MeanSight, StationModel};
use crate::network::{Number, PerStation, Prism};
use crate::pipeline::Triplets;
use crate::statistics::median;
use nalgebra::Vector3;
use std::sync::Arc;

/// Lengths of a block that are tried (s): longer ones where the data determines a direction so weakly that six seconds leave the
/// normal matrix singular, at last the whole segment.
pub const BLOCK_LENGTHS_S: [f64; 3] = [6.0, 30.0, f64::INFINITY];
/// Rows of this many knots are stored (21 MB; half an hour of a usual drive). Those of longer drives are computed twice for each
/// step, which nearly doubles its time and needs memory for one segment a thread.
const MOST_STORED_KNOTS: usize = 4096;

/// One reading of one station, in its own frame. Its [`Sight`] is computed when it is needed: long drives have millions of readings.
#[derive(Clone, Debug)]
pub struct Reading {
    pub time_s: f64,
    pub point_m: Vector3<f64>,
}

impl Reading {
    pub fn sight(&self) -> Sight {
        Sight::to(&self.point_m)
    }
}

/// An unbroken span of a drive with its readings by station.
#[derive(Clone, Debug)]
pub struct Segment {
    pub grid: KnotGrid,
    pub prisms: Arc<SegmentPrisms>,
    pub readings: PerStation<Vec<Reading>>,
    /// Middle of the drive (s), from which clock drifts count.
    pub middle_s: f64,
}

/// The readings of a drive by segment, and what its blocks have in common.
#[derive(Clone, Debug)]
pub struct Drive {
    pub layout: Arc<Layout>,
    pub segments: Vec<Segment>,
    /// Mean sights of the stations, by block over all segments.
    pub mean_sights: Vec<PerStation<MeanSight>>,
    pub block_times_s: Vec<f64>,
    /// True for a block whose next block belongs to the same segment.
    pub coupled_to_next: Vec<bool>,
    /// Start and end of each drive (s), where several are solved together.
    pub spans_s: Vec<[f64; 2]>,
}

impl Drive {
    /// Segments with blocks of about `block_s`; `None` without a segment that all stations observe.
    pub fn new(layout: &Arc<Layout>, triplets: &Triplets, block_s: f64) -> Option<Self> {
        let knot_s =
            triplets.readings.iter().map(|track| median_step_s(&track.time_s)).fold(0.0, f64::max);
        if !(0.01..=2.0).contains(&knot_s) {
            return None;
        }
        let mut drive = Self {
            layout: Arc::clone(layout),
            segments: Vec::new(),
            mean_sights: Vec::new(),
            block_times_s: Vec::new(),
            coupled_to_next: Vec::new(),
            spans_s: spans_s(triplets),
        };
        let mut last: Option<(&PerStation<Prism>, Arc<SegmentPrisms>)> = None;
        for grid in segment_grids(&triplets.time_s, &triplets.interval, knot_s, block_s) {
            let readings = triplets.readings.map(|track| {
                let from = track.time_s.partition_point(|t| *t < grid.start_s);
                let to = track.time_s.partition_point(|t| *t <= grid.end_s);
                let both = track.time_s[from..to].iter().zip(&track.position_m[from..to]);
                both.map(|(time_s, point_m)| Reading { time_s: *time_s, point_m: *point_m })
                    .collect::<Vec<_>>()
            });
            if readings.iter().any(Vec::is_empty) {
                continue;
            }
            let followed = layout.followed_at(grid.start_s);
            let prisms = match &last {
                Some((known, prisms)) if *known == followed => Arc::clone(prisms),
                _ => Arc::new(SegmentPrisms::new(layout, followed)),
            };
            last = Some((followed, Arc::clone(&prisms)));
            for block in 0..grid.blocks {
                drive.mean_sights.push(readings.map(|readings| {
                    let of_block = readings.iter().filter(|r| grid.block_at(r.time_s) == block);
                    let all = readings.iter().map(Reading::sight);
                    MeanSight::of(layout, of_block.map(Reading::sight))
                        .or_else(|| MeanSight::of(layout, all))
                        .unwrap_or_default()
                }));
                drive.block_times_s.push(grid.block_time_s(block));
                drive.coupled_to_next.push(block + 1 < grid.blocks);
            }
            let middle_s = drive.middle_s(grid.start_s);
            drive.segments.push(Segment { grid, prisms, readings, middle_s });
        }
        (!drive.segments.is_empty()).then_some(drive)
    }

    /// Knots of all segments.
    pub fn knots(&self) -> usize {
        self.segments.iter().map(|segment| segment.grid.knots).sum()
    }

    /// Number of segments, from the first on, whose rows are stored from step to step.
    pub fn stored_segments(&self) -> usize {
        let mut knots = 0;
        let fits = |segment: &&Segment| {
            knots += segment.grid.knots;
            knots <= MOST_STORED_KNOTS
        };
        self.segments.iter().take_while(fits).count()
    }

    /// Evenly spaced segments of the drive that together have about `knots` knots.
    pub fn sample(&self, knots: usize) -> Self {
        let stride = (self.knots() / knots).max(1);
        let first_blocks = self.first_blocks();
        let taken: Vec<usize> = (stride / 2..self.segments.len()).step_by(stride).collect();
        let blocks =
            || taken.iter().flat_map(|index| first_blocks[*index]..first_blocks[*index + 1]);
        Self {
            layout: Arc::clone(&self.layout),
            segments: taken.iter().map(|index| self.segments[*index].clone()).collect(),
            mean_sights: blocks().map(|block| self.mean_sights[block].clone()).collect(),
            block_times_s: blocks().map(|block| self.block_times_s[block]).collect(),
            coupled_to_next: blocks().map(|block| self.coupled_to_next[block]).collect(),
            spans_s: self.spans_s.clone(),
        }
    }

    /// Middle of the drive that an instant is in (s).
    pub fn middle_s(&self, time_s: f64) -> f64 {
        let drive = self.spans_s.iter().rfind(|[from_s, _]| *from_s <= time_s);
        drive.or(self.spans_s.first()).map_or(0.0, |[from_s, to_s]| 0.5 * (from_s + to_s))
    }

    /// The first block of each segment, and the number of all blocks.
    pub fn first_blocks(&self) -> Vec<usize> {
        let mut first = vec![0];
        for segment in &self.segments {
            first.push(first[first.len() - 1] + segment.grid.blocks);
        }
        first
    }

    /// The state in which the iteration starts: splines through the triplets, and slow states of zero.
    pub fn initial_state(&self, triplets: &Triplets, constants: &Constants) -> StateVector {
        StateVector {
            constants: constants.clone(),
            slow: vec![Slow::zeros(self.layout.slow()); self.mean_sights.len()],
            coefficients_m: self.coefficients_m(triplets, constants),
        }
    }

    /// Coefficients of splines through the triplets (m), by segment.
    fn coefficients_m(&self, triplets: &Triplets, constants: &Constants) -> Vec<Vec<f64>> {
        let stations = StationModel::all(&self.layout, constants);
        let of_segment = |segment: &Segment| {
            let Segment { grid, prisms, .. } = segment;
            let followers = (0..prisms.count()).filter_map(|prism| prisms.follower(prism));
            let followers: Vec<_> = followers.collect();
            let mut coefficients_m = Vec::with_capacity(grid.knots * 3 * followers.len());
            for knot in 0..grid.knots {
                let time_s = grid.knot_time_s(knot).clamp(grid.start_s, grid.end_s);
                let after = triplets.time_s.partition_point(|t| *t < time_s);
                let index = after.min(triplets.len() - 1);
                for station in &followers {
                    let own_m = triplets.points_m[*station][index];
                    let model = &stations[station.index()];
                    coefficients_m.extend((model.rotation * own_m + model.position_m).iter());
                }
            }
            coefficients_m
        };
        self.segments.iter().map(of_segment).collect()
    }
}

/// Start and end of each drive (s).
fn spans_s(triplets: &Triplets) -> Vec<[f64; 2]> {
    let mut cuts: Vec<usize> = triplets
        .restarts_s
        .iter()
        .map(|restart_s| triplets.time_s.partition_point(|time_s| time_s < restart_s))
        .collect();
    cuts.insert(0, 0);
    cuts.push(triplets.len());
    let spans = cuts.windows(2).filter_map(|cut| triplets.time_s.get(cut[0]..cut[1]));
    spans.filter_map(|times_s| Some([*times_s.first()?, *times_s.last()?])).collect()
}

/// Median time between consecutive instants (s).
fn median_step_s(time_s: &[f64]) -> f64 {
    median(time_s.windows(2).map(|w| w[1] - w[0])).unwrap_or(f64::NAN)
}
