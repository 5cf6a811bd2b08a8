//! All rows of the atlas, part by part.

mod casters;
mod clouds;
mod light;
mod load;
mod medium;
mod motion;
mod scale;
mod settings;
mod shadows;

use super::row::Row;

/// All rows, in order.
pub(crate) fn all() -> Vec<Row> {
    [
        light::rows(),
        medium::rows(),
        scale::rows(),
        shadows::rows(),
        casters::rows(),
        load::rows(),
        motion::rows(),
        clouds::rows(),
        settings::rows(),
    ]
    .into_iter()
    .flatten()
    .collect()
}
