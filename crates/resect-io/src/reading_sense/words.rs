//! Numbers and stations in sentences.

/// "station 2" or "stations 1, 3".
pub fn stations(numbers: &[usize]) -> String {
    let list = numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    if numbers.len() == 1 { format!("station {list}") } else { format!("stations {list}") }
}

pub fn number(value: f64) -> String {
    match value.abs() {
        size if size >= 1e11 => format!("{value:.3e}"),
        size if size >= 1e3 => format!("{value:.1}"),
        _ => format!("{value:.3}"),
    }
}
