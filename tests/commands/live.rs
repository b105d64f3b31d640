//! Live deployments: streams of servers that disconnect, repeat and garble messages, and their recordings.

mod bad_input;
mod bonn;
mod coach;
mod command;
mod corrections;
mod day;
mod peers;
mod server;
mod stream;
