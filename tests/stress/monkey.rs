//! A monkey test of the window: random events from a seed against the real window and all its panes, in a folder of its own.
//!
//! It asserts four properties. No thread panics. No frame takes the window's thread long. Closed deployments are freed. Everything that was
//! saved, by the user or by the program against a crash, is restored afterwards.
//!
//! ```sh
//! cargo test --release --test stress monkey -- --ignored --nocapture     # an hour, or RESECT_MONKEY_MINUTES
//! RESECT_MONKEY_SEED=17 cargo test --test stress a_monkey_breaks_nothing_in_a_short_while
//! ```
//! Without `--release` the hour includes egui's own checks, and compares no memory. The second command
//! repeats one life; background results may arrive at other frames. RESECT_MONKEY_TRACE=1 prints every
//! act before it is done. Only `Open in Rerun` is excluded (`dice::LEFT_OUT`), because it starts another
//! program. Links are never followed, since the harness ignores the window's requests to the system.

mod act;
mod dice;
mod life;
mod perform;
mod reached;
mod screen;
mod sessions;
mod things;

use std::time::{Duration, Instant};

use life::Life;

use super::process;

/// Number of acts in a life: about half a minute without optimisation.
const ACTS: usize = 700;
const FIRST_SEED: u64 = 1;
/// A life reaches about thirty of the states in [`reached`].
const LEAST_REACHED: usize = 22;
const MINUTES: u64 = 60;
/// Greatest growth of the resident size from the first rounds to the last: when deployments are opened and closed, and in an hour of random
/// events. Some of it is the allocator's and the driver's. Analyses that are never freed are 56 MB.
const MOST_GROWTH_BY_OPENING_MB: f64 = 24.0;
const MOST_GROWTH_MB: f64 = 64.0;

fn number(variable: &str) -> Option<u64> {
    std::env::var(variable).ok()?.parse().ok()
}

fn seed() -> u64 {
    number("RESECT_MONKEY_SEED").unwrap_or(FIRST_SEED)
}

#[test]
fn a_monkey_breaks_nothing_in_a_short_while() {
    process::alone("monkey::a_monkey_breaks_nothing_in_a_short_while", |folder| {
        let mut life = Life::new(&screen::gpu(), folder, seed());
        life.live(ACTS);
        eprintln!("came to {}: {}", life.reached.count(), life.reached);
        assert!(life.reached.count() >= LEAST_REACHED, "it hardly tried: {}", life.reached);
    });
}

#[test]
fn what_is_closed_is_let_go_of() {
    process::alone("monkey::what_is_closed_is_let_go_of", |folder| {
        let rounds = 40;
        let sizes_mb = Life::new(&screen::gpu(), folder, seed()).open_and_close(rounds);
        assert_no_growth(&sizes_mb, MOST_GROWTH_BY_OPENING_MB);
    });
}

#[test]
#[ignore = "an hour; see the head of tests/stress/monkey.rs"]
fn a_monkey_breaks_nothing_for_an_hour() {
    process::alone("monkey::a_monkey_breaks_nothing_for_an_hour", |folder| {
        let minutes = number("RESECT_MONKEY_MINUTES").unwrap_or(MINUTES);
        let until = Instant::now() + Duration::from_secs(60 * minutes);
        let gpu = screen::gpu();
        let mut sizes_mb = Vec::new();
        let mut slowest = Duration::ZERO;
        for seed in seed().. {
            let place = folder.join(seed.to_string());
            std::fs::create_dir(&place).expect("a folder");
            let mut life = Life::new(&gpu, &place, seed);
            life.live(ACTS);
            slowest = slowest.max(life.slowest());
            drop(life);
            std::fs::remove_dir_all(&place).expect("a folder");
            sizes_mb.push(process::resident_mb());
            eprintln!("seed {seed}: {:.0} MB, slowest frame {slowest:.1?}", process::resident_mb());
            if Instant::now() > until {
                break;
            }
        }
        // With its own checks on, egui stores the source of every id: 2 MB a life.
        if !cfg!(debug_assertions) {
            assert_no_growth(&sizes_mb, MOST_GROWTH_MB);
        }
    });
}

/// Compares the second quarter with the last: the first includes all first allocations.
fn assert_no_growth(sizes_mb: &[f64], most_mb: f64) {
    let quarter = sizes_mb.len() / 4;
    if quarter == 0 {
        return;
    }
    let largest = |part: &[f64]| part.iter().copied().fold(0.0, f64::max);
    let before = largest(&sizes_mb[quarter..2 * quarter]);
    let after = largest(&sizes_mb[3 * quarter..]);
    eprintln!("{before:.0} MB after the warm-up, {after:.0} MB at the end");
    assert!(after - before < most_mb, "memory grows: {sizes_mb:.0?} MB");
}
