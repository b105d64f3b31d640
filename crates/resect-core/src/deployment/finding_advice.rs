//! Advice of the Guide by kind of finding: the meaning of a finding, and the next step.

use super::FindingKind;
use super::FindingKind as Kind;

/// Advice for several kinds of findings that have the same remedy.
#[derive(Debug, PartialEq, Eq)]
pub struct Advice {
    pub title: &'static str,
    /// Meaning and next step.
    pub text: &'static str,
    pub kinds: &'static [FindingKind],
}

impl FindingKind {
    /// The advice of the Guide for this kind; `None` if it has none.
    pub fn advice(self) -> Option<&'static Advice> {
        ADVICE.iter().find(|advice| advice.kinds.contains(&self))
    }
}

pub const ADVICE: [Advice; 14] = [
    Advice {
        title: "A direction is unobservable or weakly observable",
        text: "Stations can move without a change of the inter-prism distances. No setting helps. Drive a figure-eight with \
               turns to both sides, 20 m or more across if the place allows. Then solve both drives together (File).",
        kinds: &[
            Kind::DriveLeavesDirectionFree,
            Kind::DriveWeak,
            Kind::StationsFarFromTrack,
            Kind::DriveStanding,
            Kind::DriveStraightLine,
            Kind::DriveCircle,
            Kind::DriveTwoLegs,
            Kind::PointsLeaveDirectionFree,
            Kind::PointsWeak,
            Kind::PlanLeavesDirectionFree,
            Kind::PlanWeak,
        ],
    },
    Advice {
        title: "The mirror ambiguity is not resolved",
        text: "Two solutions fit, with a station higher or lower. Add calibration_raw.csv (one station's reading of the \
               prisms) or control points. Or drive over uneven ground, so that the rig pitches and rolls.",
        kinds: &[
            Kind::FlatGround,
            Kind::RivalMinimum,
            Kind::OtherMinimumFitsBetter,
            Kind::MirrorUnresolved,
            Kind::MirrorWitnessContradicted,
            Kind::MirrorNeedsWitness,
            Kind::PlanMirrorUnresolved,
        ],
    },
    Advice {
        title: "Control points or the drive contradict the answer",
        text: "Two sources that should agree do not. A station was knocked between them, a point was read with another prism, \
               or a constant is wrong. Find the deviating file (Result, metrics), check its prism constant, and measure one \
               point again.",
        kinds: &[
            Kind::ControlPointsContradict,
            Kind::DriveContradicts,
            Kind::DriveFitsPoorly,
            Kind::RigOrientationContradicts,
            Kind::RigHeightsContradict,
            Kind::MisreadingSuspected,
            Kind::MisreadingNotFound,
            Kind::ControlPointsFitPoorly,
            Kind::ControlPointOutlier,
            Kind::KnownPointMisplaced,
        ],
    },
    Advice {
        title: "A station moved during the drive",
        text: "No single calibration fits the whole drive. Select the times before the movement and use only those. Next time, \
               use firm ground, weights on the tripods and shade.",
        kinds: &[Kind::StationMoved, Kind::SpanLeftOut, Kind::LiveStepped],
    },
    Advice {
        title: "A clock jumps, drifts or is late",
        text: "The joint estimate corrects offsets and drifts, and reports jumps. The methods of the paper do not: their answers \
               are biased. Use only the times on one side of a jump.",
        kinds: &[
            Kind::ClockStepped,
            Kind::ClockOffsetSuspected,
            Kind::ClockJumpSuspected,
            Kind::ClockDriftImplausible,
            Kind::StationClockDrifts,
            Kind::StationClockJumps,
            Kind::LiveClockJumped,
        ],
    },
    Advice {
        title: "The distances fit poorly",
        text: "The order of the prisms is wrong, the rig was measured wrongly or bent, a prism constant is added twice, or a \
               station followed another prism. Check the data under Corrections. Then measure the rig again.",
        kinds: &[
            Kind::DistancesFitPoorly,
            Kind::DistanceOff,
            Kind::DistanceImplausible,
            Kind::DistancesImplausible,
            Kind::OutliersShiftAnswer,
            Kind::LiveWrongPrism,
        ],
    },
    Advice {
        title: "An instrument error is implausibly large",
        text: "The estimated error is larger than those of sound instruments: probably another error biases the answer. Check \
               temperature, pressure and prism constant, the levelling of the station, and its view of the prism.",
        kinds: &[
            Kind::InstrumentErrorImplausible,
            Kind::StationErrorsImplausible,
            Kind::ErrorsImplausible,
            Kind::RangeWanderImplausible,
            Kind::StatedErrorContradicted,
        ],
    },
    Advice {
        title: "The solver did not converge",
        text: "The solver stopped before it reached a minimum, mostly because the data is short or contradictory. Read the other \
               findings and leave out the wrong data.",
        kinds: &[Kind::EstimateNotConverged, Kind::SolverNotConverged],
    },
    Advice {
        title: "The time stamps are not reliable",
        text: "An error of the stamps moves a prism by its speed times the error. Synchronise the stations (PTP or radio) and \
               record again. Until then, drive slowly and let the joint estimate determine the clock offsets.",
        kinds: &[
            Kind::ReadingsWithoutTime,
            Kind::StampsWholeSeconds,
            Kind::StampsContradictRecorder,
            Kind::TimeCorrectionsContradictStamps,
            Kind::StationsWithoutCommonTime,
        ],
    },
    Advice {
        title: "The files contradict each other",
        text: "Some readings or file names are wrong. Check under Corrections that each file belongs to this day and is read \
               with the right units. Then copy the data from the instruments again.",
        kinds: &[
            Kind::FolderDateContradictsStamps,
            Kind::ReadingsImplausible,
            Kind::SurveyAnglesSeemElevations,
        ],
    },
    Advice {
        title: "The rig is not known well enough",
        text: "Method D needs the distances between the prisms to a millimetre. Measure the three prisms from one station, or \
               with a calliper. Then name the file of the rig (File), or set inter_prism_m in deployment.toml.",
        kinds: &[
            Kind::NoRig,
            Kind::RigUnknown,
            Kind::RigDerivedFromReading,
            Kind::RigReadingDisagrees,
            Kind::LiveNoRig,
        ],
    },
    Advice {
        title: "Readings are missing",
        text: "A calibration needs readings of all three stations at the same times. Check that each station has its file. Then \
               relax the filters, or record a longer drive.",
        kinds: &[
            Kind::StationWithoutReadings,
            Kind::NoTriplets,
            Kind::TooFewTriplets,
            Kind::MethodLacksData,
        ],
    },
    Advice {
        title: "The method gives no answer for this data",
        text: "Choose another method (Settings), or add the data that the message names.",
        kinds: &[Kind::PointsOnALine, Kind::NoJointEstimate, Kind::NoAnswer, Kind::Cancelled],
    },
    Advice {
        title: "A trajectory cannot be evaluated",
        text: "A trajectory needs a ground truth at the same times. Check that both are of one drive and that their clocks \
               agree, or set the time offset by hand.",
        kinds: &[Kind::EstimateNotJudged, Kind::EstimateClockFarOff, Kind::EstimateScaleOff],
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deployment::Severity;

    #[test]
    fn every_doubt_and_problem_has_advice() {
        for kind in FindingKind::ALL {
            let needs = kind.is_doubt() || kind.severity() == Severity::Problem;
            assert!(!needs || kind.advice().is_some(), "{kind:?}");
        }
    }

    #[test]
    fn a_kind_has_one_advice() {
        for kind in FindingKind::ALL {
            let count = ADVICE.iter().filter(|advice| advice.kinds.contains(kind)).count();
            assert!(count <= 1, "{kind:?}");
        }
    }

    #[test]
    fn codes_are_unique_and_in_kebab_case() {
        let mut codes: Vec<&str> = FindingKind::ALL.iter().map(|kind| kind.code()).collect();
        let is_kebab = |code: &&str| code.chars().all(|c| c.is_ascii_lowercase() || c == '-');
        assert!(codes.iter().all(is_kebab), "{codes:?}");
        codes.sort_unstable();
        codes.dedup();
        assert_eq!(codes.len(), FindingKind::ALL.len());
    }
}
