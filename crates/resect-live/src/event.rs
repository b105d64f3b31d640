//! What sources say, whatever they are: channels, messages of ROS, and how the connection is.

/// A channel that a source offers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// By which its messages name it, until the source connects again.
    pub id: u64,
    pub topic: String,
    pub message_type: String,
    /// "cdr", "ros1".
    pub encoding: String,
    /// The definition of its messages, and in which language it is.
    pub schema: Vec<u8>,
    pub schema_encoding: String,
}

/// Something that a source says.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// The source answered, with this name; channels of before are no longer.
    Connected(String),
    /// There is no connection, and why not; it is tried again after so many seconds.
    Lost {
        why: String,
        again_in_s: f64,
    },
    Channel(Channel),
    Message(Sent),
    /// So many things that cannot be taken in.
    LeftOut {
        what: LeftOut,
        count: u64,
        first: String,
    },
    /// All was said, and nothing more will come.
    Ended,
}

/// A message as it was sent.
#[derive(Clone, Debug, PartialEq)]
pub struct Sent {
    /// The channel's [`Channel::id`].
    pub channel: u64,
    /// When the source sent it (ns since 1970, its clock).
    pub sent_ns: u64,
    /// When it was received here (s since 1970, this computer's clock).
    pub received_s: f64,
    pub payload: Vec<u8>,
}

/// Why something of a stream is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LeftOut {
    /// The same reading once more, from a source that repeats them.
    Repeat,
    /// A frame that makes no sense.
    Frame,
    /// A channel in an encoding that is not read.
    Encoding,
    /// A message that is longer than any can be.
    TooLong,
    /// A message that is not what its type says.
    Malformed,
    /// A reading of an instrument that nobody says the station of.
    NoStation,
    /// What the server warned of.
    Warned,
}

impl LeftOut {
    /// The name that scripts read.
    pub fn name(self) -> &'static str {
        match self {
            Self::Repeat => "repeats",
            Self::Frame => "frames",
            Self::Encoding => "encodings",
            Self::TooLong => "too_long",
            Self::Malformed => "malformed",
            Self::NoStation => "no_station",
            Self::Warned => "server_warnings",
        }
    }
}
