//! Simulation of a preset or a scenario.

use super::instrument::measure;
use super::preset::Preset;
use super::scenario::Scenario;
use super::simulated::Simulated;

/// Simulates a preset.
pub fn simulate(preset: Preset, seed: u64) -> Simulated {
    simulate_scenario(&preset.scenario(), seed)
}

/// Simulates any scenario.
pub fn simulate_scenario(scenario: &Scenario, seed: u64) -> Simulated {
    measure(&scenario.clone().draw_errors(seed), seed)
}
