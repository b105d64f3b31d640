//! Messages with positions of prisms, corrections of clocks, or poses: their types, and the order of their fields.
//!
//! - `theodolite_node_msgs/TheodoliteCoordsStamped` (norlab-ulaval, theodolite_node_msgs): `Header header; time theodolite_time;
//!   uint8 theodolite_id; uint8 status; float64 azimuth, elevation, distance`; `elevation` is a zenith angle, status 0 a reading.
//!   The master node sets `header.stamp` to `theodolite_time` minus the station's estimated clock offset.
//! - `theodolite_node_msgs/TheodoliteTimeCorrection`: `Header header; uint8 theodolite_id; duration estimated_time_offset`.
//! - `geometry_msgs/PointStamped`: `Header header; float64 x, y, z`.
//! - `leica_streaming_msgs/LeicaPoint`, in ROS 1 `leica_streaming_app/LeicaPoint` (cedricpradalier/leica_streaming_app): `Header
//!   header; string point_id; float64 x, y, z; string date, sensor_time`. The node stamps the header with its computer's clock when
//!   the point arrives. `date` and `sensor_time` are the instrument's own, as text in a form that depends on its settings, without a
//!   time zone. The header's stamp is used, since all stations share its clock.
//! - `nav_msgs/Odometry`: `Header header; string child_frame_id`, then as `geometry_msgs/PoseStamped`: `Header header; float64 x, y, z;
//!   float64 qx, qy, qz, qw`; `PoseWithCovarianceStamped` begins likewise. They are trajectories of other systems, not readings.
//! - `sensor_msgs/NavSatFix`: `Header header; int8 status; uint16 service; float64 latitude, longitude (degrees), altitude; float64[9]
//!   position_covariance; uint8 position_covariance_type`. `foxglove.LocationFix` is the same without status.
//! - `geometry_msgs/TransformStamped`: as `Odometry`; `tf2_msgs/TFMessage` is a sequence of them.
//!
//! Time corrections and Leica points are tested only on messages written to these definitions, not on a real recording.

use super::wire::{Encoding, Malformed, Wire, stamp};
use resect_core::deployment::FrameNames;

/// Kind of a message, by the name of its type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    TheodoliteCoords,
    TimeCorrection,
    Point,
    LeicaPoint,
    PoseStamped,
    Odometry,
    Transforms,
    NavSatFix,
}

/// Type of the authors' readings, with its ROS 1 name.
pub const THEODOLITE_TYPE: &str = "theodolite_node_msgs/TheodoliteCoordsStamped";

impl Kind {
    /// Returns the kind of a type named as in ROS 1 (`package/Name`) or ROS 2 (`package/msg/Name`); `None` for types that are not read.
    pub fn of_type(name: &str) -> Option<Self> {
        match short_type(name).as_str() {
            THEODOLITE_TYPE => Some(Self::TheodoliteCoords),
            "theodolite_node_msgs/TheodoliteTimeCorrection" => Some(Self::TimeCorrection),
            "geometry_msgs/PointStamped" => Some(Self::Point),
            "leica_streaming_msgs/LeicaPoint" | "leica_streaming_app/LeicaPoint" => {
                Some(Self::LeicaPoint)
            }
            "geometry_msgs/PoseStamped"
            | "geometry_msgs/PoseWithCovarianceStamped"
            | "foxglove.PoseInFrame" => Some(Self::PoseStamped),
            "nav_msgs/Odometry" | "geometry_msgs/TransformStamped" => Some(Self::Odometry),
            "tf2_msgs/TFMessage" | "tf/tfMessage" => Some(Self::Transforms),
            "sensor_msgs/NavSatFix" | "foxglove.LocationFix" => Some(Self::NavSatFix),
            _ => None,
        }
    }

    /// Returns true if its messages are positions that do not name their station.
    pub fn is_position(self) -> bool {
        matches!(self, Self::Point | Self::LeicaPoint)
    }

    /// Returns true if its messages are poses or positions estimated by another system.
    pub fn is_pose(self) -> bool {
        matches!(self, Self::PoseStamped | Self::Odometry | Self::Transforms | Self::NavSatFix)
    }
}

/// Returns the name of a type without the `msg/` of ROS 2.
pub fn short_type(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

/// Content of a message.
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    Coords(Coords),
    Correction(Correction),
    Point(Point),
    Pose(StampedPose),
    Transforms(Vec<StampedTransform>),
    Fix(NavSatFix),
}

/// A fix of a satellite receiver.
#[derive(Clone, Debug, PartialEq)]
pub struct NavSatFix {
    pub stamp_s: Option<f64>,
    /// -1 without a fix; `None` for messages without.
    pub status: Option<i8>,
    /// Latitude and longitude.
    pub degrees: [f64; 2],
    pub altitude_m: f64,
    /// East, north, up, row by row.
    pub covariance_m2: [f64; 9],
    /// 0 unknown, 1 approximated, 2 diagonal known, 3 known.
    pub covariance_type: u8,
}

/// A pose of another system.
#[derive(Clone, Debug, PartialEq)]
pub struct StampedPose {
    pub stamp_s: Option<f64>,
    pub position_m: [f64; 3],
    /// x, y, z, w; zeros if unset.
    pub orientation: [f64; 4],
    /// 36 elements, row by row; `None` for messages without.
    pub covariance: Option<Box<[f64; 36]>>,
    /// `None` if the message names no frame.
    pub frames: Option<FrameNames>,
}

/// A transform of a message.
#[derive(Clone, Debug, PartialEq)]
pub struct StampedTransform {
    pub parent: String,
    pub child: String,
    /// Pose of the child in the parent.
    pub pose: StampedPose,
}

/// A reading of a station, or its report of none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coords {
    /// Synchronised time (s); `None` if unset.
    pub stamp_s: Option<f64>,
    /// Time of the station's own clock (s); `None` if unset.
    pub own_clock_s: Option<f64>,
    pub station: u8,
    pub status: u8,
    /// Clockwise seen from above.
    pub azimuth_rad: f64,
    pub zenith_rad: f64,
    pub range_m: f64,
}

/// Estimated offset of a station's clock, positive if it is ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    pub stamp_s: Option<f64>,
    pub station: u8,
    pub offset_s: f64,
}

/// Position of a prism in the frame of the instrument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub stamp_s: Option<f64>,
    pub position_m: [f64; 3],
}

/// Decodes a binary message of a recording or of a live stream.
pub fn decode(kind: Kind, encoding: Encoding, message: &[u8]) -> Result<Message, Malformed> {
    let mut wire = Wire::new(encoding, message)?;
    if kind == Kind::Transforms {
        return Ok(Message::Transforms(transforms(&mut wire)?));
    }
    let (stamp_s, frame) = wire.header()?;
    Ok(match kind {
        Kind::TheodoliteCoords => Message::Coords(Coords {
            stamp_s,
            own_clock_s: wire.time_s()?,
            station: wire.u8()?,
            status: wire.u8()?,
            azimuth_rad: wire.f64()?,
            zenith_rad: wire.f64()?,
            range_m: wire.f64()?,
        }),
        Kind::TimeCorrection => Message::Correction(Correction {
            stamp_s,
            station: wire.u8()?,
            offset_s: wire.duration_s()?,
        }),
        Kind::Point => Message::Point(Point { stamp_s, position_m: position_m(&mut wire)? }),
        Kind::LeicaPoint => {
            wire.string()?;
            Message::Point(Point { stamp_s, position_m: position_m(&mut wire)? })
        }
        Kind::NavSatFix => Message::Fix(nav_sat_fix(&mut wire, stamp_s)?),
        Kind::PoseStamped | Kind::Odometry | Kind::Transforms => {
            let child = if kind == Kind::Odometry { Some(wire.string()?) } else { None };
            let frames = frame_names(frame, child);
            let position_m = position_m(&mut wire)?;
            let orientation = [wire.f64()?, wire.f64()?, wire.f64()?, wire.f64()?];
            let covariance = covariance(&mut wire)?;
            Message::Pose(StampedPose { stamp_s, position_m, orientation, covariance, frames })
        }
    })
}

/// Returns the names of frames; `None` without that of the parent.
fn frame_names(parent: &[u8], child: Option<&[u8]>) -> Option<FrameNames> {
    let name = |bytes: &[u8]| Some(frame(bytes)).filter(|name| !name.is_empty());
    Some(FrameNames { parent: name(parent)?, child: child.and_then(name) })
}

/// Definition of the authors' readings in ROS 2 format, with those of the nested messages.
pub const THEODOLITE_DEFINITION: &str = "std_msgs/Header header\nbuiltin_interfaces/Time theodolite_time\nuint8 theodolite_id\nuint8 status\n\
    float64 azimuth\nfloat64 elevation\nfloat64 distance\n\
    ================================================================================\n\
    MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
    ================================================================================\n\
    MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n";

/// Encodes a reading as little-endian CDR, which [`decode`] reads; times are rounded to nanoseconds.
pub fn encode_coords(coords: &Coords) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    let times = |bytes: &mut Vec<u8>, time_s: Option<f64>| {
        stamp(time_s.unwrap_or(0.0)).iter().for_each(|part| bytes.extend(part.to_le_bytes()));
    };
    times(&mut bytes, coords.stamp_s);
    // An empty frame name with its terminating zero, and padding.
    bytes.extend([1, 0, 0, 0, 0, 0, 0, 0]);
    times(&mut bytes, coords.own_clock_s);
    bytes.extend([coords.station, coords.status, 0, 0, 0, 0, 0, 0]);
    for number in [coords.azimuth_rad, coords.zenith_rad, coords.range_m] {
        bytes.extend(number.to_le_bytes());
    }
    bytes
}

/// Decodes `geometry_msgs/TransformStamped[]`.
fn transforms(wire: &mut Wire<'_>) -> Result<Vec<StampedTransform>, Malformed> {
    let count = wire.u32()?;
    let mut transforms = Vec::new();
    for _ in 0..count {
        let (stamp_s, parent) = wire.header()?;
        let child = wire.string()?;
        let position_m = position_m(wire)?;
        let orientation = [wire.f64()?, wire.f64()?, wire.f64()?, wire.f64()?];
        // The transform itself has the names.
        let pose = StampedPose { stamp_s, position_m, orientation, covariance: None, frames: None };
        transforms.push(StampedTransform { parent: frame(parent), child: frame(child), pose });
    }
    Ok(transforms)
}

fn nav_sat_fix(wire: &mut Wire<'_>, stamp_s: Option<f64>) -> Result<NavSatFix, Malformed> {
    let status = Some(wire.u8()?.cast_signed());
    // The satellite systems that are in use.
    wire.u16()?;
    let degrees = [wire.f64()?, wire.f64()?];
    let altitude_m = wire.f64()?;
    let mut covariance_m2 = [0.0; 9];
    for element_m2 in &mut covariance_m2 {
        *element_m2 = wire.f64()?;
    }
    let covariance_type = wire.u8()?;
    Ok(NavSatFix { stamp_s, status, degrees, altitude_m, covariance_m2, covariance_type })
}

/// Reads the covariance behind a pose; `None` in messages that end there.
fn covariance(wire: &mut Wire<'_>) -> Result<Option<Box<[f64; 36]>>, Malformed> {
    if wire.rest().len() < size_of::<[f64; 36]>() {
        return Ok(None);
    }
    let mut elements = [0.0; 36];
    for element in &mut elements {
        *element = wire.f64()?;
    }
    Ok(Some(Box::new(elements)))
}

/// Returns the name of a frame without the slash of old ROS versions.
fn frame(name: &[u8]) -> String {
    let name = String::from_utf8_lossy(name);
    name.trim_end_matches('\0').trim_start_matches('/').to_owned()
}

fn position_m(wire: &mut Wire<'_>) -> Result<[f64; 3], Malformed> {
    Ok([wire.f64()?, wire.f64()?, wire.f64()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes fields in any of the three encodings; the inverse of [`Wire`], for tests only.
    struct Writer(Vec<u8>, Encoding, bool);

    impl Writer {
        fn new(encoding: Encoding, big_endian: bool) -> Self {
            let head = match encoding {
                Encoding::Ros1 | Encoding::Json => vec![],
                Encoding::Cdr => vec![0, u8::from(!big_endian), 0, 0],
            };
            Self(head, encoding, big_endian)
        }

        fn number<const N: usize>(mut self, mut little_endian: [u8; N]) -> Self {
            while self.1 == Encoding::Cdr && !(self.0.len() - 4).is_multiple_of(N) {
                self.0.push(0xee);
            }
            if self.2 {
                little_endian.reverse();
            }
            self.0.extend(little_endian);
            self
        }

        fn string(self, text: &str) -> Self {
            let zero = usize::from(self.1 == Encoding::Cdr);
            let mut this = self.number(((text.len() + zero) as u32).to_le_bytes());
            this.0.extend(text.as_bytes());
            this.0.extend(vec![0; zero]);
            this
        }

        fn header(self, sec: u32, nanosec: u32) -> Self {
            let this = if self.1 == Encoding::Ros1 { self.number([7, 0, 0, 0]) } else { self };
            this.number(sec.to_le_bytes()).number(nanosec.to_le_bytes()).string("map")
        }

        fn floats(self, values: &[f64]) -> Self {
            values.iter().fold(self, |this, value| this.number(value.to_le_bytes()))
        }
    }

    const WAYS: [(Encoding, bool); 3] =
        [(Encoding::Ros1, false), (Encoding::Cdr, false), (Encoding::Cdr, true)];

    #[test]
    fn every_message_reads_in_both_encodings_and_both_byte_orders() {
        for (encoding, big_endian) in WAYS {
            let writer = || Writer::new(encoding, big_endian);
            let coords = writer()
                .header(1_657_569_001, 500_000_000)
                .number(9_u32.to_le_bytes())
                .number(250_000_000_u32.to_le_bytes())
                .number([2])
                .number([3])
                .floats(&[0.1, 1.5, 30.25]);
            let Ok(Message::Coords(read)) = decode(Kind::TheodoliteCoords, encoding, &coords.0)
            else {
                panic!("{encoding:?}, big-endian {big_endian}")
            };
            assert_eq!((read.stamp_s, read.own_clock_s), (Some(1_657_569_001.5), Some(9.25)));
            assert_eq!((read.station, read.status), (2, 3));
            assert_eq!([read.azimuth_rad, read.zenith_rad, read.range_m], [0.1, 1.5, 30.25]);

            let correction = writer()
                .header(5, 0)
                .number([3])
                .number((-1_i32).to_le_bytes())
                .number(750_000_000_u32.to_le_bytes());
            assert_eq!(
                decode(Kind::TimeCorrection, encoding, &correction.0),
                Ok(Message::Correction(Correction {
                    stamp_s: Some(5.0),
                    station: 3,
                    offset_s: -0.25
                }))
            );

            let point = Point { stamp_s: None, position_m: [1.0, -2.0, 3.5] };
            let stamped = writer().header(0, 0).floats(&point.position_m);
            assert_eq!(decode(Kind::Point, encoding, &stamped.0), Ok(Message::Point(point)));
            let leica = writer().header(0, 0).string("p12").floats(&point.position_m);
            let leica = leica.string("11.07.2022").string("19:50:01");
            assert_eq!(decode(Kind::LeicaPoint, encoding, &leica.0), Ok(Message::Point(point)));

            let covariance_m2 = [1e-4, 0.0, 0.0, 0.0, 2e-4, 0.0, 0.0, 0.0, 4e-4];
            let fix = writer().header(5, 0).number([0xff]).number([3, 0]);
            let fix = fix.floats(&[46.78, -71.275, 95.25]).floats(&covariance_m2).number([2]);
            assert_eq!(
                decode(Kind::NavSatFix, encoding, &fix.0),
                Ok(Message::Fix(NavSatFix {
                    stamp_s: Some(5.0),
                    status: Some(-1),
                    degrees: [46.78, -71.275],
                    altitude_m: 95.25,
                    covariance_m2,
                    covariance_type: 2,
                }))
            );
        }
    }

    #[test]
    fn a_reading_that_is_written_reads_as_it_was() {
        for own_clock_s in [None, Some(1_657_569_000.25)] {
            let coords = Coords {
                stamp_s: Some(1_657_569_001.123_456_7),
                own_clock_s,
                station: 3,
                status: 0,
                azimuth_rad: 0.1,
                zenith_rad: 1.5,
                range_m: 30.25,
            };
            let bytes = encode_coords(&coords);
            let read = decode(Kind::TheodoliteCoords, Encoding::Cdr, &bytes);
            assert_eq!(read, Ok(Message::Coords(coords)));
        }
    }

    #[test]
    fn a_short_message_is_refused_at_every_length() {
        for (encoding, big_endian) in WAYS {
            let whole =
                Writer::new(encoding, big_endian).header(1, 2).header(0, 0).floats(&[1.0; 4]);
            for kind in [Kind::TheodoliteCoords, Kind::Point] {
                let needed = (0..=whole.0.len())
                    .find(|length| decode(kind, encoding, &whole.0[..*length]).is_ok())
                    .expect("the whole is enough");
                for length in needed..=whole.0.len() {
                    assert!(decode(kind, encoding, &whole.0[..length]).is_ok());
                }
                assert!(needed > 40, "{needed}");
            }
        }
    }

    #[test]
    fn what_claims_too_much_is_refused() {
        let mut packed = vec![0_u8; 64];
        packed[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
        assert_eq!(decode(Kind::Point, Encoding::Ros1, &packed), Err(Malformed::Short));
        let parameter_list = [0, 3, 0, 0, 1, 2, 3, 4];
        assert_eq!(
            decode(Kind::Point, Encoding::Cdr, &parameter_list),
            Err(Malformed::Encapsulation(3))
        );
    }

    #[test]
    fn names_of_frames_end_before_the_terminating_zero_of_cdr() {
        let named = frame_names(b"/map\0", Some(b"\0"));
        assert_eq!(named, Some(FrameNames { parent: "map".to_owned(), child: None }));
        assert_eq!(frame_names(b"\0", Some(b"base_link\0")), None);
    }

    #[test]
    fn types_are_known_by_either_name() {
        for (name, kind) in [
            ("theodolite_node_msgs/TheodoliteCoordsStamped", Some(Kind::TheodoliteCoords)),
            ("theodolite_node_msgs/msg/TheodoliteCoordsStamped", Some(Kind::TheodoliteCoords)),
            ("geometry_msgs/msg/PointStamped", Some(Kind::Point)),
            ("leica_streaming_app/LeicaPoint", Some(Kind::LeicaPoint)),
            ("sensor_msgs/Imu", None),
        ] {
            assert_eq!(Kind::of_type(name), kind, "{name}");
        }
    }
}
