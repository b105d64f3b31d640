//! The list of terms, on the way from readings to a verdict: plain data.

use super::Term;

macro_rules! terms {
    ($($constant:ident = $name:literal $(/ $also:literal)*: $means:literal $(($paper:literal))?;)*) => {
        $(pub static $constant: Term = Term {
            name: $name,
            also: &[$($also),*],
            means: $means,
            paper: concat!($($paper)?),
        };)*
        /// All terms, on the way from readings to a verdict.
        pub static ALL: &[&Term] = &[$(&$constant),*];
    };
}

terms! {
    // What is measured.
    STATION = "robotic total station" / "RTS":
        "An instrument that follows a prism by itself and measures range, azimuth and zenith angle to it. Three of them, 1 to 3, follow \
         the three prisms of a vehicle." ("section I");
    DEPLOYMENT = "deployment":
        "One field session with stations that nobody moved: three tracks, and what lies beside them of control points, rig and GNSS."
        ("section IV");
    READING = "reading" / "measurement":
        "What a station measured at one instant: range, azimuth, zenith angle and a time stamp. Stations read at about 2.5 Hz, each at \
         its own moments." ("section IV");
    ZENITH_ANGLE = "zenith angle" / "zenith" / "elevation":
        "The angle from straight up down to the prism; 90° is level. Files often call it elevation." ("section III-B");
    AZIMUTH = "azimuth":
        "The horizontal angle to the prism, clockwise seen from above unless the files say otherwise, from wherever the instrument's \
         circle is zero." ("section III-B");
    PRISM_CONSTANT = "prism constant":
        "What has to be added to a range because of how light travels in the prism: +10 mm for the MT1000. A wrong one bends every \
         distance and, where stations differ in height, the answer.";
    RIG = "rig":
        "The three prisms fixed to the vehicle. Their distances must not change during a drive." ("section III-B");
    INTER_PRISM_DISTANCES = "inter-prism distance" / "prism distance":
        "How far the prisms of the rig are from each other: α = 1–2, β = 1–3, γ = 2–3. They are measured beforehand with one station, \
         and are what method D rests on." ("section III-B, eq. (3)");
    CONTROL_POINT = "control point" / "GCP" / "ground control point":
        "A point that stands still and that every station measured. Static ones are set up by hand; dynamic ones are one moving prism \
         that all stations follow." ("sections III-A and III-B");
    OWN_CLOCK = "own clock":
        "The clock of the computer at a station, beside the synchronised time that readings are stamped with. One millisecond between \
         stations is one millimetre at 1 m/s." ("section II");
    STAMP = "stamp" / "time stamp":
        "The time that a file gives for a reading. Stamps may be late, drift or jump against those of another station.";

    // The pipeline.
    OUTLIER_FILTER = "outlier filter":
        "Drops readings that differ from the one before by more than a vehicle can move: faster than τ_r in range, τ_a in azimuth or \
         τ_e in zenith angle. Optional." ("section III-B, module 1");
    TAU_R = "τ_r":
        "The fastest change of range that is believed, in m/s; the vehicle's top speed. Faster readings are dropped."
        ("sections III-B and V-A: 2 m/s for the Warthog, 1 m/s for the HD2");
    TAU_A = "τ_a":
        "The fastest change of azimuth that is believed, in degrees a second. Near a station a slow vehicle turns it fast: look at the \
         rates before you lower it." ("sections III-B and V-A: 1 °/s");
    TAU_E = "τ_e":
        "The fastest change of the zenith angle that is believed, in degrees a second." ("sections III-B and V-A: 1 °/s");
    GAP = "gap" / "silence":
        "A time without readings of a station: it lost its prism behind an obstacle, or the radio failed." ("section III-B, module 2");
    TAU_S = "τ_s":
        "The longest gap inside an interval, in seconds: across longer ones nothing is interpolated."
        ("sections III-B and V-A: 1 s, two lost readings in a row");
    INTERVAL = "interval" / "interval split":
        "A span in which all three stations measured without a gap longer than τ_s." ("section III-B, module 2");
    TAU_L = "τ_l" / "interval filter":
        "Intervals up to this length, in seconds, are dropped, because few readings make a poor interpolation. Optional."
        ("sections III-B and V-A: 6 s");
    FATE = "fate":
        "What became of a reading: kept, rejected for one of the rates, in no interval, in an interval too short, or left out by hand.";
    INTERPOLATION = "interpolation":
        "Finds where each prism was at the same instants, between readings that each station took at its own moments: along straight \
         lines, or by a Gaussian process." ("section III-B, module 4");
    GAUSSIAN_PROCESS = "Gaussian process" / "GP":
        "An interpolation that learns how smooth the motion and how noisy the readings are, and tells σ of what it says. It wants \
         long intervals." ("section III-B, module 4");
    MOTION_MODEL = "motion model" / "white noise on acceleration" / "WNOA":
        "A Gaussian process for vehicles: its velocity persists, its acceleration is random. It follows stops and turns, and its cost \
         grows only with the number of readings.";
    TRIPLET = "triplet":
        "The three prisms' interpolated positions at one instant, each in its own station's frame." ("section III-B, module 4");

    GHOST = "ghost":
        "In the scene, a prism at a time of which there is no triplet: a dashed ring where it was last read, paler the longer that is \
         ago, and gone after three seconds. Where the rig was meanwhile nobody knows.";
    TRAIL = "trail":
        "In the scene, the way that each prism went in the last seconds before the time cursor, drawn wider than its track and fading \
         out into the past.";

    // The calibrations.
    EXTRINSICS = "extrinsic calibration" / "extrinsics" / "calibration":
        "Finding where stations 2 and 3 stand and which way they face, seen from station 1, so that all readings share one frame."
        ("sections I and III");
    RESECTION = "resection" / "free stationing":
        "The surveyors' word for finding where an instrument stands from points that it sees." ("sections I and III-A");
    T12 = "T12" / "T_12":
        "The transform that takes points from station 2's frame into station 1's: x, y, z of station 2 seen from station 1, and by how \
         much its zero direction is turned (yaw)." ("figure 2, eq. (3)");
    T13 = "T13" / "T_13":
        "The transform that takes points from station 3's frame into station 1's: x, y, z and yaw, as T12 for station 2."
        ("figure 2, eq. (3)");
    YAW = "yaw" / "ψ":
        "How far a station's zero direction is turned about the vertical against station 1's. Levelled stations differ in nothing else \
         but where they stand." ("eq. (2)");
    LEVEL = "level" / "levelled":
        "Stations are set upright by their compensators: four unknowns each (x, y, z, yaw). Rigid lets roll and pitch go as well, which \
         readings seldom hold." ("section III-A, eq. (2)");
    TWO_POINT = "two-point resection" / "method A":
        "A: each station is placed in the triangle with two points whose relative position is known to a millimetre." ("section III-A");
    STATIC_GCP = "static control points" / "method B":
        "B: the stations are aligned on three or more points that each measured while nothing moved. The paper's reference."
        ("section III-A, eq. (1)");
    DYNAMIC_GCP = "dynamic control points" / "method C":
        "C: the same alignment on the moments of one moving prism that all three stations follow." ("section III-B, eq. (1)");
    INTER_PRISM = "method D" / "dynamic inter-prism calibration":
        "D: the transforms under which the prisms keep their known distances during a drive, by least squares over all triplets."
        ("section III-B, eq. (3)");
    JOINT = "joint estimate":
        "Transforms, motion, clocks, rig and the errors of the instruments in one estimate out of the readings themselves. What the \
         data does not show keeps its usual size and widens σ. Beyond the paper; where it can run, it is the answer.";
    PRIOR = "prior":
        "The guess that the minimisation of method D starts from. In closed form it needs no guess; the search is the paper's."
        ("section III-B, search of prior");
    TAU_V = "τ_v" / "speed limit":
        "In the search of the prior, only triplets slower than this count; it grows from 1 cm/s by 10 cm/s over the range of speeds."
        ("section III-B, search of prior");
    SIGMA_DISTANCES = "σ distances":
        "How well you know the inter-prism distances (1 σ): one millimetre unless given. It is part of every σ of the answer.";

    // How far it can be trusted.
    VERDICT = "verdict":
        "How far an answer can be trusted, in one word, with reasons: good, weak (a large σ or a doubt), ambiguous (two answers, and \
         nothing decides) or degenerate (a direction is free).";
    UNCHECKED = "not independently checked" / "independently checked":
        "Nothing that the answer does not itself rest on confirms it: control points would, or, for an answer from control points, a \
         drive with known distances. Errors that leave no trace in the readings stay unseen.";
    SIGMA = "σ" / "standard deviation":
        "One standard deviation: the true value lies within 1 σ in two cases of three, within 2 σ in 19 of 20. For method D it is told \
         from stretches of time (sandwich), because triplets of the same readings err together.";
    SANDWICH = "sandwich σ" / "sandwich":
        "σ from how much stretches of the drive pull the answer about, and not from the fit alone, which would be several times too \
         small: ten triplets a second come from 2.5 readings.";
    ELLIPSOID = "ellipsoid":
        "Where a station stands with 95 % probability, drawn so that it can be seen.";
    INTER_PRISM_METRIC = "inter-prism metric" / "distance error" / "residual":
        "How far the distances between prisms under the answer are from the measured ones, in mm. Method D makes it small itself, so that a \
         small one alone proves nothing." ("section V");
    APE = "APE" / "absolute pose error" / "ATE":
        "How far a trajectory's poses are from the ground truth's at the same times, once it is aligned as a whole; evo's number.";
    RPE = "RPE" / "relative pose error":
        "How far the motion over a path of some length is from the ground truth's, path after path: drift, whatever came before; \
         evo's number.";
    LEVER_ARM = "lever arm":
        "Where the origin of a sensor, or of the body whose poses a trajectory has, is in the vehicle's frame.";
    TIME_OFFSET = "time offset":
        "What is added to a trajectory's times to have the ground truth's: negative where its clock is ahead.";
    GCP_METRIC = "control-point metric" / "GCP metric":
        "How far apart the stations see the same control point, in mm, once all are in one frame: the more honest metric, where D has \
         not seen the points." ("section V");
    IQR = "IQR" / "interquartile range":
        "The span of the middle half of the errors: a quarter is below it, a quarter above." ("section V");
    RMS = "RMS" / "root mean square":
        "The square root of the mean of the squared errors. Unlike the median it is raised much by a few large ones.";
    MIRROR_TWIN = "mirror twin" / "twin" / "mirror solution":
        "On level ground all distances stay the same when station 2 or 3 is raised by twice the height difference of its prism. The \
         twin fits nearly as well and is wrong by that much; pitch and roll, the rig's heights or control points tell it apart.";
    COST_RATIO = "cost ratio":
        "How many times the sum of squared errors of another minimum is that of the answer. Close to 1, the drive does not tell them \
         apart." ("eq. (3)");
    MINIMUM = "minima" / "minimum" / "local minimum":
        "An answer that no small change improves. There may be several; the search starts from many places and compares all of them."
        ("section III-B");
    OBSERVABILITY = "observability":
        "How well the drive holds each of the eight unknowns: a straight line leaves three directions free, a circle one; an L is weak."
        ("section VI");
    WEAK_DIRECTION = "weak direction" / "free direction":
        "A motion of stations 2 and 3 together that the distances hardly notice. Turns to both sides, far apart, make them notice.";
    CORRELATION = "correlation":
        "How the errors of two numbers go together, from −1 to 1. Near ±1 the one cannot be told without the other.";
    ADVICE = "figure-eight":
        "The drive that holds every direction: turns to both sides, 20 m or more across, best on uneven ground." ("section VI");
    VALIDATION = "validation" / "moved alone":
        "Whether an earlier calibration holds for another run: the difference of both answers against its σ, and which station alone \
         would explain it. The chances say how often errors of the usual size look like that.";

    ABLATION = "ablation" / "ablate the pipeline":
        "A study: the errors with and without each optional module of the pipeline, so that one sees what each brings."
        ("section V-A");
    SENSITIVITY = "sensitivity" / "sweep a threshold":
        "A study: the errors while one threshold goes through its range and all else stays. Where the curve is flat, the threshold \
         does not matter." ("section V-A");
    COMPARISON = "comparison of the methods" / "compare calibrations":
        "A study: every method that the data allows, by both metrics." ("section V-B");
    TRAJECTORY = "trajectory" / "pose" / "six degrees of freedom":
        "Where the vehicle was and which way it faced at each moment: with all stations in one frame, the three prisms give its \
         position and orientation. The file (TUM) has time, position and quaternion, as evo reads it." ("section I");
    GNSS = "GNSS" / "RTK":
        "Satellite positions of antennas on the vehicle. Their distances are compared with those of the prisms, and tell how much \
         better the stations are." ("sections IV and V-B");

    // What instruments do wrong.
    PPM = "ppm":
        "Millionths of the range: air that is 1 °C warmer than the instrument believes makes 1 ppm, 0.1 mm at 100 m.";
    VERTICAL_INDEX = "vertical index" / "index error" / "vertical indices":
        "A constant error of all zenith angles of an instrument, of a few arcseconds; averaging both faces would take it out. On flat \
         ground it leaves no trace in the distances.";
    COLLIMATION = "collimation" / "line of sight":
        "A line of sight that is not square to its axis, or a tracker that locks on beside the prism's middle: a constant angle to the \
         side.";
    LATENCY = "latency" / "latencies":
        "The time between the angles and the range of one reading: up to 30 ms while the instrument tracks.";
    LEAN = "lean" / "tilt":
        "How far a station's vertical axis is off the plumb line, about x and y: an arcsecond or two once the compensator has done \
         its work.";
    RANGE_OFFSET = "range offset":
        "A constant error of a station's ranges to its prism: the prism constant, its centring, the instrument's zero.";
    SETTLING = "settling":
        "Tripods turn and sink a little during a drive: tens of microradians and about a millimetre, more in the sun and on soft \
         ground.";
    WANDERING_RANGES = "wandering ranges" / "wander":
        "Ranges to a turning or tilted prism err by up to a few millimetres for seconds to minutes, so that averaging does not help.";
    CLOCK_OFFSET = "clock offset" / "offset of a clock":
        "How late the stamps of a station are against station 1's. Where the vehicle moves it shows in the distances: a millisecond \
         is a millimetre at 1 m/s." ("section II");
    CLOCK_DRIFT = "clock drift" / "drift":
        "A clock that runs fast or slow: 1 ppm is a microsecond each second, a millisecond in a quarter of an hour.";
    JUMP = "jump":
        "A clock that is set anew during a drive. No one offset puts it right: cut the recording there, or use the joint estimate.";
}
