//! The list of terms, in the order from readings to a verdict: plain data.

use super::term::Term;

macro_rules! terms {
    ($($constant:ident = $name:literal $(/ $also:literal)*: $means:literal $(($paper:literal))?;)*) => {
        $(pub static $constant: Term = Term {
            name: $name,
            also: &[$($also),*],
            means: $means,
            paper: concat!($($paper)?),
        };)*
        /// All terms, in the order from readings to a verdict.
        pub static ALL: &[&Term] = &[$(&$constant),*];
    };
}

terms! {
    // Measurements.
    STATION = "robotic total station" / "RTS":
        "An instrument that follows a prism and measures range, azimuth and zenith angle to it. Each station follows a prism \
         of a vehicle." ("section I");
    DEPLOYMENT = "deployment":
        "One field session with stations that nobody moved: a track of each station, and optional control points, rig and GNSS."
        ("section IV");
    READING = "reading" / "measurement":
        "An observation of a station at one instant: range, azimuth, zenith angle and a time stamp. Stations read at about 2.5 Hz, not at \
         the same instants." ("section IV");
    ZENITH_ANGLE = "zenith angle" / "zenith" / "elevation":
        "The angle between the upward vertical and the line of sight; 90° is level. Files often call it elevation." ("section III-B");
    AZIMUTH = "azimuth":
        "The horizontal angle to the prism, clockwise from above unless the files say otherwise. Zero is the zero of the instrument's \
         circle." ("section III-B");
    PRISM_CONSTANT = "prism constant":
        "A length added to every range because light travels more slowly in the prism: +10 mm for the MT1000. A wrong constant distorts \
         all distances and, if stations differ in height, the answer.";
    RIG = "rig":
        "The prisms fixed to the vehicle. Their distances must not change during a drive." ("section III-B");
    INTER_PRISM_DISTANCES = "inter-prism distance" / "prism distance":
        "A distance between two prisms of the rig; of three prisms, α = 1–2, β = 1–3, γ = 2–3. One station measures all of them before the \
         drive. Method D is based on them." ("section III-B, eq. (3)");
    CONTROL_POINT = "control point" / "GCP" / "ground control point":
        "A fixed point that every station measured. Static points are set up by hand; dynamic points are one moving prism that all \
         stations follow." ("sections III-A and III-B");
    OWN_CLOCK = "own clock" / "station clock":
        "The clock of the computer at a station, beside the synchronised time of the stamps. A time offset of one millisecond between \
         stations is one millimetre at 1 m/s." ("section II");
    STAMP = "stamp" / "time stamp":
        "The time that a file gives for a reading. Stamps may be late, drift or jump relative to those of another station.";

    // The pipeline.
    OUTLIER_FILTER = "outlier filter":
        "Rejects readings that differ from the previous one by more than a vehicle can move: faster than τ_r in range, τ_a in azimuth or \
         τ_e in zenith angle. Optional." ("section III-B, module 1");
    OUTLIER = "outlier":
        "A reading with an error far larger than the noise, for example after a lock on another prism. The outlier filter rejects such \
         readings; the joint estimate reduces their weight.";
    TAU_R = "τ_r":
        "The largest plausible rate of the range, in m/s: the vehicle's top speed. Faster readings are rejected."
        ("sections III-B and V-A: 2 m/s for the Warthog, 1 m/s for the HD2");
    TAU_A = "τ_a":
        "The largest plausible rate of the azimuth, in degrees per second. A slow vehicle close to a station has a high rate: look at the \
         rates before you reduce τ_a." ("sections III-B and V-A: 1 °/s");
    TAU_E = "τ_e":
        "The largest plausible rate of the zenith angle, in degrees per second." ("sections III-B and V-A: 1 °/s");
    GAP = "gap" / "silence":
        "A time without readings of a station: an obstacle hid its prism, or the radio failed." ("section III-B, module 2");
    TAU_S = "τ_s":
        "The longest gap inside an interval, in seconds. Longer gaps are not interpolated."
        ("sections III-B and V-A: 1 s, two lost readings in a row");
    INTERVAL = "interval" / "interval split":
        "A span in which all stations measured without a gap longer than τ_s." ("section III-B, module 2");
    TAU_L = "τ_l" / "interval filter":
        "Intervals up to this length, in seconds, are rejected, because few readings interpolate poorly. Optional."
        ("sections III-B and V-A: 6 s");
    SEGMENT = "segment":
        "An unbroken span of readings within a drive. The joint estimate fits one spline to each segment and gives no poses between \
         segments.";
    FATE = "fate":
        "The use of a reading: kept, rejected for one of the rates, in no interval, in an interval too short, or left out by hand.";
    INTERPOLATION = "interpolation":
        "Computes the positions of all prisms at common instants from readings at different instants: by straight lines, or by a Gaussian \
         process." ("section III-B, module 4");
    GAUSSIAN_PROCESS = "Gaussian process" / "GP":
        "An interpolation that estimates the smoothness of the motion and the noise of the readings, and gives σ. It needs long \
         intervals." ("section III-B, module 4");
    MOTION_MODEL = "motion model" / "white noise on acceleration" / "WNOA":
        "A Gaussian process for vehicles: the acceleration is white noise. It follows stops and turns, and its computing time grows only \
         linearly with the number of readings.";
    TRIPLET = "triplet":
        "The interpolated positions of the stations' prisms at one instant, each in the frame of its station." ("section III-B, module 4");

    GHOST = "ghost":
        "In the scene, a prism at a time without a triplet: a dashed ring at its last reading. It fades and disappears after three \
         seconds. The position of the rig at that time is unknown.";
    TRAIL = "trail":
        "In the scene, the path of each prism in the last seconds before the time cursor. It is wider than the track and fades into the \
         past.";

    // Calibrations.
    EXTRINSICS = "extrinsic calibration" / "extrinsics" / "calibration":
        "Estimates the positions and orientations of the other stations relative to station 1, so that all readings share one frame."
        ("sections I and III");
    RESECTION = "resection" / "free stationing" / "free station":
        "The surveyors' term for the estimation of an instrument's position from points that it measures." ("sections I and III-A");
    T12 = "T12" / "T_12":
        "The transform from station 2's frame into station 1's: x, y, z of station 2 in the frame of station 1, and the rotation of its \
         zero direction (yaw)." ("figure 2, eq. (3)");
    T13 = "T13" / "T_13":
        "The transform from station 3's frame into station 1's: x, y, z and yaw, as T12 for station 2." ("figure 2, eq. (3)");
    YAW = "yaw" / "ψ":
        "The rotation of a station's zero direction about the vertical, relative to station 1. Levelled stations differ only in position \
         and yaw." ("eq. (2)");
    LEVEL = "level" / "levelled":
        "Compensators keep the stations vertical, so each has four unknowns (x, y, z, yaw). The rigid alignment also estimates roll and \
         pitch, which the readings seldom determine." ("section III-A, eq. (2)");
    TWO_POINT = "two-point resection" / "method A":
        "A: each station is placed in the triangle with two points whose relative position is known to a millimetre." ("section III-A");
    STATIC_GCP = "static control points" / "method B":
        "B: the stations are aligned on three or more points that each measured while nothing moved. The paper's reference."
        ("section III-A, eq. (1)");
    DYNAMIC_GCP = "dynamic control points" / "method C":
        "C: as method B, on the positions of one moving prism that all stations follow." ("section III-B, eq. (1)");
    INTER_PRISM = "method D" / "dynamic inter-prism calibration":
        "D: the transforms that minimise the errors of the known inter-prism distances during a drive, by least squares over all \
         triplets." ("section III-B, eq. (3)");
    JOINT = "joint estimate":
        "Estimates transforms, motion, clocks, rig and instrument errors together from the raw readings. A quantity that the data does not \
         determine keeps its prior and increases σ. It is not in the paper. If it can run, it is the answer.";
    CONVERGENCE = "convergence" / "did not converge" / "not converged" / "converged":
        "The iterations of a solver reached a minimum. If they did not converge, the numbers are not a valid answer and their σ is \
         meaningless.";
    PRIOR = "prior search" / "search of the prior" / "initial guess":
        "Finds the initial guess for the minimisation of method D, which the paper calls the prior. The closed form needs no search."
        ("section III-B, search of prior");
    PRIOR_SIZE = "prior" / "prior σ" / "a priori" / "known before":
        "Knowledge about a quantity before the drive: a value with its σ, for example the usual size of a clock offset. The joint estimate \
         combines it with the readings. In method D, the prior is the initial guess (prior search).";
    TAU_V = "τ_v" / "speed limit":
        "The search of the prior uses only triplets slower than τ_v. It increases τ_v from 1 cm/s in steps of 10 cm/s over the range of \
         speeds." ("section III-B, search of prior");
    SIGMA_DISTANCES = "σ distances":
        "The prior σ of the measured inter-prism distances: 3 mm unless given (inter_prism_sigma_m of a settings file). Method D uses at most \
         1 mm, as the paper does. It is part of every σ of the answer.";

    // Reliability of an answer.
    VERDICT = "verdict":
        "The reliability of an answer in one word, with reasons: good, weak (a large σ or a doubt), ambiguous (two solutions fit) or \
         degenerate (a direction is unobservable).";
    UNCHECKED = "not independently checked" / "independently checked":
        "No data that the answer does not use confirms it. Control points would, or, for an answer from control points, a drive with known \
         distances. Errors without a trace in the readings stay undetected.";
    SIGMA = "σ" / "standard deviation" / "uncertainty":
        "The standard deviation: the true value is within 1 σ in two cases of three, within 2 σ in 19 of 20. Method D estimates it from \
         blocks of time (sandwich), because triplets of the same readings have correlated errors.";
    SANDWICH = "sandwich σ" / "sandwich":
        "A σ from the scatter between blocks of time. A σ from the fit alone would be several times too small, because ten triplets per \
         second come from 2.5 readings.";
    REDUNDANCY = "redundancy number" / "redundancy":
        "The share of a reading's error that remains in its residual, from 0 (no other reading checks it) to 1. The normalised residual \
         is the residual over its own standard deviation.";
    MINIMAL_DETECTABLE_BIAS = "minimal detectable bias" / "MDB" / "reliability":
        "The smallest error of a group of readings that is reported with a probability of 80 %, if all tests of a kind reject one good drive \
         in a thousand. Its effect on the answer is the harm that undetected errors can do (Baarda 1968).";
    COVARIANCE = "covariance" / "covariance matrix":
        "The matrix of the variances of several quantities and of their common variation. The square roots of its diagonal are the σ.";
    SIGNIFICANCE = "significant" / "significance" / "not significant" / "p-value":
        "A value is significant if it differs from zero, or from its reference, by more than 3 σ. Noise alone seldom causes such a \
         difference; its probability is p. A value that is not significant may be zero.";
    INCONCLUSIVE = "inconclusive" / "not determined":
        "The data does not suffice for a decision either way. This is neither a confirmation nor a contradiction.";
    RANDOM_WALK = "random walk" / "process noise":
        "A model of slow changes: independent small steps add up, so the variance grows with time. The joint estimate uses it for stations \
         and clocks during a drive.";
    ELLIPSOID = "ellipsoid" / "confidence ellipsoid" / "confidence region":
        "The region that contains the station with 95 % probability, enlarged to be visible.";
    RESIDUAL = "residual":
        "A measured value minus the value that the answer predicts. Small residuals alone do not prove an answer: unobservable errors \
         leave none.";
    INTER_PRISM_METRIC = "inter-prism metric" / "distance error":
        "The difference between computed and measured inter-prism distances, in mm. Method D minimises it, so a small value alone proves \
         nothing." ("section V");
    GROUND_TRUTH = "ground truth":
        "The vehicle's trajectory from the stations, with σ. Trajectories of other systems are compared with it.";
    APE = "APE" / "absolute pose error" / "ATE":
        "The difference between the poses of a trajectory and the ground truth at the same times, after one alignment of the whole \
         trajectory; as in evo.";
    RPE = "RPE" / "relative pose error":
        "The error of the motion over paths of a fixed length, compared with the ground truth: it shows drift, independent of earlier \
         errors; as in evo.";
    LEVER_ARM = "lever arm":
        "The position of a sensor's origin, or of the body of a trajectory, in the vehicle's frame.";
    TIME_OFFSET = "time offset":
        "The correction of a trajectory's times to those of the ground truth: negative if its clock is ahead.";
    GCP_METRIC = "control-point metric" / "GCP metric":
        "The distance between the positions of one control point from different stations, in mm, in a common frame. Method D does not use \
         the points, so this is an independent check." ("section V");
    IQR = "IQR" / "interquartile range":
        "The range of the middle half of the errors: a quarter is below it, a quarter above." ("section V");
    RMS = "RMS" / "root mean square":
        "The square root of the mean squared error. Unlike the median, it is sensitive to a few large errors.";
    MIRROR_TWIN = "mirrored solution" / "mirror ambiguity" / "mirror solution" / "mirror twin" / "twin":
        "On level ground all distances stay the same if a station other than 1 is raised by twice the height difference of its prism. This \
         second solution fits nearly as well and has the wrong height. Pitch and roll, the rig's heights or control points rule it out.";
    COST_RATIO = "cost ratio":
        "The sum of squared errors of another minimum, divided by that of the answer. Close to 1, the drive does not distinguish the two."
        ("eq. (3)");
    MINIMUM = "minima" / "minimum" / "local minimum":
        "A solution that no small change improves. There may be several; the search starts from many places and compares all."
        ("section III-B");
    OBSERVABILITY = "observability" / "observable":
        "Each of the unknowns (four for each of stations 2, 3, …) is observable, weakly observable or unobservable in a drive. A \
         straight line leaves three directions unobservable, a circle one; an L is weak." ("section VI");
    WEAK_DIRECTION = "weak direction" / "weakly observable" / "unobservable" / "free direction":
        "A motion of the stations that hardly changes the inter-prism distances (weakly observable) or does not change them \
         (unobservable). Turns to both sides, far apart, determine it.";
    CORRELATION = "correlation":
        "The linear dependence of two errors, from −1 to 1. Near ±1, the data determines only a combination of the two quantities.";
    ADVICE = "figure-eight":
        "A drive that makes every direction observable: turns to both sides, 20 m or more across if the place allows, best on uneven \
         ground." ("section VI");
    VALIDATION = "validation" / "moved alone" / "evidence of movement":
        "Tests an earlier calibration on another run: the difference of both answers in σ, and the station whose movement alone would \
         explain it. p is the probability of so large a difference from errors of the usual size.";

    ABLATION = "ablation" / "ablate the pipeline":
        "A study: the errors with and without each optional module of the pipeline. It shows the benefit of each module."
        ("section V-A");
    SENSITIVITY = "sensitivity" / "sweep a threshold":
        "A study: the errors as one threshold varies over its range and all other settings stay. A flat curve means that the threshold \
         does not matter." ("section V-A");
    COMPARISON = "comparison of the methods" / "compare calibrations":
        "A study: every method that the data allows, by both metrics." ("section V-B");
    TRAJECTORY = "trajectory" / "pose" / "six degrees of freedom":
        "The position and orientation of the vehicle over time, from the prisms with all stations in one frame. The file (TUM) has \
         time, position and quaternion, as evo reads it." ("section I");
    GNSS = "GNSS" / "RTK":
        "Satellite positions of antennas on the vehicle. The errors of their distances are compared with those of the prisms."
        ("sections IV and V-B");

    // Instrument errors.
    PPM = "ppm" / "scale error":
        "Millionths of the range: air that is 1 °C warmer than the instrument's setting causes 1 ppm, 0.1 mm at 100 m.";
    VERTICAL_INDEX = "vertical index error" / "vertical index" / "index error" / "vertical indices":
        "A constant error of all zenith angles of an instrument, a few arcseconds. The mean of both faces eliminates it. On flat ground \
         it is unobservable from the distances.";
    COLLIMATION = "collimation error" / "collimation" / "line of sight":
        "A constant horizontal error of the line of sight: it is not perpendicular to its axis, or the tracker locks on beside the centre \
         of the prism.";
    LATENCY = "latency" / "latencies":
        "The time between the angles and the range of one reading: up to 30 ms while the instrument tracks.";
    LEAN = "tilt" / "lean" / "vertical axis error":
        "The deviation of a station's vertical axis from the plumb line, about x and y: one or two arcseconds with the compensator on.";
    RANGE_OFFSET = "range offset" / "additive error":
        "A constant error of a station's ranges: prism constant, centring of the prism, and zero of the instrument.";
    SETTLING = "settling":
        "Slow rotation and sinking of tripods during a drive: tens of microradians and about a millimetre, more in the sun and on soft \
         ground.";
    SLOW_ERRORS = "slow errors" / "slow error" / "slow range error" / "correlated range error":
        "Errors of up to a few millimetres to a turning or tilted prism: in range, across the sight and upward. They persist for seconds to \
         minutes, so averaging does not reduce them.";
    SET_UP_CHANGE = "set-up change" / "survey transforms":
        "A station that turns or moves between the survey, when all stations measure the control points, and the drive. The joint estimate \
         has transforms of both.";
    CLOCK_OFFSET = "clock offset" / "offset of a clock":
        "The delay of a station's stamps relative to station 1. A moving vehicle makes it observable in the distances: a millisecond is a \
         millimetre at 1 m/s." ("section II");
    CLOCK_DRIFT = "clock drift" / "drift":
        "A clock that is fast or slow: 1 ppm is a microsecond per second, a millisecond in a quarter of an hour.";
    JUMP = "clock jump" / "jump" / "clock step":
        "A step of a station's clock during a drive. One offset cannot correct it: cut the recording there, or use the joint estimate.";
}
