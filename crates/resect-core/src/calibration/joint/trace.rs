//! Trace of the Gauss–Newton iteration: a row a step, with the status at the end.

use std::mem::take;

use super::random_walks::GaussMarkov;
use super::residuals::NoiseLevels;
use super::solver_status::SolverStatus;
use crate::network::Station;

/// Trace of the Gauss–Newton iteration of a joint estimate, with all attempts in their order.
///
/// It has what the iteration computes for itself. Values that the iteration does not need are `None`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    pub status: SolverStatus,
    pub rows: Vec<TraceRow>,
    /// Events after the last row.
    pub last_events: Vec<TraceEvent>,
}

/// One step of the iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct TraceRow {
    pub phase: SolverPhase,
    /// Cost before the step (σ²). Costs are comparable only between steps of one phase without events.
    pub cost: Option<f64>,
    /// Squared length of the whole step in units of the data's information (σ²).
    pub squared_length: Option<f64>,
    /// Largest step of a constant before the searches (σ).
    pub largest_step_sigmas: Option<f64>,
    /// Share of the step that was taken.
    pub share: f64,
    /// True if the normal matrix is that of an earlier step.
    pub is_matrix_reused: bool,
    /// Share of the readings with a robust weight below a half.
    pub downweighted: Option<f64>,
    /// Noise levels with which the readings were weighted.
    pub levels: NoiseLevels,
    /// Events since the step before.
    pub events: Vec<TraceEvent>,
}

/// Phase of the iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolverPhase {
    /// Steps on a sample of the drive, from which noise levels are estimated.
    Sample,
    /// Steps of the motion alone.
    Motion,
    /// Steps with robust weights that follow the residuals.
    Reweighted,
    /// Steps with fixed robust weights.
    FixedWeights,
}

impl SolverPhase {
    /// Returns the name for people and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sample => "sample",
            Self::Motion => "motion",
            Self::Reweighted => "reweighted",
            Self::FixedWeights => "fixed weights",
        }
    }
}

/// Event between two steps.
#[derive(Clone, Debug, PartialEq)]
pub enum TraceEvent {
    /// An attempt starts with blocks of this length (s; infinite for whole segments).
    BlockLength(f64),
    /// An attempt starts that uses the survey from the first step on.
    SurveyFirst,
    /// An attempt failed.
    Failed(SolverStatus),
    /// The normal matrix was solved with tighter priors of slow changes.
    StifferPriors,
    /// The prior of the clock offset of this station is widened.
    ClockPriorWidened(Station),
    /// The survey is added to the drive.
    SurveyAdded,
    /// The set-ups of these stations changed since the survey.
    SetUpChanged(Vec<Station>),
    /// Slow changes are searched for.
    Search(SlowChanges),
    /// The robust weights are fixed.
    WeightsFixed,
}

/// Slow changes that a search chose and detected.
#[derive(Clone, Debug, PartialEq)]
pub struct SlowChanges {
    /// Errors of the ranges, of the sights across, and upward.
    pub processes: [GaussMarkov; 3],
    /// Standard deviation of the clocks' random walks over a drive (s).
    pub clocks_s: f64,
    /// Number of steps of stations and clocks that are detected by now.
    pub steps: usize,
}

impl Trace {
    /// Adds an event before the next row.
    pub fn add_event(&mut self, event: TraceEvent) {
        self.last_events.push(event);
    }

    /// Adds a row with the events since the last one.
    pub fn add_row(&mut self, mut row: TraceRow) {
        row.events = take(&mut self.last_events);
        self.rows.push(row);
    }

    /// Adds the row of a step, whose normal matrix may have been solved with tighter priors.
    pub fn add_step(&mut self, row: TraceRow, is_stiffer: bool) {
        if is_stiffer {
            self.add_event(TraceEvent::StifferPriors);
        }
        self.add_row(row);
    }

    /// Returns the events of all rows, and those after the last one.
    pub fn events(&self) -> impl Iterator<Item = &TraceEvent> {
        self.rows.iter().flat_map(|row| &row.events).chain(&self.last_events)
    }
}

impl TraceRow {
    /// Returns a whole step of the motion alone.
    pub fn of_motion(levels: NoiseLevels) -> Self {
        Self {
            phase: SolverPhase::Motion,
            cost: None,
            squared_length: None,
            largest_step_sigmas: None,
            share: 1.0,
            is_matrix_reused: false,
            downweighted: None,
            levels,
            events: Vec::new(),
        }
    }
}

impl TraceEvent {
    /// Returns the event in words: "blocks of 6 s".
    pub fn in_words(&self) -> String {
        match self {
            Self::BlockLength(length_s) if length_s.is_finite() => {
                format!("blocks of {length_s:.0} s")
            }
            Self::BlockLength(_) => "blocks of a whole segment".to_owned(),
            Self::SurveyFirst => "again, with the survey from the first step".to_owned(),
            Self::Failed(status) => format!("the attempt failed: it {}", status.in_words()),
            Self::StifferPriors => "solved with tighter priors".to_owned(),
            Self::ClockPriorWidened(station) => {
                format!("clock prior of station {station} widened")
            }
            Self::SurveyAdded => "survey added".to_owned(),
            Self::SetUpChanged(stations) => {
                let stations: Vec<String> = stations.iter().map(Station::to_string).collect();
                format!("set-up of station {} changed", stations.join(" or "))
            }
            Self::Search(SlowChanges { processes, clocks_s, steps }) => {
                let [ranges, across, upward] = processes.map(|process| 1e3 * process.sigma_m);
                format!(
                    "search: slow errors {ranges:.1}, {across:.1} and {upward:.1} mm, clocks {:.1} ms, {steps} steps",
                    1e3 * clocks_s
                )
            }
            Self::WeightsFixed => "weights fixed".to_owned(),
        }
    }
}
