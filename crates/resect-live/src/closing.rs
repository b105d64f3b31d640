//! Final state of a live deployment. When the source ends, its answers are a few seconds old; the answer to all readings follows.

use super::coach::Coach;
use super::judged::judge;
use super::view::View;
use super::warnings::speaks_against_readings;
use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;

/// The coach of a live deployment that has ended.
#[derive(Debug)]
pub struct Closing {
    coach: Coach,
}

impl Closing {
    pub fn new(coach: Coach) -> Self {
        Self { coach }
    }

    /// Returns the last view, with the answer to all readings (chosen settings) in place of the last live answer.
    pub fn judged(mut self, last: &View, deployment: &Deployment, analysis: &Analysis) -> View {
        let outcome = judge(deployment, analysis, false, None);
        let is_amiss = last.warnings.iter().any(|one| speaks_against_readings(one.finding.kind));
        self.coach.take(&outcome, is_amiss);
        let sentence = self.coach.sentence(Some(&outcome), &last.moves);
        let mut view = View { sentence, enough: self.coach.is_enough(), ..last.clone() };
        if let Ok(judged) = outcome.judged {
            (view.answer, view.answer_age_s) = (Some(judged), Some(0.0));
        }
        view.curves = self.coach.curves;
        view
    }
}
