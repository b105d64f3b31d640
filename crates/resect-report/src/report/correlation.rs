//! Correlations of the numbers of an answer.

use maud::{Markup, html};
use nalgebra::DMatrix;

use resect_tools::palette;

const NAMES: [&str; 4] = ["x", "y", "z", "yaw"];
/// Opacity of the background at a correlation of 1; more would hide the number.
const STRONGEST: f64 = 0.6;

/// Returns a shaded table, in the colours of the window's.
pub fn table(covariance: &DMatrix<f64>) -> Markup {
    let name = |place: usize| format!("{} T1{}", NAMES[place % 4], place / 4 + 2);
    html! {
        div.wide { table.correlation {
            thead { tr {
                th {}
                @for place in 0..covariance.nrows() { th.number { (name(place)) } }
            } }
            tbody {
                @for row in 0..covariance.nrows() { tr {
                    th { (name(row)) }
                    @for column in 0..covariance.ncols() {
                        @let correlation = correlation(covariance, row, column);
                        td.number style=[correlation.map(ground)] {
                            @match correlation {
                                Some(correlation) => (format!("{correlation:+.2}")),
                                None => "–",
                            }
                        }
                    }
                } }
            }
        } }
        p.weak {
            "Near ±1, the data determines only a combination of the two quantities. Vermilion: their errors have the same \
             sign; blue: opposite signs."
        }
    }
}

/// Returns a correlation; `None` if a variance is zero.
fn correlation(covariance: &DMatrix<f64>, row: usize, column: usize) -> Option<f64> {
    let spread = (covariance[(row, row)] * covariance[(column, column)]).sqrt();
    (spread > 0.0).then(|| covariance[(row, column)] / spread)
}

fn ground(correlation: f64) -> String {
    let [r, g, b] = palette::correlation(correlation);
    format!("background:rgba({r},{g},{b},{:.2})", STRONGEST * correlation.abs().min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_covariance_over_both_spreads() {
        let mut covariance = DMatrix::from_diagonal_element(8, 8, 4.0);
        covariance[(7, 7)] = 0.0;
        covariance[(1, 2)] = -3.0;
        assert_eq!(correlation(&covariance, 0, 0), Some(1.0));
        assert_eq!(correlation(&covariance, 1, 2), Some(-0.75));
        assert_eq!(correlation(&covariance, 7, 0), None);
        assert!(table(&covariance).into_string().contains("rgba(60,130,200,0.45)\">-0.75<"));
    }
}
