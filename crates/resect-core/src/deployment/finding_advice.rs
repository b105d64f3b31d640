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
    /// The advice of the Guide for this kind.
    pub fn advice(self) -> Option<&'static Advice> {
        ADVICE.iter().find(|advice| advice.kinds.contains(&self))
    }
}

pub const ADVICE: [Advice; 14] = [
    Advice {
        title: "A direction is free or weakly held",
        text: "The drive lets stations move without the distances noticing. No setting mends it: drive a figure-eight with \
               turns to both sides, 20 m or more across, and solve both drives together (File).",
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
        title: "The mirror twin is not ruled out",
        text: "Two answers fit, with a station higher or lower. Add calibration_raw.csv (one station's reading of the prisms) \
               or control points, or drive over uneven ground, so that the rig pitches and rolls.",
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
               or a constant is wrong. Look at which file is apart (Result, metrics), check its prism constant, and measure \
               one point again.",
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
        text: "No one answer holds before and after. Select the times before it and use only those; next time firm ground, \
               weights on the tripod, shade.",
        kinds: &[Kind::StationMoved, Kind::SpanLeftOut, Kind::LiveStepped],
    },
    Advice {
        title: "A clock jumps, drifts or is late",
        text: "The joint estimate takes offsets and drifts out and says when a clock jumped; the methods of the paper do not, \
               and are bent by it. Use only the times on one side of a jump.",
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
        text: "The prisms are in another order, the rig was measured wrongly or bent, a prism constant is counted twice, or a \
               station followed another prism. Check under Put right; then measure the rig again.",
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
        title: "An instrument errs more than it should",
        text: "The estimate needs an error that instruments in order do not have: something else bends the answer and is taken for \
               it. Check temperature, pressure and prism constant, whether the station was levelled, and what its prism \
               looked like from there.",
        kinds: &[
            Kind::InstrumentErrorImplausible,
            Kind::StationErrorsImplausible,
            Kind::ErrorsImplausible,
            Kind::RangeWanderImplausible,
            Kind::StatedErrorContradicted,
        ],
    },
    Advice {
        title: "It did not settle",
        text: "The estimate stopped before it reached a minimum, mostly because the data is short or contradicts itself. See \
               what else is said, and leave out what is wrong.",
        kinds: &[Kind::EstimateNotConverged, Kind::SolverNotConverged],
    },
    Advice {
        title: "The stamps are not reliable",
        text: "Errors of the stamps move a prism by its speed times the error. Synchronise the stations (PTP or radio) and \
               record again; until then drive slowly, and let the joint estimate find the offsets of the clocks.",
        kinds: &[
            Kind::ReadingsWithoutTime,
            Kind::StampsWholeSeconds,
            Kind::StampsContradictRecorder,
            Kind::TimeCorrectionsContradictStamps,
            Kind::StationsWithoutCommonTime,
        ],
    },
    Advice {
        title: "The files contradict themselves",
        text: "Readings or names of files cannot all be right. Check under Put right that each file belongs to this day and is \
               read with the right units; then copy the data from the instruments again.",
        kinds: &[
            Kind::FolderDateContradictsStamps,
            Kind::ReadingsImplausible,
            Kind::SurveyAnglesSeemElevations,
        ],
    },
    Advice {
        title: "The rig is not known well enough",
        text: "Method D needs the distances between the prisms to a millimetre. Measure the three prisms from one station, or \
               with a calliper, and name the file of the rig (File, or inter_prism_m in deployment.toml).",
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
        text: "A calibration needs readings of all three stations at the same times. Check that each station has its file; then \
               relax the filters, or record a longer drive.",
        kinds: &[
            Kind::StationWithoutReadings,
            Kind::NoTriplets,
            Kind::TooFewTriplets,
            Kind::MethodLacksData,
        ],
    },
    Advice {
        title: "The method has no answer from this data",
        text: "Choose another method (Settings), or give this one what it lacks: the message names it.",
        kinds: &[Kind::PointsOnALine, Kind::NoJointEstimate, Kind::NoAnswer, Kind::Cancelled],
    },
    Advice {
        title: "A trajectory cannot be judged",
        text: "A trajectory needs a ground truth at the same times. Check that both are of one drive and that their clocks \
               agree, or give the offset of the clock by hand.",
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
