//! The channels that are plotted over time or against another channel, and their visible series.

use resect_core::network::{Number, Pair};
use serde::{Deserialize, Serialize};

use super::Visibility;
use crate::app::prepared::channels::{Channel, Sources, Subject};
use crate::app::prepared::series::Series;

/// Plots of the channels pane.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ChannelPlots {
    /// Plots from top to bottom; a channel occurs in one of them at most.
    pub shown: Vec<SharedPlot>,
    /// Horizontal axis of all plots; `None` for time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against: Option<Horizontal>,
    /// True if each reading has the mark of its fate.
    pub fates: bool,
    /// True if the errors of the added trajectories are plotted.
    pub errors: bool,
    /// True if errors are plotted over the driven distance instead of time.
    pub by_distance: bool,
    /// True if the errors of all trajectories share one scale; a good trajectory beside a bad one then appears as a flat line.
    pub one_scale: bool,
}

/// Channels that share a plot. The channels of an axis have one unit, and the left axis has at least one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct SharedPlot {
    pub left: Vec<Channel>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub right: Vec<Channel>,
}

/// Channel on the horizontal axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Horizontal {
    pub channel: Channel,
    /// Station or pair of the channel, from 0; `None` for that of each vertical series.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub index: Option<usize>,
}

impl Default for ChannelPlots {
    /// Height, heading and σ of the vehicle over time, and errors if trajectories are added.
    fn default() -> Self {
        let shown = [Channel::VehicleHeight, Channel::Heading, Channel::PositionSigma];
        Self { errors: true, ..Self::of(&shown) }
    }
}

/// Reason why a channel cannot be on the horizontal axis without a choice of station or pair.
pub const APART: &str = "Choose one: another channel is per station or per pair";
/// Reason why two plots cannot be joined.
pub const UNITS: &str = "Not possible: a plot has at most two units, one for each axis";

/// A visible series.
pub struct SeenSeries<'a> {
    pub name: String,
    /// The subject, and its index among three, from 0.
    pub subject: (Subject, usize),
    pub series: Series<'a>,
    /// The series on the horizontal axis.
    pub against: Option<Series<'a>>,
}

impl SharedPlot {
    pub fn of(channel: Channel) -> Self {
        Self { left: vec![channel], right: Vec::new() }
    }

    /// Returns the channels, each with true if it is on the right axis.
    pub fn channels(&self) -> impl Iterator<Item = (Channel, bool)> {
        let left = self.left.iter().map(|channel| (*channel, false));
        left.chain(self.right.iter().map(|channel| (*channel, true)))
    }

    pub fn has(&self, channel: Channel) -> bool {
        self.channels().any(|(own, _)| own == channel)
    }

    /// Returns the names of its channels: "range and height".
    pub fn name(&self) -> String {
        let names: Vec<&str> = self.channels().map(|(channel, _)| channel.name()).collect();
        names.join(" and ")
    }

    /// Returns the plot with another channel on the first axis that has its unit or none; `None` without such an axis.
    fn with(&self, channel: Channel) -> Option<Self> {
        let mut plot = self.clone();
        let fits = |axis: &[Channel]| axis.iter().all(|own| own.dimension() == channel.dimension());
        let axis = if fits(&plot.left) {
            &mut plot.left
        } else if fits(&plot.right) {
            &mut plot.right
        } else {
            return None;
        };
        axis.push(channel);
        Some(plot)
    }

    /// Returns the plot without a channel. What is left is on the left axis.
    fn without(&self, channel: Channel) -> Self {
        let others = |axis: &[Channel]| -> Vec<Channel> {
            axis.iter().copied().filter(|own| *own != channel).collect()
        };
        let (left, right) = (others(&self.left), others(&self.right));
        if left.is_empty() { Self { left: right, right: left } } else { Self { left, right } }
    }

    /// Returns the plot with a channel on its other axis; `None` if that has another unit, or if no channel would be left on the left axis.
    pub fn with_other_axis(&self, channel: Channel) -> Option<Self> {
        let fits = |axis: &[Channel]| axis.iter().all(|own| own.dimension() == channel.dimension());
        let mut plot = self.clone();
        if plot.right.contains(&channel) && fits(&plot.left) {
            plot.right.retain(|own| *own != channel);
            plot.left.push(channel);
        } else if plot.left.len() > 1 && plot.left.contains(&channel) && fits(&plot.right) {
            plot.left.retain(|own| *own != channel);
            plot.right.push(channel);
        } else {
            return None;
        }
        Some(plot)
    }
}

impl Horizontal {
    /// A channel against which each series is plotted of its own station or pair.
    pub fn own(channel: Channel) -> Self {
        Self { channel, index: None }
    }

    /// Returns the name of the axis: "range", "range of station 1", "distance error of prisms 1–2".
    pub fn name(self) -> String {
        let name = self.channel.name();
        match (self.index, self.channel.subject()) {
            (Some(index), subject) if !subject.is_single() => {
                format!("{name} of {}", subject_name(subject, index))
            }
            _ => name.to_owned(),
        }
    }

    /// Returns the name of its column in a file.
    pub fn column(self) -> String {
        let column = self.channel.describe().column;
        match (self.index, self.channel.subject()) {
            (Some(index), Subject::Station) => format!("{column}_station_{}", index + 1),
            (Some(index), Subject::Pair) => {
                format!("{column}_prisms_{}", Pair::at(index).to_string().replace('–', "_"))
            }
            _ => column.to_owned(),
        }
    }
}

impl ChannelPlots {
    /// Returns a plot of each of these channels over time, without errors of trajectories.
    pub fn of(channels: &[Channel]) -> Self {
        let mut plots = Self {
            shown: Vec::new(),
            against: None,
            fates: false,
            errors: false,
            by_distance: false,
            one_scale: false,
        };
        channels.iter().for_each(|channel| plots.add(SharedPlot::of(*channel)));
        plots
    }

    /// Adds a plot, in the order of [`Channel::ALL`].
    fn add(&mut self, plot: SharedPlot) {
        let first = |plot: &SharedPlot| plot.left.first().map(|channel| *channel as usize);
        let place = self.shown.iter().position(|other| first(other) > first(&plot));
        self.shown.insert(place.unwrap_or(self.shown.len()), plot);
    }

    /// Returns these plots over time if they cannot be plotted against the chosen channel.
    fn checked(mut self) -> Self {
        self.against = self.against.filter(|other| self.goes_against(*other));
        self
    }

    /// Returns these plots with one channel added in a plot of its own, or removed.
    #[must_use]
    pub fn toggled(&self, channel: Channel) -> Self {
        let mut plots = self.without(channel);
        if !self.shows(channel) {
            plots.add(SharedPlot::of(channel));
        }
        plots.checked()
    }

    fn without(&self, channel: Channel) -> Self {
        let mut plots = self.clone();
        plots.shown.iter_mut().for_each(|plot| *plot = plot.without(channel));
        plots.shown.retain(|plot| !plot.left.is_empty());
        plots
    }

    /// Returns these plots with all channels of one plot in another; `None` if they have more than two units.
    pub fn joined(&self, plot: usize, into: usize) -> Option<Self> {
        let (moved, mut host) = (self.shown.get(plot)?, self.shown.get(into)?.clone());
        if plot == into {
            return None;
        }
        for (channel, _) in moved.channels() {
            host = host.with(channel)?;
        }
        let mut plots = self.clone();
        plots.shown[into] = host;
        plots.shown.remove(plot);
        Some(plots)
    }

    /// Returns these plots with a channel in a plot of its own.
    #[must_use]
    pub fn separated(&self, channel: Channel) -> Self {
        let mut plots = self.without(channel);
        plots.add(SharedPlot::of(channel));
        plots
    }

    /// Returns these plots if they are possible; otherwise a plot of each of their channels over time, for files that people write.
    #[must_use]
    pub fn valid(self) -> Self {
        let one_unit = |axis: &[Channel]| {
            axis.iter().all(|channel| channel.dimension() == axis[0].dimension())
        };
        let fits = |plot: &SharedPlot| {
            !plot.left.is_empty() && one_unit(&plot.left) && one_unit(&plot.right)
        };
        let mut channels: Vec<Channel> = Vec::new();
        for channel in self.channels() {
            if !channels.contains(&channel) {
                channels.push(channel);
            }
        }
        let is_once = channels.len() == self.channels().count();
        let against = self.against.filter(|other| other.index.is_none_or(|index| index < 3));
        let plots = Self { against, ..self };
        if is_once && plots.shown.iter().all(fits) {
            return plots.checked();
        }
        Self { shown: Self::of(&channels).shown, ..plots }.checked()
    }

    /// Returns the errors alone, which need the height of the pane when trajectories are added.
    #[must_use]
    pub fn only_errors(&self) -> Self {
        Self { errors: true, shown: Vec::new(), ..self.clone() }
    }

    pub fn shows(&self, channel: Channel) -> bool {
        self.shown.iter().any(|plot| plot.has(channel))
    }

    /// Returns the channels that are shown, plot by plot.
    pub fn channels(&self) -> impl Iterator<Item = Channel> {
        self.shown.iter().flat_map(|plot| plot.channels().map(|(channel, _)| channel))
    }

    /// Returns true if all shown channels can be plotted against this one.
    pub fn goes_against(&self, other: Horizontal) -> bool {
        other.index.is_some() || self.channels().all(|channel| channel.goes_with(other.channel))
    }

    /// Returns the name of a plot: "range and height over time".
    pub fn name_of(&self, plot: &SharedPlot) -> String {
        let name = plot.name();
        match self.against {
            None => format!("{name} over time"),
            Some(other) => format!("{name} against {}", other.name()),
        }
    }

    /// Returns the names of all plots.
    pub fn in_words(&self) -> String {
        self.shown.iter().map(|plot| self.name_of(plot)).collect::<Vec<_>>().join(", ")
    }

    /// Returns the series of a channel for the visible stations or pairs. A single series is plotted against each series of
    /// the other channel, unless that is one station's or pair's.
    pub fn seen<'a>(
        &self,
        channel: Channel,
        sources: Sources<'a>,
        visible: &Visibility,
    ) -> Vec<SeenSeries<'a>> {
        let each_of_other = self.against.filter(|other| other.index.is_none());
        let subject = match (channel.subject(), each_of_other) {
            (own, Some(other)) if own.is_single() => other.channel.subject(),
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
                Some(other) => Some(series(other.channel, other.index.unwrap_or(index))?),
                None => None,
            };
            let series = series(channel, index)?;
            let name = subject_name(subject, index);
            Some(SeenSeries { name, subject: (subject, index), series, against })
        };
        let most = match subject {
            Subject::Station => visible.stations.len(),
            Subject::Pair => visible.pairs.len(),
            Subject::Prism1 | Subject::Vehicle => 1,
        };
        (0..most).filter(is_seen).filter_map(seen).collect()
    }
}

/// Returns the name of a series: "station 1", "prisms 1–2".
pub fn subject_name(subject: Subject, index: usize) -> String {
    match subject {
        Subject::Station => format!("station {}", index + 1),
        Subject::Pair => format!("prisms {}", Pair::at(index)),
        Subject::Prism1 => "prism 1".to_owned(),
        Subject::Vehicle => "vehicle".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_of_two_units_share_a_plot_and_those_of_three_do_not() {
        let plots = ChannelPlots::of(&[Channel::Range, Channel::Speed, Channel::Heading]);
        let index = |plots: &ChannelPlots, channel| {
            plots.shown.iter().position(|plot| plot.has(channel)).expect("shown")
        };
        let [range, speed, heading] =
            [Channel::Range, Channel::Speed, Channel::Heading].map(|it| index(&plots, it));
        let two = plots.joined(speed, range).expect("metres and metres per second");
        let shared = &two.shown[index(&two, Channel::Range)];
        assert_eq!(
            (&shared.left[..], &shared.right[..]),
            (&[Channel::Range][..], &[Channel::Speed][..])
        );
        assert_eq!(two.name_of(shared), "range and prism speed over time");
        assert_eq!(two.joined(index(&two, Channel::Heading), index(&two, Channel::Range)), None);
        assert_eq!(plots.joined(heading, heading), None);
        // A channel that leaves takes nothing with it, and the rest stays on the left axis.
        assert_eq!(two.separated(Channel::Range), plots);
        assert_eq!(
            two.toggled(Channel::Range),
            ChannelPlots::of(&[Channel::Speed, Channel::Heading])
        );
    }

    #[test]
    fn impossible_plots_of_a_file_are_plotted_apart() {
        let plot = |left: &[Channel], right: &[Channel]| SharedPlot {
            left: left.to_vec(),
            right: right.to_vec(),
        };
        let [range, heading, speed] = [Channel::Range, Channel::Heading, Channel::Speed];
        for shown in [
            vec![plot(&[range, heading, speed], &[])],
            vec![plot(&[], &[range]), plot(&[heading, speed], &[])],
            vec![plot(&[range], &[speed]), plot(&[heading], &[range])],
        ] {
            let plots = ChannelPlots { shown, ..ChannelPlots::of(&[]) };
            assert_eq!(plots.valid(), ChannelPlots::of(&[range, heading, speed]));
        }
        let good = ChannelPlots { shown: vec![plot(&[range], &[speed])], ..ChannelPlots::of(&[]) };
        assert_eq!(good.clone().valid(), good);
        let far = Some(Horizontal { channel: range, index: Some(7) });
        assert_eq!(ChannelPlots { against: far, ..good.clone() }.valid(), good);
    }

    #[test]
    fn a_channel_changes_its_axis_only_where_the_unit_fits() {
        let plots = ChannelPlots::of(&[Channel::Range, Channel::Height, Channel::Speed]);
        let heights = plots.joined(1, 0).expect("both in metres");
        assert_eq!(heights.shown[0].left.len(), 2);
        let apart =
            heights.shown[0].with_other_axis(Channel::Height).expect("the right one is free");
        assert_eq!((apart.left.len(), apart.right.len()), (1, 1));
        assert_eq!(apart.with_other_axis(Channel::Height).as_ref(), Some(&heights.shown[0]));
        assert_eq!(apart.with_other_axis(Channel::Range), None, "the left axis stays in use");
    }

    #[test]
    fn any_channel_goes_against_one_station() {
        let errors = ChannelPlots::of(&[Channel::DistanceError]);
        assert!(!errors.goes_against(Horizontal::own(Channel::Range)));
        let second = Horizontal { channel: Channel::Range, index: Some(1) };
        assert!(errors.goes_against(second));
        assert_eq!(
            (second.name(), second.column()),
            ("range of station 2".to_owned(), "range_m_station_2".to_owned())
        );
        let own = ChannelPlots {
            against: Some(Horizontal::own(Channel::Height)),
            ..ChannelPlots::of(&[Channel::Range])
        };
        assert_eq!(own.toggled(Channel::DistanceError).against, None);
        assert_eq!(own.toggled(Channel::X).against, own.against);
    }
}
