//! The readings of a drive by segment, and the mean sights of its blocks.

use super::excess_jerk::{ExcessJerk, JerkVariance};
use super::knot_grid::{FEWEST_KNOTS, KnotGrid, segment_grids};
use super::readings::{DriveReadings, Reading, ReadingSpan, median_step_s};
use super::segment_prisms::SegmentPrisms;
use super::spans::spans;
use super::state_vector::{Constants, Layout, Slow, StateVector};
use super::station_model::{MeanSight, StationModel};
use crate::network::{Number, PerStation};
use crate::statistics::median;
use nalgebra::Vector3;
use std::sync::Arc;

/// Lengths of a block that are tried (s): longer ones where the data determines a direction so weakly that six seconds leave the
/// normal matrix singular, at last the whole segment.
pub const BLOCK_LENGTHS_S: [f64; 3] = [6.0, 30.0, f64::INFINITY];
/// Least time between knots (s): a vehicle moves smoothly for so long.
/// Effect: with knots at 20 Hz, noise of the vehicle's tilts counts as information on heights. Simulated: 10 % of the answers are not good then, and errors
/// of heights are twice as large; with this time 1 %.
const LEAST_KNOT_S: f64 = 0.1;
/// Rows of this many knots are stored (21 MB; half an hour of a usual drive). Those of longer drives are computed twice for each
/// step, which nearly doubles its time and needs memory for one segment a thread.
const MOST_STORED_KNOTS: usize = 4096;

/// An unbroken span of a drive with its readings by station.
#[derive(Clone, Debug)]
pub struct Segment {
    pub grid: KnotGrid,
    pub prisms: Arc<SegmentPrisms>,
    pub readings: PerStation<ReadingSpan>,
    /// Variance of the jerks beyond that of the whole drive, in the order of the jerks.
    pub excess_jerks: Vec<JerkVariance>,
    /// Middle of the drive (s), from which clock drifts count.
    pub middle_s: f64,
}

impl Segment {
    /// Readings of a prism by each station that follows it, by its place in the segment.
    fn readings_of(&self, prism: usize) -> impl Iterator<Item = &ReadingSpan> {
        let all = self.readings.iter().zip(&self.prisms.of_station);
        all.filter(move |(_, followed)| **followed == Some(prism)).map(|(readings, _)| readings)
    }

    /// Times of the first and of the last reading of a prism (s), by its place in the segment; `None` without readings.
    pub fn read_span_s(&self, prism: usize) -> Option<[f64; 2]> {
        let ends_s =
            |readings: &ReadingSpan| Some([readings.first()?.time_s, readings.last()?.time_s]);
        let all = self.readings_of(prism).filter_map(ends_s);
        all.reduce(|[from_s, to_s], [first_s, last_s]| [from_s.min(first_s), to_s.max(last_s)])
    }

    /// Time from an instant to the nearest reading of a prism (s), by its place in the segment.
    pub fn to_reading_s(&self, prism: usize, time_s: f64) -> f64 {
        let nearest_s = self.readings_of(prism).flat_map(|readings| {
            let next = readings.partition_point(|reading| reading.time_s < time_s);
            let around = &readings[next.saturating_sub(1)..readings.len().min(next + 1)];
            around.iter().map(|reading| (reading.time_s - time_s).abs())
        });
        nearest_s.fold(f64::INFINITY, f64::min)
    }
}

/// The readings of a drive by segment, and what its blocks have in common.
#[derive(Clone, Debug)]
pub struct Drive {
    pub layout: Arc<Layout>,
    pub segments: Vec<Segment>,
    /// Mean sights of the stations, by block over all segments; `None` for a station without readings in the segment.
    pub mean_sights: Vec<PerStation<Option<MeanSight>>>,
    pub block_times_s: Vec<f64>,
    /// True for a block whose next block belongs to the same segment.
    pub coupled_to_next: Vec<bool>,
    /// Start and end of each drive (s), where several are solved together.
    pub spans_s: Vec<[f64; 2]>,
    pub excess_jerk: Arc<ExcessJerk>,
}

impl Drive {
    /// Segments with blocks of about `block_s`; `None` without a segment.
    pub fn new(layout: &Arc<Layout>, readings: &DriveReadings, block_s: f64) -> Option<Self> {
        let step_s =
            |track: &Arc<Vec<Reading>>| median_step_s(track.iter().map(|reading| reading.time_s));
        let knot_s = readings.tracks.iter().map(step_s).fold(0.0, f64::max);
        if !(0.01..=2.0).contains(&knot_s) {
            return None;
        }
        let knot_s = knot_s.max(LEAST_KNOT_S);
        let mut drive = Self {
            layout: Arc::clone(layout),
            segments: Vec::new(),
            mean_sights: Vec::new(),
            block_times_s: Vec::new(),
            coupled_to_next: Vec::new(),
            spans_s: readings.spans_s(),
            excess_jerk: Arc::new(ExcessJerk::new(&readings.tracks)),
        };
        for span in spans(layout, readings, FEWEST_KNOTS * knot_s) {
            let followed = layout.followed_at(span.start_s);
            let prisms = Arc::new(SegmentPrisms::new(layout, followed, &span.prisms));
            for grid in segment_grids(&span, knot_s, block_s) {
                drive.add_segment(grid, &prisms, readings);
            }
        }
        (!drive.segments.is_empty()).then_some(drive)
    }

    fn add_segment(&mut self, grid: KnotGrid, prisms: &Arc<SegmentPrisms>, all: &DriveReadings) {
        let layout = &self.layout;
        let readings = all.tracks.zip(&prisms.of_station, |track, prism| match prism {
            Some(_) => ReadingSpan::between(track, grid.start_s, grid.end_s),
            None => Vec::new().into(),
        });
        for block in 0..grid.blocks {
            self.mean_sights.push(readings.map(|readings| {
                let of_block = readings.iter().filter(|r| grid.block_at(r.time_s) == block);
                let all = readings.iter().map(Reading::sight);
                MeanSight::of(layout, of_block.map(Reading::sight))
                    .or_else(|| MeanSight::of(layout, all))
            }));
            self.block_times_s.push(grid.block_time_s(block));
            self.coupled_to_next.push(block + 1 < grid.blocks);
        }
        let (middle_s, prisms) = (self.middle_s(grid.start_s), Arc::clone(prisms));
        let excess_jerks = self.excess_jerks(&grid);
        self.segments.push(Segment { grid, prisms, readings, excess_jerks, middle_s });
    }

    /// Variance of the jerks of a grid beyond that of the whole drive.
    pub fn excess_jerks(&self, grid: &KnotGrid) -> Vec<JerkVariance> {
        let at = |first: usize| self.excess_jerk.variance(grid.jerk_time_s(first), grid.knot_s);
        (0..grid.jerks()).map(at).collect()
    }

    /// Usual time between knots (s).
    pub fn knot_s(&self) -> f64 {
        median(self.segments.iter().map(|segment| segment.grid.knot_s)).unwrap_or(1.0)
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
            excess_jerk: Arc::clone(&self.excess_jerk),
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

    /// The state in which the iteration starts: splines through the readings, and slow states of zero.
    pub fn initial_state(&self, constants: &Constants) -> StateVector {
        StateVector {
            constants: constants.clone(),
            slow: vec![Slow::zeros(self.layout.slow()); self.mean_sights.len()],
            coefficients_m: self.coefficients_m(constants),
        }
    }

    /// Coefficients of splines through the readings (m), by segment.
    fn coefficients_m(&self, constants: &Constants) -> Vec<Vec<f64>> {
        let stations = StationModel::all(&self.layout, constants);
        let of_segment = |segment: &Segment| {
            let Segment { grid, prisms, readings, .. } = segment;
            let mut coefficients_m = Vec::with_capacity(grid.knots * prisms.coordinates());
            for knot in 0..grid.knots {
                let time_s = grid.knot_time_s(knot).clamp(grid.start_s, grid.end_s);
                for prism in 0..prisms.count() {
                    // The station whose readings are nearest in time.
                    let followers = readings.each().zip(&prisms.of_station);
                    let followers = followers.filter(|(_, followed)| **followed == Some(prism));
                    let read = followers.filter_map(|((station, readings), _)| {
                        let (point_m, apart_s) = interpolated(readings, time_s)?;
                        let model = &stations[station.index()];
                        Some((model.rotation * point_m + model.position_m, apart_s))
                    });
                    let nearest = read.min_by(|(_, a_s), (_, b_s)| a_s.total_cmp(b_s));
                    coefficients_m.extend(nearest.unwrap_or_default().0.iter());
                }
            }
            coefficients_m
        };
        self.segments.iter().map(of_segment).collect()
    }
}

/// Returns the point of a station's readings at an instant (m), and the time between the readings that it is interpolated from (s). Beyond
/// the first and the last reading it is theirs.
fn interpolated(readings: &[Reading], time_s: f64) -> Option<(Vector3<f64>, f64)> {
    let after = readings.partition_point(|reading| reading.time_s < time_s);
    let (before, after) = (after.checked_sub(1).map(|k| &readings[k]), readings.get(after));
    match (before, after) {
        (Some(before), Some(after)) => {
            let apart_s = after.time_s - before.time_s;
            let share = (time_s - before.time_s) / apart_s;
            Some((before.point_m.lerp(&after.point_m, share), apart_s))
        }
        (before, after) => {
            let end = before.or(after)?;
            Some((end.point_m, 2.0 * (time_s - end.time_s).abs()))
        }
    }
}
