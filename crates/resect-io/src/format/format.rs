//! The kinds of files.

/// The key that a session begins with; its value is the version of the format.
pub const SESSION_KEY: &str = "resect_session";

/// What a file holds, judged by its content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    PolarCsv,
    /// Cartesian track of one station; three make a deployment.
    CartesianTrack,
    /// What Cartesian tracks were turned with.
    AppliedTransforms,
    /// Track of one station of Bonn's network.
    BonnCsv,
    /// A header that no reader knows above numbers: tracks, once the user says which column is what.
    UnknownTable,
    Ros1Bag,
    Ros2Sqlite,
    Mcap,
    /// `metadata.yaml` of a ROS 2 bag, which stands for its folder.
    RosbagMetadata,
    ControlPoints,
    /// Readings of one instrument.
    Gsi,
    /// Readings of one instrument, as JobXML.
    JobXml,
    Pillars,
    SurveyedPoints,
    RigReading,
    SensorPositions,
    RigDistances,
    RtklibPos,
    DeploymentToml,
    /// A trajectory that another system estimated: no part of a deployment, but judged by one.
    Estimate,
    /// A file or folder that its permissions or the disk keep from being read.
    Unreadable,
    /// A known kind of file that is not read, and why.
    Ignored(&'static str),
}

impl Format {
    /// The part it plays, in words.
    pub fn describe(self) -> &'static str {
        match self {
            Self::PolarCsv => "polar measurements of the three stations (CSV)",
            Self::BonnCsv => "polar measurements of one station (CSV of Bonn's rts-network)",
            Self::UnknownTable => "a table whose columns no reader knows",
            Self::CartesianTrack => "positions of one station's prism",
            Self::AppliedTransforms => "transforms applied to positions",
            Self::Ros1Bag => "measurements of the three stations (ROS 1 bag)",
            Self::Ros2Sqlite => "measurements of the three stations (ROS 2 bag, SQLite)",
            Self::Mcap => "measurements of the three stations (MCAP bag)",
            Self::RosbagMetadata => "what a ROS 2 bag says of its files",
            Self::ControlPoints => "control points",
            Self::Gsi => {
                "one instrument's readings of points (Leica GSI); its stamps are whole seconds, so no track"
            }
            Self::JobXml => {
                "one instrument's readings of points (JobXML); its stamps are whole seconds, so no track"
            }
            Self::Pillars => "surveyed pillars",
            Self::SurveyedPoints => "coordinates of control points",
            Self::RigReading => "a static station's reading of the rig",
            Self::SensorPositions => "positions of the prisms and sensors on the vehicle",
            Self::RigDistances => "inter-prism distances",
            Self::RtklibPos => "positions of a GNSS antenna (RTKLIB)",
            Self::DeploymentToml => "overrides",
            Self::Estimate => "a trajectory of another system; `resect evaluate` judges it",
            Self::Unreadable => "cannot be read",
            Self::Ignored(why) => why,
        }
    }

    /// Whether it holds the stations' tracks.
    pub fn is_track(self) -> bool {
        matches!(self, Self::PolarCsv | Self::BonnCsv | Self::CartesianTrack) || self.is_bag()
    }

    /// Whether it is a recording of ROS 1 or ROS 2.
    pub fn is_bag(self) -> bool {
        matches!(self, Self::Ros1Bag | Self::Ros2Sqlite | Self::Mcap)
    }

    /// Whether it holds tracks, or may do so once the user says which column is what.
    pub fn may_be_track(self) -> bool {
        self.is_track() || self == Self::UnknownTable
    }
}
