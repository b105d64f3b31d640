//! Reasons why an answer gives no trajectory.

/// Reason why there are no poses.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoTrajectory {
    #[error(
        "{0}: all stations follow one prism, so there is no orientation; use the joint estimate for its positions"
    )]
    OnePrism(String),
    #[error(
        "{0}: the inter-prism distances are not known; put calibration_results.csv beside the tracks, or name a rig file"
    )]
    NoRig(String),
    #[error(
        "{0}: the orientation is not determined: there are fewer than three prisms, or they lie on a line"
    )]
    PrismsOnALine(String),
    #[error(
        "{0}: the distances do not determine the positions of more than three prisms; give prisms_m in deployment.toml, or a \
         reading of the rig"
    )]
    UnknownLayout(String),
    #[error(
        "{0}: this calibration is in the stations' own frames, but the tracks are in another frame; use method C or D"
    )]
    OtherFrame(String),
    #[error(
        "{0}: this method has poses at the triplets only; use the joint estimate for poses at any time"
    )]
    NoMotion(String),
    #[error("{name}: no trajectory without a calibration: {why}")]
    NoAnswer { name: String, why: String },
    #[error("{0}: the joint estimate found no motion that fits the readings; see its findings")]
    NoMotionFits(String),
}
