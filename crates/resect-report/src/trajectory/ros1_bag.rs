//! A trajectory as a ROS 1 bag, format 2.0 (wiki.ros.org/Bags/Format/2.0), uncompressed.

use super::odometry::{ROS1_MD5, TOPIC, ros1_definition, ros1_message, stamp};
use resect_core::evaluation::trajectory::Pose;

/// Size to which the first record is padded, so that recorders can rewrite it.
const FIRST_RECORD: usize = 4096;
/// Messages of one chunk: about a megabyte.
const CHUNK: usize = 1400;
/// Kinds of records.
const MESSAGE: u8 = 2;
const BAG: u8 = 3;
const INDEX: u8 = 4;
const PIECE: u8 = 5;
const PIECE_INFO: u8 = 6;
const CONNECTION: u8 = 7;

pub fn ros1_bag(poses: &[Pose], frame_id: &str) -> Vec<u8> {
    let mut bag = b"#ROSBAG V2.0\n".to_vec();
    let first = bag.len();
    bag.resize(first + FIRST_RECORD, b' ');
    let mut chunk_infos = Vec::new();
    for (index, chunk) in poses.chunks(CHUNK).enumerate() {
        let place = bag.len() as u64;
        let mut data = if index == 0 { connection() } else { Vec::new() };
        let mut index_data = Vec::new();
        for (number, pose) in chunk.iter().enumerate() {
            let time = time(pose);
            index_data.extend([&time[..], &(data.len() as u32).to_le_bytes()].concat());
            let header = fields(MESSAGE, &[("conn", &0_u32.to_le_bytes()), ("time", &time)]);
            let message = ros1_message(pose, frame_id, (CHUNK * index + number) as u32);
            record(&header, &message, &mut data);
        }
        let size = (data.len() as u32).to_le_bytes();
        record(&fields(PIECE, &[("compression", b"none"), ("size", &size)]), &data, &mut bag);
        let (one, zero, count) = (1_u32.to_le_bytes(), 0_u32.to_le_bytes(), chunk.len() as u32);
        let count = count.to_le_bytes();
        let header = fields(INDEX, &[("ver", &one), ("conn", &zero), ("count", &count)]);
        record(&header, &index_data, &mut bag);
        let [start, end] = [&chunk[0], &chunk[chunk.len() - 1]].map(time);
        let header = fields(
            PIECE_INFO,
            &[
                ("ver", &one),
                ("chunk_pos", &place.to_le_bytes()),
                ("start_time", &start),
                ("end_time", &end),
                ("count", &one),
            ],
        );
        record(&header, &[zero, count].concat(), &mut chunk_infos);
    }
    let index_place = bag.len() as u64;
    bag.extend(connection());
    bag.extend(chunk_infos);
    let chunks = poses.chunks(CHUNK).len() as u32;
    let header = fields(
        BAG,
        &[
            ("index_pos", &index_place.to_le_bytes()),
            ("conn_count", &1_u32.to_le_bytes()),
            ("chunk_count", &chunks.to_le_bytes()),
        ],
    );
    let mut record_of_bag = Vec::new();
    let room = FIRST_RECORD - header.len() - 8;
    record(&header, &vec![b' '; room], &mut record_of_bag);
    bag[first..first + FIRST_RECORD].copy_from_slice(&record_of_bag);
    bag
}

/// Returns the record that describes the messages.
fn connection() -> Vec<u8> {
    let header = fields(CONNECTION, &[("conn", &0_u32.to_le_bytes()), ("topic", TOPIC.as_bytes())]);
    let definition = ros1_definition();
    let data = [
        ("topic", TOPIC),
        ("type", "nav_msgs/Odometry"),
        ("md5sum", ROS1_MD5),
        ("message_definition", &definition),
    ];
    let mut record_of_connection = Vec::new();
    let data: Vec<u8> =
        data.iter().flat_map(|(name, value)| field(name, value.as_bytes())).collect();
    record(&header, &data, &mut record_of_connection);
    record_of_connection
}

fn time(pose: &Pose) -> [u8; 8] {
    let [seconds, nanoseconds] = stamp(pose.time_s).map(u32::to_le_bytes);
    let mut bytes = [0; 8];
    bytes[..4].copy_from_slice(&seconds);
    bytes[4..].copy_from_slice(&nanoseconds);
    bytes
}

fn fields(kind: u8, others: &[(&str, &[u8])]) -> Vec<u8> {
    let kind = [kind];
    let all = std::iter::once(("op", &kind[..])).chain(others.iter().copied());
    all.flat_map(|(name, value)| field(name, value)).collect()
}

fn field(name: &str, value: &[u8]) -> Vec<u8> {
    let length = (name.len() + 1 + value.len()) as u32;
    [&length.to_le_bytes()[..], name.as_bytes(), b"=", value].concat()
}

fn record(header: &[u8], data: &[u8], to: &mut Vec<u8>) {
    for part in [header, data] {
        to.extend((part.len() as u32).to_le_bytes());
        to.extend(part);
    }
}
