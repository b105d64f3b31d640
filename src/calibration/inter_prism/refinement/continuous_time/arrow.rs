//! Normal equations of a band of local unknowns, each tied to its neighbours only, and a border of global ones.

use nalgebra::SVector;

use super::super::model::UNKNOWNS;
use super::spline::PER_KNOT;

/// Four neighbouring knots.
const WIDTH: usize = 4 * PER_KNOT;

type Globals = SVector<f64, UNKNOWNS>;
type Square = nalgebra::SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// A linear observation: what it is made of, in units of its noise.
#[derive(Clone, Debug, Default)]
pub struct Row {
    /// Local unknowns and their coefficients; at most four knots of two prisms.
    pub local: Vec<(usize, f64)>,
    pub global: Globals,
    /// Predicted minus observed.
    pub error: f64,
}

/// `[band, border; borderᵀ, corner]`, and the gradient.
pub struct Arrow {
    /// Row i holds columns i−WIDTH+1 to i.
    band: Vec<[f64; WIDTH]>,
    border: Vec<Globals>,
    corner: Square,
    local_gradient: Vec<f64>,
    global_gradient: Globals,
}

/// The same with the local unknowns eliminated.
pub struct Eliminated {
    /// Lower triangle L of the band.
    factor: Vec<[f64; WIDTH]>,
    /// L⁻¹ border, and L⁻¹ gradient.
    border: Vec<Globals>,
    gradient: Vec<f64>,
    /// Information about the global unknowns, and its gradient, whatever the local ones are.
    pub information: Square,
    pub global_gradient: Globals,
}

impl Arrow {
    pub fn new(local: usize) -> Self {
        Self {
            band: vec![[0.0; WIDTH]; local],
            border: vec![Globals::zeros(); local],
            corner: Square::zeros(),
            local_gradient: vec![0.0; local],
            global_gradient: Globals::zeros(),
        }
    }

    /// Adds a row with a weight.
    pub fn add(&mut self, row: &Row, weight: f64) {
        for (i, a) in &row.local {
            let a = weight * a;
            let line = &mut self.band[*i];
            for (j, b) in row.local.iter().filter(|(j, _)| j <= i) {
                line[j + WIDTH - 1 - i] += a * b;
            }
            self.border[*i].axpy(a, &row.global, 1.0);
            self.local_gradient[*i] += a * row.error;
        }
        self.corner.ger(weight, &row.global, &row.global, 1.0);
        self.global_gradient.axpy(weight * row.error, &row.global, 1.0);
    }

    /// `None` where the band is not positive definite.
    pub fn eliminate(self) -> Option<Eliminated> {
        let factor = cholesky(self.band)?;
        let mut border = self.border;
        forward(&factor, &mut border);
        let mut gradient = self.local_gradient;
        forward_one(&factor, &mut gradient);
        let (mut information, mut global_gradient) = (self.corner, self.global_gradient);
        for (line, g) in border.iter().zip(&gradient) {
            information.ger(-1.0, line, line, 1.0);
            global_gradient.axpy(-g, line, 1.0);
        }
        Some(Eliminated { factor, border, gradient, information, global_gradient })
    }
}

impl Eliminated {
    /// The local part of the step, given the global one; both are to be subtracted.
    pub fn local_step(&self, global_step: &Globals) -> Vec<f64> {
        let mut step: Vec<f64> =
            self.border.iter().zip(&self.gradient).map(|(b, g)| g - b.dot(global_step)).collect();
        backward_one(&self.factor, &mut step);
        step
    }

    /// What the local unknowns do when the global ones move: the rows of band⁻¹ border.
    pub fn followed(&self) -> Vec<Globals> {
        let mut followed = self.border.clone();
        backward(&self.factor, &mut followed);
        followed
    }

    /// band⁻¹ applied to a vector.
    pub fn solve_local(&self, right: &mut [f64]) {
        forward_one(&self.factor, right);
        backward_one(&self.factor, right);
    }
}

/// L of band = L Lᵀ.
fn cholesky(mut band: Vec<[f64; WIDTH]>) -> Option<Vec<[f64; WIDTH]>> {
    for i in 0..band.len() {
        let (above, rest) = band.split_at_mut(i);
        let line = &mut rest[0];
        let first = (WIDTH - 1).saturating_sub(i);
        for at in first..WIDTH - 1 {
            // Column j of row i, and what row j has of the columns that both share.
            let j = i + at + 1 - WIDTH;
            let other = &above[j];
            let shift = WIDTH - 1 - at;
            let dot: f64 = line[first..at]
                .iter()
                .zip(&other[first + shift..WIDTH - 1])
                .map(|(a, b)| a * b)
                .sum();
            line[at] = (line[at] - dot) / other[WIDTH - 1];
        }
        let square: f64 = line[first..WIDTH - 1].iter().map(|a| a * a).sum();
        let pivot = line[WIDTH - 1] - square;
        // A pivot that is lost in rounding is none.
        if pivot.is_nan() || pivot <= 1e-13 * line[WIDTH - 1] {
            return None;
        }
        line[WIDTH - 1] = pivot.sqrt();
    }
    Some(band)
}

fn forward(factor: &[[f64; WIDTH]], right: &mut [Globals]) {
    for i in 0..factor.len() {
        let (above, rest) = right.split_at_mut(i);
        let first = (WIDTH - 1).saturating_sub(i);
        let mut value = rest[0];
        for at in first..WIDTH - 1 {
            value.axpy(-factor[i][at], &above[i + at + 1 - WIDTH], 1.0);
        }
        rest[0] = value / factor[i][WIDTH - 1];
    }
}

fn backward(factor: &[[f64; WIDTH]], right: &mut [Globals]) {
    for i in (0..factor.len()).rev() {
        let value = right[i] / factor[i][WIDTH - 1];
        right[i] = value;
        for at in (WIDTH - 1).saturating_sub(i)..WIDTH - 1 {
            right[i + at + 1 - WIDTH].axpy(-factor[i][at], &value, 1.0);
        }
    }
}

fn forward_one(factor: &[[f64; WIDTH]], right: &mut [f64]) {
    for i in 0..factor.len() {
        let first = (WIDTH - 1).saturating_sub(i);
        let dot: f64 = (first..WIDTH - 1).map(|at| factor[i][at] * right[i + at + 1 - WIDTH]).sum();
        right[i] = (right[i] - dot) / factor[i][WIDTH - 1];
    }
}

fn backward_one(factor: &[[f64; WIDTH]], right: &mut [f64]) {
    for i in (0..factor.len()).rev() {
        let value = right[i] / factor[i][WIDTH - 1];
        right[i] = value;
        for at in (WIDTH - 1).saturating_sub(i)..WIDTH - 1 {
            right[i + at + 1 - WIDTH] -= factor[i][at] * value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng};

    /// The whole matrix.
    fn dense(arrow: &Arrow) -> DMatrix<f64> {
        let local = arrow.band.len();
        let mut full = DMatrix::zeros(local + UNKNOWNS, local + UNKNOWNS);
        for i in 0..local {
            for at in (WIDTH - 1).saturating_sub(i)..WIDTH {
                let j = i + at + 1 - WIDTH;
                full[(i, j)] = arrow.band[i][at];
                full[(j, i)] = arrow.band[i][at];
            }
            for g in 0..UNKNOWNS {
                full[(i, local + g)] = arrow.border[i][g];
                full[(local + g, i)] = arrow.border[i][g];
            }
        }
        full.view_mut((local, local), (UNKNOWNS, UNKNOWNS)).copy_from(&arrow.corner);
        full
    }

    #[test]
    fn elimination_is_the_dense_solution() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let local = 8 * PER_KNOT;
        let mut arrow = Arrow::new(local);
        for _ in 0..2000 {
            let first = PER_KNOT * rng.random_range(0..5);
            let row = Row {
                local: (0..12).map(|k| (first + 3 * k, rng.random_range(-1.0..1.0))).collect(),
                global: Globals::from_fn(|_, _| rng.random_range(-1.0..1.0)),
                error: rng.random_range(-1.0..1.0),
            };
            arrow.add(&row, rng.random_range(0.1..2.0));
        }
        for i in 0..local {
            let global = Globals::zeros();
            arrow.add(&Row { local: vec![(i, 1.0)], global, error: 0.3 }, 1.0);
        }
        let full = dense(&arrow);
        let right = DVector::from_iterator(
            local + UNKNOWNS,
            arrow.local_gradient.iter().chain(arrow.global_gradient.iter()).copied(),
        );
        let solution = full.clone().cholesky().expect("definite").solve(&right);
        let eliminated = arrow.eliminate().expect("definite");
        let inverse = eliminated.information.cholesky().expect("definite").inverse();
        let global = inverse * eliminated.global_gradient;
        let found = eliminated.local_step(&global);
        for i in 0..local {
            assert!((found[i] - solution[i]).abs() < 1e-9, "{i}");
        }
        for g in 0..UNKNOWNS {
            assert!((global[g] - solution[local + g]).abs() < 1e-9, "global {g}");
        }
        let all = full.try_inverse().expect("definite");
        let corner = all.view((local, local), (UNKNOWNS, UNKNOWNS));
        assert!((inverse - corner).amax() < 1e-9);
    }
}
