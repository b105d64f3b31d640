//! Estimate of the unknowns beside a frame and a clock that wander.
//!
//! An odometry drifts: its frame turns and moves against the ground truth's as a random walk, about the place where it is. Its clock may
//! wander about the mean offset (a Gauss–Markov process). Noise is beside both. A Kalman filter follows what wanders, and leaves
//! innovations that are independent of each other. The unknowns are estimated by generalised least squares from these: the filter runs
//! for the derivatives as for the residuals (de Jong 1991, "The diffuse Kalman filter"). So an error that lasts is no evidence of
//! a lever arm or a time offset, however many epochs have it.
//!
//! With the residual e + H x + J θ of an epoch, x what wanders and θ the unknowns, an innovation is −e − E θ, where E = J + H X and X is
//! the derivative of the filtered x by θ.

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, SMatrix, SVector, Vector3};

use super::drift_sizes::DriftSizes;
use super::epoch_rows::{EpochRow, EpochRows, epoch_rows};
use super::fit::LEVER_SIGMA_M;
use super::instruments::FilteredBlock;
use super::neighbours::Neighbours;
use super::state::{
    BY_CLOCK, BY_ORIENTATION, BY_POSITION, BY_SLOW_CLOCK, BY_TRANSLATION, FitState, WANDERING,
};
use super::unknowns::{CLOCK, COLUMNS};
use crate::estimates::matched_pose::MatchedPose;
use resect_core::calibration::joint::prism_motion::ConstantsJacobian;
use resect_core::geometry::RigidTransform;
use resect_core::statistics::robust::huber;

/// Number of blocks of time for σ, and the shortest one (s). Innovations are independent only if the model holds.
/// Simulated: with 24 blocks the regions of clock, lever arm and body cover the truth as stated.
const BLOCKS: f64 = 24.0;
const SHORTEST_BLOCK_S: f64 = 2.0;
/// Bend of Huber's loss, in σ of an innovation. Textbook: 2 to 3 leaves normal errors their weight.
const BEND: f64 = 2.5;
/// Standard deviations of the frame at the last epoch, where the filter begins that runs back (rad), and of its translation relative to the
/// misfit of the alignment and to the lever arm, from which a translation does not differ without rotations. They decide nothing as long as
/// they are larger than the errors of that frame.
const LAST_RAD: f64 = 0.3;
const FIRST_MISFITS: f64 = 10.0;

type Covariance = SMatrix<f64, WANDERING, WANDERING>;
type Gain = SMatrix<f64, WANDERING, 3>;

/// Normal equations of the unknowns by a pass over the epochs.
pub struct WanderingPass {
    /// By block of time.
    pub blocks: Vec<FilteredBlock>,
    /// Twice the negative logarithm of the likelihood of the innovations at the unknowns.
    pub cost: f64,
    /// Time of each epoch, and the change of the time offset that the filter follows (s).
    pub clock: Vec<(f64, f64)>,
    /// Jacobian of the gradient by the errors of the ground truth that are common to all epochs; no columns without any.
    pub by_common: DMatrix<f64>,
}

/// The filter at an epoch.
struct Filter {
    state: FitState,
    /// Time of the epoch before (s), and the compared point there (m).
    before: Option<(f64, Vector3<f64>)>,
    /// Errors that last; zero for the frame, which is part of the state.
    lasting: SVector<f64, WANDERING>,
    covariance: Covariance,
    neighbours: Neighbours,
    by_unknowns: SMatrix<f64, WANDERING, COLUMNS>,
    by_common: DMatrix<f64>,
}

/// An innovation with its weight.
struct Innovation {
    value: Vector3<f64>,
    by_unknowns: SMatrix<f64, 3, COLUMNS>,
    by_common: DMatrix<f64>,
    information: Matrix3<f64>,
    cost: f64,
}

/// Runs the filter over the epochs, which are in order of time.
pub fn pass(
    pairs: &[MatchedPose],
    state: &FitState,
    sizes: &DriftSizes,
    common: Option<&ConstantsJacobian>,
) -> WanderingPass {
    let (from_s, to_s) = (pairs[0].truth.time_s, pairs[pairs.len() - 1].truth.time_s);
    let block_s = ((to_s - from_s) / BLOCKS).max(SHORTEST_BLOCK_S);
    let columns = common.map_or(0, |common| common.covariance.nrows());
    let mut pass = WanderingPass {
        blocks: Vec::new(),
        cost: 0.0,
        clock: Vec::with_capacity(pairs.len()),
        by_common: DMatrix::zeros(COLUMNS, columns),
    };
    let mut filter = Filter::new(pairs, state, sizes, (sizes.first_rad, columns));
    let mut instants = common.map(|common| common.instants.iter().peekable());
    let mut block = usize::MAX;
    let mut information = SMatrix::<f64, COLUMNS, COLUMNS>::zeros();
    let mut gradient = SVector::<f64, COLUMNS>::zeros();
    for (number, pair) in pairs.iter().enumerate() {
        let time_s = pair.truth.time_s;
        filter.neighbours = Neighbours::at(pairs, number);
        let index = ((time_s - from_s) / block_s) as usize;
        if index != block && block != usize::MAX {
            pass.blocks.push(block_of(&information, &gradient));
            information.fill(0.0);
            gradient.fill(0.0);
        }
        block = index;
        let by_common = instants.as_mut().and_then(|instants| {
            while instants.next_if(|(other_s, _)| *other_s < time_s).is_some() {}
            Some(&instants.next_if(|(other_s, _)| *other_s == time_s)?.1)
        });
        for innovation in filter.next(pair, sizes, by_common) {
            let weighted = innovation.by_unknowns.tr_mul(&innovation.information);
            information += weighted * innovation.by_unknowns;
            gradient += weighted * innovation.value;
            pass.cost += innovation.cost;
            if columns > 0 {
                pass.by_common += weighted * innovation.by_common;
            }
        }
        pass.clock.push((time_s, filter.later_s()));
    }
    pass.blocks.push(block_of(&information, &gradient));
    pass
}

/// Returns the frame at the first epoch, by a filter that runs back from the last one.
pub fn first_frame(pairs: &[MatchedPose], state: &FitState, sizes: &DriftSizes) -> RigidTransform {
    let mut filter = Filter::new(pairs, state, sizes, (LAST_RAD, 0));
    for pair in pairs.iter().rev() {
        filter.next(pair, sizes, None);
    }
    filter.state.fit.truth_from_estimate
}

/// Returns the information between the unknowns, by their rows, and the clock by the velocities of the one trajectory, by the columns, and
/// those of the other.
pub fn clock_by_both_motions(
    pairs: &[MatchedPose],
    state: &FitState,
    sizes: &DriftSizes,
) -> DVector<f64> {
    let mut filters = [1.0, 0.0].map(|share_of_stamped| {
        let state = FitState { share_of_stamped, ..state.clone() };
        Filter::new(pairs, &state, sizes, (sizes.first_rad, 0))
    });
    let mut sum = DVector::zeros(COLUMNS);
    for (number, pair) in pairs.iter().enumerate() {
        filters[0].neighbours = Neighbours::at(pairs, number);
        filters[1].neighbours = filters[0].neighbours;
        let [first, second] = filters.each_mut().map(|filter| filter.next(pair, sizes, None));
        for (first, second) in first.iter().zip(&second) {
            let weighted = first.information * second.by_unknowns.column(CLOCK);
            sum += first.by_unknowns.tr_mul(&weighted);
        }
    }
    sum
}

fn block_of(
    information: &SMatrix<f64, COLUMNS, COLUMNS>,
    gradient: &SVector<f64, COLUMNS>,
) -> FilteredBlock {
    FilteredBlock {
        information: DMatrix::from_iterator(COLUMNS, COLUMNS, information.iter().copied()),
        gradient: DVector::from_iterator(COLUMNS, gradient.iter().copied()),
    }
}

impl Filter {
    /// `first_rad` is the standard deviation of the frame's rotation, `columns` the number of common errors.
    fn new(
        pairs: &[MatchedPose],
        state: &FitState,
        sizes: &DriftSizes,
        (first_rad, columns): (f64, usize),
    ) -> Self {
        let mut covariance = Covariance::zeros();
        if sizes.is_aligned {
            let squares: f64 = pairs
                .iter()
                .map(|pair| {
                    let [placed_m, true_m] = state.fit.both_positions_m(&pair.pose, &pair.truth);
                    (true_m - placed_m).norm_squared()
                })
                .sum();
            let first_m = FIRST_MISFITS * ((squares / pairs.len() as f64).sqrt() + LEVER_SIGMA_M);
            for axis in 0..3 {
                covariance[(axis, axis)] = first_rad.powi(2);
                let translation = BY_TRANSLATION + axis;
                covariance[(translation, translation)] = first_m.powi(2);
            }
        }
        for (size, _, range) in sizes.processes() {
            range.for_each(|index| covariance[(index, index)] = size * size);
        }
        Self {
            state: state.clone(),
            before: None,
            lasting: SVector::zeros(),
            covariance,
            neighbours: Neighbours::default(),
            by_unknowns: SMatrix::zeros(),
            by_common: DMatrix::zeros(WANDERING, columns),
        }
    }

    /// Change of the time offset that the filter follows (s).
    fn later_s(&self) -> f64 {
        self.lasting[BY_CLOCK] + self.lasting[BY_SLOW_CLOCK]
    }

    /// Predicts the next epoch and takes its residuals.
    fn next(
        &mut self,
        pair: &MatchedPose,
        sizes: &DriftSizes,
        common: Option<&DMatrix<f64>>,
    ) -> Vec<Innovation> {
        let time_s = pair.truth.time_s;
        let placed_m =
            |filter: &Self| filter.state.fit.both_positions_m(&pair.pose, &pair.truth)[0];
        if let Some((before_s, before_m)) = self.before {
            self.predict((time_s - before_s).abs(), &(placed_m(self) - before_m), sizes);
        }
        let innovations = self.update(pair, sizes, common);
        self.before = Some((time_s, placed_m(self)));
        innovations
    }

    /// Goes on by some time (s), in which the compared point moved (m).
    fn predict(&mut self, after_s: f64, moved_m: &Vector3<f64>, sizes: &DriftSizes) {
        // A rotation about the former place is one about the new place, and a translation.
        let turned = -moved_m.cross_matrix();
        let rows = turned * self.covariance.fixed_rows::<3>(0);
        let mut sum = self.covariance.fixed_rows_mut::<3>(BY_TRANSLATION);
        sum += rows;
        let columns = self.covariance.fixed_columns::<3>(0) * turned.transpose();
        let mut sum = self.covariance.fixed_columns_mut::<3>(BY_TRANSLATION);
        sum += columns;
        let rows = turned * self.by_unknowns.fixed_rows::<3>(0);
        let mut sum = self.by_unknowns.fixed_rows_mut::<3>(BY_TRANSLATION);
        sum += rows;
        if !self.by_common.is_empty() {
            let rows = turned * self.by_common.fixed_rows::<3>(0);
            let mut sum = self.by_common.fixed_rows_mut::<3>(BY_TRANSLATION);
            sum += rows;
        }
        let [tilt, turn, walk] =
            [sizes.tilt_rad_per_root_s, sizes.turn_rad_per_root_s, sizes.walk_m_per_root_s];
        for (index, walk) in [tilt, tilt, turn, walk, walk, walk].into_iter().enumerate() {
            self.covariance[(index, index)] += walk * walk * after_s;
        }
        for (size, time_s, range) in sizes.processes() {
            let kept = (-after_s / time_s).exp();
            for index in range {
                self.lasting[index] *= kept;
                self.covariance.row_mut(index).scale_mut(kept);
                self.covariance.column_mut(index).scale_mut(kept);
                self.covariance[(index, index)] += size * size * (1.0 - kept * kept);
                self.by_unknowns.row_mut(index).scale_mut(kept);
                self.by_common.row_mut(index).scale_mut(kept);
            }
        }
    }

    /// Takes the residuals of an epoch: position first, then orientation.
    fn update(
        &mut self,
        pair: &MatchedPose,
        sizes: &DriftSizes,
        common: Option<&DMatrix<f64>>,
    ) -> Vec<Innovation> {
        let mut innovations = Vec::with_capacity(2);
        let rows = self.rows(pair);
        let by_common = |first: usize| {
            let common = common.filter(|common| common.nrows() >= first + 3)?;
            let mut rows = common.rows(first, 3).into_owned();
            let lever_m = self.state.fit.lever_arm_m;
            let is_by_truth = first == 0 && !self.state.is_turned_by_estimate;
            let turned = pair.truth.rotation.as_ref().zip(lever_m).filter(|_| is_by_truth);
            if let Some((rotation, lever_m)) = turned {
                // The body's true position depends on the vehicle's rotation by the lever arm.
                rows += -(rotation.orientation * lever_m).cross_matrix() * common.rows(3, 3);
            }
            Some(rows)
        };
        let (of_position, of_rotation) = (by_common(0), by_common(3));
        innovations.push(self.take(&rows.position, sizes.position_m, of_position, &rows.placed_m));
        if rows.rotation.is_some() {
            let rows = self.rows(pair);
            let taken = rows
                .rotation
                .map(|row| self.take(&row, sizes.rotation_rad, of_rotation, &rows.placed_m));
            innovations.extend(taken);
        }
        innovations
    }

    fn rows(&self, pair: &MatchedPose) -> EpochRows {
        let mut rows =
            epoch_rows(pair, &self.state, self.state.later_s + self.later_s(), &self.neighbours);
        rows.position.residual -= self.lasting.fixed_rows::<3>(BY_POSITION);
        if let Some(row) = &mut rows.rotation {
            row.residual -= self.lasting.fixed_rows::<3>(BY_ORIENTATION);
        }
        rows
    }

    fn take(
        &mut self,
        row: &EpochRow,
        noise: f64,
        common: Option<DMatrix<f64>>,
        placed_m: &Vector3<f64>,
    ) -> Innovation {
        let value = -row.residual;
        let projected: Gain = self.covariance * row.by_wandering.transpose();
        let predicted = row.by_wandering * projected;
        let with_noise = |variance: f64| {
            let root = (predicted + Matrix3::from_diagonal_element(variance)).cholesky();
            root.map(|root| (root.inverse(), root.ln_determinant()))
        };
        // Without rounding errors there always is a root. Sizes without one are refused by their cost.
        let (mut information, ln_determinant) =
            with_noise(noise * noise).unwrap_or((Matrix3::zeros(), f64::INFINITY));
        let size = (value.dot(&(information * value)) / 3.0).sqrt();
        let weight = huber(size, BEND).weight;
        let square = if weight < 1.0 { BEND * (2.0 * size - BEND) } else { size * size };
        if weight < 1.0 {
            information = with_noise(noise * noise / weight).map_or(information, |(root, _)| root);
        }
        let gain: Gain = projected * information;
        let by_unknowns = row.by_unknowns + row.by_wandering * self.by_unknowns;
        self.covariance -= gain * projected.transpose();
        self.covariance = (self.covariance + self.covariance.transpose()) * 0.5;
        self.by_unknowns -= gain * by_unknowns;
        let mut by_common = DMatrix::zeros(3, self.by_common.ncols());
        if !self.by_common.is_empty() {
            by_common.copy_from(&(row.by_wandering * &self.by_common));
            if let Some(common) = common {
                by_common += common;
            }
            self.by_common -= gain * &by_common;
        }
        self.move_by(&(gain * value), placed_m);
        let cost = ln_determinant + 3.0 * square;
        Innovation { value, by_unknowns, by_common, information, cost }
    }

    /// Moves frame and clock; the frame turns about a point (m).
    fn move_by(&mut self, step: &SVector<f64, WANDERING>, about_m: &Vector3<f64>) {
        let turn = Rotation3::new(step.fixed_rows::<3>(0).into_owned());
        let frame = &mut self.state.fit.truth_from_estimate;
        frame.rotation = turn * frame.rotation;
        frame.translation_m =
            about_m + turn * (frame.translation_m - about_m) + step.fixed_rows::<3>(BY_TRANSLATION);
        let lasting = step.fixed_rows::<{ WANDERING - BY_POSITION }>(BY_POSITION);
        let mut sum = self.lasting.fixed_rows_mut::<{ WANDERING - BY_POSITION }>(BY_POSITION);
        sum += lasting;
    }
}
