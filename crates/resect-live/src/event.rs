//! Events of any source: channels, ROS messages, and the state of the connection.

/// A channel that a source offers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Identifier of the channel in messages, until the source connects again.
    pub id: u64,
    pub topic: String,
    pub message_type: String,
    /// `"cdr"`, `"ros1"` or `"json"`.
    pub encoding: String,
    /// Definition of its messages, and the language of that definition.
    pub schema: Vec<u8>,
    pub schema_encoding: String,
}

/// An event of a source.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// The source answered, with this name; earlier channels are invalid.
    Connected(String),
    /// The connection failed, with the reason; the next attempt follows after `again_in_s` (s).
    Lost {
        why: String,
        again_in_s: f64,
    },
    Channel(Channel),
    Message(Sent),
    /// A number of items that cannot be processed, with a description of the first.
    LeftOut {
        what: LeftOut,
        count: u64,
        first: String,
    },
    /// The source has ended; no event follows.
    Ended,
}

/// A message with its times.
#[derive(Clone, Debug, PartialEq)]
pub struct Sent {
    /// The channel's [`Channel::id`].
    pub channel: u64,
    /// Time of sending (ns since 1970, the source's clock).
    pub sent_ns: u64,
    /// Time of reception (s since 1970, this computer's clock).
    pub received_s: f64,
    pub payload: Vec<u8>,
}

/// Reason why an item of a stream is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LeftOut {
    /// The same reading again, from a source that repeats readings.
    Repeat,
    /// An unreadable frame.
    Frame,
    /// A channel in an unsupported encoding.
    Encoding,
    /// A message longer than the limit.
    TooLong,
    /// A message that does not match its type.
    Malformed,
    /// A reading of an instrument that is assigned to no station.
    NoStation,
    /// A warning of the server.
    Warned,
}

impl LeftOut {
    /// Returns the name for scripts.
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
