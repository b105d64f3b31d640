//! Remedies of findings as flags of the command line.

use resect_core::calibration::CalibrationError;
use resect_core::deployment::{Finding, Remedy, Severity};
use resect_core::evaluation::no_trajectory::NoTrajectory;
use resect_core::evaluation::requested_trajectory::RequestError;
use resect_tools::estimates::Unjudged;
use resect_tools::estimates::unfit::Unfit;

/// Returns the flag that applies a remedy; `None` without one.
fn flag(remedy: &Remedy) -> Option<&'static str> {
    match remedy {
        Remedy::JointEstimate => Some("--method joint"),
        Remedy::ClosedFormPrior => Some("--prior closed-form"),
        Remedy::LevelAlignment => Some("--alignment level"),
        Remedy::GiveRig => Some("--rig"),
        Remedy::GiveControlPoints => Some("--gcp"),
        Remedy::PublishedMethod
        | Remedy::RelaxFilters
        | Remedy::Corrections
        | Remedy::ReadWith(_)
        | Remedy::ShowTimes(_)
        | Remedy::ShowPoint { .. } => None,
    }
}

/// Returns the line of a finding in a list; a warning or a problem has its code at the end, by which the book explains it.
pub fn finding_line(finding: &Finding) -> String {
    let line = with_flags(finding);
    match finding.severity {
        Severity::Note => line,
        Severity::Warning | Severity::Problem => format!("{line} [{}]", finding.kind.code),
    }
}

/// Returns the message of a finding with the flags of its remedies: "…; use --gcp or --rig".
fn with_flags(finding: &Finding) -> String {
    let mut line = finding.to_string();
    for (index, flag) in finding.remedies.iter().filter_map(flag).enumerate() {
        line += if index == 0 { "; use " } else { " or " };
        line += flag;
    }
    line
}

/// Returns the flag, or the command, that follows the advice of an error about a trajectory.
fn trajectory_flag(why: &NoTrajectory) -> Option<&'static str> {
    match why {
        NoTrajectory::OnePrism(_) | NoTrajectory::NoMotion(_) => Some("--method joint"),
        NoTrajectory::NoRig(_) => Some("--rig"),
        NoTrajectory::NoMotionFits(_) => Some("resect calibrate"),
        NoTrajectory::PrismsOnALine(_)
        | NoTrajectory::UnknownLayout(_)
        | NoTrajectory::OtherFrame(_)
        | NoTrajectory::NoAnswer { .. } => None,
    }
}

/// Returns the flag, or the command, that follows the advice of an error about a requested trajectory.
pub fn request_flag(why: &RequestError) -> Option<&'static str> {
    match why {
        RequestError::NoTrajectory(NoTrajectory::PrismsOnALine(_)) => Some("--station"),
        RequestError::NoTrajectory(why) => trajectory_flag(why),
        RequestError::NoOrientation(_) => Some("--lever-arm"),
        RequestError::NoPose { .. } => Some("--max-error"),
        RequestError::NoSite(_) | RequestError::NoPosition(_) => None,
    }
}

/// Returns the flag, or the command, that follows the advice of an error about an estimate.
pub fn unjudged_flag(why: &Unjudged) -> Option<&'static str> {
    match why {
        Unjudged::NoReference(NoTrajectory::PrismsOnALine(_)) => Some("--truth-station"),
        Unjudged::NoReference(why) => trajectory_flag(why),
        // The message names the flag.
        Unjudged::OtherConvention(_) => None,
        Unjudged::Unfit { why, .. } => match why {
            Unfit::NoOverlap | Unfit::OtherDrive(_) | Unfit::AmbiguousOffset { .. } => {
                Some("--time-offset")
            }
            Unfit::OnALine => Some("--align none"),
            Unfit::Undetermined => Some("--body same"),
            Unfit::OtherScale(_) => Some("--align similarity"),
            Unfit::NoOrientation => Some("--body found"),
            Unfit::FirstOnALine(_) => Some("--align-first"),
            Unfit::EmptySpan(_) => Some("--from, --to"),
            Unfit::FewEpochs
            | Unfit::FewPoses(_)
            | Unfit::OtherShape(_)
            | Unfit::Inverse { .. }
            | Unfit::TruthInverse { .. } => None,
        },
    }
}

/// Returns an error as one line, with the flags of its remedies.
pub fn error_with_flags(error: &anyhow::Error) -> String {
    match error.downcast_ref::<CalibrationError>() {
        Some(error) => with_flags(&error.finding()),
        None => format!("{error:#}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::deployment::kinds;

    #[test]
    fn the_line_has_the_flags_and_the_message_has_none() {
        let finding = Finding::new(kinds::MIRROR_NEEDS_WITNESS, "the twins fit equally well")
            .with(Remedy::GiveControlPoints)
            .with(Remedy::ShowTimes([1.0, 2.0]))
            .with(Remedy::GiveRig);
        assert_eq!(finding.to_string(), "the twins fit equally well");
        assert_eq!(with_flags(&finding), "the twins fit equally well; use --gcp or --rig");
    }
}
