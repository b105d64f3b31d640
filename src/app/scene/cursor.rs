//! The rig at the time cursor: the prism triangle and the vehicle, or the ghosts of its prisms.

use nalgebra::Vector3;
use resect_core::network::{Number, PerPrism, PerStation, Prism, StationPair};

use super::content::SceneContent;
use super::vertices::{LineVertex, PointVertex, f32s};
use super::{ghosts, overlays, vehicle};
use crate::app::prepared::rig_at::{RigAt, rig_at};
use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;
use resect_tools::palette;
use resect_tools::palette::Rgb;

impl SceneContent {
    /// Draws the rig at a time (s, in the stations' clock), or removes it.
    pub fn set_cursor(
        &mut self,
        deployment: &Deployment,
        analysis: &Analysis,
        time_s: Option<f64>,
        colour: Rgb,
    ) {
        self.cursor.clear();
        (self.prisms_m, self.pose, self.middle_m) = (None, None, None);
        self.ghosts = PerStation::default();
        let Some(time_s) = time_s else { return };
        let transforms = &self.station1_from_tracks;
        let placed_m: PerStation<Option<Vector3<f64>>> = match rig_at(deployment, analysis, time_s)
        {
            RigAt::Together(triplet) => {
                let corners_m = triplet.triplet_m(0);
                let placed_m = transforms.zip(&corners_m, |transform, corner_m| {
                    Some(transform.as_ref()?.apply(corner_m))
                });
                self.prisms_m = prisms_at(&analysis.offer.followed, &placed_m);
                if self.prisms_m.is_some() {
                    self.pose = vehicle::pose_of(deployment, analysis, &triplet);
                }
                if let Some(pose) = &self.pose {
                    overlays::add_pose(&mut self.cursor.lines, pose);
                }
                let (points, lines) = self.triangle(&corners_m, colour, [10.0, 2.5], 255);
                self.cursor.points.extend(points);
                self.cursor.lines.extend(lines);
                placed_m
            }
            RigAt::LastRead(prisms) => {
                self.ghosts = ghosts::placed(&prisms, transforms);
                // A rejected reading may be at any position.
                self.ghosts.map(|ghost| Some(ghost.filter(|it| !it.rejected)?.position_m))
            }
        };
        let placed_m: Vec<Vector3<f64>> = placed_m.into_iter().flatten().collect();
        if !placed_m.is_empty() {
            self.middle_m = Some(placed_m.iter().sum::<Vector3<f64>>() / placed_m.len() as f64);
        }
    }

    /// Draws a faint triangle at the time under another pane's pointer, or removes it.
    pub fn set_hover(&mut self, analysis: &Analysis, instant: Option<usize>, colour: Rgb) {
        if instant.is_none() && self.hover.points.is_empty() {
            return;
        }
        self.hover.clear();
        let Some(instant) = instant else { return };
        let corners_m = analysis.triplets().triplet_m(instant);
        let (points, lines) = self.triangle(&corners_m, colour, [7.0, 1.5], 120);
        self.hover.points.extend(points);
        self.hover.lines.extend(lines);
    }

    /// Returns the prisms whose stations have a pose, joined if all have one.
    fn triangle(
        &self,
        corners_m: &PerStation<Vector3<f64>>,
        [r, g, b]: Rgb,
        [diameter_points, width_points]: [f32; 2],
        alpha: u8,
    ) -> (Vec<PointVertex>, Vec<LineVertex>) {
        let corners = corners_m.map(f32s);
        let placed = |station: &usize| self.station1_from_tracks[*station].is_some();
        let points: Vec<_> = (0..corners.len())
            .filter(placed)
            .map(|station| {
                let [r, g, b] = palette::station(station);
                PointVertex {
                    position_m: corners[station],
                    frame: station as u32,
                    colour: [r, g, b, alpha],
                    diameter_points,
                }
            })
            .collect();
        let joined = if points.len() == corners.len() { points.len() } else { 0 };
        let lines =
            StationPair::among(joined).map(StationPair::indices).map(|[from, to]| LineVertex {
                from_m: corners[from],
                from_frame: from as u32,
                to_m: corners[to],
                to_frame: to as u32,
                colour: [r, g, b, alpha],
                width_points,
            });
        (points, lines.collect())
    }
}

/// Returns the position of each prism by the first station that follows it; `None` unless all stations have a position.
fn prisms_at(
    followed: &PerStation<Prism>,
    placed_m: &PerStation<Option<Vector3<f64>>>,
) -> Option<PerPrism<Vector3<f64>>> {
    let placed_m: PerStation<Vector3<f64>> = placed_m.iter().copied().collect::<Option<_>>()?;
    let by_first = |prism: Prism| {
        let first = followed.each().find(|(_, own)| **own == prism)?.0;
        placed_m.get(first).copied()
    };
    (0..Prism::count(followed)).map(Prism::at).map(by_first).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::prepared::placing::placed_tracks;
    use crate::app::prepared::rig_at::LAST_READ_S;
    use crate::app::scene::vehicle::PoseBy;
    use resect_core::analysis::{Analyst, Settings};
    use resect_core::geometry::RigidTransform;
    use resect_io::sample::Sample;

    struct Drawn {
        deployment: Deployment,
        analysis: Analysis,
        content: SceneContent,
    }

    impl Drawn {
        fn new() -> Self {
            let deployment = Sample::Warthog.open().expect("built in");
            let analysis = Analyst::new(deployment.clone().into()).run(&Settings::default());
            let station1_from_tracks = placed_tracks(&deployment, &analysis);
            let content = SceneContent { station1_from_tracks, ..SceneContent::default() };
            Self { deployment, analysis, content }
        }

        /// Counts of the discs, lines and ghosts of the rig at a time.
        fn at(&mut self, time_s: f64) -> [usize; 3] {
            self.content.set_cursor(&self.deployment, &self.analysis, Some(time_s), [0; 3]);
            let Self { content, .. } = self;
            let ghosts = content.ghosts.iter().flatten().count();
            [content.cursor.points.len(), content.cursor.lines.len(), ghosts]
        }

        /// Returns start and end of the longest gap between two intervals (s).
        fn gap_s(&self) -> [f64; 2] {
            let intervals = &self.analysis.pipeline.kept_intervals;
            let gaps = intervals.windows(2).map(|two| [two[0].end_s, two[1].start_s]);
            gaps.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0]))).expect("several intervals")
        }
    }

    #[test]
    fn between_two_triplets_there_are_discs_a_triangle_and_axes_and_no_ghost() {
        let mut drawn = Drawn::new();
        let time_s = &drawn.analysis.triplets().time_s;
        let between_s = 0.5 * (time_s[100] + time_s[101]);
        assert_eq!(drawn.at(between_s), [3, 6, 0]);
        let prisms_m = drawn.content.prisms_m.clone().expect("placed");
        let middle_m = drawn.content.middle_m.expect("placed");
        assert!((middle_m - (prisms_m[0] + prisms_m[1] + prisms_m[2]) / 3.0).norm() < 1e-12);
        let pose = drawn.content.pose.as_ref().expect("placed");
        assert_eq!((pose.time_s, &pose.by), (between_s, &PoseBy::Motion));
    }

    #[test]
    fn in_a_gap_there_is_no_pose_and_each_ghost_is_at_its_own_reading() {
        let mut drawn = Drawn::new();
        let [from_s, to_s] = drawn.gap_s();
        let mut ghosts_seen = 0;
        let steps = 40_usize;
        for step in 1..steps {
            let time_s = from_s + (to_s - from_s) * step as f64 / steps as f64;
            let [discs, lines, ghosts] = drawn.at(time_s);
            assert_eq!([discs, lines], [0, 0], "nothing is invented at {time_s}");
            assert!(drawn.content.prisms_m.is_none() && drawn.content.pose.is_none());
            let transforms = drawn.content.station1_from_tracks.clone();
            for station in 0..3 {
                let track = &drawn.deployment.tracks[station];
                let newest = track.measurements.iter().rfind(|m| m.time_s <= time_s);
                let expected = newest.filter(|m| time_s - m.time_s <= LAST_READ_S);
                let expected_m = expected
                    .map(|m| transforms[station].expect("placed").apply(&track.position_m(m)));
                assert_eq!(drawn.content.ghosts[station].map(|g| g.position_m), expected_m);
            }
            let sound = drawn.content.ghosts.iter().flatten().any(|ghost| !ghost.rejected);
            assert_eq!(drawn.content.middle_m.is_some(), sound, "what the camera goes with");
            ghosts_seen += ghosts;
        }
        assert!(ghosts_seen > 0 && ghosts_seen < 3 * (steps - 1), "one comes and goes");
    }

    #[test]
    fn before_the_start_and_without_a_cursor_there_is_nothing() {
        let mut drawn = Drawn::new();
        let start_s = drawn.deployment.start_s().expect("readings");
        assert_eq!(drawn.at(start_s - 1.0), [0; 3]);
        assert_eq!(drawn.content.middle_m, None);
        let at = drawn.analysis.triplets().time_s[0];
        assert_eq!(drawn.at(at)[0], 3);
        drawn.content.set_cursor(&drawn.deployment, &drawn.analysis, None, [0; 3]);
        assert!(drawn.content.cursor.points.is_empty() && drawn.content.middle_m.is_none());
    }

    #[test]
    fn stations_without_a_place_have_neither_disc_nor_ghost() {
        let mut drawn = Drawn::new();
        drawn.content.station1_from_tracks = [Some(RigidTransform::IDENTITY), None, None].into();
        let time_s = drawn.analysis.triplets().time_s[100];
        assert_eq!(drawn.at(time_s), [1, 0, 0]);
        assert!(drawn.content.prisms_m.is_none() && drawn.content.middle_m.is_some());
        let after_s = drawn.gap_s()[0] + 0.2;
        assert!(drawn.at(after_s)[2] <= 1);
    }
}
