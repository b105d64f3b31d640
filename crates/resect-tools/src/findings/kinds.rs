//! Kinds of findings of planning, studies, validation and other trajectories.

resect_core::finding_kinds! {
    /// The clock of a trajectory is far from that of the ground truth.
    ESTIMATE_CLOCK_FAR_OFF = "estimate-clock-far-off", Warning, TRAJECTORY;
    /// The clock of a trajectory is set during the drive.
    ESTIMATE_CLOCK_STEPPED = "estimate-clock-stepped", Warning, TRAJECTORY;
    /// The clock of a trajectory has another rate than that of the ground truth.
    ESTIMATE_CLOCK_DRIFTS = "estimate-clock-drifts", Warning, TRAJECTORY;
    /// The stamps of a trajectory or of its ground truth jitter.
    ESTIMATE_STAMPS_JITTER = "estimate-stamps-jitter", Note;
    /// The clock of a trajectory changes slowly to and fro during the drive.
    ESTIMATE_CLOCK_WANDERS = "estimate-clock-wanders", Note;
    /// A trajectory has another scale than the ground truth.
    ESTIMATE_SCALE_OFF = "estimate-scale-off", Warning, TRAJECTORY;
    /// A trajectory has too few common times with the ground truth to estimate its clock and lever arm.
    ESTIMATE_FEW_POINTS = "estimate-few-points", Note;
    /// A trajectory cannot be compared with the ground truth.
    ESTIMATE_NOT_JUDGED = "estimate-not-judged", Problem, TRAJECTORY;
    /// The orientations of a trajectory follow the ground truth in another convention only.
    ESTIMATE_ORIENTATION_CONVENTION = "estimate-orientation-convention", Warning;
    /// A trajectory or its ground truth has another unit of length than metres.
    ESTIMATE_UNIT = "estimate-unit", Warning;
    /// A trajectory has a slightly different scale all over the drive.
    ESTIMATE_SCALE_DIFFERS = "estimate-scale-differs", Note;
    /// The stamps of a trajectory have another unit, or its clock another rate.
    ESTIMATE_CLOCK_RATE = "estimate-clock-rate", Warning;
    /// The poses of a trajectory are held until the next.
    ESTIMATE_POSES_HELD = "estimate-poses-held", Warning;
    /// The poses of a trajectory are interpolated between others.
    ESTIMATE_POSES_INTERPOLATED = "estimate-poses-interpolated", Note;
    /// Poses of a trajectory are zeros that were never set.
    ESTIMATE_POSES_UNSET = "estimate-poses-unset", Warning;
    /// Poses of a trajectory are far from those before and after, or it continues elsewhere.
    ESTIMATE_JUMPS = "estimate-jumps", Note;
    /// The positions of a trajectory are in a plane.
    ESTIMATE_PLANAR = "estimate-planar", Note;
    /// The positions of a trajectory are mirrored.
    ESTIMATE_MIRRORED = "estimate-mirrored", Warning;
    /// The orientations of a trajectory are later or earlier than its positions.
    ESTIMATE_ORIENTATIONS_LATE = "estimate-orientations-late", Note;
    /// The poses of a trajectory are those of two bodies.
    ESTIMATE_BODIES_MIXED = "estimate-bodies-mixed", Warning;
    /// A trajectory is a copy of another one.
    ESTIMATE_COPY = "estimate-copy", Note;
    /// A trajectory and its ground truth seem to be exchanged.
    ESTIMATE_EXCHANGED = "estimate-exchanged", Note;
    /// A deployment of a study cannot be judged, and was left out.
    DEPLOYMENT_LEFT_OUT = "deployment-left-out", Warning;

    /// The earlier calibration is itself weak.
    EARLIER_CALIBRATION_WEAK = "earlier-calibration-weak", Warning;
    /// One of the compared calibrations is not a joint estimate.
    COMPARED_WITHOUT_JOINT_ESTIMATE = "compared-without-joint-estimate", Note;
    /// Both runs have tracks that an unknown transform brought into one frame.
    COMPARED_IN_UNKNOWN_FRAME = "compared-in-unknown-frame", Warning;
    /// The rig is not the one of the earlier calibration.
    RIG_DIFFERS_FROM_EARLIER = "rig-differs-from-earlier", Warning;

    /// The planned drive leaves a direction unobservable.
    PLAN_LEAVES_DIRECTION_FREE = "plan-leaves-direction-free", Problem, DIRECTION_UNOBSERVABLE;
    /// The planned drive determines a direction weakly.
    PLAN_WEAK = "plan-weak", Warning, DIRECTION_UNOBSERVABLE;
    /// The predicted standard deviation at the far end of the track.
    PLAN_FAR_END = "plan-far-end", Note;
    /// The planned drive decides between the answer and its mirror twin.
    PLAN_RESOLVES_MIRROR = "plan-resolves-mirror", Note;
    /// The planned drive needs a static reading of the prisms to resolve the mirror twin.
    PLAN_MIRROR_NEEDS_READING = "plan-mirror-needs-reading", Note;
    /// The planned drive does not resolve the mirror twin, and the heights of the prisms are too similar to do so.
    PLAN_MIRROR_UNRESOLVED = "plan-mirror-unresolved", Warning, MIRROR;
    /// Readings of the planned drive are lost.
    PLAN_READINGS_LOST = "plan-readings-lost", Warning;
}
