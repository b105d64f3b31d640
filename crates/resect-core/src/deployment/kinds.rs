//! Kinds of findings of calibration and its data.

crate::finding_kinds! {
    /// Two stations have no common time.
    STATIONS_WITHOUT_COMMON_TIME = "stations-without-common-time", Problem, STAMPS;
    /// The stamps of the readings are the clocks of the stations.
    STAMPS_ARE_STATION_CLOCKS = "stamps-are-station-clocks", Note;
    /// The offset, drift and scatter of the station clocks against the stamps.
    STATION_CLOCKS_COMPARED = "station-clocks-compared", Note;
    /// A station clock and the stamps drift apart faster than clocks do.
    STATION_CLOCK_DRIFTS = "station-clock-drifts", Warning, CLOCK;
    /// A station clock jumps against the stamps.
    STATION_CLOCK_JUMPS = "station-clock-jumps", Warning, CLOCK;
    /// The recording has corrections of a station clock.
    TIME_CORRECTIONS = "time-corrections", Note;
    /// The recorded corrections of a station clock contradict the stamps.
    TIME_CORRECTIONS_CONTRADICT_STAMPS = "time-corrections-contradict-stamps", Doubt, STAMPS;
    /// The stamps of the stations disagree by the clock of the recorder.
    STAMPS_CONTRADICT_RECORDER = "stamps-contradict-recorder", Doubt, STAMPS;
    /// A drive overlaps the one before it in time, and was shifted.
    DRIVE_SHIFTED = "drive-shifted", Note;
    /// A further drive has slightly different inter-prism distances.
    DRIVE_DISTANCES_DIFFER = "drive-distances-differ", Note;

    /// No triplets are left to calibrate from.
    NO_TRIPLETS = "no-triplets", Problem, READINGS_MISSING;
    /// There are too few triplets to calibrate from.
    TOO_FEW_TRIPLETS = "too-few-triplets", Problem, READINGS_MISSING;
    /// Method D lacks the inter-prism distances.
    NO_RIG = "no-inter-prism-distances", Problem, RIG;
    /// The data lacks something that the method needs.
    METHOD_LACKS_DATA = "method-lacks-data", Problem, READINGS_MISSING;
    /// The points lie on a line, so they determine no rigid transform.
    POINTS_ON_A_LINE = "points-on-a-line", Problem, NO_ANSWER;
    /// The joint estimate has no result.
    NO_JOINT_ESTIMATE = "no-joint-estimate", Problem, NO_ANSWER;
    /// The report has no answer of a method.
    NO_ANSWER = "no-answer", Problem, NO_ANSWER;
    /// The calibration was cancelled.
    CANCELLED = "cancelled", Problem, NO_ANSWER;

    /// The estimate stopped before it converged.
    ESTIMATE_NOT_CONVERGED = "estimate-not-converged", Warning, SOLVER;
    /// The estimate moved away from its start without reaching a minimum.
    ESTIMATE_DIVERGED = "estimate-diverged", Warning, SOLVER;
    /// The drive has no span in which each prism is read at least every 2 s.
    NO_COMMON_READINGS = "no-common-readings", Warning, SOLVER;
    /// The normal matrix of the joint estimate is positive definite only with tighter priors.
    PRIORS_TIGHTENED = "priors-tightened", Warning, SOLVER;
    /// The solver stopped before it converged.
    SOLVER_NOT_CONVERGED = "solver-not-converged", Warning, SOLVER;
    /// The data does not determine all parameters of the joint estimate.
    JOINT_ESTIMATE_UNDETERMINED = "joint-estimate-undetermined", Warning, SOLVER;
    /// Another minimum fits better than the joint estimate.
    OTHER_MINIMUM_FITS_BETTER = "other-minimum-fits-better", Warning, TWO_SOLUTIONS;
    /// The published method and the joint estimate differ by more than instrument errors.
    PUBLISHED_ANSWER_FAR_APART = "published-answer-far-apart", Warning, DISTANCES;
    /// The published method has no result to compare with.
    PUBLISHED_ANSWER_MISSING = "published-answer-missing", Warning;
    /// The answer does not transform the tracks, which are in another frame.
    TRACKS_NOT_TRANSFORMED = "tracks-not-transformed", Warning;
    /// Two methods differ by more than their standard deviations.
    METHODS_DISAGREE = "methods-disagree", Warning, CONTRADICTION;

    /// The points leave a direction unobservable.
    POINTS_LEAVE_DIRECTION_FREE = "points-leave-direction-free", Problem, POINTS_WEAK;
    /// The points determine the stations weakly.
    POINTS_WEAK = "points-weak", Warning, POINTS_WEAK;
    /// The drive leaves a direction unobservable.
    DRIVE_LEAVES_DIRECTION_FREE = "drive-leaves-direction-free", Problem, DIRECTION_UNOBSERVABLE;
    /// The drive determines a direction weakly.
    DRIVE_WEAK = "drive-weak", Warning, DIRECTION_UNOBSERVABLE;
    /// The stations stand too far from the track.
    STATIONS_FAR_FROM_TRACK = "stations-far-from-track", Warning, STATIONS_FAR;
    /// The direction with the largest standard deviation.
    WEAKEST_DIRECTION = "weakest-direction", Note;
    /// The vehicle hardly moved.
    DRIVE_STANDING = "drive-standing", Problem, DIRECTION_UNOBSERVABLE;
    /// The drive is a straight line.
    DRIVE_STRAIGHT_LINE = "drive-straight-line", Problem, DIRECTION_UNOBSERVABLE;
    /// The drive is one circle, or an arc of one.
    DRIVE_CIRCLE = "drive-circle", Problem, DIRECTION_UNOBSERVABLE;
    /// The drive is two straight legs with one corner.
    DRIVE_TWO_LEGS = "drive-two-legs", Problem, DIRECTION_UNOBSERVABLE;
    /// The ground is flat, so heights have a mirror twin.
    FLAT_GROUND = "flat-ground", Note, MIRROR;
    /// Another minimum fits nearly as well.
    RIVAL_MINIMUM = "rival-minimum", Warning, TWO_SOLUTIONS;
    /// The inter-prism distances fit poorly.
    DISTANCES_FIT_POORLY = "distances-fit-poorly", Warning, DISTANCES;

    /// All prisms stand at one height, so the mirror twin is the answer itself.
    MIRROR_SAME_HEIGHT = "mirror-same-height", Note;
    /// The mirror twin is no minimum.
    MIRROR_RULED_OUT = "mirror-ruled-out", Note;
    /// The rig decides between the answer and its mirror twin.
    MIRROR_RESOLVED_BY_RIG = "mirror-resolved-by-rig", Note;
    /// The control points decide between the answer and its mirror twin.
    MIRROR_RESOLVED_BY_CONTROL_POINTS = "mirror-resolved-by-control-points", Note;
    /// The cost decides between the answer and its mirror twin.
    MIRROR_RESOLVED_BY_COST = "mirror-resolved-by-cost", Note;
    /// All readings decide between the answer and its mirror twin.
    MIRROR_RESOLVED_BY_LIKELIHOOD = "mirror-resolved-by-likelihood", Note;
    /// Nothing decides between the answer and its mirror twin.
    MIRROR_UNRESOLVED = "mirror-unresolved", Warning, MIRROR;
    /// The witness that decides about the mirror twin contradicts the cost.
    MIRROR_WITNESS_CONTRADICTED = "mirror-witness-contradicted", Warning, MIRROR;
    /// More data is needed to resolve the mirror twin.
    MIRROR_NEEDS_WITNESS = "mirror-needs-witness", Warning, MIRROR;

    /// The control points contradict the answer.
    CONTROL_POINTS_CONTRADICT = "control-points-contradict", Warning, CONTRADICTION;
    /// The inter-prism distances of the drive contradict the answer.
    DRIVE_CONTRADICTS = "drive-contradicts", Warning, CONTRADICTION;
    /// The inter-prism distances of the drive are off by more than with a good answer.
    DRIVE_FITS_POORLY = "drive-fits-poorly", Warning, CONTRADICTION;
    /// Seen from above, the prisms have the opposite order to the reading of the rig.
    RIG_ORIENTATION_CONTRADICTS = "rig-orientation-contradicts", Warning, READINGS_AGAINST_RIG;
    /// The heights of the prisms contradict the reading of the rig.
    RIG_HEIGHTS_CONTRADICT = "rig-heights-contradict", Warning, READINGS_AGAINST_RIG;
    /// A misreading of the data explains the contradictions.
    MISREADING_SUSPECTED = "misreading-suspected", Warning, READINGS_AGAINST_RIG;
    /// No single misreading of the data explains the contradictions.
    MISREADING_NOT_FOUND = "misreading-not-found", Note, READINGS_AGAINST_RIG;

    /// Outlying triplets were left out.
    OUTLIERS_LEFT_OUT = "outliers-left-out", Note;
    /// So many outlying triplets were left out that the rest may be wrong too.
    MANY_OUTLIERS_LEFT_OUT = "many-outliers-left-out", Warning, DISTANCES;
    /// Readings of a station in a row contradict the other stations, and were left out.
    STATION_LEFT_OUT = "station-left-out", Note;
    /// Most triplets of a span of time were left out.
    SPAN_LEFT_OUT = "span-left-out", Warning, STATION_MOVED;
    /// A station followed another prism for some time.
    PRISM_CHANGED = "prism-changed", Warning, PRISM_CHANGE;
    /// Outlying triplets shift the answer.
    OUTLIERS_SHIFT_ANSWER = "outliers-shift-answer", Warning, DISTANCES;

    /// The search of the prior found no optimum that other runs agree with.
    PRIOR_SEARCH_UNCONFIRMED = "prior-search-unconfirmed", Warning;
    /// The search of the prior ended in another minimum than the answer.
    PRIOR_SEARCH_ELSEWHERE = "prior-search-elsewhere", Note;

    /// The stamps of a station are late or early by an estimated offset.
    CLOCK_OFFSET = "clock-offset", Tabled;
    /// The clock of a station drifts by an estimated rate.
    CLOCK_DRIFT = "clock-drift", Tabled;
    /// The stamps of a station seem late or early, and the method does not estimate clocks.
    CLOCK_OFFSET_SUSPECTED = "clock-offset-suspected", Warning, CLOCK;
    /// The stamps of a station seem to jump, and the method does not estimate clocks.
    CLOCK_JUMP_SUSPECTED = "clock-jump-suspected", Warning, CLOCK;
    /// The clock of a station drifts more than clocks of total stations do.
    CLOCK_DRIFT_IMPLAUSIBLE = "clock-drift-implausible", Warning, CLOCK;
    /// The stamps of a station jump.
    CLOCK_STEPPED = "clock-stepped", Warning, CLOCK;
    /// A station turned and moved during the drive.
    STATION_MOVED = "station-moved", Warning, STATION_MOVED;
    /// A station turned or moved between the survey of the control points and the drive.
    SET_UP_CHANGED = "set-up-changed", Note;
    /// A station turned or moved between survey and drive, and the data does not decide which one.
    SET_UP_CHANGE_UNDECIDED = "set-up-change-undecided", Warning, CONTRADICTION;

    /// The noise of the readings about the motion.
    NOISE_LEVELS = "noise-levels", Tabled;
    /// An error of an instrument is significant.
    INSTRUMENT_ERROR = "instrument-error", Tabled;
    /// The largest sources of the standard deviations of a station.
    UNCERTAINTY_SOURCES = "uncertainty-sources", Tabled;
    /// An error of an instrument is larger than those of instruments in order.
    INSTRUMENT_ERROR_IMPLAUSIBLE = "instrument-error-implausible", Warning, INSTRUMENT;
    /// The errors of a station, taken together, are larger than those of instruments in order.
    STATION_ERRORS_IMPLAUSIBLE = "station-errors-implausible", Warning, INSTRUMENT;
    /// The errors of all stations and distances, taken together, are implausible.
    ERRORS_IMPLAUSIBLE = "errors-implausible", Warning, INSTRUMENT;
    /// An estimated inter-prism distance.
    DISTANCE_ESTIMATED = "distance-estimated", Tabled;
    /// One inter-prism distance contradicts its measurement: by more than 4.2 σ, given the stated σ of the distances; the answer is weak.
    DISTANCE_IMPLAUSIBLE = "distance-implausible", Warning, DISTANCES;
    /// The inter-prism distances together contradict their measurements by more than 3 σ, and no single error does; the answer is weak.
    DISTANCES_IMPLAUSIBLE = "distances-implausible", Warning, DISTANCES;
    /// An error is larger than the user stated.
    STATED_ERROR_CONTRADICTED = "stated-error-contradicted", Warning, INSTRUMENT;
    /// Slow errors of the ranges are larger than those of any prism.
    RANGE_WANDER_IMPLAUSIBLE = "range-wander-implausible", Warning, INSTRUMENT;

    /// The residuals after aligning the tracks of one prism.
    TRACKS_ALIGNED = "tracks-aligned", Note;
    /// The drive does not show if the stations followed one prism or several.
    PRISM_COUNT_UNDECIDED = "prism-count-undecided", Warning, ONE_PRISM;
    /// The tracks are so far apart that the stations cannot have followed one prism.
    TRACKS_APART = "tracks-apart", Warning, ONE_PRISM;
    /// The tracks of one prism fit poorly.
    TRACKS_FIT_POORLY = "tracks-fit-poorly", Warning, ONE_PRISM;
    /// The drive has too few independent segments of time for a good standard deviation.
    FEW_TIME_BLOCKS = "few-time-blocks", Warning, READINGS_MISSING;

    /// The residuals after aligning the control points.
    CONTROL_POINTS_ALIGNED = "control-points-aligned", Note;
    /// The control points fit poorly.
    CONTROL_POINTS_FIT_POORLY = "control-points-fit-poorly", Warning, CONTRADICTION;
    /// One control point fits far worse than the others.
    CONTROL_POINT_OUTLIER = "control-point-outlier", Warning, CONTRADICTION;
    /// A station's ranges to control points are longer or shorter than those of the others.
    CONTROL_POINT_RANGES_OFF = "control-point-ranges-off", Warning, CONTRADICTION;
    /// A station stood elsewhere in one set of control points than in the others.
    STATION_MOVED_BETWEEN_SETS = "station-moved-between-sets", Warning, CONTRADICTION;
    /// The pair of known points that the resection uses.
    RESECTION_PAIR = "resection-pair", Note;
    /// No third known point checks the resection.
    RESECTION_UNCHECKED = "resection-unchecked", Warning, POINTS_WEAK;
    /// The stations disagree at the points that the resection does not use.
    RESECTION_INCONSISTENT = "resection-inconsistent", Warning, CONTRADICTION;
    /// A known point lies elsewhere than the other points place it.
    KNOWN_POINT_MISPLACED = "known-point-misplaced", Warning, CONTRADICTION;
    /// Measured distances between known points have a scale error.
    KNOWN_DISTANCE_OFF = "known-distance-off", Warning, CONTRADICTION;
}
