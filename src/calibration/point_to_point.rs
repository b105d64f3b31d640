//! Point-to-point alignments of several frames at once, with the covariance that their residuals support.
//!
//! Methods A, B and C share it: minimise Σ ‖to − T from‖² (`paper.tex`, eq. `icp_p_to_point_min`) over a level or a
//! full rigid T. The estimates are unweighted least squares, so to first order the error of (t, ω) is
//! N⁻¹ Jᵀ e with J = [I, −(R from)×]; what is known about e makes the covariance.

use nalgebra::{DMatrix, Matrix3, Matrix3x6, Matrix6, SMatrix, Vector3, Vector6};

use super::{Alignment, TransformSigma};
use crate::geometry::{LevelTransform, RigidTransform, align_level, align_rigid};

/// Points in two frames, in corresponding order.
#[derive(Clone, Debug, Default)]
pub struct Matches {
    pub to_m: Vec<Vector3<f64>>,
    pub from_m: Vec<Vector3<f64>>,
    /// Errors within a block hang together, those of different blocks do not. Blocks of several alignments with the
    /// same number share errors as well. In increasing order.
    pub block: Vec<u32>,
}

impl Matches {
    pub fn push(&mut self, to_m: Vector3<f64>, from_m: Vector3<f64>, block: u32) {
        self.to_m.push(to_m);
        self.from_m.push(from_m);
        self.block.push(block);
    }

    pub fn len(&self) -> usize {
        self.block.len()
    }
}

/// What is known about the errors of the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Errors {
    /// As large as the residuals, alike on all axes, independent from block to block; a block is one point in each
    /// alignment. For too few points to tell more.
    AsResiduals,
    /// Correlated within each block, whatever their size: the sandwich estimator.
    ByBlock,
    /// This large on each axis (m, 1 σ), independent.
    Known(f64),
}

/// The alignments, `to_from[k]` being that of `matches[k]`.
#[derive(Clone, Debug)]
pub struct Aligned {
    pub to_from: Vec<RigidTransform>,
    /// to − T from (m).
    pub residuals_m: Vec<Vec<Vector3<f64>>>,
    /// Of (t, ω) of each alignment in turn, ω turning about the axes of the target frame; a held axis has zeros.
    /// `None` when a direction is free.
    pub covariance: Option<DMatrix<f64>>,
}

/// The scaled normal matrix of a free direction: points in one place, or on a line with roll and pitch free.
const FREE_DIRECTION: f64 = 1e-9;

/// Aligns; `None` where a list is too short or the points do not hold a transform.
pub fn align(matches: &[Matches], alignment: Alignment, errors: Errors) -> Option<Aligned> {
    let to_from: Vec<RigidTransform> = matches
        .iter()
        .map(|m| match alignment {
            Alignment::Level => align_level(&m.to_m, &m.from_m).map(RigidTransform::from),
            Alignment::Rigid => align_rigid(&m.to_m, &m.from_m),
        })
        .collect::<Option<_>>()?;
    let residuals_m: Vec<Vec<_>> = matches
        .iter()
        .zip(&to_from)
        .map(|(m, t)| m.to_m.iter().zip(&m.from_m).map(|(to, from)| to - t.apply(from)).collect())
        .collect();
    let covariance = covariance(matches, &to_from, &residuals_m, alignment, errors);
    Some(Aligned { to_from, residuals_m, covariance })
}

/// Columns of (t, ω) that an alignment estimates.
fn estimated(alignment: Alignment) -> &'static [usize] {
    match alignment {
        Alignment::Level => &[0, 1, 2, 5],
        Alignment::Rigid => &[0, 1, 2, 3, 4, 5],
    }
}

/// How a placed point moves with (t, ω) of its transform; held axes have zeros.
fn jacobian(turned_m: &Vector3<f64>, alignment: Alignment) -> Matrix3x6<f64> {
    let mut jacobian = Matrix3x6::zeros();
    jacobian.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::identity());
    jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&-turned_m.cross_matrix());
    if alignment == Alignment::Level {
        jacobian.fixed_columns_mut::<2>(3).fill(0.0);
    }
    jacobian
}

fn covariance(
    matches: &[Matches],
    to_from: &[RigidTransform],
    residuals_m: &[Vec<Vector3<f64>>],
    alignment: Alignment,
    errors: Errors,
) -> Option<DMatrix<f64>> {
    let jacobians: Vec<Vec<Matrix3x6<f64>>> = matches
        .iter()
        .zip(to_from)
        .map(|(m, t)| m.from_m.iter().map(|from| jacobian(&t.rotate(from), alignment)).collect())
        .collect();
    let inverses: Vec<Matrix6<f64>> = jacobians
        .iter()
        .map(|rows| inverse(rows.iter().map(|j| j.transpose() * j).sum(), alignment))
        .collect::<Option<_>>()?;
    let count = matches.len();
    let unknowns = estimated(alignment).len() as f64;
    let mut covariance = DMatrix::zeros(6 * count, 6 * count);
    for a in 0..count {
        for b in 0..count {
            let meat: Matrix6<f64> = match errors {
                Errors::Known(_) if a != b => Matrix6::zeros(),
                Errors::Known(sigma_m) => {
                    jacobians[a].iter().map(|j| j.transpose() * j).sum::<Matrix6<f64>>()
                        * sigma_m.powi(2)
                }
                Errors::AsResiduals => {
                    let shared = shared_points(&matches[a].block, &matches[b].block);
                    let products: f64 = shared
                        .iter()
                        .map(|(i, j)| residuals_m[a][*i].dot(&residuals_m[b][*j]))
                        .sum();
                    let degrees = 3.0 * shared.len() as f64 - unknowns;
                    if degrees <= 0.0 {
                        if a == b {
                            return None;
                        }
                        // Too few points in common to tell how the two hang together.
                        continue;
                    }
                    shared
                        .iter()
                        .map(|(i, j)| jacobians[a][*i].transpose() * jacobians[b][*j])
                        .sum::<Matrix6<f64>>()
                        * (products / degrees)
                }
                Errors::ByBlock => {
                    let [pulls_a, pulls_b] =
                        [a, b].map(|k| pulls(&matches[k].block, &jacobians[k], &residuals_m[k]));
                    let numbers = |pulls: &[(u32, Vector6<f64>)]| -> Vec<u32> {
                        pulls.iter().map(|(number, _)| *number).collect()
                    };
                    let shared = shared_points(&numbers(&pulls_a), &numbers(&pulls_b));
                    // Residuals are smaller than errors: each block of points lost a share of its freedom.
                    let blocks = shared.len() as f64;
                    let freedom = (blocks - unknowns / 3.0).max(1.0);
                    shared
                        .iter()
                        .map(|(i, j)| pulls_a[*i].1 * pulls_b[*j].1.transpose())
                        .sum::<Matrix6<f64>>()
                        * (blocks / freedom)
                }
            };
            let part = inverses[a] * meat * inverses[b];
            covariance.fixed_view_mut::<6, 6>(6 * a, 6 * b).copy_from(&part);
        }
    }
    covariance.iter().all(|entry| entry.is_finite()).then_some(covariance)
}

/// Inverse over the estimated directions, zeros elsewhere; `None` when one of them is free.
fn inverse(normal: Matrix6<f64>, alignment: Alignment) -> Option<Matrix6<f64>> {
    let columns = estimated(alignment);
    let small =
        DMatrix::from_fn(columns.len(), columns.len(), |i, j| normal[(columns[i], columns[j])]);
    let scale: Vec<f64> = (0..columns.len()).map(|i| small[(i, i)].sqrt()).collect();
    if scale.iter().any(|s| *s <= 0.0) {
        return None;
    }
    let scaled = DMatrix::from_fn(columns.len(), columns.len(), |i, j| {
        small[(i, j)] / (scale[i] * scale[j])
    });
    if scaled.symmetric_eigenvalues().min() < FREE_DIRECTION {
        return None;
    }
    let inverse = scaled.try_inverse()?;
    let mut full = Matrix6::zeros();
    for (i, row) in columns.iter().enumerate() {
        for (j, column) in columns.iter().enumerate() {
            full[(*row, *column)] = inverse[(i, j)] / (scale[i] * scale[j]);
        }
    }
    Some(full)
}

/// Places of the blocks that two alignments share.
fn shared_points(a: &[u32], b: &[u32]) -> Vec<(usize, usize)> {
    a.iter()
        .enumerate()
        .filter_map(|(i, block)| b.binary_search(block).ok().map(|j| (i, j)))
        .collect()
}

/// Number of each block, and Jᵀ r summed over it.
fn pulls(
    block: &[u32],
    jacobians: &[Matrix3x6<f64>],
    residuals_m: &[Vector3<f64>],
) -> Vec<(u32, Vector6<f64>)> {
    let mut sums: Vec<(u32, Vector6<f64>)> = Vec::new();
    for ((block, jacobian), residual) in block.iter().zip(jacobians).zip(residuals_m) {
        if sums.last().is_none_or(|(last, _)| last != block) {
            sums.push((*block, Vector6::zeros()));
        }
        if let Some((_, sum)) = sums.last_mut() {
            *sum += jacobian.transpose() * residual;
        }
    }
    sums
}

/// Covariance of (x, y, z, yaw) of two transforms out of that of their (t, ω).
pub fn level_part(covariance: &DMatrix<f64>) -> SMatrix<f64, 8, 8> {
    const COLUMNS: [usize; 4] = [0, 1, 2, 5];
    SMatrix::from_fn(|i, j| {
        covariance[(6 * (i / 4) + COLUMNS[i % 4], 6 * (j / 4) + COLUMNS[j % 4])]
    })
}

pub fn sigmas(covariance: &SMatrix<f64, 8, 8>) -> [TransformSigma; 2] {
    let sigma = |k: usize| covariance[(k, k)].max(0.0).sqrt();
    [0, 4].map(|k| TransformSigma {
        translation_m: Vector3::new(sigma(k), sigma(k + 1), sigma(k + 2)),
        yaw_rad: sigma(k + 3),
    })
}

/// From alignments to a common frame, `world_from_station`, to the frames of stations 2 and 3 in station 1's.
///
/// With T = W1⁻¹ Ws: δt = R1ᵀ (δt_s − δt_1 − ω_1 × (t_s − t_1)) and ω = R1ᵀ (ω_s − ω_1).
pub fn relative_to_station1(
    world_from_station: &[RigidTransform; 3],
    covariance: Option<&DMatrix<f64>>,
) -> ([RigidTransform; 3], Option<DMatrix<f64>>) {
    let station1_from_world = world_from_station[0].inverse();
    let back = station1_from_world.rotation.matrix();
    let transforms = [
        LevelTransform::IDENTITY.into(),
        station1_from_world.then_from(&world_from_station[1]),
        station1_from_world.then_from(&world_from_station[2]),
    ];
    let covariance = covariance.map(|covariance| {
        let mut jacobian = DMatrix::zeros(12, 18);
        for slot in 0..2 {
            let (row, column) = (6 * slot, 6 * (slot + 1));
            let offset =
                world_from_station[slot + 1].translation_m - world_from_station[0].translation_m;
            let mut set = |r: usize, c: usize, part: Matrix3<f64>| {
                jacobian.fixed_view_mut::<3, 3>(r, c).copy_from(&part);
            };
            set(row, column, *back);
            set(row, 0, -back);
            set(row, 3, back * offset.cross_matrix());
            set(row + 3, column + 3, *back);
            set(row + 3, 3, -back);
        }
        &jacobian * covariance * jacobian.transpose()
    });
    (transforms, covariance)
}
