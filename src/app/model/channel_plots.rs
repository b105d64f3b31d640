//! The channels that are plotted over time or against another channel, and their visible series.

use serde::{Deserialize, Serialize};

use super::Visibility;
use crate::app::prepared::channels::{Channel, Sources, Subject};
use crate::app::prepared::series::Series;
use resect_core::deployment::pair_label;

/// Plots of the channels pane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ChannelPlots {
    /// Plotted channels, in the order of [`Channel::ALL`].
    pub shown: [bool; Channel::ALL.len()],
    /// Channel on the horizontal axis; `None` for time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against: Option<Channel>,
    /// True if the errors of the added trajectories are plotted.
    pub errors: bool,
    /// True if errors are plotted over the driven distance instead of time.
    pub by_distance: bool,
    /// True if the errors of all trajectories share one scale; a good trajectory beside a bad one then appears as a flat line.
    pub one_scale: bool,
}

impl Default for ChannelPlots {
    /// Height, heading and σ of the vehicle over time, and errors if trajectories are added.
    fn default() -> Self {
        let shown = [Channel::VehicleHeight, Channel::Heading, Channel::PositionSigma];
        Self { errors: true, ..Self::of(&shown) }
    }
}

/// Reason why two channels cannot be plotted against each other.
pub const APART: &str = "Not possible: one channel is per station, the other per pair of prisms";

/// A visible series.
pub struct SeenSeries<'a> {
    pub name: String,
    /// The subject, and its index among three, from 0.
    pub subject: (Subject, usize),
    pub series: Series<'a>,
    /// The series on the horizontal axis.
    pub against: Option<Series<'a>>,
}

impl ChannelPlots {
    /// Returns plots of these channels over time, without errors of trajectories.
    pub fn of(channels: &[Channel]) -> Self {
        Self {
            shown: Channel::ALL.map(|channel| channels.contains(&channel)),
            against: None,
            errors: false,
            by_distance: false,
            one_scale: false,
        }
    }

    /// Returns these plots with other channels; over time if they cannot be plotted against the chosen channel.
    #[must_use]
    pub fn with_channels(self, channels: &[Channel]) -> Self {
        let all_go = |other: &Channel| channels.iter().all(|channel| channel.goes_with(*other));
        Self { shown: Self::of(channels).shown, against: self.against.filter(all_go), ..self }
    }

    /// Returns these plots with one channel added or removed.
    #[must_use]
    pub fn toggled(self, channel: Channel) -> Self {
        let is_shown = |other: &Channel| self.shows(*other) != (*other == channel);
        let channels: Vec<Channel> = Channel::ALL.into_iter().filter(is_shown).collect();
        self.with_channels(&channels)
    }

    /// Returns the errors alone, which need the height of the pane when trajectories are added.
    #[must_use]
    pub fn only_errors(self) -> Self {
        Self { errors: true, ..self.with_channels(&[]) }
    }

    pub fn shows(&self, channel: Channel) -> bool {
        self.shown[channel as usize]
    }

    /// Returns the channels that are shown, in the order of [`Channel::ALL`].
    pub fn channels(self) -> impl Iterator<Item = Channel> {
        Channel::ALL.into_iter().filter(move |channel| self.shows(*channel))
    }

    /// Returns true if all shown channels can be plotted against this one.
    pub fn goes_against(self, other: Channel) -> bool {
        self.channels().all(|channel| channel.goes_with(other))
    }

    /// Returns the name of a channel's plot: "range over time".
    pub fn name_of(self, channel: Channel) -> String {
        let name = channel.name();
        match self.against {
            None => format!("{name} over time"),
            Some(other) => format!("{name} against {}", other.name()),
        }
    }

    /// Returns the names of all channels' plots.
    pub fn in_words(self) -> String {
        self.channels().map(|channel| self.name_of(channel)).collect::<Vec<_>>().join(", ")
    }

    /// Returns the series of a channel for the visible stations or pairs. A single series is plotted against each series of
    /// the other channel.
    pub fn seen<'a>(
        self,
        channel: Channel,
        sources: Sources<'a>,
        visible: &Visibility,
    ) -> Vec<SeenSeries<'a>> {
        let subject = match (channel.subject(), self.against.map(Channel::subject)) {
            (own, Some(other)) if own.is_single() => other,
            (own, _) => own,
        };
        let series = |channel: Channel, index: usize| {
            channel.series(sources, if channel.subject().is_single() { 0 } else { index })
        };
        let is_seen = |index: &usize| match subject {
            Subject::Station => visible.stations[*index],
            Subject::Pair => visible.pairs[*index],
            Subject::Prism1 | Subject::Vehicle => *index == 0,
        };
        let seen = |index: usize| {
            let against = match self.against {
                Some(other) => Some(series(other, index)?),
                None => None,
            };
            let name = match subject {
                Subject::Station => format!("station {}", index + 1),
                Subject::Pair => format!("prisms {}", pair_label(index)),
                Subject::Prism1 => "prism 1".to_owned(),
                Subject::Vehicle => "vehicle".to_owned(),
            };
            let series = series(channel, index)?;
            Some(SeenSeries { name, subject: (subject, index), series, against })
        };
        (0..3).filter(is_seen).filter_map(seen).collect()
    }
}
