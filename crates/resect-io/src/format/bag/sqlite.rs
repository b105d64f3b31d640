//! ROS 2 bags in SQLite (rosbag2_storage_sqlite3): tables `topics` and `messages`, in one file or one of several.
//!
//! A file is opened without locking or writing. A write-ahead log or a journal beside the file is left by a killed recorder; both are
//! then copied to a temporary folder and merged there. From a file that is cut off or malformed, all reachable rows are read: from
//! the first on and, behind the first damage, those reachable backwards from the last.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use rusqlite::limits::Limit;
use rusqlite::{Connection, OpenFlags, Row};

use super::intake::{Intake, LARGEST_MESSAGE_BYTES, Subscription};
use super::wire::Encoding;
use crate::error::OpenError;

pub const MAGIC: &[u8] = b"SQLite format 3\0";
/// Endings of the files that a killed recorder leaves beside the database.
const LEFT_BESIDE: [&str; 2] = ["-wal", "-journal"];
/// Rows between two reports of progress.
const ROWS_BETWEEN_REPORTS: u64 = 1000;
const RECOVER: &str = "repair it with `sqlite3 OLD .recover | sqlite3 NEW`, or copy it again from the recording \
                       computer";

/// Returns true if these first bytes of a database can be a bag's: the first page contains the names of the tables, if they fit.
pub fn may_be_a_bag(head: &[u8]) -> bool {
    // Type of the first page: 13 is a leaf, with the schema itself in its cells.
    let schema_is_here = head.get(100) == Some(&13) && head.len() >= page_bytes(head) as usize;
    !schema_is_here || head.windows(8).any(|window| window == b"messages")
}

/// Returns true for the first bytes of a write-ahead log or of a journal (sqlite.org/fileformat2.html, 4.1 and 3).
pub fn is_log(head: &[u8]) -> bool {
    [&b"\x37\x7f\x06\x82"[..], b"\x37\x7f\x06\x83", b"\xd9\xd5\x05\xf9\x20\xa1\x63\xd7"]
        .iter()
        .any(|magic| head.starts_with(magic))
}

/// Returns the page size from a database's first bytes (sqlite.org/fileformat2.html, 1.3); 0 if it is missing.
fn page_bytes(head: &[u8]) -> u64 {
    match head.get(16..18) {
        Some([0, 1]) => 65_536,
        Some([a, b]) => u64::from(u16::from_be_bytes([*a, *b])),
        _ => 0,
    }
}

/// Reads all messages in the order of their recording.
pub fn read(path: &Path, intake: &mut Intake<'_>) -> Result<(), OpenError> {
    let file = intake.file().to_owned();
    let refused = |error: &rusqlite::Error| {
        OpenError::file(&file, format!("not a readable ROS 2 bag ({})", one_line(error)), RECOVER)
    };
    // The folder is removed when dropped, so it is kept to the end.
    let (own_copy, folder) = copy_with_log(path, intake)?;
    let connection = open(&own_copy, folder.is_some()).map_err(|error| refused(&error))?;
    let missing = missing_bytes(path);
    if folder.is_none() && missing > 0 {
        intake.lost(missing, format!("cut off: {missing} bytes are missing at its end"));
    }
    let is_table = "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name IN ('topics', 'messages')";
    let tables: i64 =
        connection.query_row(is_table, [], |row| row.get(0)).map_err(|error| refused(&error))?;
    if tables != 2 {
        return Err(OpenError::file(
            &file,
            "an SQLite database without the tables `topics` and `messages` of a ROS 2 bag",
            "open the .db3 file that `ros2 bag record` wrote",
        ));
    }
    let subscriptions = subscriptions(&connection, intake).map_err(|error| refused(&error))?;
    let mut rows =
        Rows { connection: &connection, subscriptions, last_id: rows_up_to(&connection) };
    rows.read(intake)
}

/// Returns the file to read and, if it had to be copied, its temporary folder.
fn copy_with_log(
    path: &Path,
    intake: &mut Intake<'_>,
) -> Result<(PathBuf, Option<tempfile::TempDir>), OpenError> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let beside: Vec<_> = LEFT_BESIDE
        .iter()
        .map(|ending| (ending, path.with_file_name(format!("{name}{ending}"))))
        .filter(|(_, log)| log.metadata().is_ok_and(|log| log.len() > 0))
        .collect();
    if beside.is_empty() {
        return Ok((path.to_owned(), None));
    }
    let io = |error| OpenError::Io { path: path.to_owned(), error };
    let folder = tempfile::Builder::new().prefix("resect-bag-").tempdir().map_err(io)?;
    let own_copy = folder.path().join("bag.db3");
    std::fs::copy(path, &own_copy).map_err(io)?;
    for (ending, log) in beside {
        std::fs::copy(log, folder.path().join(format!("bag.db3{ending}"))).map_err(io)?;
        intake
            .note(&format!("read with {name}{ending} beside it, left by an interrupted recording"));
    }
    Ok((own_copy, Some(folder)))
}

fn open(path: &Path, is_own_copy: bool) -> rusqlite::Result<Connection> {
    let connection = if is_own_copy {
        Connection::open_with_flags(path, OpenFlags::SQLITE_OPEN_READ_WRITE)?
    } else {
        let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_URI;
        Connection::open_with_flags(uri(path), flags)?
    };
    // No value is larger than its file, but an expression in a hostile schema may be.
    let bytes = path.metadata().map_or(0, |metadata| metadata.len());
    let largest = i32::try_from(bytes.max(1 << 20)).unwrap_or(i32::MAX);
    connection.set_limit(Limit::SQLITE_LIMIT_LENGTH, largest)?;
    connection.pragma_update(None, "trusted_schema", false)?;
    // Without this, a file shorter than its header states is refused as a whole.
    connection.pragma_update(None, "writable_schema", true)?;
    connection.pragma_update(None, "cell_size_check", true)?;
    Ok(connection)
}

/// `immutable` keeps SQLite from writing files beside the database.
fn uri(path: &Path) -> String {
    let path = path.to_string_lossy();
    let path = if cfg!(windows) { with_slashes(&path) } else { path.into_owned() };
    let mut uri = "file:".to_owned();
    for byte in path.bytes() {
        match byte {
            b'/' | b'.' | b'-' | b'_' | b':' => uri.push(char::from(byte)),
            _ if byte.is_ascii_alphanumeric() => uri.push(char::from(byte)),
            _ => uri.push_str(&format!("%{byte:02x}")),
        }
    }
    uri + "?immutable=1"
}

/// Returns a Windows path as SQLite's URIs have it: slashes, and one before a drive's letter (sqlite.org/uri.html). A path with the prefix
/// `\\?\` stays: Windows opens a longer path only with it, and reads no slashes in it.
fn with_slashes(path: &str) -> String {
    if path.starts_with(r"\\?\") {
        return path.to_owned();
    }
    let plain = path.replace('\\', "/");
    match plain.as_bytes() {
        [_, b':', ..] => format!("/{plain}"),
        [b'/', b'/', ..] => format!("//{plain}"),
        _ => plain,
    }
}

/// Returns the number of bytes missing from the size in the file's header (sqlite.org/fileformat2.html, 1.3); 0 if complete.
fn missing_bytes(path: &Path) -> u64 {
    let mut head = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| {
        std::io::Read::read_to_end(&mut std::io::Read::take(file, 100), &mut head)
    });
    if read.is_err() || head.len() < 100 {
        return 0;
    }
    let pages = u64::from(u32::from_be_bytes([head[28], head[29], head[30], head[31]]));
    // The page count is valid only if both change counters agree.
    if head[24..28] != head[92..96] {
        return 0;
    }
    let length = path.metadata().map_or(0, |metadata| metadata.len());
    (page_bytes(&head) * pages).saturating_sub(length)
}

fn subscriptions(
    connection: &Connection,
    intake: &mut Intake<'_>,
) -> rusqlite::Result<HashMap<i64, Subscription>> {
    let mut statement = connection.prepare(
        "SELECT id, name, type, serialization_format FROM topics WHERE length(name) + length(type) < 10000 LIMIT 10000",
    )?;
    let mut rows = statement.query([])?;
    let mut found = HashMap::new();
    while let Some(row) = rows.next()? {
        let (id, name, message_type, format): (i64, String, String, String) =
            (row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?);
        if format == "cdr"
            && let Some(subscription) = intake.topic(&name, &message_type, Encoding::Cdr)
        {
            found.insert(id, subscription);
        }
    }
    Ok(found)
}

/// Returns the largest row id, for progress; 0 if it cannot be read.
fn rows_up_to(connection: &Connection) -> i64 {
    connection.query_row("SELECT max(id) FROM messages", [], |row| row.get(0)).unwrap_or(0)
}

struct Rows<'c> {
    connection: &'c Connection,
    subscriptions: HashMap<i64, Subscription>,
    last_id: i64,
}

/// End of reading rows.
enum Walk {
    End,
    Damaged(String),
}

impl Rows<'_> {
    fn read(&mut self, intake: &mut Intake<'_>) -> Result<(), OpenError> {
        let mut reached = None;
        let Walk::Damaged(why) = self.from(i64::MIN, &mut reached, intake)? else { return Ok(()) };
        let after =
            reached.map_or_else(|| "at its first row".to_owned(), |id| format!("after row {id}"));
        // Rows behind the damage that can be reached from the end.
        let behind = self.first_from_the_end(reached).filter(|first| Some(*first) > reached);
        let rest = match behind {
            Some(first) => {
                let lost = first.saturating_sub(reached.unwrap_or(0)).saturating_sub(1);
                format!("{lost} rows up to row {first} are lost")
            }
            None => "the rows after it are lost".to_owned(),
        };
        intake.lost(0, format!("damaged {after} ({why}); {rest}"));
        if let Some(first) = behind {
            let mut again = Some(first - 1);
            if let Walk::Damaged(why) = self.from(first, &mut again, intake)? {
                intake.lost(0, format!("damaged after row {} ({why})", again.unwrap_or(first)));
            }
        }
        Ok(())
    }

    fn wanted(&self) -> String {
        let ids: Vec<_> = self.subscriptions.keys().map(ToString::to_string).collect();
        ids.join(", ")
    }

    /// Reads rows from an id on, in order; `reached` becomes the last id read.
    fn from(
        &self,
        first: i64,
        reached: &mut Option<i64>,
        intake: &mut Intake<'_>,
    ) -> Result<Walk, OpenError> {
        // rosbag2 declares `id` as an alias of the row id; a table without this alias has no `id`.
        let sql = format!(
            "SELECT id, topic_id, timestamp, CASE WHEN length(data) <= {LARGEST_MESSAGE_BYTES} THEN data END, length(data) \
             FROM messages NOT INDEXED WHERE id >= ?1 AND topic_id IN ({}) ORDER BY id",
            self.wanted()
        );
        let damaged = |error: &rusqlite::Error| Ok(Walk::Damaged(one_line(error)));
        let mut statement = match self.connection.prepare(&sql) {
            Ok(statement) => statement,
            Err(error) => return damaged(&error),
        };
        let mut rows = match statement.query([first]) {
            Ok(rows) => rows,
            Err(error) => return damaged(&error),
        };
        for number in 0_u64.. {
            let row = match rows.next() {
                Ok(Some(row)) => row,
                Ok(None) => break,
                Err(error) => return damaged(&error),
            };
            let id: i64 = match row.get(0) {
                Ok(id) => id,
                Err(error) => return damaged(&error),
            };
            // Pages that refer to each other in a cycle would never end.
            if reached.is_some_and(|reached| id <= reached) {
                return Ok(Walk::Damaged(format!("row {id} a second time")));
            }
            *reached = Some(id);
            self.take_in(row, intake)?;
            if number % ROWS_BETWEEN_REPORTS == 0 && self.last_id > 0 {
                intake.done(id as f64 / self.last_id as f64)?;
            }
        }
        Ok(Walk::End)
    }

    fn take_in(&self, row: &Row<'_>, intake: &mut Intake<'_>) -> Result<(), OpenError> {
        let Some(subscription) = row.get(1).ok().and_then(|id: i64| self.subscriptions.get(&id))
        else {
            return Ok(());
        };
        let recorded_s = row.get(2).map_or(f64::NAN, |stamp: i64| stamp as f64 * 1e-9);
        match row.get_ref(3).ok().and_then(|data| data.as_blob().ok()) {
            Some(data) => intake.message(*subscription, recorded_s, data),
            None => {
                let bytes: i64 = row.get(4).unwrap_or(0);
                intake.overlong_message(*subscription, bytes.unsigned_abs());
                Ok(())
            }
        }
    }

    /// Returns the smallest row id behind `reached` that can be reached backwards from the last.
    fn first_from_the_end(&self, reached: Option<i64>) -> Option<i64> {
        let sql = "SELECT id FROM messages NOT INDEXED WHERE id > ?1 ORDER BY id DESC";
        let mut statement = self.connection.prepare(sql).ok()?;
        let mut rows = statement.query([reached.unwrap_or(i64::MIN)]).ok()?;
        let mut first: Option<i64> = None;
        while let Ok(Some(row)) = rows.next() {
            let id: i64 = row.get(0).ok()?;
            if first.is_some_and(|first| id >= first) {
                break;
            }
            first = Some(id);
        }
        first
    }
}

fn one_line(error: &rusqlite::Error) -> String {
    error.to_string().replace('\n', " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_paths_become_paths_of_uris() {
        for (path, expected) in [
            (r"C:\drives\a.db3", "/C:/drives/a.db3"),
            (r"\\?\C:\drives\a.db3", r"\\?\C:\drives\a.db3"),
            (r"\\server\share\a.db3", "////server/share/a.db3"),
            (r"drives\a.db3", "drives/a.db3"),
        ] {
            assert_eq!(with_slashes(path), expected);
        }
    }
}
