//! How certain an eliminated motion is: the blocks of the inverse about four knots that follow each other, which is all that
//! an instant takes.
//!
//! From the last knot back, as a smoother goes (Rauch, Tung & Striebel 1965): a knot's unknowns are its row's factors times
//! those of the next three and of the parts, and noise of its own.

use nalgebra::{DMatrix, DMatrixView};

use super::band::Band;
use super::band_rows::{FIRST_PART, PART, TIED};

/// How certain four knots that follow each other are.
pub struct Window {
    pub first: usize,
    /// Covariance of their unknowns, were those of the parts known: 4 × `LOCAL` each way.
    pub covariance: DMatrix<f64>,
    /// How they move with the unknowns of the part that they are in, neighbours being moved alike: 4 × `LOCAL` by [`PART`].
    pub by_part: DMatrix<f64>,
}

/// Shows four knots after the other, from the last back.
pub fn each_window<const LOCAL: usize, const ROW: usize>(
    band: &Band<LOCAL, ROW>,
    mut show: impl FnMut(&Window),
) {
    let size = TIED * LOCAL;
    let rest = size - LOCAL;
    let mut window = Window {
        first: band.rows().len(),
        covariance: DMatrix::zeros(size, size),
        by_part: DMatrix::zeros(size, PART),
    };
    for (knot, rows) in band.rows().iter().enumerate().rev() {
        let own = DMatrix::from_fn(LOCAL, LOCAL, |i, j| if j < i { 0.0 } else { rows[i][j] });
        // It was eliminated with these on its diagonal, none of which is zero.
        let inverse = own.solve_upper_triangular(&DMatrix::identity(LOCAL, LOCAL));
        let inverse = inverse.unwrap_or_else(|| DMatrix::identity(LOCAL, LOCAL));
        let forward = -&inverse * DMatrix::from_fn(LOCAL, rest, |i, j| rows[i][LOCAL + j]);
        let border = DMatrix::from_fn(LOCAL, PART, |i, j| {
            let parts = &rows[i][size + FIRST_PART..];
            parts[j] + parts[PART + j]
        });
        let after = |all: &DMatrix<f64>, columns: usize| -> DMatrix<f64> {
            let kept: DMatrixView<'_, f64> = all.view((0, 0), (rest, columns));
            kept.into_owned()
        };
        let (of_rest, rest_by_part) =
            (after(&window.covariance, rest), after(&window.by_part, PART));
        let with_rest = &forward * &of_rest;
        let own_covariance = &with_rest * forward.transpose() + &inverse * inverse.transpose();
        let own_by_part = &forward * &rest_by_part - &inverse * border;
        window.first = knot;
        window.covariance.view_mut((0, 0), (LOCAL, LOCAL)).copy_from(&own_covariance);
        window.covariance.view_mut((0, LOCAL), (LOCAL, rest)).copy_from(&with_rest);
        window.covariance.view_mut((LOCAL, 0), (rest, LOCAL)).tr_copy_from(&with_rest);
        window.covariance.view_mut((LOCAL, LOCAL), (rest, rest)).copy_from(&of_rest);
        window.by_part.view_mut((0, 0), (LOCAL, PART)).copy_from(&own_by_part);
        window.by_part.view_mut((LOCAL, 0), (rest, PART)).copy_from(&rest_by_part);
        if knot + TIED <= band.rows().len() {
            show(&window);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::band::tests::{KNOTS, LOCAL, example};
    use super::*;

    #[test]
    fn four_knots_are_as_certain_as_the_dense_inverse_says() {
        let (mut band, full, _) = example();
        assert!(band.eliminate());
        let dense = full.try_inverse().expect("definite");
        let locals = KNOTS * LOCAL;
        let of_parts = dense.view((locals, locals), (PART, PART)).into_owned();
        let mut shown = 0;
        each_window(&band, |window| {
            let found =
                &window.covariance + &window.by_part * &of_parts * window.by_part.transpose();
            let (at, size) = (window.first * LOCAL, TIED * LOCAL);
            let expected = dense.view((at, at), (size, size));
            let off = (&found - expected).amax();
            assert!(off < 1e-9 * expected.amax(), "knots from {}: {off}", window.first);
            shown += 1;
        });
        assert_eq!(shown, KNOTS - TIED + 1);
    }
}
