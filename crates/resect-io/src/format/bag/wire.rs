//! Decoding of the fields of a message in the two encodings of ROS.
//!
//! ROS 1 packs fields little-endian without gaps (wiki.ros.org/msg). ROS 2 uses XCDR version 1 (OMG DDS-XTypes 1.3, 7.4.1): four
//! bytes of encapsulation, the second of which gives the byte order, then every number aligned to its own size, counted from after
//! these four bytes. The length of a string includes its terminating zero. Tested on little-endian recordings; big-endian ones only
//! on messages written for the tests, because ROS 2 on today's machines does not write them.

/// Encoding of a message. JSON has no fields that follow each other; [`json_messages`](super::json_messages) decodes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Ros1,
    Cdr,
    Json,
}

/// Reason why bytes are not the expected message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Malformed {
    #[error("it ends too early")]
    Short,
    #[error("its encapsulation {0:#06x} is not plain CDR")]
    Encapsulation(u16),
    #[error("it is not JSON")]
    NotJson,
    #[error("its JSON has no valid `{0}`")]
    Field(&'static str),
}

/// Decodes one field after the other.
pub struct Wire<'a> {
    /// The message without the encapsulation.
    data: &'a [u8],
    at: usize,
    encoding: Encoding,
    big_endian: bool,
}

impl<'a> Wire<'a> {
    pub fn new(encoding: Encoding, message: &'a [u8]) -> Result<Self, Malformed> {
        let (data, big_endian) = match encoding {
            Encoding::Ros1 | Encoding::Json => (message, false),
            Encoding::Cdr => {
                let (head, data) = message.split_first_chunk::<4>().ok_or(Malformed::Short)?;
                match u16::from_be_bytes([head[0], head[1]]) {
                    0 => (data, true),
                    1 => (data, false),
                    other => return Err(Malformed::Encapsulation(other)),
                }
            }
        };
        Ok(Self { data, at: 0, encoding, big_endian })
    }

    /// Returns the bytes of one number, least significant first.
    fn number<const N: usize>(&mut self) -> Result<[u8; N], Malformed> {
        let start = match self.encoding {
            Encoding::Ros1 | Encoding::Json => self.at,
            Encoding::Cdr => self.at.next_multiple_of(N),
        };
        let rest = self.data.get(start..).ok_or(Malformed::Short)?;
        let mut bytes = *rest.first_chunk::<N>().ok_or(Malformed::Short)?;
        self.at = start + N;
        if self.big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    pub fn u8(&mut self) -> Result<u8, Malformed> {
        Ok(u8::from_le_bytes(self.number()?))
    }

    pub fn u32(&mut self) -> Result<u32, Malformed> {
        Ok(u32::from_le_bytes(self.number()?))
    }

    pub fn u16(&mut self) -> Result<u16, Malformed> {
        Ok(u16::from_le_bytes(self.number()?))
    }

    pub fn u64(&mut self) -> Result<u64, Malformed> {
        Ok(u64::from_le_bytes(self.number()?))
    }

    pub fn i32(&mut self) -> Result<i32, Malformed> {
        Ok(i32::from_le_bytes(self.number()?))
    }

    pub fn f64(&mut self) -> Result<f64, Malformed> {
        Ok(f64::from_le_bytes(self.number()?))
    }

    /// Returns the bytes of a string, in CDR with the terminating zero. A claimed length allocates nothing.
    pub fn string(&mut self) -> Result<&'a [u8], Malformed> {
        let length = self.u32()? as usize;
        let end = self.at.checked_add(length).ok_or(Malformed::Short)?;
        let text = self.data.get(self.at..end).ok_or(Malformed::Short)?;
        self.at = end;
        Ok(text)
    }

    /// Bytes not read yet.
    pub fn rest(&self) -> &'a [u8] {
        self.data.get(self.at..).unwrap_or_default()
    }

    /// Reads a time (s since 1970); `None` if it is zero, which means unset.
    pub fn time_s(&mut self) -> Result<Option<f64>, Malformed> {
        let seconds = match self.encoding {
            Encoding::Ros1 | Encoding::Json => f64::from(self.u32()?),
            Encoding::Cdr => f64::from(self.i32()?),
        };
        let time_s = seconds + f64::from(self.u32()?) * 1e-9;
        Ok((time_s != 0.0).then_some(time_s))
    }

    /// Reads a duration (s), which may be negative.
    pub fn duration_s(&mut self) -> Result<f64, Malformed> {
        Ok(f64::from(self.i32()?) + f64::from(self.i32()?) * 1e-9)
    }

    /// Reads a `std_msgs/Header` and returns its stamp (s), `None` if zero. In ROS 1, a sequence number precedes it.
    pub fn header_s(&mut self) -> Result<Option<f64>, Malformed> {
        Ok(self.header()?.0)
    }

    /// Reads a header; returns its stamp (s), `None` if unset, and its frame.
    pub fn header(&mut self) -> Result<(Option<f64>, &'a [u8]), Malformed> {
        if self.encoding == Encoding::Ros1 {
            self.u32()?;
        }
        Ok((self.time_s()?, self.string()?))
    }
}

/// Splits a time into whole seconds and nanoseconds, as ROS writes it.
pub fn stamp(time_s: f64) -> [u32; 2] {
    // Unix times in nanoseconds have more digits than a double.
    let seconds = time_s.max(0.0).floor();
    match ((time_s - seconds) * 1e9).round() as u32 {
        1_000_000_000 => [seconds as u32 + 1, 0],
        nanoseconds => [seconds as u32, nanoseconds],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stamps_are_rounded_to_nanoseconds_across_whole_seconds() {
        assert_eq!(stamp(1.999_999_999_9), [2, 0]);
        assert_eq!(stamp(1_657_543_210.25), [1_657_543_210, 250_000_000]);
    }
}
