//! Which channels the pane of channels plots, and which series of them are seen.

use serde::{Deserialize, Serialize};

use super::Visibility;
use crate::app::prepared::PreparedPlots;
use crate::app::prepared::channels::{Channel, Of};
use crate::app::prepared::series::Series;
use resect_core::deployment::pair_label;

/// A channel, and what it is plotted against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Plotted {
    pub channel: Channel,
    /// Another channel; `None` is time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against: Option<Channel>,
}

/// Why two channels cannot stand against each other.
pub const APART: &str = "One is of each station, the other of each pair of prisms";

/// One of the series that are seen.
pub struct SeenSeries<'a> {
    pub name: String,
    /// What it is of, and which, from 0.
    pub of: (Of, usize),
    pub series: Series<'a>,
    /// What it stands against.
    pub against: Option<Series<'a>>,
}

impl Plotted {
    /// With another channel; against what it cannot stand against, it is plotted over time.
    pub fn with_channel(self, channel: Channel) -> Self {
        Self { channel, against: self.against.filter(|other| channel.goes_with(*other)) }
    }

    /// In words: "range over time".
    pub fn in_words(self) -> String {
        let name = self.channel.name();
        match self.against {
            None => format!("{name} over time"),
            Some(other) => format!("{name} against {}", other.name()),
        }
    }

    /// The series of the stations or pairs that are not hidden; where the vehicle's only one stands against those of
    /// stations or pairs, it does so against each.
    pub fn seen<'a>(self, plots: &'a PreparedPlots, visible: &Visibility) -> Vec<SeenSeries<'a>> {
        let of = match (self.channel.of(), self.against.map(Channel::of)) {
            (Of::Vehicle, Some(other)) => other,
            (of, _) => of,
        };
        let series = |channel: Channel, index: usize| {
            channel.series(plots, if channel.of() == Of::Vehicle { 0 } else { index })
        };
        let seen = |index: &usize| match of {
            Of::Station => visible.stations[*index],
            Of::Pair => visible.pairs[*index],
            Of::Vehicle => *index == 0,
        };
        (0..3)
            .filter(seen)
            .filter_map(|index| {
                let against = match self.against {
                    Some(other) => Some(series(other, index)?),
                    None => None,
                };
                let name = match of {
                    Of::Station => format!("station {}", index + 1),
                    Of::Pair => format!("prisms {}", pair_label(index)),
                    Of::Vehicle => "prism 1".to_owned(),
                };
                let series = series(self.channel, index)?;
                Some(SeenSeries { name, of: (of, index), series, against })
            })
            .collect()
    }
}
