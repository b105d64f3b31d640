//! A trajectory as MCAP, with the messages of ROS 2.

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions};

use super::odometry::{TOPIC, ros2_definition, ros2_message, stamp};
use resect_core::evaluation::trajectory::Pose;

pub fn mcap(poses: &[Pose], frame_id: &str) -> Result<Vec<u8>, McapError> {
    let mut bytes = Cursor::new(Vec::new());
    let options = WriteOptions::new().compression(None).profile("ros2").library("resect");
    let mut writer = options.create(&mut bytes)?;
    let definition = ros2_definition();
    let schema = writer.add_schema("nav_msgs/msg/Odometry", "ros2msg", definition.as_bytes())?;
    let channel_id = writer.add_channel(schema, TOPIC, "cdr", &BTreeMap::new())?;
    for (sequence, pose) in (0..).zip(poses) {
        let [seconds, nanoseconds] = stamp(pose.time_s).map(u64::from);
        let log_time = 1_000_000_000 * seconds + nanoseconds;
        let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
        writer.write_to_known_channel(&header, &ros2_message(pose, frame_id))?;
    }
    writer.finish()?;
    drop(writer);
    Ok(bytes.into_inner())
}
