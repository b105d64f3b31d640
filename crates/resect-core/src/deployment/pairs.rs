//! Pairs of prisms.

/// Pairs of prisms in the order of every `[f64; 3]` of distances: α, β, γ.
pub const PAIRS: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

/// Label of a pair for people: "1–2".
pub fn pair_label(pair: usize) -> String {
    let (a, b) = PAIRS[pair];
    format!("{}–{}", a + 1, b + 1)
}
