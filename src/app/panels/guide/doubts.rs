//! What the doubts about an answer mean, and what to do about each.

/// A kind of doubt.
pub struct Doubt {
    pub title: &'static str,
    /// Findings of this kind have one of these words.
    signs: &'static [&'static str],
    /// What it means, and what to do.
    pub means: &'static str,
}

impl Doubt {
    /// Whether a finding is of this kind.
    pub fn is_of(&self, message: &str) -> bool {
        self.signs.iter().any(|sign| message.contains(sign))
    }
}

pub const DOUBTS: [Doubt; 8] = [
    Doubt {
        title: "A direction is free or weakly held",
        signs: &["a direction free", "weakly held", "of 8 direction", "hardly moved"],
        means: "The drive lets stations move without the distances noticing. No setting mends it: drive a figure-eight with \
                turns to both sides, 20 m or more across, and solve both drives together (File).",
    },
    Doubt {
        title: "The mirror twin is not ruled out",
        signs: &["twin", "another solution", "another minimum"],
        means: "Two answers fit, with a station higher or lower. Add calibration_raw.csv (one station's reading of the prisms) \
                or control points, or drive over uneven ground, so that the rig pitches and rolls.",
    },
    Doubt {
        title: "Control points or the drive contradict the answer",
        signs: &["contradict"],
        means: "Two sources that should agree do not. A station was knocked between them, a point was read with another prism, \
                or a constant is wrong. Look at which file is apart (Result, metrics), check its prism constant, and measure \
                one point again.",
    },
    Doubt {
        title: "A station moved during the drive",
        signs: &[" turned by ", " moved by ", "was knocked"],
        means: "No one answer holds before and after. Select the times before it and use only those; next time firm ground, \
                weights on the tripod, shade.",
    },
    Doubt {
        title: "A clock jumps, drifts or is late",
        signs: &["stamps jump", "stamps seem", "clock seems", "clock that jumped"],
        means: "The joint estimate takes offsets and drifts out and says when a clock jumped; the methods of the paper do not, \
                and are bent by it. Use only the times on one side of a jump.",
    },
    Doubt {
        title: "The distances fit poorly",
        signs: &[
            "fit poorly",
            "from their measured distance",
            "measure the rig again",
            "off by up to",
        ],
        means: "The prisms are in another order, the rig was measured wrongly or bent, a prism constant is counted twice, or a \
                station followed another prism. Check under Put right; then measure the rig again.",
    },
    Doubt {
        title: "An instrument errs more than it should",
        signs: &["beyond chance", "beyond what instruments", "ranges wander by"],
        means: "The estimate needs an error that instruments in order do not have: something else bends the answer and is taken for \
                it. Check temperature, pressure and prism constant, whether the station was levelled, and what its prism \
                looked like from there.",
    },
    Doubt {
        title: "It did not settle",
        signs: &["did not converge", "solver stopped"],
        means: "The estimate stopped before it reached a minimum, mostly because the data is short or contradicts itself. See \
                what else is said, and leave out what is wrong.",
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::analysis::{Analyst, Settings};
    use resect_core::calibration::Verdict;
    use resect_core::deployment::Severity;
    use resect_core::simulation::{Preset, simulate};

    /// What is said of drives that cannot be good is explained.
    #[test]
    fn the_doubts_of_drives_that_hold_little_are_of_a_known_kind() {
        for preset in [Preset::StraightLine, Preset::Circle, Preset::LShape] {
            let deployment =
                resect_io::simulation_files::open(&simulate(preset, 1)).expect("valid");
            let analysis = Analyst::new(deployment.into()).run(&Settings::default());
            let answer = analysis.answer.expect("an answer");
            assert!(answer.calibration.verdict > Verdict::Good, "{preset:?}");
            let doubts: Vec<&str> = answer
                .calibration
                .findings
                .iter()
                .filter(|finding| finding.severity > Severity::Note)
                .map(|finding| finding.message.as_str())
                .collect();
            let known = doubts.iter().any(|line| DOUBTS.iter().any(|doubt| doubt.is_of(line)));
            assert!(known, "{preset:?}: {doubts:#?}");
        }
    }
}
