//! Every command that writes, killed at any moment: each file is the old one or the new one, and the next run removes half-written files.
//!
//! `cargo nextest run --test stress kills --run-ignored only --no-capture` kills each a hundred times.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use resect_io::simulation_files::write_folder;
use resect_tools::simulation::{Preset, simulate_scenario};

/// Long enough for files of some size, short enough for hundreds of runs.
const DRIVE_S: f64 = 60.0;

/// Commands; `IN` is the deployment and `OUT` the output folder.
const COMMANDS: [(&str, &str); 7] = [
    ("tables", "export IN --csv OUT --method inter-prism"),
    ("recording", "export IN --rrd OUT/drive.rrd --method inter-prism"),
    ("trajectory", "trajectory IN --out OUT/drive.tum --method inter-prism"),
    ("report", "report IN --out OUT/report.html --method inter-prism"),
    ("picture", "screenshot IN --out OUT/window.png --size 300x200 --method inter-prism"),
    ("simulation", "simulate --preset warthog --duration 60 --out OUT"),
    ("study", "ablate IN --out OUT"),
];

type Files = BTreeMap<String, Vec<u8>>;

/// One command with its own folder.
struct Killed {
    arguments: Vec<String>,
    out: PathBuf,
    /// Files of an undisturbed run.
    new: Files,
    old: Files,
    /// Times after which it begins to write, and after which it ends.
    begins: Duration,
    ends: Duration,
}

impl Killed {
    fn prepare(command: &str, data: &Path, out: &Path) -> Self {
        std::fs::create_dir(out).expect("made");
        let place = |word: &str| {
            word.replace("IN", &data.display().to_string())
                .replace("OUT", &out.display().to_string())
        };
        let arguments = command.split(' ').map(place).collect();
        let none = Files::new();
        let mut killed = Self {
            arguments,
            out: out.to_owned(),
            new: none.clone(),
            old: none,
            begins: Duration::ZERO,
            ends: Duration::ZERO,
        };
        let started = Instant::now();
        let mut child = killed.start();
        killed.wait_until_it_writes(&mut child);
        killed.begins = started.elapsed();
        assert!(child.wait().expect("a child").success(), "{command}");
        killed.ends = started.elapsed();
        killed.new = killed.files();
        let old = |(name, new): (&String, &Vec<u8>)| {
            (name.clone(), format!("the old {name}\n").repeat(new.len() / 10).into_bytes())
        };
        killed.old = killed.new.iter().map(old).collect();
        killed
    }

    fn start(&self) -> Child {
        Command::new(env!("CARGO_BIN_EXE_resect"))
            .args(&self.arguments)
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            // The report contains the date.
            .env("SOURCE_DATE_EPOCH", "1760000000")
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("resect starts")
    }

    fn files(&self) -> Files {
        let entries = std::fs::read_dir(&self.out).expect("a folder");
        let paths = entries.map(|entry| entry.expect("an entry").path());
        let name = |path: &Path| path.file_name().expect("named").to_string_lossy().into_owned();
        paths.map(|path| (name(&path), std::fs::read(&path).expect("readable"))).collect()
    }

    /// Returns names, sizes and times of the files; skips those that disappear meanwhile.
    fn look(&self) -> Vec<(PathBuf, u64, Option<std::time::SystemTime>)> {
        let entries = std::fs::read_dir(&self.out).expect("a folder").flatten();
        let seen = entries.filter_map(|entry| {
            let metadata = entry.metadata().ok()?;
            Some((entry.path(), metadata.len(), metadata.modified().ok()))
        });
        seen.collect()
    }

    fn wait_until_it_writes(&self, child: &mut Child) {
        let before = self.look();
        while self.look() == before && child.try_wait().expect("a child").is_none() {
            std::thread::sleep(Duration::from_micros(100));
        }
    }

    /// Kills a run; returns true if a half-written file remained.
    fn kill(&self, number: usize, random: &mut ChaCha8Rng) -> bool {
        for (name, old) in &self.old {
            std::fs::write(self.out.join(name), old).expect("written");
        }
        let mut child = self.start();
        // Every second kill is during the writing, a small share of the run; half of these
        // without a delay, because a small file is written before a sleeping thread wakes up.
        let span = if number.is_multiple_of(2) {
            self.ends
        } else {
            self.wait_until_it_writes(&mut child);
            if number % 4 == 1 { self.ends - self.begins } else { Duration::ZERO }
        };
        if !span.is_zero() {
            std::thread::sleep(span.mul_f64(random.random_range(0.0..1.0)));
        }
        // SIGKILL: the child executes nothing after it.
        child.kill().expect("killed");
        child.wait().expect("gone");
        let mut files = self.files();
        let parts = files.extract_if(.., |name, _| name.ends_with(".part")).count();
        assert_eq!(Vec::from_iter(files.keys()), Vec::from_iter(self.new.keys()), "kill {number}");
        for (name, found) in &files {
            let is_whole = *found == self.old[name] || *found == self.new[name];
            let arguments = &self.arguments;
            assert!(
                is_whole,
                "kill {number} of {arguments:?}: {name} is torn ({} bytes)",
                found.len()
            );
        }
        parts > 0
    }

    /// Runs the command once more, to its end.
    fn finish(&self) {
        assert!(self.start().wait().expect("a child").success());
        let files = self.files();
        assert_eq!(Vec::from_iter(files.keys()), Vec::from_iter(self.new.keys()), "a part is left");
        for (name, found) in &files {
            assert!(*found == self.new[name], "{name} is another than before");
        }
    }
}

fn kill_each(kills: usize) {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("data");
    let scenario = Preset::Warthog.scenario();
    let scenario = resect_tools::simulation::Scenario { duration_s: DRIVE_S, ..scenario };
    write_folder(&simulate_scenario(&scenario, 1), &data).expect("writable");
    std::thread::scope(|scope| {
        for (seed, (name, command)) in COMMANDS.iter().enumerate() {
            let (data, out) = (&data, folder.path().join(name));
            scope.spawn(move || {
                kill_one(name, &Killed::prepare(command, data, &out), kills, seed as u64);
            });
        }
    });
}

fn kill_one(name: &str, killed: &Killed, kills: usize, seed: u64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let half = (0..kills).filter(|number| killed.kill(*number, &mut random)).count();
    killed.finish();
    eprintln!(
        "{name}: writes from {:.3} to {:.3} s; {kills} kills, {half} of them with something half-written",
        killed.begins.as_secs_f64(),
        killed.ends.as_secs_f64()
    );
    // Otherwise no kill came during the writing.
    assert!(kills < 100 || half > 0, "{name}: no kill came while it wrote");
}

#[test]
fn three_kills_of_each_command_tear_no_file() {
    kill_each(3);
}

#[test]
#[ignore = "takes minutes; run it by name after a change of how files are written"]
fn a_hundred_kills_of_each_command_tear_no_file() {
    kill_each(100);
}
