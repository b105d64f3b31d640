//! A deployment while it is driven: readings from the network, answers while they come in, and whether it is enough.
//!
//! | file | what |
//! |---|---|
//! | [`event`] | what sources say, whatever they are: channels and messages of ROS |
//! | [`foxglove`], [`bonn`], [`replay`] | the sources |
//! | [`connect`] | the way to one over the network, again and again |
//! | [`recorder`] | what comes in, as MCAP, while it comes in |
//! | [`findings`] | the warnings of the live drive, one constructor for each kind |
//! | [`status`], [`warnings`] | how the stations are, and what is amiss |
//! | [`judged`], [`coach`], [`next`] | what an answer means in the field: is it enough, and if not what to drive |
//! | [`pace`] | how often answers are begun |
//! | [`engine`], [`view`] | all of it without threads: events go in, snapshots and views come out |
//! | [`session`] | the threads, behind one handle |
//! | [`Closing`] | the last words, once all readings have their answer |
//!
//! The tracks grow in [`resect_io::growing::Growing`], which makes the same deployment of the messages as a bag of them makes: answers are
//! those of [`resect_core::analysis::Analyst`], as of any other deployment.

pub mod bonn;
mod closing;
pub mod coach;
pub mod connect;
pub mod engine;
pub mod event;
pub mod findings;
pub mod foxglove;
pub mod judged;
mod next;
pub mod pace;
pub mod recorder;
pub mod replay;
pub mod session;
pub mod status;
pub mod view;
pub mod warnings;

pub use self::closing::Closing;
pub use self::engine::Engine;
pub use self::pace::Pace;
pub use self::session::{Feed, Finished, LiveError, Session, Wanted, around};
pub use self::view::{Link, View};
