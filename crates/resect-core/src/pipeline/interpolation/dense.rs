//! Gaussian process with a squared-exponential kernel and an unknown straight line as mean, for series short enough to
//! factor their covariance matrix.
//!
//! The covariance is `K = exp(−Δt²/2ℓ²) + (σ_n²/σ_f²) I` in units of `σ_f²`. The line has the basis `H` under a flat prior
//! (Rasmussen & Williams 2006, sections 2.2 and 2.7). With `K = UᵀU`, all results follow from columns multiplied by `U⁻ᵀ`:
//! the line, the positions, and either the identity or the covariances with the instants.

use nalgebra::{DMatrix, Vector2};

use super::kernel::{correlations, correlations_and_changes};
use crate::linear_algebra::dense_tiles::{LANES, contract, eliminate, padded, products_with};

/// Hyper-parameters of a kernel: length scale, and variance of the noise `σ_n²/σ_f²`.
#[derive(Clone, Copy, Debug)]
pub struct Kernel {
    pub length_scale_s: f64,
    pub noise_ratio: f64,
}

/// Terms of the marginal likelihood of a kernel, and their derivatives.
#[derive(Clone, Copy, Debug, Default)]
pub struct KernelEvidence {
    /// `yᵀPy` summed over the axes, with `P = K⁻¹ − K⁻¹H (HᵀK⁻¹H)⁻¹ HᵀK⁻¹`, the weight matrix of the readings after the
    /// line is projected out.
    pub energy_m2: f64,
    /// Derivatives of the energy by `ln ℓ` and by the logarithm of the noise ratio.
    pub energy_slope: Vector2<f64>,
    /// `ln |K| + ln |HᵀK⁻¹H|`.
    pub volume: f64,
    pub volume_slope: Vector2<f64>,
}

/// Computes the evidence of positions (m) with one column for each axis, two at most, at increasing times (s).
pub fn evidence(times_s: &[f64], positions_m: &DMatrix<f64>, kernel: Kernel) -> KernelEvidence {
    let order = padded(times_s.len());
    let mut rows = CovarianceRows::new(times_s, positions_m, order);
    let staircase = rows.beside();
    // ∂K/∂ln ℓ above the diagonal, by rows.
    let mut changes = vec![0.0; order * order];
    rows.fill(times_s, kernel, |i, t_s, times_s, row| {
        let changes = &mut changes[i * order..(i + 1) * order];
        let from = order - times_s.len();
        let (found, changes) = (&mut row[from..order], &mut changes[from..]);
        correlations_and_changes(t_s, times_s, kernel.length_scale_s, found, changes);
        changes[..i - from].fill(0.0);
        row[staircase + i] = 1.0;
    });
    for i in 0..times_s.len() {
        changes[i * order + times_s.len()..(i + 1) * order].fill(0.0);
    }
    let Eliminated { rows, line, rest_m, lists } = rows.eliminate(kernel.noise_ratio, staircase);
    // `P = XᵀX − GᵀG` with X = U⁻ᵀ and G = QᵀX; `P y` are the weights of the readings.
    let lower = (&rows.values[staircase..], rows.width);
    let found = products_with(lower, &lists, order, true);
    let (known, weights) = found.with_lists.split_at(2);
    let square = |lists: &[Vec<f64>]| lists.iter().map(|list| dot(list, list)).sum::<f64>();
    let trace = found.squares.iter().sum::<f64>() - square(known);
    let [volume_change, energy_change] = contract(lower, [known, weights], &changes, order);
    let ln_pivots: f64 = (0..times_s.len()).map(|i| rows.row(i)[i].ln()).sum();
    KernelEvidence {
        energy_m2: square(&rest_m),
        energy_slope: -Vector2::new(2.0 * energy_change, kernel.noise_ratio * square(weights)),
        volume: 2.0 * (ln_pivots + line.ln_size()),
        volume_slope: Vector2::new(2.0 * volume_change, kernel.noise_ratio * trace),
    }
}

/// Predicts positions (m) at instants (s), one column for each axis, and their standard deviations in units of `σ_f` (eq.
/// 2.41 and 2.42 with a flat prior).
pub fn predict(
    times_s: &[f64],
    positions_m: &DMatrix<f64>,
    kernel: Kernel,
    instants_s: &[f64],
) -> (DMatrix<f64>, Vec<f64>) {
    let (count, room) = (instants_s.len(), padded(instants_s.len()));
    let mut rows = CovarianceRows::new(times_s, positions_m, room);
    let (beside, width) = (rows.beside(), rows.width);
    let order = padded(times_s.len());
    let instants = in_vectors(instants_s);
    rows.fill(times_s, kernel, |_, t_s, times_s, row| {
        let from = order - times_s.len();
        correlations(t_s, times_s, kernel.length_scale_s, &mut row[from..order]);
        correlations(t_s, &instants, kernel.length_scale_s, &mut row[beside..]);
    });
    let Eliminated { rows, line, rest_m, lists } = rows.eliminate(kernel.noise_ratio, width);
    let found = products_with((&rows.values[beside..], width), &lists, room, false);
    let (of_line, points_m) = found.with_lists.split_at(2);
    // Lower bound of the variance: weights that sum to one cannot average the noise further, but rounding could.
    let least = kernel.noise_ratio / times_s.len() as f64;
    let at = |i: usize| line_at(times_s, instants_s[i]);
    let points_m = DMatrix::from_fn(count, rest_m.len(), |i, axis| {
        let [level, slope] = line.coefficients_m[axis];
        points_m[axis][i] + level + slope * at(i)[1]
    });
    let sigma = (0..count).map(|i| {
        // Variance of the line: squared norm of `L⁻¹ (h − HᵀK⁻¹k)`, with its basis h and the covariances k at the instant.
        let unsaid = line.in_basis(at(i));
        let unsaid: f64 =
            of_line.iter().zip(unsaid).map(|(said, all)| (all - said[i]).powi(2)).sum();
        (1.0 - found.squares[i] + unsaid).max(least).sqrt()
    });
    (points_m, sigma.collect())
}

/// Pads times to whole vectors by repeating the last one.
fn in_vectors(times_s: &[f64]) -> Vec<f64> {
    let mut filled = times_s.to_vec();
    filled.resize(padded(times_s.len()), times_s.last().copied().unwrap_or_default());
    filled
}

/// Rows of `[K | H, y, …]`: covariances of the readings, then the line's basis, the positions and further columns.
struct CovarianceRows {
    values: Vec<f64>,
    width: usize,
    /// Number of readings. Padding rows follow to complete the tiles, with zeros and a one on the diagonal.
    readings: usize,
    axes: usize,
}

impl CovarianceRows {
    /// Fills in the line and the positions, with space for `more` columns.
    fn new(times_s: &[f64], positions_m: &DMatrix<f64>, more: usize) -> Self {
        let (readings, axes) = (times_s.len(), positions_m.ncols());
        let order = padded(readings);
        let width = order + padded(2 + axes) + more;
        let mut rows = Self { values: vec![0.0; order * width], width, readings, axes };
        for (i, t_s) in times_s.iter().enumerate() {
            let row = rows.row_mut(i);
            row[order..order + 2].copy_from_slice(&line_at(times_s, *t_s));
            for axis in 0..axes {
                row[order + 2 + axis] = positions_m[(i, axis)];
            }
        }
        for i in readings..order {
            rows.row_mut(i)[i] = 1.0;
        }
        rows
    }

    /// Calls `write` for the covariances of each reading. Its arguments are the reading's index and time, the times from
    /// the beginning of the same vector, and the row.
    fn fill(
        &mut self,
        times_s: &[f64],
        kernel: Kernel,
        mut write: impl FnMut(usize, f64, &[f64], &mut [f64]),
    ) {
        let (in_vectors, order, readings) =
            (in_vectors(times_s), padded(self.readings), self.readings);
        for (i, t_s) in times_s.iter().enumerate() {
            let row = self.row_mut(i);
            write(i, *t_s, &in_vectors[i / LANES * LANES..], row);
            row[readings..order].fill(0.0);
            row[i] += kernel.noise_ratio;
        }
    }

    fn row(&self, i: usize) -> &[f64] {
        &self.values[i * self.width..(i + 1) * self.width]
    }

    fn row_mut(&mut self, i: usize) -> &mut [f64] {
        &mut self.values[i * self.width..(i + 1) * self.width]
    }

    /// Returns the first column after the positions.
    fn beside(&self) -> usize {
        padded(self.readings) + padded(2 + self.axes)
    }

    fn eliminate(mut self, noise_ratio: f64, staircase: usize) -> Eliminated {
        let order = padded(self.readings);
        eliminate(&mut self.values, self.width, order, staircase, noise_ratio.min(1.0));
        let column = |j: usize| (0..self.readings).map(|i| self.row(i)[order + j]).collect();
        let mut line = Line::new(column(0), (self.readings > 1).then(|| column(1)));
        let rest_m: Vec<Vec<f64>> =
            (0..self.axes).map(|axis| line.take_out(column(2 + axis))).collect();
        let mut lists = vec![[0.0; 4]; order];
        for (place, list) in (0..).zip(&line.basis).chain((2..).zip(&rest_m)) {
            lists.iter_mut().zip(list).for_each(|(lists, value)| lists[place] = *value);
        }
        Eliminated { rows: self, line, rest_m, lists }
    }
}

/// Result of the multiplication by `U⁻ᵀ`.
struct Eliminated {
    rows: CovarianceRows,
    line: Line,
    /// Positions with their best line projected out, one list for each axis.
    rest_m: Vec<Vec<f64>>,
    /// For each row, the line's basis and `rest_m`, side by side.
    lists: Vec<[f64; 4]>,
}

/// The best line and its information: `U⁻ᵀH = Q Lᵀ`.
struct Line {
    /// Columns of `Q`: two, or one for a single reading.
    basis: Vec<Vec<f64>>,
    /// `L`: its diagonal and the element below.
    diagonal: [f64; 2],
    below: f64,
    /// Position at mid-time and displacement over half the span, for each axis (m).
    coefficients_m: Vec<[f64; 2]>,
}

impl Line {
    fn new(mut ones: Vec<f64>, times: Option<Vec<f64>>) -> Self {
        let size = normalise(&mut ones);
        let (mut diagonal, mut below) = ([size, 1.0], 0.0);
        let mut basis = vec![ones];
        if let Some(mut times) = times {
            below = subtract_along(&basis[0], &mut times);
            diagonal[1] = normalise(&mut times);
            basis.push(times);
        }
        Self { basis, diagonal, below, coefficients_m: Vec::new() }
    }

    /// `½ ln |HᵀK⁻¹H|`.
    fn ln_size(&self) -> f64 {
        self.diagonal[0].ln() + self.diagonal[1].ln()
    }

    /// Projects the best line out of an axis and stores its coefficients.
    fn take_out(&mut self, mut column_m: Vec<f64>) -> Vec<f64> {
        let mut along = [0.0; 2];
        for (along, basis) in along.iter_mut().zip(&self.basis) {
            *along = subtract_along(basis, &mut column_m);
        }
        let slope = along[1] / self.diagonal[1];
        self.coefficients_m.push([(along[0] - self.below * slope) / self.diagonal[0], slope]);
        column_m
    }

    /// Returns `L⁻¹` times the line's basis functions at an instant.
    fn in_basis(&self, at: [f64; 2]) -> [f64; 2] {
        let level = at[0] / self.diagonal[0];
        [level, (at[1] - self.below * level) / self.diagonal[1]]
    }
}

/// Basis functions of the line at an instant, centred and scaled to the span of the readings so that both have equal
/// weight.
fn line_at(times_s: &[f64], t_s: f64) -> [f64; 2] {
    let (first_s, last_s) = (times_s[0], times_s[times_s.len() - 1]);
    let half_s = 0.5 * (last_s - first_s);
    [1.0, if half_s > 0.0 { (t_s - 0.5 * (first_s + last_s)) / half_s } else { 0.0 }]
}

/// Subtracts a column's component along a unit vector, and returns that component.
fn subtract_along(direction: &[f64], column: &mut [f64]) -> f64 {
    let along = dot(direction, column);
    for (value, direction) in column.iter_mut().zip(direction) {
        *value -= along * direction;
    }
    along
}

/// Normalises a column, and returns its former norm.
fn normalise(column: &mut [f64]) -> f64 {
    let size = dot(column, column).sqrt();
    for value in column.iter_mut() {
        *value /= size;
    }
    size
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::interpolation::tests::{series_of, wander};

    /// Numbers of readings that fill whole vectors, and some smaller and larger ones.
    #[test]
    fn evidence_is_the_textbook_s() {
        let kernel = Kernel { length_scale_s: 2.5, noise_ratio: 1e-3 };
        for count in [3, 7, 8, 9, 40, 61] {
            let series = series_of(&wander(count, 6));
            let times_s = &series.time_s;
            let y_m = DMatrix::from_fn(count, 2, |i, j| {
                series.position_m[i][j] - series.position_m[0][j]
            });
            let apart = |i: usize, j: usize| (times_s[i] - times_s[j]) / kernel.length_scale_s;
            let correlation =
                DMatrix::from_fn(count, count, |i, j| (-0.5 * apart(i, j).powi(2)).exp());
            let change =
                DMatrix::from_fn(count, count, |i, j| apart(i, j).powi(2) * correlation[(i, j)]);
            let noise = DMatrix::identity(count, count) * kernel.noise_ratio;
            let line = DMatrix::from_fn(count, 2, |i, j| line_at(times_s, times_s[i])[j]);
            let factor = (correlation + noise).cholesky().expect("positive");
            let known = (line.tr_mul(&factor.solve(&line))).cholesky().expect("positive");
            let weighted = factor.solve(&line);
            let projector = factor.inverse() - &weighted * known.inverse() * weighted.transpose();
            let weights = &projector * &y_m;

            let found = evidence(times_s, &y_m, kernel);
            let expected = [
                y_m.dot(&weights),
                factor.ln_determinant() + known.ln_determinant(),
                -weights.dot(&(&change * &weights)),
                -kernel.noise_ratio * weights.norm_squared(),
                projector.dot(&change),
                kernel.noise_ratio * projector.trace(),
            ];
            let found = [
                found.energy_m2,
                found.volume,
                found.energy_slope.x,
                found.energy_slope.y,
                found.volume_slope.x,
                found.volume_slope.y,
            ];
            for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
                let off = (found - expected).abs();
                assert!(off < 1e-8 * (1.0 + expected.abs()), "{k} of {count}: {found} {expected}");
            }
        }
    }
}
