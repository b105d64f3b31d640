//! The kinds of findings: one variant for each, with its stable code and its usual severity.

use super::Severity;

/// Defines [`FindingKind`] from lines of variant, code and nature.
macro_rules! finding_kinds {
    ($($(#[doc = $cause:literal])+ $kind:ident = $code:literal, $nature:ident;)+) => {
        /// A kind of finding: the same cause, whatever the station, the file and the numbers.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum FindingKind {
            $($(#[doc = $cause])+ $kind,)+
        }

        impl FindingKind {
            /// All kinds, of all crates.
            pub const ALL: &'static [Self] = &[$(Self::$kind),+];

            /// The stable name in JSON.
            pub fn code(self) -> &'static str {
                match self {
                    $(Self::$kind => $code,)+
                }
            }

            /// The cause in one sentence, as the documentation of the kind has it.
            pub fn cause(self) -> &'static str {
                match self {
                    $(Self::$kind => concat!($($cause),+).trim_ascii(),)+
                }
            }

            fn nature(self) -> Nature {
                match self {
                    $(Self::$kind => Nature::$nature,)+
                }
            }
        }
    };
}

/// Severity of a kind, with the two properties that only some kinds of a severity have.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Nature {
    Note,
    /// A note that a table beside the answer shows too.
    Tabled,
    Warning,
    /// A warning about the data: no answer from it can be better than weak.
    Doubt,
    Problem,
}

impl FindingKind {
    /// The usual severity. Some findings have a lower or higher one: see their constructors.
    pub fn severity(self) -> Severity {
        match self.nature() {
            Nature::Note | Nature::Tabled => Severity::Note,
            Nature::Warning | Nature::Doubt => Severity::Warning,
            Nature::Problem => Severity::Problem,
        }
    }

    /// Returns true if no answer from this data can be better than weak.
    pub fn is_doubt(self) -> bool {
        self.nature() == Nature::Doubt
    }

    /// Returns true if a table beside the answer shows the same numbers.
    pub fn is_tabled(self) -> bool {
        self.nature() == Nature::Tabled
    }
}

// Opening files and streams, calibration, evaluation and planning, the live drive, the window.
finding_kinds! {
    /// A file could not be read, and was skipped.
    FileUnreadable = "file-unreadable", Warning;
    /// The date in the name of the folder contradicts the stamps of the readings.
    FolderDateContradictsStamps = "folder-date-contradicts-stamps", Doubt;

    /// The columns of a table were recognised by their names or assigned by the user.
    TableColumns = "table-columns", Note;
    /// A table has two clocks, and one of them gives the stamps.
    TableClock = "table-clock", Note;
    /// Records were dropped because they cannot be readings.
    RecordsDropped = "records-dropped", Warning;
    /// Readings were not in order of time, and were sorted.
    StampsOutOfOrder = "stamps-out-of-order", Warning;
    /// Several readings of a station have the same stamp; the first of each was kept.
    StampsRepeated = "stamps-repeated", Warning;
    /// A station has no reading.
    StationWithoutReadings = "station-without-readings", Problem;
    /// Readings that are marked as valid have impossible values.
    ReadingsImplausible = "readings-implausible", Doubt;
    /// Readings are in face right and were converted to face left.
    ReadingsInFaceRight = "readings-in-face-right", Note;
    /// The stamps of a station are rounded to a tenth of a second or more, too coarse for a moving prism.
    StampsCoarse = "stamps-coarse", Doubt;
    /// The clock of the recording was set back.
    ClockSetBack = "clock-set-back", Doubt;
    /// Stamps do not count from 1970, so they cannot be compared with GNSS.
    StampsRelative = "stamps-relative", Note;
    /// Two stations have no common time.
    StationsWithoutCommonTime = "stations-without-common-time", Problem;
    /// The prism constant that was added to the ranges.
    PrismConstantAdded = "prism-constant-added", Note;
    /// Only a span of the drive is used.
    SpanSelected = "span-selected", Note;
    /// Readings are left out by hand.
    ReadingsMasked = "readings-masked", Note;
    /// Readings that were left out by hand are not in this data.
    MaskedReadingsMissing = "masked-readings-missing", Warning;

    /// A bag is damaged, and some of its data was lost.
    BagDamaged = "bag-damaged", Warning;
    /// The recording of a bag was interrupted, and the bag was read completely.
    BagIncomplete = "bag-incomplete", Note;
    /// Messages of a bag cannot be decoded.
    BagMessagesMalformed = "bag-messages-malformed", Warning;
    /// The files number the stations other than 1, 2, 3.
    StationsRenumbered = "stations-renumbered", Note;
    /// The stamps of a recording jump by many hours; only the longest part is used.
    StampsJumped = "stamps-jumped", Warning;
    /// Rows of a table, or poses of a bag, are not valid and were skipped.
    RowsSkipped = "rows-skipped", Warning;
    /// A bag is one of several files of a recording, and the others are not read.
    BagSplitsUnread = "bag-splits-unread", Warning;
    /// Several bags are read as one drive.
    BagsJoined = "bags-joined", Note;
    /// Files contain the same readings as another, and are not read.
    CopiesLeftOut = "copies-left-out", Note;
    /// One of the numbered bags of a recording is missing.
    BagMissing = "bag-missing", Warning;
    /// Readings have no synchronised stamp, so the clock of the station is used.
    ReadingsWithoutStamp = "readings-without-stamp", Warning;
    /// Readings have no time of their own, so their time of arrival is used.
    ReadingsWithoutTime = "readings-without-time", Doubt;
    /// Topics with positions are not read.
    PositionsNotRead = "positions-not-read", Note;
    /// Positions are taken as measured in the frame of each instrument.
    PositionsInInstrumentFrames = "positions-in-instrument-frames", Note;
    /// A station has no position on the topic that was given.
    TopicWithoutPositions = "topic-without-positions", Warning;
    /// Theodolite messages are not read because other topics were given.
    TheodoliteMessagesNotRead = "theodolite-messages-not-read", Note;

    /// The tracks are positions, each in the frame of its station.
    TracksInStationFrames = "tracks-in-station-frames", Note;
    /// The tracks were transformed into one frame by an unknown transform.
    TracksInCommonFrame = "tracks-in-common-frame", Warning;
    /// The tracks were transformed into one frame; this was inverted.
    TrackTransformInverted = "track-transform-inverted", Note;
    /// A file of transforms cannot be read.
    TransformsUnreadable = "transforms-unreadable", Warning;
    /// No transform of the files is shown to be the one that was applied to the tracks.
    TransformsNotConfirmed = "transforms-not-confirmed", Warning;
    /// A transform tilts a station more than its compensator allows.
    TransformTiltsStation = "transform-tilts-station", Warning;

    /// A reading of a control point names a station other than 1, 2, 3.
    ControlPointStationUnknown = "control-point-station-unknown", Warning;
    /// A reading of a control point has a status other than 0.
    ControlPointStatusInvalid = "control-point-status-invalid", Warning;
    /// A reading of a control point has an impossible value.
    ControlPointReadingImplausible = "control-point-reading-implausible", Warning;
    /// A station read a control point twice; the first reading is used.
    ControlPointRepeated = "control-point-repeated", Warning;
    /// A file of control points has no usable point.
    ControlPointsEmpty = "control-points-empty", Warning;
    /// The coordinates of a pillar are in no survey of pillars.
    PillarCoordinatesUnknown = "pillar-coordinates-unknown", Warning;
    /// The survey of pillars belongs to no file of readings.
    PillarsWithoutReadings = "pillars-without-readings", Warning;
    /// A point with known coordinates was not measured.
    KnownPointNotMeasured = "known-point-not-measured", Warning;

    /// Readings of a survey have no usable range or angle.
    SurveyReadingsUnusable = "survey-readings-unusable", Warning;
    /// Readings of one point of a survey lie too far apart.
    SurveyPointsInconsistent = "survey-points-inconsistent", Warning;
    /// The vertical angles of a survey seem to be elevations, but are read as zenith angles.
    SurveyAnglesSeemElevations = "survey-angles-seem-elevations", Doubt;
    /// A file of a survey has several set-ups; only the first is used.
    SurveyOtherSetUps = "survey-other-set-ups", Warning;
    /// Readings of a survey lack a distance or an angle.
    SurveyReadingsIncomplete = "survey-readings-incomplete", Warning;
    /// Points that were deleted in the job of a survey are left out.
    SurveyPointsDeleted = "survey-points-deleted", Warning;
    /// Readings of a survey have no prism constant; that of the deployment is added.
    SurveyPrismConstantMissing = "survey-prism-constant-missing", Warning;
    /// The slope distances of a survey contain the prism constant.
    SurveyPrismConstantIncluded = "survey-prism-constant-included", Note;
    /// The prism constants of the targets of a survey are added.
    SurveyPrismConstantsAdded = "survey-prism-constants-added", Note;
    /// The prism constant of the deployment is not added to a survey that has its own.
    SurveyPrismConstantKept = "survey-prism-constant-kept", Note;
    /// A survey has no usable reading.
    SurveyEmpty = "survey-empty", Warning;
    /// A survey has coordinates without readings.
    SurveyCoordinatesLeftOut = "survey-coordinates-left-out", Warning;
    /// The station that measured a survey is not known.
    SurveyStationUnknown = "survey-station-unknown", Warning;
    /// Two surveys are of the same station.
    SurveyStationRepeated = "survey-station-repeated", Warning;
    /// The points of a survey are numbered in order of appearance.
    SurveyPointsNumbered = "survey-points-numbered", Note;

    /// A file of the rig that the user gave replaces the distances of deployment.toml.
    RigFilePreferred = "rig-file-preferred", Note;
    /// The inter-prism distances are not known.
    RigUnknown = "rig-unknown", Note;
    /// The inter-prism distances are derived from one reading of each prism.
    RigDerivedFromReading = "rig-derived-from-reading", Doubt;
    /// The inter-prism distances and the reading of the rig disagree.
    RigReadingDisagrees = "rig-reading-disagrees", Doubt;
    /// The prism positions in deployment.toml belong to another rig.
    PrismPositionsOfOtherRig = "prism-positions-of-other-rig", Warning;
    /// The prism positions and the inter-prism distances disagree.
    PrismPositionsDisagree = "prism-positions-disagree", Warning;

    /// GNSS solutions are left out because there are not three.
    GnssAntennasMissing = "gnss-antennas-missing", Warning;
    /// GNSS solutions have different origins.
    GnssOriginsDiffer = "gnss-origins-differ", Warning;
    /// GNSS fixes were not in order of time, and were sorted.
    GnssStampsOutOfOrder = "gnss-stamps-out-of-order", Warning;
    /// Several GNSS fixes have the same stamp; the first of each was kept.
    GnssStampsRepeated = "gnss-stamps-repeated", Warning;

    /// Poses of a trajectory were not in order of time, and were sorted.
    EstimateOutOfOrder = "estimate-out-of-order", Warning;
    /// Seconds and nanoseconds of an estimated trajectory were joined without leading zeros.
    EstimateStampsJoined = "estimate-stamps-joined", Warning;
    /// The columns of an estimated trajectory have no header.
    EstimateColumnsGuessed = "estimate-columns-guessed", Note;
    /// Several poses of a trajectory have the same time; the first of each was kept.
    EstimateTimesRepeated = "estimate-times-repeated", Warning;
    /// Some poses of a trajectory have no orientation, so none is used.
    EstimateOrientationsMissing = "estimate-orientations-missing", Warning;
    /// All poses of a trajectory have the same orientation.
    EstimateOrientationsConstant = "estimate-orientations-constant", Note;
    /// The coordinates of a trajectory are rounded to centimetres or more.
    EstimatePositionsRounded = "estimate-positions-rounded", Warning;
    /// Some poses of a trajectory have no covariance.
    EstimateCovariancesMissing = "estimate-covariances-missing", Warning;
    /// Quaternions of a trajectory were normalised.
    EstimateQuaternionsNormalised = "estimate-quaternions-normalised", Warning;

    /// The stamps of the readings are the clocks of the stations.
    StampsAreStationClocks = "stamps-are-station-clocks", Note;
    /// The offset, drift and scatter of the station clocks against the stamps.
    StationClocksCompared = "station-clocks-compared", Note;
    /// A station clock and the stamps drift apart faster than clocks do.
    StationClockDrifts = "station-clock-drifts", Warning;
    /// A station clock jumps against the stamps.
    StationClockJumps = "station-clock-jumps", Warning;
    /// The recording has corrections of a station clock.
    TimeCorrections = "time-corrections", Note;
    /// The recorded corrections of a station clock contradict the stamps.
    TimeCorrectionsContradictStamps = "time-corrections-contradict-stamps", Doubt;
    /// The stamps of the stations disagree by the clock of the recorder.
    StampsContradictRecorder = "stamps-contradict-recorder", Doubt;
    /// A drive overlaps the one before it in time, and was shifted.
    DriveShifted = "drive-shifted", Note;
    /// A further drive has slightly different inter-prism distances.
    DriveDistancesDiffer = "drive-distances-differ", Note;

    /// No triplets are left to calibrate from.
    NoTriplets = "no-triplets", Problem;
    /// There are too few triplets to calibrate from.
    TooFewTriplets = "too-few-triplets", Problem;
    /// Method D lacks the inter-prism distances.
    NoRig = "no-inter-prism-distances", Problem;
    /// The data lacks something that the method needs.
    MethodLacksData = "method-lacks-data", Problem;
    /// The points lie on a line, so they determine no rigid transform.
    PointsOnALine = "points-on-a-line", Problem;
    /// The joint estimate has no result.
    NoJointEstimate = "no-joint-estimate", Problem;
    /// The calibration was cancelled.
    Cancelled = "cancelled", Problem;

    /// The estimate stopped before it converged.
    EstimateNotConverged = "estimate-not-converged", Warning;
    /// The estimate moved away from its start without reaching a minimum.
    EstimateDiverged = "estimate-diverged", Warning;
    /// No span of the drive has readings of all stations.
    NoCommonReadings = "no-common-readings", Warning;
    /// The normal matrix of the joint estimate is positive definite only with tighter priors.
    PriorsTightened = "priors-tightened", Warning;
    /// The solver stopped before it converged.
    SolverNotConverged = "solver-not-converged", Warning;
    /// The data does not determine all parameters of the joint estimate.
    JointEstimateUndetermined = "joint-estimate-undetermined", Warning;
    /// Another minimum fits better than the joint estimate.
    OtherMinimumFitsBetter = "other-minimum-fits-better", Warning;
    /// The published method and the joint estimate differ by more than instrument errors.
    PublishedAnswerFarApart = "published-answer-far-apart", Warning;
    /// The published method has no result to compare with.
    PublishedAnswerMissing = "published-answer-missing", Warning;
    /// The answer does not transform the tracks, which are in another frame.
    TracksNotTransformed = "tracks-not-transformed", Warning;
    /// Two methods differ by more than their standard deviations.
    MethodsDisagree = "methods-disagree", Warning;

    /// The points leave a direction unobservable.
    PointsLeaveDirectionFree = "points-leave-direction-free", Problem;
    /// The points determine the stations weakly.
    PointsWeak = "points-weak", Warning;
    /// The drive leaves a direction unobservable.
    DriveLeavesDirectionFree = "drive-leaves-direction-free", Problem;
    /// The drive determines a direction weakly.
    DriveWeak = "drive-weak", Warning;
    /// The stations stand too far from the track.
    StationsFarFromTrack = "stations-far-from-track", Warning;
    /// The direction with the largest standard deviation.
    WeakestDirection = "weakest-direction", Note;
    /// The vehicle hardly moved.
    DriveStanding = "drive-standing", Problem;
    /// The drive is a straight line.
    DriveStraightLine = "drive-straight-line", Problem;
    /// The drive is one circle, or an arc of one.
    DriveCircle = "drive-circle", Problem;
    /// The drive is two straight legs with one corner.
    DriveTwoLegs = "drive-two-legs", Problem;
    /// The ground is flat, so heights have a mirror twin.
    FlatGround = "flat-ground", Note;
    /// Another minimum fits nearly as well.
    RivalMinimum = "rival-minimum", Warning;
    /// The inter-prism distances fit poorly.
    DistancesFitPoorly = "distances-fit-poorly", Warning;

    /// All prisms stand at one height, so the mirror twin is the answer itself.
    MirrorSameHeight = "mirror-same-height", Note;
    /// The mirror twin is no minimum.
    MirrorRuledOut = "mirror-ruled-out", Note;
    /// The rig decides between the answer and its mirror twin.
    MirrorResolvedByRig = "mirror-resolved-by-rig", Note;
    /// The control points decide between the answer and its mirror twin.
    MirrorResolvedByControlPoints = "mirror-resolved-by-control-points", Note;
    /// The cost decides between the answer and its mirror twin.
    MirrorResolvedByCost = "mirror-resolved-by-cost", Note;
    /// Nothing decides between the answer and its mirror twin.
    MirrorUnresolved = "mirror-unresolved", Warning;
    /// The witness that decides about the mirror twin contradicts the cost.
    MirrorWitnessContradicted = "mirror-witness-contradicted", Warning;
    /// More data is needed to resolve the mirror twin.
    MirrorNeedsWitness = "mirror-needs-witness", Warning;

    /// The control points contradict the answer.
    ControlPointsContradict = "control-points-contradict", Warning;
    /// The inter-prism distances of the drive contradict the answer.
    DriveContradicts = "drive-contradicts", Warning;
    /// The inter-prism distances of the drive are off by more than with a good answer.
    DriveFitsPoorly = "drive-fits-poorly", Warning;
    /// Seen from above, the prisms have the opposite order to the reading of the rig.
    RigOrientationContradicts = "rig-orientation-contradicts", Warning;
    /// The heights of the prisms contradict the reading of the rig.
    RigHeightsContradict = "rig-heights-contradict", Warning;
    /// A misreading of the data explains the contradictions.
    MisreadingSuspected = "misreading-suspected", Warning;
    /// No single misreading of the data explains the contradictions.
    MisreadingNotFound = "misreading-not-found", Note;

    /// Outlying triplets were left out.
    OutliersLeftOut = "outliers-left-out", Note;
    /// So many outlying triplets were left out that the rest may be wrong too.
    ManyOutliersLeftOut = "many-outliers-left-out", Warning;
    /// Most triplets of a span of time were left out.
    SpanLeftOut = "span-left-out", Warning;
    /// Outlying triplets shift the answer.
    OutliersShiftAnswer = "outliers-shift-answer", Warning;

    /// The search of the prior found no optimum that other runs agree with.
    PriorSearchUnconfirmed = "prior-search-unconfirmed", Warning;
    /// The search of the prior ended in another minimum than the answer.
    PriorSearchElsewhere = "prior-search-elsewhere", Note;

    /// The stamps of a station are late or early by an estimated offset.
    ClockOffset = "clock-offset", Tabled;
    /// The clock of a station drifts by an estimated rate.
    ClockDrift = "clock-drift", Tabled;
    /// The stamps of a station seem late or early, and the method does not estimate clocks.
    ClockOffsetSuspected = "clock-offset-suspected", Warning;
    /// The stamps of a station seem to jump, and the method does not estimate clocks.
    ClockJumpSuspected = "clock-jump-suspected", Warning;
    /// The clock of a station drifts more than clocks of total stations do.
    ClockDriftImplausible = "clock-drift-implausible", Warning;
    /// The stamps of a station jump.
    ClockStepped = "clock-stepped", Warning;
    /// A station turned and moved during the drive.
    StationMoved = "station-moved", Warning;
    /// A station turned or moved between the survey of the control points and the drive.
    SetUpChanged = "set-up-changed", Note;
    /// A station turned or moved between survey and drive, and the data does not decide which one.
    SetUpChangeUndecided = "set-up-change-undecided", Warning;

    /// The noise of the readings about the motion.
    NoiseLevels = "noise-levels", Tabled;
    /// An error of an instrument is significant.
    InstrumentError = "instrument-error", Tabled;
    /// The largest sources of the standard deviations of a station.
    UncertaintySources = "uncertainty-sources", Tabled;
    /// An error of an instrument is larger than those of instruments in order.
    InstrumentErrorImplausible = "instrument-error-implausible", Warning;
    /// The errors of a station, taken together, are larger than those of instruments in order.
    StationErrorsImplausible = "station-errors-implausible", Warning;
    /// The errors of all stations and distances, taken together, are implausible.
    ErrorsImplausible = "errors-implausible", Warning;
    /// An estimated inter-prism distance.
    DistanceEstimated = "distance-estimated", Tabled;
    /// The estimate of an inter-prism distance differs from its measurement by more than 3 mm and 3 σ of the estimate; the verdict stays.
    DistanceOff = "distance-off", Warning;
    /// One inter-prism distance contradicts its measurement: by more than 4.2 σ, given the stated σ of the distances; the answer is weak.
    DistanceImplausible = "distance-implausible", Warning;
    /// The three inter-prism distances together contradict their measurements by more than 3 σ, and no single error does; the answer is weak.
    DistancesImplausible = "distances-implausible", Warning;
    /// An error is larger than the user stated.
    StatedErrorContradicted = "stated-error-contradicted", Warning;
    /// Slow errors of the ranges are larger than those of any prism.
    RangeWanderImplausible = "range-wander-implausible", Warning;

    /// The residuals after aligning the tracks of one prism.
    TracksAligned = "tracks-aligned", Note;
    /// The drive does not show if the stations followed one prism or three.
    PrismCountUndecided = "prism-count-undecided", Warning;
    /// The tracks are so far apart that the stations cannot have followed one prism.
    TracksApart = "tracks-apart", Warning;
    /// The tracks of one prism fit poorly.
    TracksFitPoorly = "tracks-fit-poorly", Warning;
    /// The drive has too few independent segments of time for a good standard deviation.
    FewTimeBlocks = "few-time-blocks", Warning;

    /// The residuals after aligning the control points.
    ControlPointsAligned = "control-points-aligned", Note;
    /// The control points fit poorly.
    ControlPointsFitPoorly = "control-points-fit-poorly", Warning;
    /// One control point fits far worse than the others.
    ControlPointOutlier = "control-point-outlier", Warning;
    /// The pair of known points that the resection uses.
    ResectionPair = "resection-pair", Note;
    /// No third known point checks the resection.
    ResectionUnchecked = "resection-unchecked", Warning;
    /// The stations disagree at the points that the resection does not use.
    ResectionInconsistent = "resection-inconsistent", Warning;
    /// Cartesian positions are far from the station compared with their extent.
    CartesianOriginDoubtful = "cartesian-origin-doubtful", Doubt;
    /// A station repeated an old range while its prism moved.
    RangesRepeated = "ranges-repeated", Warning;
    /// The stamps of a station differ from those of the others by seconds.
    StationClockOff = "station-clock-off", Doubt;
    /// A known point lies elsewhere than the other points place it.
    KnownPointMisplaced = "known-point-misplaced", Warning;
    /// Measured distances between known points have a scale error.
    KnownDistanceOff = "known-distance-off", Warning;

    /// The clock of a trajectory is far from that of the ground truth.
    EstimateClockFarOff = "estimate-clock-far-off", Warning;
    /// A trajectory has another scale than the ground truth.
    EstimateScaleOff = "estimate-scale-off", Warning;
    /// A trajectory has too few common times with the ground truth to estimate its clock and lever arm.
    EstimateFewPoints = "estimate-few-points", Note;
    /// A trajectory cannot be compared with the ground truth.
    EstimateNotJudged = "estimate-not-judged", Problem;
    /// A deployment of a study cannot be judged, and was left out.
    DeploymentLeftOut = "deployment-left-out", Warning;

    /// The earlier calibration is itself weak.
    EarlierCalibrationWeak = "earlier-calibration-weak", Warning;
    /// One of the compared calibrations is not a joint estimate.
    ComparedWithoutJointEstimate = "compared-without-joint-estimate", Note;
    /// Both runs have tracks that an unknown transform brought into one frame.
    ComparedInUnknownFrame = "compared-in-unknown-frame", Warning;
    /// The rig is not the one of the earlier calibration.
    RigDiffersFromEarlier = "rig-differs-from-earlier", Warning;

    /// The planned drive leaves a direction unobservable.
    PlanLeavesDirectionFree = "plan-leaves-direction-free", Problem;
    /// The planned drive determines a direction weakly.
    PlanWeak = "plan-weak", Warning;
    /// The predicted standard deviation at the far end of the track.
    PlanFarEnd = "plan-far-end", Note;
    /// The planned drive decides between the answer and its mirror twin.
    PlanResolvesMirror = "plan-resolves-mirror", Note;
    /// The planned drive needs a static reading of the prisms to resolve the mirror twin.
    PlanMirrorNeedsReading = "plan-mirror-needs-reading", Note;
    /// The planned drive does not resolve the mirror twin, and the heights of the prisms are too similar to do so.
    PlanMirrorUnresolved = "plan-mirror-unresolved", Warning;
    /// Readings of the planned drive are lost.
    PlanReadingsLost = "plan-readings-lost", Warning;

    /// The live source is not connected.
    LiveNoConnection = "no-connection", Warning;
    /// A station has had no reading for a while.
    LiveLostLock = "lost-lock", Warning;
    /// The clock of a station jumped during the live drive.
    LiveClockJumped = "clock-jumped", Warning;
    /// A station or its clock stepped during the live drive.
    LiveStepped = "stepped", Warning;
    /// A station follows the prism of another.
    LiveWrongPrism = "wrong-prism", Warning;
    /// The live drive is a straight line so far.
    LiveStraightLine = "straight-line", Warning;
    /// The live drive has no inter-prism distances.
    LiveNoRig = "no-rig", Warning;
    /// Topics or instruments of the live source belong to no station.
    LiveNoStation = "no-station", Warning;
    /// The live drive is no longer recorded.
    LiveNotRecorded = "not-recorded", Warning;

    /// The report has no answer of a method.
    NoAnswer = "no-answer", Problem;
    /// Autosave cannot write, so nothing is restored after a crash.
    AutosaveUnavailable = "autosave-unavailable", Warning;
    /// A session of an earlier crash is kept.
    EarlierSessionKept = "earlier-session-kept", Warning;
    /// An element of a session has an unknown form, and was left out.
    SessionPartUnknown = "session-part-unknown", Warning;
    /// The plan of a session is invalid, and was left out.
    SessionPlanInvalid = "session-plan-invalid", Warning;
    /// A file of the user cannot be used, and was moved aside.
    UnusableFileKept = "unusable-file-kept", Warning;
    /// A file has changed since the session was saved.
    SessionFileChanged = "session-file-changed", Warning;
    /// A file of the session can no longer be read.
    SessionFileMissing = "session-file-missing", Warning;
    /// The stored layout of the window has an unknown or repeated element.
    LayoutInvalid = "layout-invalid", Warning;
}
