//! What is promised: one table, measured on a software adapter, with room for others.

use super::row::{PROMISED, Row};

/// Bounds of a row's figure by column, in the order of [`PROMISED`]: the defaults of `billeter-plv`, `biri-ss`,
/// `chen-planes` and `szk-network`, and the lit intervals. Where a law is known, of its harmless end.
const BOUNDS: &[(&str, [f64; 5])] = &[
    ("light-near-ray", [0.001, 0.001, 0.001, NONE, 0.001]),
    ("light-at-eye", [0.001, 0.005, 0.001, NONE, 0.001]),
    ("closed", [0.001, 0.0001, 0.002, NONE, 0.002]),
    ("thin-wall", [0.0, 0.0, 0.0, NONE, 0.0]),
    ("eye-across-shadow", [0.02, 0.001, 0.02, NONE, 0.02]),
    ("eye-outside", [0.02, 0.03, 0.03, NONE, 0.02]),
    ("optical-thickness", [0.01, 0.005, 0.05, NONE, 0.01]),
    ("peak", [0.01, 0.005, 0.03, NONE, 0.01]),
    ("thin-bars", [0.02, 0.001, 0.02, NONE, 0.02]),
    ("sizes", [0.01, 0.005, 0.05, NONE, 0.01]),
    ("large", [0.01, 0.005, 0.01, NONE, 0.01]),
    ("resize", SAME),
    ("there-and-back", SAME),
    ("again", SAME),
    ("drift-soak", SAME),
    ("cloud-peak", [NONE, NONE, NONE, 0.2, NONE]),
    ("memory", [100.0, 100.0, 100.0, NONE, 100.0]),
];

/// Where a row has none of its own.
const USUAL: [f64; 5] = [0.01, 0.005, 0.01, 0.15, 0.01];
/// The same bits.
const SAME: [f64; 5] = [0.0; 5];
/// Who is not in the row.
const NONE: f64 = f64::INFINITY;

/// What is promised of a column in a row at a value of its parameter.
pub(super) fn bound(row: &Row, column: &str, value: f64) -> Option<f64> {
    let index = PROMISED.iter().position(|promised| *promised == column)?;
    let bounds = BOUNDS.iter().find(|(id, _)| *id == row.id).map_or(&USUAL, |(_, bounds)| bounds);
    Some(bounds[index] * (row.law)(value)).filter(|bound| bound.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::rows;

    #[test]
    fn every_bound_is_of_a_row_and_every_row_has_one() {
        let rows = rows::all();
        for (id, _) in BOUNDS {
            assert!(rows.iter().any(|row| row.id == *id), "{id}");
        }
        for row in &rows {
            for value in row.parameter.values() {
                for entry in (row.methods)(value) {
                    let promised = PROMISED.contains(&entry.column);
                    assert_eq!(
                        bound(row, entry.column, value).is_some(),
                        promised,
                        "{} {}",
                        row.id,
                        entry.column
                    );
                }
            }
            assert!(row.quick.iter().all(|value| row.parameter.values().contains(value)), "{}", row.id);
        }
    }
}
