//! Numbers over the scene, in the same words everywhere.

/// With its unit.
pub fn length(metres: f64) -> String {
    format!("{} m", minus(&format!("{metres:.4}")))
}

/// With its sign.
pub fn signed_length(metres: f64) -> String {
    format!("{} m", signed(metres, 4))
}

pub fn signed_mm(millimetres: f64) -> String {
    format!("{} mm", signed(millimetres, 1))
}

pub fn angle(radians: f64) -> String {
    format!("{}°", minus(&format!("{:.4}", radians.to_degrees())))
}

fn signed(number: f64, decimals: usize) -> String {
    minus(&format!("{number:+.decimals$}"))
}

/// A minus as wide as the plus.
fn minus(text: &str) -> String {
    text.replace('-', "−")
}
