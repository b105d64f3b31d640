//! Differences of overrides from the values in the files, and renumbered stations.

use super::{AzimuthSense, Overrides, PrismConstants};

/// The station numbers of files that do not say otherwise.
pub const AS_NUMBERED: [i64; 3] = [1, 2, 3];

impl Overrides {
    /// Returns the overrides that differ from those of the folder, `as_read`.
    #[must_use]
    pub fn beyond(self, as_read: &Self) -> Self {
        /// `silent` is the value where neither gives one.
        fn beyond<T: PartialEq>(own: Option<T>, read: Option<&T>, silent: Option<&T>) -> Option<T> {
            own.filter(|own| read.or(silent) != Some(own))
        }
        let Self {
            name,
            tracks,
            topics,
            stations,
            azimuth,
            prism_constant_m,
            ranges_include_prism_constant,
            inter_prism_m,
            prisms,
            prisms_m,
            gnss,
            control_points,
            rig,
            span_s,
            masked,
            columns,
            surveys,
        } = self;
        Self {
            name: beyond(name, as_read.name.as_ref(), None),
            tracks: beyond(tracks, as_read.tracks.as_ref(), None),
            topics: beyond(topics, as_read.topics.as_ref(), None),
            stations: beyond(stations, as_read.stations.as_ref(), Some(&AS_NUMBERED)),
            azimuth: beyond(azimuth, as_read.azimuth.as_ref(), Some(&AzimuthSense::Clockwise)),
            prism_constant_m: prism_constant_m.filter(|own| {
                let read = as_read.prism_constant_m.map(PrismConstants::each_m);
                read.unwrap_or(PrismConstants::default().each_m()) != own.each_m()
            }),
            ranges_include_prism_constant: beyond(
                ranges_include_prism_constant,
                as_read.ranges_include_prism_constant.as_ref(),
                None,
            ),
            inter_prism_m: beyond(inter_prism_m, as_read.inter_prism_m.as_ref(), None),
            prisms: beyond(prisms, as_read.prisms.as_ref(), None),
            prisms_m: beyond(prisms_m, as_read.prisms_m.as_ref(), None),
            gnss: beyond(gnss, as_read.gnss.as_ref(), None),
            control_points: beyond(control_points, as_read.control_points.as_ref(), None),
            rig: beyond(rig, as_read.rig.as_ref(), None),
            span_s: beyond(span_s, as_read.span_s.as_ref(), None),
            masked: beyond(masked, as_read.masked.as_ref(), Some(&Vec::new())),
            columns: beyond(columns, as_read.columns.as_ref(), None),
            surveys: beyond(surveys, as_read.surveys.as_ref(), None),
        }
    }

    /// Renumbers the stations; the same readings stay masked.
    pub fn renumber(&mut self, before: [i64; 3], after: [i64; 3]) {
        for mask in self.masked.iter_mut().flatten() {
            let number = before.get(usize::from(mask.station).wrapping_sub(1));
            let place = number.and_then(|own| after.iter().position(|new| new == own));
            if let Some(place) = place {
                mask.station = place as u8 + 1;
            }
        }
        self.stations = Some(after);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deployment::MaskedReading;

    #[test]
    fn what_the_folder_says_already_is_not_put_right() {
        let as_read = Overrides { stations: Some([1, 3, 2]), ..Overrides::default() };
        let own = Overrides {
            stations: Some([1, 3, 2]),
            azimuth: Some(AzimuthSense::Clockwise),
            prism_constant_m: Some(PrismConstants::Each([0.010; 3])),
            masked: Some(Vec::new()),
            ..Overrides::default()
        };
        assert!(own.clone().beyond(&as_read).is_empty());
        // Back to the numbers of the files is something to say where the folder says otherwise.
        let back = Overrides { stations: Some([1, 2, 3]), ..own }.beyond(&as_read);
        assert_eq!(back.stations, Some([1, 2, 3]));
    }

    #[test]
    fn a_masked_reading_stays_masked_when_stations_are_renumbered() {
        let mask = |station| MaskedReading { station, time_s: 7.5 };
        let mut overrides =
            Overrides { masked: Some(vec![mask(1), mask(2)]), ..Overrides::default() };
        overrides.renumber([1, 2, 3], [1, 3, 2]);
        assert_eq!(overrides.masked, Some(vec![mask(1), mask(3)]));
        overrides.renumber([1, 3, 2], [2, 3, 1]);
        assert_eq!(overrides.masked, Some(vec![mask(3), mask(1)]));
    }
}
