//! Remedies of findings as flags of the command line.

use resect_core::calibration::CalibrationError;
use resect_core::deployment::{Finding, Remedy};

/// The flag that applies a remedy; `None` where no flag does.
fn flag(remedy: &Remedy) -> Option<&'static str> {
    match remedy {
        Remedy::JointEstimate => Some("--method joint"),
        Remedy::ClosedFormPrior => Some("--prior closed-form"),
        Remedy::LevelAlignment => Some("--alignment level"),
        Remedy::GiveRig => Some("--rig"),
        Remedy::GiveControlPoints => Some("--gcp"),
        Remedy::PublishedMethod
        | Remedy::RelaxFilters
        | Remedy::PutRight
        | Remedy::ReadWith(_)
        | Remedy::ShowTimes(_)
        | Remedy::ShowPoint { .. } => None,
    }
}

/// The message of a finding with the flags of its remedies: "…; use --gcp or --rig".
pub fn with_flags(finding: &Finding) -> String {
    let mut line = finding.to_string();
    for (index, flag) in finding.remedies.iter().filter_map(flag).enumerate() {
        line += if index == 0 { "; use " } else { " or " };
        line += flag;
    }
    line
}

/// An error as one line, with the flags of its remedies.
pub fn error_with_flags(error: &anyhow::Error) -> String {
    match error.downcast_ref::<CalibrationError>() {
        Some(error) => with_flags(&error.finding()),
        None => format!("{error:#}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::deployment::FindingKind;

    #[test]
    fn the_line_has_the_flags_and_the_message_has_none() {
        let finding = Finding::new(FindingKind::MirrorNeedsWitness, "the twins fit equally well")
            .with(Remedy::GiveControlPoints)
            .with(Remedy::ShowTimes([1.0, 2.0]))
            .with(Remedy::GiveRig);
        assert_eq!(finding.to_string(), "the twins fit equally well");
        assert_eq!(with_flags(&finding), "the twins fit equally well; use --gcp or --rig");
    }
}
