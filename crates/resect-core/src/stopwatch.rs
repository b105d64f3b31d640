//! Wall time of a calculation.

/// Time since a start, on targets that have a clock.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch {
    // `Instant::now` panics on this target.
    #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
    started: std::time::Instant,
}

impl Stopwatch {
    pub fn start() -> Self {
        Self {
            #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
            started: std::time::Instant::now(),
        }
    }

    /// Wall time since the start (ms); not a number on `wasm32-unknown-unknown`, which has no clock.
    pub fn elapsed_ms(&self) -> f64 {
        #[cfg(not(all(target_family = "wasm", target_os = "unknown")))]
        return self.started.elapsed().as_secs_f64() * 1e3;
        #[cfg(all(target_family = "wasm", target_os = "unknown"))]
        f64::NAN
    }
}
