//! The values of the vehicle over time that are plotted, each with σ.

use serde::{Deserialize, Serialize};

use super::dimension::Dimension;
use super::way::Instant;
use resect_core::calibration::Estimate;

/// A value of the vehicle over time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Aspect {
    Height,
    Speed,
    Heading,
    Roll,
    Pitch,
    /// Root of the mean variance of the three axes.
    PositionSigma,
    /// Root of the mean variance about the three axes.
    TurnSigma,
}

impl Aspect {
    /// All aspects in the order of their plots.
    pub const ALL: [Self; 7] = [
        Self::Height,
        Self::Speed,
        Self::Heading,
        Self::Roll,
        Self::Pitch,
        Self::PositionSigma,
        Self::TurnSigma,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Height => "height",
            Self::Speed => "speed",
            Self::Heading => "heading",
            Self::Roll => "roll",
            Self::Pitch => "pitch",
            Self::PositionSigma => "σ position",
            Self::TurnSigma => "σ rotation",
        }
    }

    pub fn hint(self) -> &'static str {
        match self {
            Self::Height => "z of the vehicle's origin in the frame of station 1, with ±1.96 σ",
            Self::Speed => "Length of the velocity of the vehicle's origin, with ±1.96 σ",
            Self::Heading => {
                "Turn about z from the frame of station 1 to the vehicle's, with ±1.96 σ"
            }
            Self::Roll => "Turn about the vehicle's own x, with ±1.96 σ",
            Self::Pitch => "Turn about y between heading and roll, with ±1.96 σ",
            Self::PositionSigma => {
                "How well the position is known: the root of the mean variance of its three axes, with all that is open \
                 about readings, calibration, clocks and rig"
            }
            Self::TurnSigma => {
                "How well the orientation is known: the root of the mean variance about the three axes"
            }
        }
    }

    pub fn dimension(self) -> Dimension {
        match self {
            Self::Height => Dimension::Length,
            Self::Speed => Dimension::Other("m/s"),
            Self::Heading | Self::Roll | Self::Pitch => Dimension::Angle,
            Self::PositionSigma => Dimension::LengthSigma,
            Self::TurnSigma => Dimension::AngleSigma,
        }
    }

    /// The value at an instant, where there is one (m, m/s, rad); σ of what is itself a σ is zero.
    pub fn of(self, instant: &Instant) -> Option<Estimate> {
        let exact = |value: f64| Estimate { value, sigma: 0.0 };
        match self {
            Self::Height => {
                let sigma = instant.position_covariance_m2[(2, 2)].max(0.0).sqrt();
                Some(Estimate { value: instant.position_m.z, sigma })
            }
            Self::Speed => instant.speed_m_per_s,
            Self::Heading => instant.attitude.map(|attitude| attitude.yaw_rad),
            Self::Roll => instant.attitude.map(|attitude| attitude.roll_rad),
            Self::Pitch => instant.attitude.map(|attitude| attitude.pitch_rad),
            Self::PositionSigma => {
                Some(exact((instant.position_covariance_m2.trace() / 3.0).max(0.0).sqrt()))
            }
            Self::TurnSigma => instant.turn_sigma_rad.map(exact),
        }
    }
}
