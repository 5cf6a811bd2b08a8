//! What is promised: one table, measured once with room for other adapters.

use super::row::{PROMISED, Row};

/// Bounds of a row's figure by column, in the order of [`PROMISED`]: the defaults of `billeter-plv`, `biri-ss`,
/// `chen-planes` and `szk-network`, and the lit intervals.
const BOUNDS: &[(&str, [f64; 5])] = &[];

/// Where a row has none of its own.
const USUAL: [f64; 5] = [0.02, 0.005, 0.05, 0.15, 0.02];

/// What is promised of a column in a row at a value of its parameter.
pub(super) fn bound(row: &Row, column: &str, value: f64) -> Option<f64> {
    let index = PROMISED.iter().position(|promised| *promised == column)?;
    let bounds = BOUNDS.iter().find(|(id, _)| *id == row.id).map_or(&USUAL, |(_, bounds)| bounds);
    Some(bounds[index] * (row.law)(value))
}
