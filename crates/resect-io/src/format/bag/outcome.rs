//! Final findings about the messages of a bag: clock and topics, or the error if nothing was read.

use super::intake::{Intake, natural_key};
use super::messages::{Kind, THEODOLITE_TYPE};
use crate::error::{OpenError, Question, Topic};
use crate::findings::kinds;
use resect_core::deployment::{Finding, Subject};

/// Returns true if a finding is about damage of one of these files.
fn is_about_bag(finding: &Finding, files: &[impl AsRef<str>]) -> bool {
    let is_damage = matches!(
        finding.kind,
        kinds::BAG_DAMAGED | kinds::BAG_MESSAGES_MALFORMED | kinds::BAG_INCOMPLETE
    );
    let is_one = |name: &str| files.iter().any(|file| file.as_ref() == name);
    is_damage && matches!(&finding.subject, Some(Subject::File(file)) if is_one(file))
}

impl Intake<'_> {
    /// Adds the findings about all files together; an error if there was no reading.
    pub fn finish(self) -> Result<(), OpenError> {
        if self.stream.readings == 0 {
            return Err(self.nothing());
        }
        self.into.findings.extend(self.stream.findings());
        Ok(())
    }

    /// Returns the question or the error for a bag without readings.
    fn nothing(self) -> OpenError {
        let file = self.files.join(", ");
        let topics = &self.stream.topics;
        let mut positions: Vec<Topic> = topics
            .iter()
            .filter(|t| t.kind.is_some_and(Kind::is_position) && t.messages > 0)
            .map(|t| Topic {
                name: t.name.clone(),
                message_type: t.message_type.clone(),
                messages: t.messages,
            })
            .collect();
        positions.sort_by_cached_key(|topic| natural_key(&topic.name));
        if let Some(named) = &self.stream.named {
            let there = positions.iter().map(|t| t.name.as_str()).collect::<Vec<_>>().join(", ");
            let there = if there.is_empty() { "none".to_owned() } else { there };
            return OpenError::file(
                &file,
                format!("no position on the topics {}", named.as_slice().join(", ")),
                format!("correct `topics`; topics with positions: {there}"),
            );
        }
        if !positions.is_empty() {
            return Question::Topics { file, topics: positions }.into();
        }
        let damaged =
            self.into.findings.iter().rev().find(|finding| is_about_bag(finding, &self.files));
        if let Some(damage) = damaged {
            let what = damage.message();
            return OpenError::file(
                &file,
                format!("no station readings can be read: {what}"),
                "copy it again from the recording computer, or record it again",
            );
        }
        let poses: Vec<&str> = topics
            .iter()
            .filter(|topic| Kind::of_type(&topic.message_type).is_some_and(Kind::is_pose))
            .map(|topic| topic.name.as_str())
            .collect();
        if !poses.is_empty() {
            return OpenError::file(
                &file,
                format!("no station readings, only poses ({})", poses.join(", ")),
                "judge it as a trajectory: `resect evaluate`, in the window File > Evaluate a trajectory…",
            );
        }
        let mut others: Vec<_> =
            topics.iter().map(|t| format!("{} ({})", t.name, t.message_type)).collect();
        let more = others.len().saturating_sub(5);
        others.truncate(5);
        if more > 0 {
            others.push(format!("{more} more"));
        }
        let others = if others.is_empty() { "none".to_owned() } else { others.join(", ") };
        OpenError::file(
            &file,
            format!("no message of type {}; its topics: {others}", THEODOLITE_TYPE),
            "open the bag that the theodolite node recorded",
        )
    }
}
