//! The formats of files.

/// First key of a session; its value is the version of the format.
pub const SESSION_KEY: &str = "resect_session";

/// Format of a file, recognised by its content.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    PolarCsv,
    /// Cartesian track of one station; three form a deployment.
    CartesianTrack,
    /// Transforms that were applied to Cartesian tracks.
    AppliedTransforms,
    /// Track of one station of Bonn's network.
    BonnCsv,
    /// A table with an unknown header: tracks, after the user has named the columns.
    UnknownTable,
    Ros1Bag,
    Ros2Sqlite,
    Mcap,
    /// `metadata.yaml` of a ROS 2 bag, which represents its folder.
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
    /// A trajectory estimated by another system: not part of a deployment, but compared with one.
    Estimate,
    /// A file or folder that cannot be read, because of its permissions or the disk.
    Unreadable,
    /// A known kind of file that is not read, with the reason.
    Ignored(&'static str),
}

impl Format {
    /// Description of the content.
    pub fn describe(self) -> &'static str {
        match self {
            Self::PolarCsv => "polar measurements of the stations (CSV)",
            Self::BonnCsv => "polar measurements of one station (CSV of Bonn's rts-network)",
            Self::UnknownTable => "a table with unknown columns",
            Self::CartesianTrack => "positions of one station's prism",
            Self::AppliedTransforms => "transforms applied to positions",
            Self::Ros1Bag => "measurements of the stations (ROS 1 bag)",
            Self::Ros2Sqlite => "measurements of the stations (ROS 2 bag, SQLite)",
            Self::Mcap => "measurements of the stations (MCAP bag)",
            Self::RosbagMetadata => "metadata of a ROS 2 bag",
            Self::ControlPoints => "control points",
            Self::Gsi => {
                "one instrument's readings of points (Leica GSI); not a track, because stamps are whole seconds"
            }
            Self::JobXml => {
                "one instrument's readings of points (JobXML); not a track, because stamps are whole seconds"
            }
            Self::Pillars => "surveyed pillars",
            Self::SurveyedPoints => "coordinates of control points",
            Self::RigReading => "a static station's reading of the rig",
            Self::SensorPositions => "positions of the prisms and sensors on the vehicle",
            Self::RigDistances => "inter-prism distances",
            Self::RtklibPos => "positions of a GNSS antenna (RTKLIB)",
            Self::DeploymentToml => "overrides",
            Self::Estimate => "a trajectory of another system; evaluate it with `resect evaluate`",
            Self::Unreadable => "cannot be read",
            Self::Ignored(why) => why,
        }
    }

    /// Returns true if the file contains tracks of stations.
    pub fn is_track(self) -> bool {
        matches!(self, Self::PolarCsv | Self::BonnCsv | Self::CartesianTrack) || self.is_bag()
    }

    /// True for a recording of ROS 1 or ROS 2.
    pub fn is_bag(self) -> bool {
        matches!(self, Self::Ros1Bag | Self::Ros2Sqlite | Self::Mcap)
    }

    /// Returns true if the file contains tracks, or may contain them after the user has named the columns.
    pub fn may_be_track(self) -> bool {
        self.is_track() || self == Self::UnknownTable
    }
}
