//! Thresholds with which a reading would pass the module that stopped it.

use super::explanation::{Explanation, Place, Rate};
use crate::pipeline::{OutlierReason, PipelineSettings, SampleFate};

/// Longest gap that is worth closing (s); positions interpolated across longer ones are not measurements.
const LONGEST_GAP_S: f64 = 10.0;

impl Explanation {
    /// Returns settings with the module relaxed that stopped this reading, by the smallest round amount. The next module
    /// may still stop the reading, and the thresholds apply to every other reading. `None` for a kept reading, or if no
    /// threshold helps.
    pub fn remedy(&self) -> Option<PipelineSettings> {
        let mut settings = self.settings;
        let thresholds = &mut settings.thresholds;
        match (&self.place, self.fate) {
            (_, SampleFate::Rejected(_)) => {
                for Rate { of, value, .. } in self.step?.rates.iter().filter(|r| r.exceeds()) {
                    let allowed = two_digits_up(value.abs());
                    match of {
                        OutlierReason::Range => thresholds.tau_r_m_per_s = allowed,
                        OutlierReason::Azimuth => thresholds.tau_a_deg_per_s = allowed,
                        OutlierReason::Zenith => thresholds.tau_e_deg_per_s = allowed,
                    }
                }
            }
            (Place::In { interval, kept: None, .. }, _) => {
                let tenths = (interval.length_s() * 10.0).ceil() - 1.0;
                thresholds.tau_l_seconds = tenths.max(0.0) / 10.0;
            }
            (Place::InNone(silences), _) => {
                let gaps: Option<Vec<f64>> =
                    silences.iter().map(|silence| self.gap_s(silence)).collect();
                let longest_s = gaps?.into_iter().max_by(f64::total_cmp)?;
                let allowed_s = (longest_s * 10.0).ceil() / 10.0;
                if allowed_s > LONGEST_GAP_S {
                    return None;
                }
                thresholds.tau_s_seconds = allowed_s;
            }
            _ => return None,
        }
        settings.check().is_ok().then_some(settings)
    }
}

/// Rounds up to two digits: 3.42 becomes 3.5.
fn two_digits_up(value: f64) -> f64 {
    let decimals = 1 - value.log10().floor() as i32;
    let scale = 10_f64.powi(decimals);
    // Division by a whole power of ten gives 3.5; multiplication by 0.1 gives 3.5000000000000004.
    if decimals >= 0 {
        (value * scale).ceil() / scale
    } else {
        (value / 10_f64.powi(-decimals)).ceil() * 10_f64.powi(-decimals)
    }
}

#[cfg(test)]
mod tests {
    use super::two_digits_up;

    #[test]
    fn rounding_up_never_falls_below() {
        for (value, expected) in
            [(3.42, 3.5), (1.0, 1.0), (0.051_2, 0.052), (99.1, 100.0), (1234.0, 1300.0)]
        {
            assert_eq!(two_digits_up(value), expected);
        }
    }
}
