//! Where each known failure is looked at: in rows of the atlas, in a crate's tests, in a paper's results.

/// A failure and the places where it is provoked and measured: ids of rows, files of tests, commands.
type Failure = (&'static str, &'static [&'static str]);

/// Known failures by technique.
pub(super) const FAILURES: &[(&str, &[Failure])] = &[
    (
        "biri-ss",
        &[
            ("light on a view ray, h → 0", &["light-near-ray", "biri-ss/tests/failures.rs"]),
            ("range of the arc tangent's table", &["biri-ss/tests/table.rs", "harness papers biri"]),
            (
                "Γ(γ_P) − Γ(γ_O) cancels for far lights behind short rays",
                &["light-around-eye", "biri-ss/tests/failures.rs"],
            ),
            ("domain of the Γ table", &["optical-thickness", "coloured"]),
            ("resolution of tables, peaked phase functions", &["peak", "biri-ss/tests/failures.rs"]),
            ("tables of 8 and 16 bits", &["biri-ss/tests/failures.rs"]),
            ("eye in a shadow", &["eye-across-shadow", "closed"]),
            ("near plane cuts caps and planes", &["near-plane", "eye-across-shadow"]),
            ("stencil of 8 bits", &["stacked", "stacked-aside", "biri-ss/tests/failures.rs"]),
            (
                "shadows in shadows, planes that cross or chase each other",
                &["casters", "crossings", "harness papers biri"],
            ),
            ("order that changes from frame to frame", &["drift", "again", "there-and-back"]),
            ("open, non-manifold, flipped casters", &["casters", "biri-ss/tests/render.rs"]),
            ("silhouettes that pop", &["drift", "turning-sun"]),
            ("planes that touch surfaces", &["grazed", "near-plane"]),
            ("fill rate behind a grating", &["crossings", "harness --study edges"]),
            ("indirect light knows no walls", &["biri-ss/tests/render.rs", "harness papers biri"]),
        ],
    ),
    (
        "billeter-plv",
        &[
            ("signed sums of 16 bits", &["crossings", "formats", "billeter-plv/tests/failures.rs"]),
            ("hidden mesh has to cancel", &["closed", "thin-wall"]),
            ("order of blending", &["again", "drift-soak"]),
            ("leaks of the shadow map's resolution", &["shadow-map", "thin-bars", "plain-sun"]),
            ("walls at depth edges", &["shadow-map", "harness --improvements"]),
            ("mesh in a surface", &["grazed"]),
            ("bias", &["thin-wall", "light-on-surface"]),
            ("cracks between levels", &["large", "billeter-plv/tests/failures.rs"]),
            (
                "closing of the frustum, wide cones, seams of cubes",
                &["spot-angle", "eye-in-apex", "billeter-plv/tests/render.rs"],
            ),
            ("eye inside, near plane", &["eye-across-shadow", "near-plane", "eye-outside"]),
            ("table's domain, sign at 0", &["optical-thickness", "scale", "billeter-plv/tests/airlight.rs"]),
            ("zero foot distance", &["light-near-ray", "light-at-eye", "billeter-plv/tests/render.rs"]),
            ("shimmer under a moving light", &["drift", "turning-sun"]),
            ("overdraw, many lights", &["lights", "harness --study lights"]),
            ("table against a simpler one of the same bytes", &["billeter-plv/tests/airlight.rs"]),
        ],
    ),
    (
        "chen-planes",
        &[
            ("bands near a light", &["between-planes", "chen-planes/tests/failures.rs"]),
            ("interpolation of 1/r²", &["chen-planes/tests/failures.rs"]),
            ("light on and between planes", &["between-planes", "light-near-ray"]),
            ("shadows at lattice points", &["lattice", "chen-planes/tests/failures.rs"]),
            ("edges along a ray", &["samples", "harness papers chen"]),
            ("constant step off axis", &["chen-planes/tests/failures.rs"]),
            ("planes cut by geometry", &["chen-planes/tests/failures.rs"]),
            ("sums of 8 and 16 bits", &["formats", "chen-planes/tests/failures.rs"]),
            ("swimming under a moving eye", &["dolly"]),
            ("light maps and depth maps of few texels", &["shadow-map", "harness papers chen"]),
            ("far range", &["eye-outside", "far-thing", "plain"]),
            ("peak between planes", &["peak", "chen-planes/tests/failures.rs"]),
        ],
    ),
    (
        "szk-network",
        &[
            ("divergence", &["cloud-peak", "szk-network/tests/twin.rs", "harness papers szk"]),
            ("albedo near 1", &["cloud-albedo", "szk-network/tests/twin.rs"]),
            ("energy", &["cloud-albedo", "szk-network/tests/twin.rs"]),
            ("windows too fine and too coarse", &["cloud-window", "szk-network/tests/twin.rs"]),
            (
                "few directions, aliasing of a moving light",
                &["cloud-directions", "cloud-there-and-back", "szk-network/tests/failures.rs"],
            ),
            ("light inside and near", &["cloud-lamp", "szk-network/tests/render.rs"]),
            ("one step a frame", &["cloud-there-and-back", "harness papers szk"]),
            ("few particles", &["cloud-particles", "szk-network/tests/render.rs"]),
            ("indices in 16 bits", &["szk-network/tests/failures.rs"]),
            ("eye between directions, inside", &["cloud-eye", "szk-network/tests/render.rs"]),
            ("transparency of splats", &["cloud-thickness", "szk-network/tests/failures.rs"]),
            ("known solutions, seeds", &["szk-network/tests/twin.rs", "szk-network/tests/failures.rs"]),
            ("cost of N and D", &["harness papers szk"]),
        ],
    ),
    (
        "all",
        &[
            ("marching: bands, thin casters, noise", &["samples", "thin-bars", "between-planes"]),
            ("froxels: blurred edges, leaks, thin volumes", &["thin-wall", "closed", "samples", "dolly"]),
            ("shadow maps: acne, leaks, seams", &["grazed", "thin-wall", "spot-angle", "shadow-map"]),
            (
                "optical depth, albedo, phase function, colour",
                &["optical-thickness", "optical-thickness-sun", "albedo", "peak", "coloured"],
            ),
            ("scale and place", &["scale", "shift", "plain", "far-thing"]),
            ("targets of 16 and 32 bits", &["formats", "dazzling", "brightness"]),
            ("many lights", &["lights"]),
            ("light at the eye, behind a wall, on geometry", &["light-at-eye", "light-on-surface", "closed"]),
            ("nothing to draw", &["nothing"]),
            ("resize, one pixel, many pixels", &["resize", "sizes", "large"]),
            ("a thousand frames, two runs", &["drift-soak", "memory", "again", "there-and-back"]),
        ],
    ),
];

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::stability::rows;

    #[test]
    fn every_place_exists_and_every_row_is_for_something() {
        let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let ids: Vec<&str> = rows::all().iter().map(|row| row.id).collect();
        let places: Vec<&str> =
            FAILURES.iter().flat_map(|(_, all)| *all).flat_map(|(_, places)| *places).copied().collect();
        for place in &places {
            let there = match place {
                file if file.ends_with(".rs") => workspace.join(file).is_file(),
                command if command.starts_with("harness") => true,
                id => ids.contains(id),
            };
            assert!(there, "{place}");
        }
        let unused: Vec<&&str> =
            ids.iter().filter(|id| !places.contains(id) && !id.starts_with("cloud")).collect();
        // What no list of failures names is looked at all the same.
        assert!(unused.is_empty() || unused.iter().all(|id| ["sun-grazing"].contains(*id)), "{unused:?}");
    }
}
