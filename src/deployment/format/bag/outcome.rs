//! What is said of the messages of a bag when all are in: by which clock, from which topics, or why there is nothing.

use super::OpenError;
use super::intake::{Intake, SeenTopic, natural_key};
use super::messages::{Kind, THEODOLITE_TYPE};
use crate::deployment::Finding;
use crate::deployment::format::{Question, Topic};

impl Intake<'_> {
    /// What holds for all files together: whether there was anything to read, and by which clock.
    pub fn finish(self) -> Result<(), OpenError> {
        if self.readings == 0 {
            return Err(self.nothing());
        }
        let findings = &mut self.into.findings;
        for (station, count) in self.without_stamp.into_iter().enumerate().filter(|(_, n)| *n > 0) {
            findings.push(Finding::warning(format!(
                "station {}: {count} readings have no synchronised time (header.stamp is zero); they are taken at \
                 theodolite_time, the station's own clock, which nothing synchronises",
                station + 1
            )));
        }
        let without_any = self.without_any_time.into_iter().enumerate();
        for (station, count) in without_any.filter(|(_, n)| *n > 0) {
            findings.push(Finding::doubt(format!(
                "station {}: {count} readings have no time of their own; they are taken at the time when the recorder got \
                 them, which is late by an unknown and changing delay",
                station + 1
            )));
        }
        findings.extend(self.arrivals.finding());
        let positions = || self.topics.iter().filter(|t| t.kind.is_some_and(Kind::is_position));
        let list = |topics: &[&SeenTopic]| {
            let each = topics
                .iter()
                .map(|t| format!("{} ({}, {} messages)", t.name, t.message_type, t.messages));
            each.collect::<Vec<_>>().join(", ")
        };
        let unread: Vec<_> =
            positions().filter(|t| t.station.is_none() && t.messages > 0).collect();
        if !unread.is_empty() {
            findings.push(Finding::note(format!("positions that are not read: {}", list(&unread))));
        }
        if let Some(named) = self.named {
            findings.push(Finding::note(format!(
                "positions of {} are taken as in the frame of each instrument, the prism constant in them; if an \
                 instrument was set up on coordinates of a site, its rates mean something else",
                named.join(", ")
            )));
            for (station, name) in named.iter().enumerate() {
                if !positions().any(|t| t.station == Some(station) && t.messages > 0) {
                    let there = list(&positions().collect::<Vec<_>>());
                    findings.push(Finding::warning(format!(
                        "station {}: no position on its topic `{name}`; there are {there}",
                        station + 1
                    )));
                }
            }
        }
        if self.stood_in_for > 0 {
            findings.push(Finding::note(format!(
                "{} theodolite messages are not read, because `topics` names others",
                self.stood_in_for
            )));
        }
        Ok(())
    }

    /// The question or the error where no message was a reading.
    fn nothing(self) -> OpenError {
        let file = self.files.join(", ");
        let mut positions: Vec<Topic> = self
            .topics
            .iter()
            .filter(|t| t.kind.is_some_and(Kind::is_position) && t.messages > 0)
            .map(|t| Topic {
                name: t.name.clone(),
                message_type: t.message_type.clone(),
                messages: t.messages,
            })
            .collect();
        positions.sort_by_cached_key(|topic| natural_key(&topic.name));
        if let Some(named) = self.named {
            let there = positions.iter().map(|t| t.name.as_str()).collect::<Vec<_>>().join(", ");
            let there = if there.is_empty() { "none".to_owned() } else { there };
            return OpenError::file(
                &file,
                format!("no position on the topics {}", named.join(", ")),
                format!("correct `topics`; the topics with positions: {there}"),
            );
        }
        if !positions.is_empty() {
            return Question::Topics { file, topics: positions }.into();
        }
        let damaged = self
            .into
            .findings
            .iter()
            .rev()
            .find(|f| self.files.iter().any(|file| f.message.starts_with(file)));
        if let Some(damage) = damaged {
            let what = damage.message.split_once(": ").map_or("", |(_, what)| what);
            return OpenError::file(
                &file,
                format!("nothing of the stations can be read: {what}"),
                "copy it again from where it was recorded, or record it again",
            );
        }
        let poses: Vec<&str> = self
            .topics
            .iter()
            .filter(|topic| Kind::of_type(&topic.message_type).is_some_and(Kind::is_pose))
            .map(|topic| topic.name.as_str())
            .collect();
        if !poses.is_empty() {
            return OpenError::file(
                &file,
                format!("no readings of stations in it, but poses ({})", poses.join(", ")),
                "judge it as a trajectory: `resect evaluate`, in the window File > Judge a trajectory…",
            );
        }
        let mut others: Vec<_> =
            self.topics.iter().map(|t| format!("{} ({})", t.name, t.message_type)).collect();
        let more = others.len().saturating_sub(5);
        others.truncate(5);
        if more > 0 {
            others.push(format!("{more} more"));
        }
        let others = if others.is_empty() { "no topic".to_owned() } else { others.join(", ") };
        OpenError::file(
            &file,
            format!("no message of type {} in it; it has {others}", THEODOLITE_TYPE),
            "open the bag that the theodolite node recorded",
        )
    }
}
