//! Point-to-point alignments of several frames at once, with the covariance from their residuals.
//!
//! Methods A, B and C share it. It minimises Σ ‖to − T from‖² (Vaidis et al. 2022, eq. (1)) over a level or a full rigid T. The
//! estimates are unweighted least squares, so to first order the error of (t, ω) is N⁻¹ Jᵀ e with J = [I, −(R from)×]. The
//! covariance follows from that of e.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector, Matrix3, Matrix3x6, Matrix6, Vector3};

use super::Alignment;
use crate::geometry::{RigidTransform, align_level, align_rigid};
use crate::network::PerStation;
use crate::statistics::sandwich;
use crate::statistics::sandwich::Block;

/// Points in two frames, in corresponding order.
#[derive(Clone, Debug, Default)]
pub struct Matches {
    pub to_m: Vec<Vector3<f64>>,
    pub from_m: Vec<Vector3<f64>>,
    /// Block of each point, in increasing order. Errors within a block are correlated, those of different blocks are independent.
    /// Blocks of several alignments with the same number share errors as well.
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

/// Model of the errors of the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Errors {
    /// Errors with the variance of the residuals, equal on all axes, independent from block to block. A block is one point in each
    /// alignment. For too few points to estimate more.
    AsResiduals,
    /// Errors of any size, correlated within each block: the [`sandwich`].
    ByBlock,
    /// Independent errors of this size on each axis (m, 1 σ).
    Known(f64),
}

/// Alignments, with `to_from[k]` from `matches[k]`.
#[derive(Clone, Debug)]
pub struct Aligned {
    pub to_from: Vec<RigidTransform>,
    /// to − T from (m).
    pub residuals_m: Vec<Vec<Vector3<f64>>>,
    /// Covariance of (t, ω) of each alignment in turn (m, rad), with ω about the axes of the target frame; zeros for a constrained
    /// axis. `None` if a direction is unobservable.
    pub covariance: Option<DMatrix<f64>>,
}

/// Smallest eigenvalue of the scaled normal matrix below which a direction is unobservable: points at one place, or on a line with
/// roll and pitch unconstrained.
const FREE_DIRECTION: f64 = 1e-9;

/// Returns the transforms that align; `None` if a list is too short or the points do not determine a transform.
pub fn transforms(matches: &[Matches], alignment: Alignment) -> Option<Vec<RigidTransform>> {
    let align = |m: &Matches| match alignment {
        Alignment::Level => align_level(&m.to_m, &m.from_m).map(RigidTransform::from),
        Alignment::Rigid => align_rigid(&m.to_m, &m.from_m),
    };
    matches.iter().map(align).collect()
}

/// Returns to − T from of each alignment (m).
pub fn residuals_m(matches: &[Matches], to_from: &[RigidTransform]) -> Vec<Vec<Vector3<f64>>> {
    let of_one = |(m, t): (&Matches, &RigidTransform)| {
        m.to_m.iter().zip(&m.from_m).map(|(to, from)| to - t.apply(from)).collect()
    };
    matches.iter().zip(to_from).map(of_one).collect()
}

/// Returns the transforms that align, with their residuals, and the covariance by this error model.
pub fn align(matches: &[Matches], alignment: Alignment, errors: Errors) -> Option<Aligned> {
    let to_from = transforms(matches, alignment)?;
    let residuals_m = residuals_m(matches, &to_from);
    let covariance = covariance(matches, &to_from, &residuals_m, alignment, errors);
    Some(Aligned { to_from, residuals_m, covariance })
}

/// Returns the columns of (t, ω) that an alignment estimates.
fn estimated(alignment: Alignment) -> &'static [usize] {
    match alignment {
        Alignment::Level => &[0, 1, 2, 5],
        Alignment::Rigid => &[0, 1, 2, 3, 4, 5],
    }
}

/// Returns the Jacobian of a transformed point with respect to (t, ω) of its transform; zeros for constrained axes.
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
    let covariance = match errors {
        Errors::AsResiduals => {
            as_residuals(matches, &jacobians, &inverses, residuals_m, alignment)?
        }
        Errors::ByBlock => by_block(matches, &jacobians, residuals_m, alignment)?,
        Errors::Known(sigma_m) => {
            let mut covariance = DMatrix::zeros(6 * inverses.len(), 6 * inverses.len());
            for (a, inverse) in inverses.iter().enumerate() {
                let own = inverse * sigma_m.powi(2);
                covariance.fixed_view_mut::<6, 6>(6 * a, 6 * a).copy_from(&own);
            }
            covariance
        }
    };
    covariance.iter().all(|entry| entry.is_finite()).then_some(covariance)
}

/// Covariance with one variance for all axes of all points. Only the sum of their leverages matters then: the number of unknowns.
fn as_residuals(
    matches: &[Matches],
    jacobians: &[Vec<Matrix3x6<f64>>],
    inverses: &[Matrix6<f64>],
    residuals_m: &[Vec<Vector3<f64>>],
    alignment: Alignment,
) -> Option<DMatrix<f64>> {
    let count = matches.len();
    let mut covariance = DMatrix::zeros(6 * count, 6 * count);
    for a in 0..count {
        for b in 0..count {
            let shared = shared_points(&matches[a].block, &matches[b].block);
            let degrees = 3.0 * shared.len() as f64 - estimated(alignment).len() as f64;
            if degrees <= 0.0 {
                if a == b {
                    return None;
                }
                // Too few common points to estimate the correlation of the two.
                continue;
            }
            let products: f64 =
                shared.iter().map(|(i, j)| residuals_m[a][*i].dot(&residuals_m[b][*j])).sum();
            let middle: Matrix6<f64> =
                shared.iter().map(|(i, j)| jacobians[a][*i].transpose() * jacobians[b][*j]).sum();
            let part = inverses[a] * (middle * (products / degrees)) * inverses[b];
            covariance.fixed_view_mut::<6, 6>(6 * a, 6 * b).copy_from(&part);
        }
    }
    Some(covariance)
}

/// The sandwich of all alignments at once: they have no common unknown, but common blocks.
fn by_block(
    matches: &[Matches],
    jacobians: &[Vec<Matrix3x6<f64>>],
    residuals_m: &[Vec<Vector3<f64>>],
    alignment: Alignment,
) -> Option<DMatrix<f64>> {
    let columns = estimated(alignment);
    let (each, all) = (columns.len(), columns.len() * matches.len());
    let mut blocks: BTreeMap<u32, Block> = BTreeMap::new();
    for (a, matches) in matches.iter().enumerate() {
        let points = matches.block.iter().zip(&jacobians[a]).zip(&residuals_m[a]);
        for ((number, jacobian), residual_m) in points {
            let block = blocks.entry(*number).or_insert_with(|| Block {
                information: DMatrix::zeros(all, all),
                gradient: DVector::zeros(all),
            });
            let jacobian = jacobian.select_columns(columns);
            let mut own = block.information.view_mut((each * a, each * a), (each, each));
            own += jacobian.tr_mul(&jacobian);
            let mut own = block.gradient.rows_mut(each * a, each);
            own += jacobian.tr_mul(residual_m);
        }
    }
    let blocks: Vec<Block> = blocks.into_values().collect();
    let found = sandwich::covariance(&blocks, None)?;
    let place = |k: usize| 6 * (k / each) + columns[k % each];
    let mut covariance = DMatrix::zeros(6 * matches.len(), 6 * matches.len());
    for i in 0..all {
        for j in 0..all {
            covariance[(place(i), place(j))] = found[(i, j)];
        }
    }
    Some(covariance)
}

/// Returns the inverse over the estimated directions, zeros elsewhere; `None` if one of them is unobservable.
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

/// Returns the indices of the blocks that two alignments share.
fn shared_points(a: &[u32], b: &[u32]) -> Vec<(usize, usize)> {
    a.iter()
        .enumerate()
        .filter_map(|(i, block)| b.binary_search(block).ok().map(|j| (i, j)))
        .collect()
}

/// Returns the covariance of (x, y, z, yaw) of some transforms from that of their (t, ω).
pub fn level_part(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    const COLUMNS: [usize; 4] = [0, 1, 2, 5];
    let count = 4 * (covariance.nrows() / 6);
    DMatrix::from_fn(count, count, |i, j| {
        covariance[(6 * (i / 4) + COLUMNS[i % 4], 6 * (j / 4) + COLUMNS[j % 4])]
    })
}

/// Converts alignments to a common frame, `world_from_station`, into transforms to station 1's frame, and the covariance of the
/// transforms of stations 2, 3, …
///
/// With T = W1⁻¹ Ws: δt = R1ᵀ (δt_s − δt_1 − ω_1 × (t_s − t_1)) and ω = R1ᵀ (ω_s − ω_1).
pub fn relative_to_station1(
    world_from_station: &PerStation<RigidTransform>,
    covariance: Option<&DMatrix<f64>>,
) -> (PerStation<RigidTransform>, Option<DMatrix<f64>>) {
    let station1_from_world = world_from_station[0].inverse();
    let back = station1_from_world.rotation.matrix();
    let transforms =
        world_from_station.map_each(|station, world_from_station| match station.slot() {
            None => RigidTransform::IDENTITY,
            Some(_) => station1_from_world.then_from(world_from_station),
        });
    let covariance = covariance.map(|covariance| {
        let slots = world_from_station.len() - 1;
        let mut jacobian = DMatrix::zeros(6 * slots, 6 * (slots + 1));
        for slot in 0..slots {
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

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};

    const SIGMA_M: f64 = 0.003;
    const DRAWS: usize = 300;

    /// Draws control points in a typical layout: most of them near the stations, one in five far away.
    fn points_m(count: usize, rng: &mut ChaCha8Rng) -> Vec<Vector3<f64>> {
        (0..count)
            .map(|k| {
                let reach_m = if k % 5 == 0 { 60.0 } else { 10.0 };
                let mut along = || rng.random_range(-reach_m..reach_m);
                Vector3::new(along(), along(), 0.05 * along())
            })
            .collect()
    }

    /// Returns stated over true variance of each parameter of two alignments to the same points, and of their covariances. `state`
    /// returns the stated covariance.
    fn stated_over_true(
        count: usize,
        alignment: Alignment,
        state: impl Fn(&[Matches], &Aligned) -> DMatrix<f64>,
    ) -> Vec<f64> {
        let mut rng = ChaCha8Rng::seed_from_u64(count as u64);
        let noise = Normal::new(0.0, SIGMA_M).expect("a σ");
        let columns = estimated(alignment);
        let mut ratios = vec![0.0; 3 * columns.len()];
        for _ in 0..DRAWS {
            let truth_m = points_m(count, &mut rng);
            let mut seen = || -> Vec<Vector3<f64>> {
                truth_m.iter().map(|p| p.map(|axis| axis + noise.sample(&mut rng))).collect()
            };
            let to_m = seen();
            let matches = [0, 1].map(|_| Matches {
                to_m: to_m.clone(),
                from_m: seen(),
                block: (0..count as u32).collect(),
            });
            let aligned = align(&matches, alignment, Errors::ByBlock).expect("held");
            let stated = state(&matches, &aligned);
            let rows = truth_m.iter().map(|point| jacobian(point, alignment));
            let normal: Matrix6<f64> = rows.map(|j| j.transpose() * j).sum();
            let unit = inverse(normal, alignment).expect("held") * SIGMA_M.powi(2);
            for (place, k) in columns.iter().enumerate() {
                let variance = unit[(*k, *k)];
                let [own, other, common] = [(*k, *k), (6 + k, 6 + k), (*k, 6 + k)];
                for (kind, (at, truth)) in
                    [(own, 2.0 * variance), (other, 2.0 * variance), (common, variance)]
                        .into_iter()
                        .enumerate()
                {
                    ratios[kind * columns.len() + place] += stated[at] / truth / DRAWS as f64;
                }
            }
        }
        ratios
    }

    fn ours(_: &[Matches], aligned: &Aligned) -> DMatrix<f64> {
        aligned.covariance.clone().expect("held")
    }

    /// The sandwich with B / (B − n/3) for B points and n unknowns.
    fn with_a_common_factor(matches: &[Matches], aligned: &Aligned) -> DMatrix<f64> {
        let alignment = Alignment::Level;
        let count = matches[0].len() as f64;
        let mut covariance = DMatrix::zeros(12, 12);
        for (a, one) in matches.iter().enumerate() {
            let rows =
                || one.from_m.iter().map(|p| jacobian(&aligned.to_from[a].rotate(p), alignment));
            let inverse =
                inverse(rows().map(|j| j.transpose() * j).sum(), alignment).expect("held");
            let pulls = rows().zip(&aligned.residuals_m[a]).map(|(j, r)| j.transpose() * r);
            let middle: Matrix6<f64> = pulls.map(|pull| pull * pull.transpose()).sum();
            let part = inverse * middle * inverse * (count / (count - 4.0 / 3.0));
            covariance.fixed_view_mut::<6, 6>(6 * a, 6 * a).copy_from(&part);
        }
        covariance
    }

    #[test]
    fn stated_variances_by_block_are_the_true_ones_from_8_to_60_points() {
        for count in [8, 12, 16, 20, 40, 60] {
            for alignment in [Alignment::Level, Alignment::Rigid] {
                let ratios = stated_over_true(count, alignment, ours);
                let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
                assert!((0.93..1.07).contains(&mean), "{count} points: {ratios:.2?}");
                let all = ratios.iter().all(|ratio| (0.75..1.25).contains(ratio));
                assert!(all, "{count} points: {ratios:.2?}");
            }
        }
        // The few points far away determine yaw, which a common factor ignores.
        for (count, most) in [(8, 0.65), (12, 0.75), (20, 0.85)] {
            let old = stated_over_true(count, Alignment::Level, with_a_common_factor);
            assert!(old[3] < most, "{count} points: {old:.2?}");
        }
    }
}
