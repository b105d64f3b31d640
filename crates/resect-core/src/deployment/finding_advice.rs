//! Advice of the Guide by kind of finding: the meaning of a finding, and the next step.

use super::FindingKind;
use super::FindingKind as Kind;

/// Advice for several kinds of findings that have the same remedy.
#[derive(Debug, PartialEq, Eq)]
pub struct Advice {
    pub title: &'static str,
    pub meaning: &'static str,
    /// The next step, as one sentence.
    pub step: &'static str,
    pub kinds: &'static [FindingKind],
}

impl Advice {
    /// Returns the meaning and the next step.
    pub fn in_words(&self) -> String {
        format!("{} {}", self.meaning, self.step)
    }
}

impl FindingKind {
    /// The advice of the Guide for this kind; `None` if it has none.
    pub fn advice(self) -> Option<&'static Advice> {
        ADVICE.iter().find(|advice| advice.kinds.contains(&self))
    }
}

pub const ADVICE: [Advice; 19] = [
    Advice {
        title: "A direction is unobservable or weakly observable",
        meaning: "Stations can move without a change of the inter-prism distances. No setting helps. Control points that all stations \
                  measure help wherever a vehicle cannot turn. Several drives can be solved together (File).",
        step: "Turn once around on the spot in several places, or drive a figure-eight as wide as the place allows.",
        kinds: &[
            Kind::DriveLeavesDirectionFree,
            Kind::DriveWeak,
            Kind::DriveStanding,
            Kind::DriveStraightLine,
            Kind::DriveCircle,
            Kind::DriveTwoLegs,
            Kind::PlanLeavesDirectionFree,
            Kind::PlanWeak,
        ],
    },
    Advice {
        title: "The stations stand too far from the track",
        meaning: "An error of yaw grows with the distance from the track. Control points near the stations help as well.",
        step: "Drive nearer to the stations or over a larger area, if the place allows.",
        kinds: &[Kind::StationsFarFromTrack],
    },
    Advice {
        title: "The points determine the stations weakly",
        meaning: "Points in one place or near a line let a station turn or slide.",
        step: "Spread three or more points, or the drive of one prism, over a larger area.",
        kinds: &[Kind::PointsLeaveDirectionFree, Kind::PointsWeak, Kind::ResectionUnchecked],
    },
    Advice {
        title: "The mirror ambiguity is not resolved",
        meaning: "Two solutions fit, with a station higher or lower. A drive over uneven ground, on which the rig pitches and rolls, \
                  decides as well.",
        step: "Let one station read all three prisms (calibration_raw.csv), or let all stations measure three control points.",
        kinds: &[
            Kind::FlatGround,
            Kind::MirrorUnresolved,
            Kind::MirrorWitnessContradicted,
            Kind::MirrorNeedsWitness,
            Kind::PlanMirrorUnresolved,
        ],
    },
    Advice {
        title: "Two different solutions fit",
        meaning: "With few turns, a solution with the rig turned fits nearly as well.",
        step: "Drive again with turns to both sides, or let all stations measure three control points.",
        kinds: &[Kind::RivalMinimum, Kind::OtherMinimumFitsBetter],
    },
    Advice {
        title: "Control points or the drive contradict the answer",
        meaning: "Two sources that should agree do not. A station was knocked between them, a point was read with another prism, or a \
                  constant is wrong. The metrics (Result) name the deviating file.",
        step: "Check marker and prism constant of the deviating file, and measure one of its points again.",
        kinds: &[
            Kind::ControlPointsContradict,
            Kind::DriveContradicts,
            Kind::DriveFitsPoorly,
            Kind::SetUpChangeUndecided,
            Kind::MethodsDisagree,
            Kind::ControlPointsFitPoorly,
            Kind::ControlPointOutlier,
            Kind::KnownPointMisplaced,
            Kind::KnownDistanceOff,
            Kind::ResectionInconsistent,
        ],
    },
    Advice {
        title: "The readings contradict the rig",
        meaning: "Stations are exchanged, azimuths have the other sense, a range is in feet, or the reading of the rig is wrong.",
        step: "Correct how the files are read, under Corrections or in deployment.toml.",
        kinds: &[
            Kind::RigOrientationContradicts,
            Kind::RigHeightsContradict,
            Kind::MisreadingSuspected,
            Kind::MisreadingNotFound,
        ],
    },
    Advice {
        title: "A station moved during the drive",
        meaning: "No single calibration fits the whole drive. Firm ground, weights on the tripods and shade prevent it next time.",
        step: "Select the times on one side of the movement, and use only those.",
        kinds: &[Kind::StationMoved, Kind::SpanLeftOut, Kind::LiveStepped],
    },
    Advice {
        title: "A clock jumps, drifts or is late",
        meaning: "A joint estimate that converged corrects offsets and drifts, and reports jumps. The methods of the paper do not: \
                  their answers are biased.",
        step: "Synchronise the stations before the next drive, and use only the times on one side of a jump.",
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
        meaning: "The order of the prisms is wrong, the rig was mismeasured or bent, a prism constant is added twice, or a \
                  station followed another prism.",
        step: "Check the order of the prisms and their constants, then measure the rig again.",
        kinds: &[
            Kind::DistancesFitPoorly,
            Kind::DistanceOff,
            Kind::DistanceImplausible,
            Kind::DistancesImplausible,
            Kind::OutliersShiftAnswer,
            Kind::ManyOutliersLeftOut,
            Kind::PublishedAnswerFarApart,
            Kind::LiveWrongPrism,
        ],
    },
    Advice {
        title: "The tracks do not fit one prism",
        meaning: "The stations followed several prisms, or their clocks differ.",
        step: "State the number of prisms under Corrections or in deployment.toml, and check the clocks.",
        kinds: &[Kind::PrismCountUndecided, Kind::TracksApart, Kind::TracksFitPoorly],
    },
    Advice {
        title: "An instrument error is implausibly large",
        meaning: "The estimated error is larger than those of sound instruments: probably another error biases the answer.",
        step: "Check the instrument for that error: temperature, pressure and prism constant for ranges, levelling and calibration for \
               angles; then its view of the prism.",
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
        meaning: "The solver stopped before it reached a minimum, mostly because the data is short or contradictory.",
        step: "Leave out the data that the other findings name, or record a longer drive.",
        kinds: &[
            Kind::EstimateNotConverged,
            Kind::EstimateDiverged,
            Kind::NoCommonReadings,
            Kind::PriorsTightened,
            Kind::SolverNotConverged,
            Kind::JointEstimateUndetermined,
        ],
    },
    Advice {
        title: "The time stamps are not reliable",
        meaning: "An error of the stamps moves a prism by its speed times the error. Until the next recording, trust the slow parts \
                  of the drive.",
        step: "Synchronise the stations (PTP or radio), and record again.",
        kinds: &[
            Kind::ReadingsWithoutTime,
            Kind::StampsCoarse,
            Kind::ClockSetBack,
            Kind::StationClockOff,
            Kind::StampsContradictRecorder,
            Kind::TimeCorrectionsContradictStamps,
            Kind::StationsWithoutCommonTime,
        ],
    },
    Advice {
        title: "The files contradict each other",
        meaning: "Some readings or file names are wrong. If no correction helps, copy the data from the instruments again.",
        step: "Check under Corrections that each file belongs to this day and is read with the right units.",
        kinds: &[
            Kind::CartesianOriginDoubtful,
            Kind::FolderDateContradictsStamps,
            Kind::ReadingsImplausible,
            Kind::SurveyAnglesSeemElevations,
        ],
    },
    Advice {
        title: "The rig is not known well enough",
        meaning: "Method D needs the distances between the prisms to a millimetre. A file of the rig (File) or inter_prism_m in \
                  deployment.toml gives them.",
        step: "Measure the three prisms from one station, or with a calliper.",
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
        meaning: "A calibration needs readings of all stations at the same times.",
        step: "Check that each station has its file, then relax the filters or record a longer drive.",
        kinds: &[
            Kind::StationWithoutReadings,
            Kind::NoTriplets,
            Kind::TooFewTriplets,
            Kind::FewTimeBlocks,
            Kind::MethodLacksData,
        ],
    },
    Advice {
        title: "The method gives no answer for this data",
        meaning: "The data lacks something that the method needs, or the calibration was cancelled.",
        step: "Choose another method (Settings), or add the data that the message names.",
        kinds: &[Kind::PointsOnALine, Kind::NoJointEstimate, Kind::NoAnswer, Kind::Cancelled],
    },
    Advice {
        title: "A trajectory cannot be evaluated",
        meaning: "A trajectory needs a ground truth at the same times.",
        step: "Check that both are of one drive and that their clocks agree, or set the time offset by hand.",
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
    fn a_step_is_one_short_sentence() {
        for Advice { step, .. } in &ADVICE {
            let ends = step.matches(". ").count();
            assert!(step.ends_with('.') && ends == 0, "{step}");
            assert!(step.split_whitespace().count() <= 25, "{step}");
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
