//! A Gaussian process with a squared-exponential kernel over a straight line of which nothing is known, for so few
//! readings that their covariance matrix can be factored.
//!
//! With `K = exp(−Δt²/2ℓ²) + (σ_n²/σ_f²) I` and the line's basis `H` under a flat prior (Rasmussen & Williams 2006,
//! sections 2.2 and 2.7).

use nalgebra::{Cholesky, DMatrix, Dyn};

/// Readings whose covariances, in units of `σ_f²`, are factored.
pub struct Window<'a> {
    times_s: &'a [f64],
    length_scale_s: f64,
    noise_ratio: f64,
    /// `exp(−Δt²/2ℓ²)` between readings.
    pub correlation: DMatrix<f64>,
    /// Cholesky factor of `K`, the correlation with the noise ratio on its diagonal.
    factor: Cholesky<f64, Dyn>,
    /// `H`: one column of ones, and one of times if there are two readings or more.
    line: DMatrix<f64>,
    /// `K⁻¹ H`.
    weighted_line: DMatrix<f64>,
    /// Cholesky factor of `Hᵀ K⁻¹ H`, what the readings know of the line.
    line_factor: Cholesky<f64, Dyn>,
}

impl<'a> Window<'a> {
    /// Factors the covariances of readings at these times, with a kernel of this length scale and noise of variance
    /// `σ_n²/σ_f²`.
    pub fn new(times_s: &'a [f64], length_scale_s: f64, noise_ratio: f64) -> Self {
        let correlation = correlation(times_s, times_s, length_scale_s);
        let mut kernel = correlation.clone();
        for i in 0..times_s.len() {
            kernel[(i, i)] += noise_ratio;
        }
        let factor = Cholesky::new(kernel).expect("noise keeps the kernel positive");
        let line = line(times_s, times_s);
        let weighted_line = factor.solve(&line);
        let line_factor = Cholesky::new(line.tr_mul(&weighted_line)).expect("stamps differ");
        Self {
            times_s,
            length_scale_s,
            noise_ratio,
            correlation,
            factor,
            line,
            weighted_line,
            line_factor,
        }
    }

    /// `ln |K| + ln |HᵀK⁻¹H|`.
    pub fn ln_determinants(&self) -> f64 {
        self.factor.ln_determinant() + self.line_factor.ln_determinant()
    }

    /// `P = K⁻¹ − K⁻¹H (HᵀK⁻¹H)⁻¹ HᵀK⁻¹`: the weights of readings once any line is taken out.
    pub fn projector(&self) -> DMatrix<f64> {
        let known = &self.weighted_line * self.line_factor.inverse();
        self.factor.inverse() - known * self.weighted_line.transpose()
    }

    /// Weighs positions with one column for each axis: the best line's coefficients, what it leaves, and `K⁻¹` times
    /// that, which is `P y`.
    pub fn weigh(&self, positions_m: &DMatrix<f64>) -> [DMatrix<f64>; 3] {
        let coefficients = self.line_factor.solve(&self.weighted_line.tr_mul(positions_m));
        let rest_m = positions_m - &self.line * &coefficients;
        let weights = self.factor.solve(&rest_m);
        [coefficients, rest_m, weights]
    }

    /// Positions (m) at some instants, one column for each axis, and their standard deviations in units of `σ_f`
    /// (eq. 2.41 and 2.42 with a flat prior).
    pub fn predict(
        &self,
        positions_m: &DMatrix<f64>,
        instants_s: &[f64],
    ) -> (DMatrix<f64>, Vec<f64>) {
        let [coefficients, _, weights] = self.weigh(positions_m);
        let mut cross = correlation(self.times_s, instants_s, self.length_scale_s);
        let line = line(self.times_s, instants_s);
        let points_m = cross.tr_mul(&weights) + &line * coefficients;
        // What the readings near an instant leave unsaid of the line there.
        let mut unsaid = line.transpose() - self.weighted_line.tr_mul(&cross);
        self.line_factor.l_dirty().solve_lower_triangular_mut(&mut unsaid);
        self.factor.l_dirty().solve_lower_triangular_mut(&mut cross);
        // Weights that add to one cannot average the noise further down; rounding could.
        let least = self.noise_ratio / self.times_s.len() as f64;
        let sigma = cross.column_iter().zip(unsaid.column_iter()).map(|(known, unsaid)| {
            (1.0 - known.norm_squared() + unsaid.norm_squared()).max(least).sqrt()
        });
        (points_m, sigma.collect())
    }
}

fn correlation(a_s: &[f64], b_s: &[f64], length_scale_s: f64) -> DMatrix<f64> {
    let scale = -0.5 / length_scale_s.powi(2);
    DMatrix::from_fn(a_s.len(), b_s.len(), |i, j| (scale * (a_s[i] - b_s[j]).powi(2)).exp())
}

/// The line's basis at some instants, centred and scaled to the readings so that both columns weigh alike.
fn line(readings_s: &[f64], instants_s: &[f64]) -> DMatrix<f64> {
    let last = readings_s.len() - 1;
    let (middle_s, half_s) =
        ((readings_s[0] + readings_s[last]) / 2.0, (readings_s[last] - readings_s[0]) / 2.0);
    DMatrix::from_fn(instants_s.len(), readings_s.len().min(2), |i, j| {
        if j == 0 { 1.0 } else { (instants_s[i] - middle_s) / half_s }
    })
}
