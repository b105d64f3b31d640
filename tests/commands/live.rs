//! Live deployments: streams of servers that break off, repeat and garble, and what is recorded of them.

mod bad_input;
mod bonn;
mod coach;
mod command;
mod day;
mod peers;
mod put_right;
mod server;
mod stream;
