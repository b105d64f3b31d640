//! Cost of reading a large table of tracks: megabytes a second on one core, and peak
//! memory; compared with the `csv` crate, which reads the same file into the same records.
//!
//! `cargo bench --bench reading -- 1000` uses 1000 MB (default 200). The file is in `target/bench-tables/` and is kept. Each reader runs in
//! a process of its own, so that its memory is measured alone.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use resect_core::deployment::Measurement;
use resect_core::progress::Progress;
use resect_io::format::polar_csv;
use resect_io::recording::Recording;
use resect_tools::simulation::{Preset, simulate};

/// A function that reads a file, and returns its number of readings.
type Reader = fn(&Path) -> usize;

const READERS: [(&str, Reader); 2] = [("resect", ours), ("csv-crate", peer)];

fn main() {
    // `cargo bench` adds flags of its own.
    let arguments: Vec<String> =
        std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    if let [reader, path] = &arguments[..] {
        let (_, read) = READERS.iter().find(|(name, _)| name == reader).expect("a reader's name");
        measure(reader, Path::new(path), *read);
        return;
    }
    let megabytes: u64 = arguments.first().map_or(200, |text| text.parse().expect("a size in MB"));
    let path = table(megabytes);
    let program = std::env::current_exe().expect("it runs");
    for (name, _) in READERS {
        let ended = Command::new(&program).arg(name).arg(&path).status().expect("it starts");
        assert!(ended.success());
    }
}

/// Writes a drive of the Warthog repeatedly, one after the other.
fn table(megabytes: u64) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/bench-tables");
    std::fs::create_dir_all(&folder).expect("target can be written");
    let path = folder.join(format!("{megabytes}.csv"));
    if path.exists() {
        return path;
    }
    let mut records = simulate(Preset::Warthog, 1).records;
    let time_s = |at: usize| records[at].measurement.time_s;
    let length_s = time_s(records.len() - 1) - time_s(0) + 1.0;
    let mut file = std::io::BufWriter::new(std::fs::File::create(&path).expect("writable"));
    let mut written = 0;
    while written < megabytes * 1_000_000 {
        let text = polar_csv::write(&records);
        // One header is enough.
        let from = if written == 0 { 0 } else { text.find('\n').map_or(0, |end| end + 1) };
        file.write_all(&text.as_bytes()[from..]).expect("there is room");
        written += text.len() as u64;
        records.iter_mut().for_each(|record| record.measurement.time_s += length_s);
    }
    file.flush().expect("there is room");
    path
}

fn measure(name: &str, path: &Path, read: fn(&Path) -> usize) {
    let megabytes = std::fs::metadata(path).expect("written").len() as f64 / 1e6;
    let start = Instant::now();
    let readings = read(path);
    let took_s = start.elapsed().as_secs_f64();
    let rate = megabytes / took_s;
    let (cores_s, peak) = (processor_s().unwrap_or(f64::NAN), peak_megabytes().unwrap_or(f64::NAN));
    eprintln!(
        "{name}: {megabytes:.0} MB, {readings} readings: {rate:.0} MB/s by the clock, {:.0} MB/s of one core's time, at most \
         {peak:.0} MB of memory",
        megabytes / cores_s
    );
}

fn ours(path: &Path) -> usize {
    let mut recording = Recording::new(None, false);
    let file = std::fs::File::open(path).expect("readable");
    polar_csv::read("bench.csv", file, &Progress::default(), &mut recording).expect("plain");
    let (tracks, _) = recording.finish("bench.csv").expect("readings");
    tracks.iter().map(|track| track.measurements.len()).sum()
}

/// Reads as its documentation advises for speed, without checks.
fn peer(path: &Path) -> usize {
    let mut tracks: [Vec<Measurement>; 3] = Default::default();
    let mut reader = csv::Reader::from_path(path).expect("readable");
    let mut record = csv::StringRecord::new();
    while reader.read_record(&mut record).expect("plain") {
        let value = |column: usize| record[column].parse::<f64>().expect("a number");
        let measurement = Measurement {
            time_s: value(0),
            range_m: value(2),
            azimuth_rad: value(3),
            zenith_rad: value(4),
        };
        tracks[value(1) as usize - 1].push(measurement);
    }
    tracks.iter().map(Vec::len).sum()
}

/// Returns the peak memory of this process; `None` except on Linux.
fn peak_megabytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok()? / 1e3)
}

/// Returns the processor time of this process, with a resolution of a hundredth of a second; `None` except on Linux.
fn processor_s() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = stat.rsplit_once(") ")?.1.split(' ').collect();
    Some((fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?) / 100.0)
}
