//! Kinds of findings of reading files.

resect_core::finding_kinds! {
    /// A file could not be read, and was skipped.
    FILE_UNREADABLE = "file-unreadable", Warning;
    /// The date in the name of the folder contradicts the stamps of the readings.
    FOLDER_DATE_CONTRADICTS_STAMPS = "folder-date-contradicts-stamps", Doubt, FILES;

    /// The columns of a table were recognised by their names or assigned by the user.
    TABLE_COLUMNS = "table-columns", Note;
    /// A table has two clocks, and one of them gives the stamps.
    TABLE_CLOCK = "table-clock", Note;
    /// Records were dropped because they cannot be readings.
    RECORDS_DROPPED = "records-dropped", Warning;
    /// Readings were not in order of time, and were sorted.
    STAMPS_OUT_OF_ORDER = "stamps-out-of-order", Warning;
    /// Several readings of a station have the same stamp; the first of each was kept.
    STAMPS_REPEATED = "stamps-repeated", Warning;
    /// A station has no reading.
    STATION_WITHOUT_READINGS = "station-without-readings", Problem, READINGS_MISSING;
    /// Readings that are marked as valid have impossible values.
    READINGS_IMPLAUSIBLE = "readings-implausible", Doubt, FILES;
    /// Readings are in face right and were converted to face left.
    READINGS_IN_FACE_RIGHT = "readings-in-face-right", Note;
    /// The stamps of a station are rounded to a tenth of a second or more, too coarse for a moving prism.
    STAMPS_COARSE = "stamps-coarse", Doubt, STAMPS;
    /// The clock of the recording was set back.
    CLOCK_SET_BACK = "clock-set-back", Doubt, STAMPS;
    /// Stamps do not count from 1970, so they cannot be compared with GNSS.
    STAMPS_RELATIVE = "stamps-relative", Note;
    /// Cartesian positions are far from the station compared with their extent.
    CARTESIAN_ORIGIN_DOUBTFUL = "cartesian-origin-doubtful", Doubt, FILES;
    /// A station repeated an old range while its prism moved.
    RANGES_REPEATED = "ranges-repeated", Warning;
    /// The stamps of a station differ from those of the others by seconds.
    STATION_CLOCK_OFF = "station-clock-off", Doubt, STAMPS;
    /// The prism constant that was added to the ranges.
    PRISM_CONSTANT_ADDED = "prism-constant-added", Note;
    /// Only a span of the drive is used.
    SPAN_SELECTED = "span-selected", Note;
    /// Readings are left out by hand.
    READINGS_MASKED = "readings-masked", Note;
    /// Readings that were left out by hand are not in this data.
    MASKED_READINGS_MISSING = "masked-readings-missing", Warning;

    /// A bag is damaged, and some of its data was lost.
    BAG_DAMAGED = "bag-damaged", Warning;
    /// The recording of a bag was interrupted, and the bag was read completely.
    BAG_INCOMPLETE = "bag-incomplete", Note;
    /// Messages of a bag cannot be decoded.
    BAG_MESSAGES_MALFORMED = "bag-messages-malformed", Warning;
    /// The files do not number the stations 1, 2, 3, …
    STATIONS_RENUMBERED = "stations-renumbered", Note;
    /// The stamps of a recording jump by many hours; only the longest part is used.
    STAMPS_JUMPED = "stamps-jumped", Warning;
    /// Rows of a table, or poses of a bag, are not valid and were skipped.
    ROWS_SKIPPED = "rows-skipped", Warning;
    /// A bag is one of several files of a recording, and the others are not read.
    BAG_SPLITS_UNREAD = "bag-splits-unread", Warning;
    /// Several bags are read as one drive.
    BAGS_JOINED = "bags-joined", Note;
    /// Files contain the same readings as another, and are not read.
    COPIES_LEFT_OUT = "copies-left-out", Note;
    /// One of the numbered bags of a recording is missing.
    BAG_MISSING = "bag-missing", Warning;
    /// Readings have no synchronised stamp, so the clock of the station is used.
    READINGS_WITHOUT_STAMP = "readings-without-stamp", Warning;
    /// Readings have no time of their own, so their time of arrival is used.
    READINGS_WITHOUT_TIME = "readings-without-time", Doubt, STAMPS;
    /// Topics with positions are not read.
    POSITIONS_NOT_READ = "positions-not-read", Note;
    /// Positions are taken as measured in the frame of each instrument.
    POSITIONS_IN_INSTRUMENT_FRAMES = "positions-in-instrument-frames", Note;
    /// A station has no position on the topic that was given.
    TOPIC_WITHOUT_POSITIONS = "topic-without-positions", Warning;
    /// Theodolite messages are not read because other topics were given.
    THEODOLITE_MESSAGES_NOT_READ = "theodolite-messages-not-read", Note;

    /// The tracks are positions, each in the frame of its station.
    TRACKS_IN_STATION_FRAMES = "tracks-in-station-frames", Note;
    /// The tracks were transformed into one frame by an unknown transform.
    TRACKS_IN_COMMON_FRAME = "tracks-in-common-frame", Warning;
    /// The tracks were transformed into one frame; this was inverted.
    TRACK_TRANSFORM_INVERTED = "track-transform-inverted", Note;
    /// A file of transforms cannot be read.
    TRANSFORMS_UNREADABLE = "transforms-unreadable", Warning;
    /// No transform of the files is shown to be the one that was applied to the tracks.
    TRANSFORMS_NOT_CONFIRMED = "transforms-not-confirmed", Warning;
    /// A transform tilts a station more than its compensator allows.
    TRANSFORM_TILTS_STATION = "transform-tilts-station", Warning;

    /// A reading of a control point names a station without a track.
    CONTROL_POINT_STATION_UNKNOWN = "control-point-station-unknown", Warning;
    /// A reading of a control point has a status other than 0.
    CONTROL_POINT_STATUS_INVALID = "control-point-status-invalid", Warning;
    /// A reading of a control point has an impossible value.
    CONTROL_POINT_READING_IMPLAUSIBLE = "control-point-reading-implausible", Warning;
    /// A station read a control point twice; the first reading is used.
    CONTROL_POINT_REPEATED = "control-point-repeated", Warning;
    /// A file of control points has no usable point.
    CONTROL_POINTS_EMPTY = "control-points-empty", Warning;
    /// The coordinates of a pillar are in no survey of pillars.
    PILLAR_COORDINATES_UNKNOWN = "pillar-coordinates-unknown", Warning;
    /// The survey of pillars belongs to no file of readings.
    PILLARS_WITHOUT_READINGS = "pillars-without-readings", Warning;
    /// A point with known coordinates was not measured.
    KNOWN_POINT_NOT_MEASURED = "known-point-not-measured", Warning;

    /// Readings of a survey have no usable range or angle.
    SURVEY_READINGS_UNUSABLE = "survey-readings-unusable", Warning;
    /// Readings of one point of a survey lie too far apart.
    SURVEY_POINTS_INCONSISTENT = "survey-points-inconsistent", Warning;
    /// The vertical angles of a survey seem to be elevations, but are read as zenith angles.
    SURVEY_ANGLES_SEEM_ELEVATIONS = "survey-angles-seem-elevations", Doubt, FILES;
    /// A file of a survey has several set-ups; only the first is used.
    SURVEY_OTHER_SET_UPS = "survey-other-set-ups", Warning;
    /// Readings of a survey lack a distance or an angle.
    SURVEY_READINGS_INCOMPLETE = "survey-readings-incomplete", Warning;
    /// Points that were deleted in the job of a survey are left out.
    SURVEY_POINTS_DELETED = "survey-points-deleted", Warning;
    /// Readings of a survey have no prism constant; that of the deployment is added.
    SURVEY_PRISM_CONSTANT_MISSING = "survey-prism-constant-missing", Warning;
    /// The slope distances of a survey contain the prism constant.
    SURVEY_PRISM_CONSTANT_INCLUDED = "survey-prism-constant-included", Note;
    /// The prism constants of the targets of a survey are added.
    SURVEY_PRISM_CONSTANTS_ADDED = "survey-prism-constants-added", Note;
    /// The prism constant of the deployment is not added to a survey that has its own.
    SURVEY_PRISM_CONSTANT_KEPT = "survey-prism-constant-kept", Note;
    /// A survey has no usable reading.
    SURVEY_EMPTY = "survey-empty", Warning;
    /// A survey has coordinates without readings.
    SURVEY_COORDINATES_LEFT_OUT = "survey-coordinates-left-out", Warning;
    /// The station that measured a survey is not known.
    SURVEY_STATION_UNKNOWN = "survey-station-unknown", Warning;
    /// Two surveys are of the same station.
    SURVEY_STATION_REPEATED = "survey-station-repeated", Warning;
    /// The points of a survey are numbered in order of appearance.
    SURVEY_POINTS_NUMBERED = "survey-points-numbered", Note;

    /// A file of the rig that the user gave replaces the distances of deployment.toml.
    RIG_FILE_PREFERRED = "rig-file-preferred", Note;
    /// The inter-prism distances are not known.
    RIG_UNKNOWN = "rig-unknown", Note, RIG;
    /// The inter-prism distances are derived from one reading of each prism.
    RIG_DERIVED_FROM_READING = "rig-derived-from-reading", Doubt, RIG;
    /// The inter-prism distances and the reading of the rig disagree.
    RIG_READING_DISAGREES = "rig-reading-disagrees", Doubt, RIG;
    /// The prism positions in deployment.toml belong to another rig.
    PRISM_POSITIONS_OF_OTHER_RIG = "prism-positions-of-other-rig", Warning;
    /// The prism positions and the inter-prism distances disagree.
    PRISM_POSITIONS_DISAGREE = "prism-positions-disagree", Warning;

    /// GNSS solutions are left out because there are not three.
    GNSS_ANTENNAS_MISSING = "gnss-antennas-missing", Warning;
    /// GNSS solutions have different origins.
    GNSS_ORIGINS_DIFFER = "gnss-origins-differ", Warning;
    /// GNSS fixes were not in order of time, and were sorted.
    GNSS_STAMPS_OUT_OF_ORDER = "gnss-stamps-out-of-order", Warning;
    /// Several GNSS fixes have the same stamp; the first of each was kept.
    GNSS_STAMPS_REPEATED = "gnss-stamps-repeated", Warning;

    /// Positions on the Earth were converted to metres east, north and up.
    GNSS_POSITIONS_LOCAL = "gnss-positions-local", Note;
    /// Only the most accurate kind of GNSS solutions is the ground truth; the others are left out.
    GNSS_SOLUTIONS_LEFT_OUT = "gnss-solutions-left-out", Warning;
    /// GNSS solutions of several kinds are used.
    GNSS_SOLUTIONS_MIXED = "gnss-solutions-mixed", Note;
    /// Records of a receiver have no solution.
    GNSS_WITHOUT_SOLUTION = "gnss-without-solution", Warning;
    /// No solution of a ground truth has fixed ambiguities.
    GNSS_NOT_FIXED = "gnss-not-fixed", Warning;
    /// A log of NMEA has no date.
    GNSS_DATES_MISSING = "gnss-dates-missing", Warning;
    /// Covariances of a receiver are approximated from the dilution of precision.
    GNSS_SIGMA_APPROXIMATED = "gnss-sigma-approximated", Warning;
    /// A column of a table with latitude and longitude is not read.
    GNSS_COLUMN_NOT_READ = "gnss-column-not-read", Warning;
    /// Poses are computed from the positions of several antennas.
    ANTENNA_POSES = "antenna-poses", Note;
    /// Positions of antennas give no pose.
    ANTENNA_EPOCHS_LEFT_OUT = "antenna-epochs-left-out", Warning;
    /// Positions of antennas state no σ.
    ANTENNAS_WITHOUT_SIGMA = "antennas-without-sigma", Warning;

    /// Poses of a trajectory were not in order of time, and were sorted.
    ESTIMATE_OUT_OF_ORDER = "estimate-out-of-order", Warning;
    /// Seconds and nanoseconds of an estimated trajectory were joined without leading zeros.
    ESTIMATE_STAMPS_JOINED = "estimate-stamps-joined", Warning;
    /// The columns of an estimated trajectory have no header.
    ESTIMATE_COLUMNS_GUESSED = "estimate-columns-guessed", Note;
    /// Roll, pitch and yaw of a trajectory have no unit, which was guessed.
    ESTIMATE_ANGLE_UNIT_GUESSED = "estimate-angle-unit-guessed", Note;
    /// Columns of an orientation or a covariance are not read.
    ESTIMATE_COLUMNS_UNREAD = "estimate-columns-unread", Warning;
    /// Several poses of a trajectory have the same time; the first of each was kept.
    ESTIMATE_TIMES_REPEATED = "estimate-times-repeated", Warning;
    /// Poses of KITTI have no times; their numbers replace them.
    ESTIMATE_TIMES_BY_NUMBER = "estimate-times-by-number", Note;
    /// Some poses of a trajectory have no orientation, so none is used.
    ESTIMATE_ORIENTATIONS_MISSING = "estimate-orientations-missing", Warning;
    /// All poses of a trajectory have the same orientation.
    ESTIMATE_ORIENTATIONS_CONSTANT = "estimate-orientations-constant", Note;
    /// The coordinates of a trajectory are rounded to centimetres or more.
    ESTIMATE_POSITIONS_ROUNDED = "estimate-positions-rounded", Warning;
    /// Some poses of a trajectory have no covariance.
    ESTIMATE_COVARIANCES_MISSING = "estimate-covariances-missing", Warning;
    /// Quaternions of a trajectory were normalised.
    ESTIMATE_QUATERNIONS_NORMALISED = "estimate-quaternions-normalised", Warning;
    /// Orientations of a motion capture are angles about axes, and are not read.
    ESTIMATE_ANGLES_NOT_READ = "estimate-angles-not-read", Warning;
}
