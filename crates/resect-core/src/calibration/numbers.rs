//! The numbers of a calibration's settings: standard deviations of priors.

use std::ops::Bound;

use super::CalibrationSettings;
use crate::geometry::ARCSECOND_RAD;
use crate::number_setting::{NumberSetting, check_all};

/// All numbers: σ of the inter-prism distances, then the priors of the instrument errors.
pub static CALIBRATION_NUMBERS: [&NumberSetting<CalibrationSettings>; 13] = [
    &SIGMA_DISTANCES,
    &SIGMA_CLOCK_OFFSETS,
    &SIGMA_CLOCK_DRIFTS,
    &SIGMA_CLOCK_WANDER,
    &SIGMA_LATENCIES,
    &SIGMA_LEANS,
    &SIGMA_RANGE_OFFSETS,
    &SIGMA_RANGE_SCALES,
    &SIGMA_INDICES,
    &SIGMA_COLLIMATIONS,
    &SIGMA_REFRACTION,
    &SIGMA_SETTLING_TURN,
    &SIGMA_SETTLING_PLACE,
];

impl CalibrationSettings {
    /// Checks the evidence and all numbers.
    ///
    /// # Errors
    /// Evidence that determines no transform, or the first number that is not accepted, as one line.
    pub fn check(&self) -> Result<(), String> {
        self.evidence.check()?;
        check_all(&CALIBRATION_NUMBERS, self)
    }
}

pub static SIGMA_DISTANCES: NumberSetting<CalibrationSettings> = NumberSetting {
    name: "σ distances",
    label: "σ distances",
    title: "σ distances",
    key: "inter_prism_sigma_m",
    flag: None,
    meaning: "Standard deviation of the known inter-prism distances",
    unit: "mm",
    per_stored: 1e3,
    least: Bound::Included(0.0),
    most: 1.0,
    slider: [0.0, 20.0],
    field: |settings| &mut settings.inter_prism_sigma_m,
};

/// Returns the setting of one prior's standard deviation.
const fn prior(
    name: &'static str,
    key: &'static str,
    meaning: &'static str,
    (unit, per_stored): (&'static str, f64),
    field: fn(&mut CalibrationSettings) -> &mut f64,
) -> NumberSetting<CalibrationSettings> {
    NumberSetting {
        name,
        label: name,
        title: name,
        key,
        flag: None,
        meaning,
        unit,
        per_stored,
        least: Bound::Included(0.0),
        most: f64::INFINITY,
        slider: [0.0, 100.0],
        field,
    }
}

static SIGMA_CLOCK_OFFSETS: NumberSetting<CalibrationSettings> = prior(
    "σ clock offsets",
    "clock_offset_s",
    "Time offset of the clocks from station 1's",
    ("ms", 1e3),
    |settings| &mut settings.errors.clock_offset_s,
);

static SIGMA_CLOCK_DRIFTS: NumberSetting<CalibrationSettings> =
    prior("σ clock drifts", "clock_drift", "Drift of the clocks", ("ppm", 1e6), |settings| {
        &mut settings.errors.clock_drift
    });

static SIGMA_CLOCK_WANDER: NumberSetting<CalibrationSettings> = prior(
    "σ wandering clocks",
    "clock_wander_s",
    "Random walk of the clocks during a drive",
    ("ms", 1e3),
    |settings| &mut settings.errors.clock_wander_s,
);

static SIGMA_LATENCIES: NumberSetting<CalibrationSettings> = prior(
    "σ latencies",
    "latency_s",
    "Time between the angles and the range of a reading",
    ("ms", 1e3),
    |settings| &mut settings.errors.latency_s,
);

static SIGMA_LEANS: NumberSetting<CalibrationSettings> = prior(
    "σ leans",
    "lean_rad",
    "Tilt that the compensator leaves",
    ("″", 1.0 / ARCSECOND_RAD),
    |settings| &mut settings.errors.lean_rad,
);

static SIGMA_RANGE_OFFSETS: NumberSetting<CalibrationSettings> = prior(
    "σ range offsets",
    "range_offset_m",
    "Additive error of the ranges",
    ("mm", 1e3),
    |settings| &mut settings.errors.range_offset_m,
);

static SIGMA_RANGE_SCALES: NumberSetting<CalibrationSettings> =
    prior("σ range scales", "range_scale", "Scale error of the ranges", ("ppm", 1e6), |settings| {
        &mut settings.errors.range_scale
    });

static SIGMA_INDICES: NumberSetting<CalibrationSettings> = prior(
    "σ vertical indices",
    "index_rad",
    "Vertical index error",
    ("″", 1.0 / ARCSECOND_RAD),
    |settings| &mut settings.errors.index_rad,
);

static SIGMA_COLLIMATIONS: NumberSetting<CalibrationSettings> = prior(
    "σ collimations",
    "collimation_rad",
    "Collimation error",
    ("″", 1.0 / ARCSECOND_RAD),
    |settings| &mut settings.errors.collimation_rad,
);

static SIGMA_REFRACTION: NumberSetting<CalibrationSettings> = prior(
    "σ refraction",
    "refraction",
    "Coefficient of refraction upward, beyond 0.13; sideways a quarter",
    ("", 1.0),
    |settings| &mut settings.errors.refraction,
);

static SIGMA_SETTLING_TURN: NumberSetting<CalibrationSettings> = prior(
    "σ settling, turn",
    "settling_rad",
    "Rotation of a tripod during a drive",
    ("mrad", 1e3),
    |settings| &mut settings.errors.settling_rad,
);

static SIGMA_SETTLING_PLACE: NumberSetting<CalibrationSettings> = prior(
    "σ settling, place",
    "settling_m",
    "Displacement of a tripod during a drive",
    ("mm", 1e3),
    |settings| &mut settings.errors.settling_m,
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::Evidence;

    #[test]
    fn evidence_that_determines_no_transform_is_refused() {
        let rig = Evidence { rig: true, ..Evidence::NONE };
        let alone = CalibrationSettings { evidence: rig, ..Default::default() };
        let message = alone.check().expect_err("the rig alone");
        assert!(message.contains("control-points"), "{message}");
        let drive = Evidence { drive: true, ..Evidence::NONE };
        let alone = CalibrationSettings { evidence: drive, ..Default::default() };
        assert_eq!(alone.check(), Ok(()));
    }
}
