#![no_main]

//! The content of one JSON message of an MCAP file.

use resect_io::format::bag::{json_messages, messages::Kind};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    for kind in
        [Kind::TheodoliteCoords, Kind::PoseStamped, Kind::Transforms, Kind::Point, Kind::NavSatFix]
    {
        _ = json_messages::decode(kind, bytes);
    }
});
