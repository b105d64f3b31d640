//! Where the prisms were at any instant of a solution, how fast they moved, and how certain that is.
//!
//! The splines that the estimate has, and the covariance of four knots ([`super::band_covariance`]) with all that the parts of
//! the drive leave open ([`super::chain_factor`]): readings, transforms, clocks, instruments, and stations that settle. An
//! instant between two stretches has no motion, and none is made up.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, SVector, Vector3, Vector4};
use rayon::prelude::*;

use super::band::Band;
use super::band_covariance::{Window, each_window};
use super::band_rows::{BORDER, MOTION_BORDER, PART, TIED};
use super::cuts::{AboutCut, about_cut, taken_s};
use super::drive::Drive;
use super::motion::{Place, Stretch};
use super::pass::{Around, Estimates, Model, Pass, Spare, Weigh, pass};
use super::slow_changes::station_1_by_slow;
use super::unknowns::{CONSTANTS, SLOW, Slow};
use crate::calibration::ErrorSizes;
use crate::progress::{Cancelled, Progress};

/// What an estimate found, from which its motion can be had again.
#[derive(Clone, Debug)]
pub struct Solution {
    pub(super) drive: Arc<Drive>,
    pub(super) at: Estimates,
    pub(super) by: Weigh,
    pub(super) model: Model,
    pub(super) sizes: ErrorSizes,
    pub(super) prisms: usize,
}

/// The prisms at one instant in the frame of station 1 as it was set up: x, y, z of each.
#[derive(Clone, Debug, PartialEq)]
pub struct Instant<const N: usize> {
    pub time_s: f64,
    pub position_m: SVector<f64, N>,
    pub velocity_m_per_s: SVector<f64, N>,
    /// Covariance of the positions, and of the velocities.
    pub position_covariance: SMatrix<f64, N, N>,
    pub velocity_covariance: SMatrix<f64, N, N>,
}

/// The instants that are inside of stretches, in order of time.
#[derive(Clone, Debug, PartialEq)]
pub enum Prisms {
    /// Instants of the three prisms of a rig.
    Rig(Vec<Instant<9>>),
    /// Instants of the one prism that all stations follow.
    Prism(Vec<Instant<3>>),
}

impl Solution {
    /// The motion at some times in their order (s, in the stamps of station 1).
    pub fn instants(&self, time_s: &[f64], progress: &Progress) -> Result<Prisms, Cancelled> {
        const RIG: usize = 9;
        const PRISM: usize = 3;
        Ok(if self.prisms == 3 {
            const ROW: usize = TIED * RIG;
            const WITH_PARTS: usize = ROW + BORDER;
            Prisms::Rig(self.moved::<RIG, WITH_PARTS, { ROW + MOTION_BORDER }>(time_s, progress)?)
        } else {
            const ROW: usize = TIED * PRISM;
            const WITH_PARTS: usize = ROW + BORDER;
            Prisms::Prism(
                self.moved::<PRISM, WITH_PARTS, { ROW + MOTION_BORDER }>(time_s, progress)?,
            )
        })
    }

    /// How the prisms at some times move with what is constant during the drive: what all instants have in common.
    pub fn by_constants(
        &self,
        time_s: &[f64],
        progress: &Progress,
    ) -> Result<ByConstants, Cancelled> {
        const RIG: usize = 9;
        const PRISM: usize = 3;
        if self.prisms == 3 {
            const ROW: usize = TIED * RIG;
            const WITH_PARTS: usize = ROW + BORDER;
            self.by_constants_of::<RIG, WITH_PARTS, { ROW + MOTION_BORDER }>(time_s, progress)
        } else {
            const ROW: usize = TIED * PRISM;
            const WITH_PARTS: usize = ROW + BORDER;
            self.by_constants_of::<PRISM, WITH_PARTS, { ROW + MOTION_BORDER }>(time_s, progress)
        }
    }

    fn moved<const LOCAL: usize, const ROW: usize, const MOTION: usize>(
        &self,
        time_s: &[f64],
        progress: &Progress,
    ) -> Result<Vec<Instant<LOCAL>>, Cancelled> {
        let Some(pass) = self.pass::<LOCAL, ROW>(progress)? else { return Ok(Vec::new()) };
        let frames = self.frames(&pass);
        self.each_instant::<LOCAL, ROW, MOTION, _>(&pass, time_s, progress, |at| {
            instant::<LOCAL>(at.time_s, &at.place, at.knots, at.window, &frames[at.part])
        })
    }

    fn by_constants_of<const LOCAL: usize, const ROW: usize, const MOTION: usize>(
        &self,
        time_s: &[f64],
        progress: &Progress,
    ) -> Result<ByConstants, Cancelled> {
        let Some(pass) = self.pass::<LOCAL, ROW>(progress)? else {
            return Ok(ByConstants::default());
        };
        let each = self.each_instant::<LOCAL, ROW, MOTION, _>(&pass, time_s, progress, |at| {
            let moves = &pass.linear.data.moves;
            let mut open = SMatrix::<f64, OPEN, CONSTANTS>::zeros();
            open.fixed_rows_mut::<PART>(0).copy_from(&moves.of(at.part).0);
            open.fixed_rows_mut::<6>(PART).copy_from(&moves.of_station_1(at.part).0);
            let places = by_knots(LOCAL, &at.place.position);
            let read_m = &places * DVector::from_column_slice(&at.knots[..TIED * LOCAL]);
            let open = DMatrix::from_column_slice(OPEN, CONSTANTS, open.as_slice());
            (at.time_s, by_open(&(places * &at.window.by_part), &read_m) * open)
        })?;
        let covariance = pass.factor.of_constants();
        let covariance = DMatrix::from_column_slice(CONSTANTS, CONSTANTS, covariance.as_slice());
        Ok(ByConstants { each, covariance })
    }

    fn pass<const LOCAL: usize, const ROW: usize>(
        &self,
        progress: &Progress,
    ) -> Result<Option<Pass<LOCAL, ROW>>, Cancelled> {
        let mut spare = Spare::default();
        pass(&self.drive, &self.at, &self.by, &self.model, &mut spare, progress)
    }

    /// Makes something of each of the times that is inside of a stretch, in their order.
    fn each_instant<const LOCAL: usize, const ROW: usize, const MOTION: usize, T: Send>(
        &self,
        pass: &Pass<LOCAL, ROW>,
        time_s: &[f64],
        progress: &Progress,
        make: impl Fn(At<'_>) -> T + Sync,
    ) -> Result<Vec<T>, Cancelled> {
        let drive = &self.drive;
        let around = Around::new(drive, &self.at, &pass.linear.data.moves);
        let about_cut = |index: usize| {
            progress.check()?;
            let Some(taken_s) = taken_s(drive, index) else { return Ok(None) };
            let times_s = within(time_s, |t| t < taken_s[0], |t| t > taken_s[1]);
            if times_s.is_empty() {
                return Ok(None);
            }
            // Where the motion about a cut is not held, each side has its own.
            let found = about_cut::<LOCAL, ROW, MOTION>(&around, &self.by, index);
            Ok(found.map(|AboutCut { stretch, coefficients_m, band }| {
                let last_part = around.first_parts[index + 1] - 1;
                (taken_s, made(&stretch, &coefficients_m, &band, times_s, last_part, &make))
            }))
        };
        let about_cuts = (0..drive.pieces.len()).into_par_iter().map(about_cut);
        let about_cuts: Vec<_> = about_cuts.collect::<Result<_, Cancelled>>()?;
        let (taken_s, about_cuts): (Vec<_>, Vec<_>) =
            about_cuts.into_iter().map(Option::unzip).unzip();
        let of_stretch = |index: usize, band: &Band<LOCAL, ROW>| {
            let stretch = &drive.pieces[index].stretch;
            let (before, after) = (index.checked_sub(1).and_then(|k| taken_s[k]), taken_s[index]);
            let times_s = within(
                time_s,
                |t| t < stretch.start_s || before.is_some_and(|taken_s| t <= taken_s[1]),
                |t| t > stretch.end_s || after.is_some_and(|taken_s| t >= taken_s[0]),
            );
            let coefficients_m = &self.at.coefficients_m[index];
            made(stretch, coefficients_m, band, times_s, around.first_parts[index], &make)
        };
        let found = pass.with_bands(drive, &self.at, &self.by.levels, of_stretch);
        progress.check()?;
        let all = found.into_iter().zip(about_cuts).flat_map(|(own, cut)| [own, cut]);
        Ok(all.flatten().flatten().collect())
    }

    /// Where the prisms of a rig are at an instant (s, in the stamps of station 1), in the frame of station 1 as it was set up
    /// (m); `None` outside of all stretches, and of one prism.
    ///
    /// It is read off the splines, without the pass over the drive that covariances take: there is time for it in every frame
    /// of a window. [`Self::instants`] has the same but about the [`super::cuts`] of long stretches.
    pub fn prisms_m(&self, time_s: f64) -> Option<[Vector3<f64>; 3]> {
        let pieces = &self.drive.pieces;
        let index = pieces.partition_point(|piece| piece.stretch.end_s < time_s);
        let stretch = &pieces.get(index).filter(|_| self.prisms == 3)?.stretch;
        if !stretch.has(time_s) {
            return None;
        }
        let first_part: usize = pieces[..index].iter().map(|piece| piece.stretch.parts).sum();
        let slow = &self.at.slow[first_part + stretch.part(time_s)];
        let moved = station_1_by_slow(&self.sizes, &self.model.start).0 * slow.fixed_rows::<8>(0);
        let place = stretch.place(time_s);
        let knots = &self.at.coefficients_m[index][9 * place.first..];
        Some([0, 1, 2].map(|prism| {
            let at_knot = |k: usize| Vector3::from_column_slice(&knots[9 * k + 3 * prism..][..3]);
            let read_m = (0..TIED).map(|k| place.position[k] * at_knot(k)).sum::<Vector3<f64>>();
            settled(&read_m, &moved)
        }))
    }

    /// Start and end of what has a motion (s), each stretch by itself.
    pub fn spans_s(&self) -> impl Iterator<Item = [f64; 2]> {
        self.drive.pieces.iter().map(|piece| [piece.stretch.start_s, piece.stretch.end_s])
    }

    /// How often a second the slowest station reads: knots are as far apart as its readings.
    pub fn readings_hz(&self) -> f64 {
        self.drive.pieces.first().map_or(1.0, |piece| 1.0 / piece.stretch.knot_s)
    }

    /// What each part of the drive leaves open.
    fn frames<const LOCAL: usize, const ROW: usize>(&self, pass: &Pass<LOCAL, ROW>) -> Vec<Frame> {
        let drive = &self.drive;
        let (by_slow, left) = station_1_by_slow(&self.sizes, &self.model.start);
        // It settles along x, y, z and about z.
        let by_settling = SMatrix::<f64, 6, 4>::from_fn(|row, settles| {
            f64::from(row == if settles < 3 { settles } else { 5 })
        });
        let of_constants = pass.factor.of_constants();
        let mut frames = vec![Frame::default(); drive.part_times_s.len()];
        let shares = pass.slow_priors.settled_shares();
        pass.factor.each_covariance(|part, slow| {
            let (part_by_constants, part_by_slow) = pass.linear.data.moves.of(part);
            let (seen_by_constants, seen_by_slow) = pass.linear.data.moves.of_station_1(part);
            let mut constants = SMatrix::<f64, OPEN, CONSTANTS>::zeros();
            constants.fixed_rows_mut::<PART>(0).copy_from(&part_by_constants);
            constants.fixed_rows_mut::<6>(PART).copy_from(&seen_by_constants);
            let mut by_states = SMatrix::<f64, OPEN, SLOW>::zeros();
            by_states.fixed_rows_mut::<PART>(0).copy_from(&part_by_slow);
            by_states.fixed_rows_mut::<6>(PART).copy_from(&seen_by_slow);
            let mut settled = by_states.fixed_view_mut::<6, 8>(PART, 0);
            settled += by_settling * by_slow;
            let across = constants * slow.with_constants.transpose() * by_states.transpose();
            let mut covariance = constants * of_constants * constants.transpose()
                + by_states * slow.own * by_states.transpose()
                + across
                + across.transpose();
            let mut open = covariance.fixed_view_mut::<6, 6>(PART, PART);
            open += by_settling * left * by_settling.transpose() * shares[part];
            let state: &Slow = &self.at.slow[part];
            frames[part] = Frame { moved: by_slow * state.fixed_rows::<8>(0), covariance };
        });
        frames
    }
}

/// How positions move with the constants of a drive, and how well those are known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ByConstants {
    /// By time (s), the coordinates of the prisms in rows (m), a column for each constant.
    pub each: Vec<(f64, DMatrix<f64>)>,
    pub covariance: DMatrix<f64>,
}

/// One of the times that something is made of.
struct At<'a> {
    time_s: f64,
    place: Place,
    /// The coefficients from the place's first knot on.
    knots: &'a [f64],
    window: &'a Window,
    part: usize,
}

/// Makes something of each of some times of a stretch, in their order.
fn made<const LOCAL: usize, const ROW: usize, T>(
    stretch: &Stretch,
    coefficients_m: &[f64],
    band: &Band<LOCAL, ROW>,
    times_s: &[f64],
    first_part: usize,
    make: &impl Fn(At<'_>) -> T,
) -> Vec<T> {
    let mut all: Vec<(Place, f64)> = times_s.iter().map(|t| (stretch.place(*t), *t)).collect();
    let mut found = Vec::with_capacity(all.len());
    each_window(band, |window| {
        while let Some((place, time_s)) = all.pop_if(|(p, _)| p.first == window.first) {
            let knots = &coefficients_m[LOCAL * place.first..];
            let part = first_part + stretch.part(time_s);
            found.push(make(At { time_s, place, knots, window, part }));
        }
    });
    found.reverse();
    found
}

/// Those of some times in their order that are neither too early nor too late.
fn within(time_s: &[f64], is_early: impl Fn(f64) -> bool, is_late: impl Fn(f64) -> bool) -> &[f64] {
    let from = time_s.partition_point(|t| is_early(*t));
    &time_s[from..time_s.partition_point(|t| !is_late(*t)).max(from)]
}

/// The unknowns of a part, and how station 1 and what it reads are shifted along x, y, z (m) and turned about them (rad).
const OPEN: usize = PART + 6;

/// How station 1 stood during a part against its set-up, and what is open about it and the part.
#[derive(Clone)]
struct Frame {
    moved: Vector4<f64>,
    covariance: SMatrix<f64, OPEN, OPEN>,
}

impl Default for Frame {
    fn default() -> Self {
        Self { moved: Vector4::zeros(), covariance: SMatrix::zeros() }
    }
}

/// How a place moves with the coefficients of four knots, each of which counts by its weight.
fn by_knots(local: usize, weights: &[f64; TIED]) -> DMatrix<f64> {
    DMatrix::from_fn(
        local,
        TIED * local,
        |i, j| {
            if j % local == i { weights[j / local] } else { 0.0 }
        },
    )
}

/// How prisms that were read at a place (m) move with what is open, if they move so with the unknowns of the part.
fn by_open(by_part: &DMatrix<f64>, read_m: &DVector<f64>) -> DMatrix<f64> {
    let mut by_open = DMatrix::zeros(read_m.len(), OPEN);
    by_open.view_mut((0, 0), (read_m.len(), PART)).copy_from(by_part);
    for at in (0..read_m.len()).step_by(3) {
        let turned = turned(&Vector3::new(read_m[at], read_m[at + 1], read_m[at + 2]));
        by_open.fixed_view_mut::<3, 3>(at, PART).fill_with_identity();
        by_open.fixed_view_mut::<3, 3>(at, PART + 3).copy_from(&turned);
    }
    by_open
}

/// Where a prism is that was read there (m), once station 1 has moved along x, y, z (m) and turned about z (rad).
fn settled(read_m: &Vector3<f64>, moved: &Vector4<f64>) -> Vector3<f64> {
    read_m + moved.fixed_rows::<3>(0) + moved[3] * Vector3::z().cross(read_m)
}

/// How a vector moves with turns about x, y, z (per rad).
fn turned(vector: &Vector3<f64>) -> Matrix3<f64> {
    -vector.cross_matrix()
}

/// `knots` are the coefficients from the place's first knot on.
fn instant<const LOCAL: usize>(
    time_s: f64,
    place: &Place,
    knots: &[f64],
    window: &Window,
    frame: &Frame,
) -> Instant<LOCAL> {
    let sum = |weights: &[f64; TIED]| {
        SVector::<f64, LOCAL>::from_fn(|i, _| {
            weights.iter().enumerate().map(|(k, weight)| weight * knots[LOCAL * k + i]).sum()
        })
    };
    let (read_m, velocity_m_per_s) = (sum(&place.position), sum(&place.velocity));
    let (places, rates) = (by_knots(LOCAL, &place.position), by_knots(LOCAL, &place.velocity));
    let read = DVector::from_column_slice(read_m.as_slice());
    let place_by_open = by_open(&(&places * &window.by_part), &read);
    let mut rate_by_open = DMatrix::zeros(LOCAL, OPEN);
    rate_by_open.view_mut((0, 0), (LOCAL, PART)).copy_from(&(&rates * &window.by_part));
    let (mut position_m, mut velocity) = (read_m, velocity_m_per_s);
    for prism in 0..LOCAL / 3 {
        let at = 3 * prism;
        let prism_m = settled(&read_m.fixed_rows::<3>(at).into_owned(), &frame.moved);
        position_m.fixed_rows_mut::<3>(at).copy_from(&prism_m);
        let turning = Vector3::z().cross(&velocity_m_per_s.fixed_rows::<3>(at));
        let turned = turned(&velocity_m_per_s.fixed_rows::<3>(at).into_owned());
        rate_by_open.fixed_view_mut::<3, 3>(at, PART + 3).copy_from(&turned);
        for axis in 0..3 {
            velocity[at + axis] += frame.moved[3] * turning[axis];
        }
    }
    let open = DMatrix::from_column_slice(OPEN, OPEN, frame.covariance.as_slice());
    let covariance = |knots: &DMatrix<f64>, by_open: &DMatrix<f64>| {
        let all =
            knots * &window.covariance * knots.transpose() + by_open * &open * by_open.transpose();
        SMatrix::<f64, LOCAL, LOCAL>::from_column_slice(all.as_slice())
    };
    Instant {
        time_s,
        position_m,
        velocity_m_per_s: velocity,
        position_covariance: covariance(&places, &place_by_open),
        velocity_covariance: covariance(&rates, &rate_by_open),
    }
}
