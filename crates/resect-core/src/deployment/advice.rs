//! Advice of the Guide: the meaning of findings, and the next step. Kinds of findings name theirs.

/// Advice for several kinds of findings that have the same remedy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Advice {
    pub title: &'static str,
    pub meaning: &'static str,
    /// The next step, as one sentence.
    pub step: &'static str,
}

impl Advice {
    /// Returns the meaning and the next step.
    pub fn in_words(&self) -> String {
        format!("{} {}", self.meaning, self.step)
    }
}

/// Defines constants of [`Advice`], and the list of them.
macro_rules! advice {
    ($($name:ident { $title:literal, $meaning:literal, $step:literal })+) => {
        $(pub const $name: Advice = Advice { title: $title, meaning: $meaning, step: $step };)+

        /// All advice, in the order of the Guide.
        pub const ADVICE: &[Advice] = &[$($name),+];
    };
}

advice! {
    DIRECTION_UNOBSERVABLE {
        "A direction is unobservable or weakly observable",
        "Stations can move without a change of the inter-prism distances. No setting helps. Control points that all stations \
                  measure help wherever a vehicle cannot turn. Several drives can be solved together (File).",
        "Turn once around on the spot in several places, or drive a figure-eight as wide as the place allows."
    }
    STATIONS_FAR {
        "The stations stand too far from the track",
        "An error of yaw grows with the distance from the track. Control points near the stations help as well.",
        "Drive nearer to the stations or over a larger area, if the place allows."
    }
    POINTS_WEAK {
        "The points determine the stations weakly",
        "Points in one place or near a line let a station turn or slide.",
        "Spread three or more points, or the drive of one prism, over a larger area."
    }
    MIRROR {
        "The mirror ambiguity is not resolved",
        "Two solutions fit, with a station higher or lower. A drive over uneven ground, on which the rig pitches and rolls, \
                  decides as well.",
        "Let one station read all prisms (calibration_raw.csv), or let all stations measure three control points."
    }
    TWO_SOLUTIONS {
        "Two different solutions fit",
        "With few turns, a solution with the rig turned fits nearly as well.",
        "Drive again with turns to both sides, or let all stations measure three control points."
    }
    CONTRADICTION {
        "Control points or the drive contradict the answer",
        "Two sources that should agree do not. A station was knocked between them, a point was read with another prism, or a \
                  constant is wrong. The metrics (Result) name the deviating file.",
        "Check marker and prism constant of the deviating file, and measure one of its points again."
    }
    READINGS_AGAINST_RIG {
        "The readings contradict the rig",
        "Stations are exchanged, azimuths have the other sense, a range is in feet, or the reading of the rig is wrong.",
        "Correct how the files are read, under Corrections or in deployment.toml."
    }
    STATION_MOVED {
        "A station moved during the drive",
        "No single calibration fits the whole drive. Firm ground, weights on the tripods and shade prevent it next time.",
        "Select the times on one side of the movement, and use only those."
    }
    CLOCK {
        "A clock jumps, drifts or is late",
        "A joint estimate that converged corrects offsets and drifts, and reports jumps. The methods of the paper do not: \
                  their answers are biased.",
        "Synchronise the stations before the next drive, and use only the times on one side of a jump."
    }
    DISTANCES {
        "The distances fit poorly",
        "The order of the prisms is wrong, the rig was mismeasured or bent, a prism constant is added twice, or a \
                  station followed another prism.",
        "Check the order of the prisms and their constants, then measure the rig again."
    }
    PRISM_CHANGE {
        "A station followed another prism",
        "Its readings of that time were left out, because they contradict the distances of the rig.",
        "State the change of the prism, and the readings count."
    }
    ONE_PRISM {
        "The tracks do not fit one prism",
        "The stations followed several prisms, or their clocks differ.",
        "State the number of prisms under Corrections or in deployment.toml, and check the clocks."
    }
    INSTRUMENT {
        "An instrument error is implausibly large",
        "The estimated error is larger than those of sound instruments: probably another error biases the answer.",
        "Check the instrument: temperature, pressure and prism constant for ranges, levelling and calibration for angles, hot ground for \
               refraction; then its view of the prism."
    }
    SOLVER {
        "The solver did not converge",
        "The solver stopped before it reached a minimum, mostly because the data is short or contradictory.",
        "Leave out the data that the other findings name, or record a longer drive."
    }
    STAMPS {
        "The time stamps are not reliable",
        "An error of the stamps moves a prism by its speed times the error. Until the next recording, trust the slow parts \
                  of the drive.",
        "Synchronise the stations (PTP or radio), and record again."
    }
    FILES {
        "The files contradict each other",
        "Some readings or file names are wrong. If no correction helps, copy the data from the instruments again.",
        "Check under Corrections that each file belongs to this day and is read with the right units."
    }
    RIG {
        "The rig is not known well enough",
        "Method D needs the distances between the prisms to a millimetre. A file of the rig (File) or inter_prism_m in \
                  deployment.toml gives them.",
        "Measure the prisms from one station, or with a calliper."
    }
    READINGS_MISSING {
        "Readings are missing",
        "A calibration needs readings of all stations at the same times.",
        "Check that each station has its file, then relax the filters or record a longer drive."
    }
    NO_ANSWER {
        "The method gives no answer for this data",
        "The data lacks something that the method needs, or the calibration was cancelled.",
        "Choose another method (Settings), or add the data that the message names."
    }
    TRAJECTORY {
        "A trajectory cannot be evaluated",
        "A trajectory needs a ground truth at the same times.",
        "Check that both are of one drive and that their clocks agree, or set the time offset by hand."
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_one_short_sentence() {
        for Advice { step, .. } in ADVICE {
            let ends = step.matches(". ").count();
            assert!(step.ends_with('.') && ends == 0, "{step}");
            assert!(step.split_whitespace().count() <= 25, "{step}");
        }
    }
}
