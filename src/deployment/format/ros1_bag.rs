//! ROS 1 bags of the authors' theodolite node.
//!
//! Messages are found by their type, `theodolite_node_msgs/TheodoliteCoordsStamped`, on whatever topic:
//! `Header header; time theodolite_time; uint8 theodolite_id; uint8 status; float64 azimuth, elevation,
//! distance`. The time of a reading is the station's own (`theodolite_time`), and `elevation` is a zenith angle.

use std::io::Read;
use std::path::Path;

use rosbag::{ChunkRecord, IndexRecord, MessageRecord, RosBag};

use super::OpenError;
use crate::deployment::{Measurement, RawRecord};
use crate::progress::Progress;

const MESSAGE_TYPE: &str = "theodolite_node_msgs/TheodoliteCoordsStamped";
const REINDEX: &str = "repair it with `rosbag reindex`, or record it again";

/// Every theodolite message in the order of the file, one chunk in memory at a time. `progress` counts the file's bytes.
pub fn read(path: &Path, file: &str, progress: &Progress) -> Result<Vec<RawRecord>, OpenError> {
    let length = check_index(path, file)?;
    let bag = RosBag::new(path)
        .map_err(|error| OpenError::file(file, format!("not a readable bag ({error})"), REINDEX))?;
    let (mut connections, mut chunk_starts) = (Vec::new(), Vec::new());
    for record in bag.index_records() {
        match record.map_err(|error| damaged(file, &error))? {
            IndexRecord::Connection(connection) if connection.tp == MESSAGE_TYPE => {
                connections.push(connection.id);
            }
            IndexRecord::ChunkInfo(chunk) => chunk_starts.push(chunk.chunk_pos),
            _ => {}
        }
    }
    // As they lie in the file, which is how they are read.
    chunk_starts.sort_unstable();
    let mut chunk_ends = chunk_starts.into_iter().skip(1);
    let mut counted = 0;
    if connections.is_empty() {
        return Err(OpenError::file(
            file,
            format!("holds no message of type {MESSAGE_TYPE}"),
            "open the bag that the theodolite node recorded",
        ));
    }
    let mut records = Vec::new();
    for chunk in bag.chunk_records() {
        let ChunkRecord::Chunk(chunk) = chunk.map_err(|error| damaged(file, &error))? else {
            continue;
        };
        for message in chunk.messages() {
            let MessageRecord::MessageData(message) =
                message.map_err(|error| damaged(file, &error))?
            else {
                continue;
            };
            if connections.contains(&message.conn_id) {
                let place = records.len() + 1;
                records.push(decode(message.data, place).ok_or_else(|| {
                    OpenError::file(
                        file,
                        format!("message {place} is shorter than {MESSAGE_TYPE}"),
                        "the message definition differs; record with the authors' node",
                    )
                })?);
            }
        }
        // An index that is out of order costs the progress its truth, and nothing else.
        let end = chunk_ends.next().unwrap_or(length).clamp(counted, length);
        progress.advance(end - counted)?;
        counted = end;
    }
    if records.is_empty() {
        return Err(OpenError::file(
            file,
            "its theodolite topic has no message",
            "record it again",
        ));
    }
    Ok(records)
}

/// The bag's header names where its index starts. A recording that was killed has 0 there; a copy that was
/// cut short ends before it. Both must be caught here: the bag crate would index past the end. Gives the file's length.
fn check_index(path: &Path, file: &str) -> Result<u64, OpenError> {
    let io = |error| OpenError::Io { path: path.to_owned(), error };
    let length = std::fs::metadata(path).map_err(io)?.len();
    let mut head = Vec::new();
    std::fs::File::open(path).and_then(|f| f.take(4096).read_to_end(&mut head)).map_err(io)?;
    let key = b"index_pos=";
    let index_position = head
        .windows(key.len())
        .position(|window| window == key)
        .and_then(|at| head.get(at + key.len()..at + key.len() + 8))
        .and_then(|bytes| bytes.try_into().ok())
        .map(u64::from_le_bytes);
    match index_position {
        None => Err(OpenError::file(file, "the bag ends inside its header", REINDEX)),
        Some(0) => Err(OpenError::file(
            file,
            "the bag has no index: its recording was interrupted",
            REINDEX,
        )),
        Some(index) if index < 4096 => Err(OpenError::file(
            file,
            format!("the bag's header is damaged (index at byte {index})"),
            REINDEX,
        )),
        Some(index) if index >= length => Err(OpenError::file(
            file,
            format!("the bag is cut short: {length} bytes, and its index starts at byte {index}"),
            REINDEX,
        )),
        Some(_) => Ok(length),
    }
}

fn damaged(file: &str, error: &rosbag::Error) -> OpenError {
    OpenError::file(file, format!("the bag is damaged or cut short ({error:?})"), REINDEX)
}

/// ROS serialisation is little-endian and packed.
fn decode(data: &[u8], place: usize) -> Option<RawRecord> {
    let frame_id_length = u32_at(data, 12)? as usize;
    let body = data.get(16usize.checked_add(frame_id_length)?..)?;
    Some(RawRecord {
        station: i64::from(*body.get(8)?),
        status: i64::from(*body.get(9)?),
        place,
        measurement: Measurement {
            time_s: f64::from(u32_at(body, 0)?) + f64::from(u32_at(body, 4)?) * 1e-9,
            azimuth_rad: f64_at(body, 10)?,
            zenith_rad: f64_at(body, 18)?,
            range_m: f64_at(body, 26)?,
        },
    })
}

fn u32_at(data: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(data.get(at..at + 4)?.try_into().ok()?))
}

fn f64_at(data: &[u8], at: usize) -> Option<f64> {
    Some(f64::from_le_bytes(data.get(at..at + 8)?.try_into().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_message_is_refused_at_every_length() {
        let mut data = vec![0_u8; 16 + 34];
        data[24] = 2;
        assert_eq!(decode(&data, 1).expect("complete").station, 2);
        for length in 0..data.len() {
            assert!(decode(&data[..length], 1).is_none(), "length {length}");
        }
    }

    #[test]
    fn a_frame_id_that_claims_too_much_is_refused() {
        let mut data = vec![0_u8; 64];
        data[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(decode(&data, 1).is_none());
    }
}
