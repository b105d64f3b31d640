//! Quality of an answer by the paper's two metrics.

pub mod answer_rows;
mod evaluation;
pub mod far_end;
pub mod gnss;
pub mod no_trajectory;
pub mod requested_trajectory;
pub mod rig_layout;
pub mod rig_motion;
pub mod site;
mod spread;
pub mod trajectory;
pub mod usual_tilt;
pub mod vehicle;
mod vehicle_rig;

pub use evaluation::{
    ControlPointMetric, Evaluation, evaluate, evaluate_answer, known_distances_m,
};
pub use spread::Spread;
