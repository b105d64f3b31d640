//! The paths of other open runs in the frame of the active one.

use std::sync::Arc;

use super::way::Way;
use resect_core::analysis::{Analysis, Answer};
use resect_core::deployment::Deployment;
use resect_tools::validation::in_words::Tell;
use resect_tools::validation::one_frame::{NotPlaced, Placed, PlacedBy, place};

/// Another open run: its name and its path.
#[derive(Clone, Debug)]
pub struct RunBeside {
    pub name: String,
    /// The path in the frame of the active run, or the reason for its absence.
    pub way: Result<(Way, Placed), NotPlaced>,
}

impl RunBeside {
    pub fn of(
        own: (&Deployment, &Answer),
        name: String,
        (other, analysis): (&Arc<Deployment>, &Analysis),
    ) -> Self {
        let way = place(own, (other, analysis)).and_then(|placed| {
            let mut way = Way::of(other, analysis);
            if let Some(why) = way.why_not {
                return Err(NotPlaced::Itself(why));
            }
            for at in &mut way.instants {
                at.position_m = placed.station1_from_other.apply(&at.position_m);
            }
            Ok((way, placed))
        });
        Self { name, way }
    }

    /// Describes the alignment of the run, or the reason for its absence.
    pub fn in_words(&self, tell: &Tell<'_>) -> String {
        match &self.way {
            Err(why) => format!("{}: not drawn: {}", self.name, why.in_words(tell)),
            Ok((_, Placed { by: PlacedBy::SetUp, .. })) => {
                format!("{}: same set-up: no station moved in between", self.name)
            }
            Ok((_, Placed { by: PlacedBy::ControlPoints { points, rms_m }, .. })) => format!(
                "{}: another set-up, aligned by {points} common control points ({:.1} mm rms)",
                self.name,
                1e3 * rms_m
            ),
        }
    }
}
