//! The refinement pattern: one lattice for all planes, made once.

/// Points (u, v) in [0, 1]², row by row: equations (7) and (8) of the paper, which the vertex shader inverts by (9).
pub(crate) fn points([columns, rows]: [u32; 2]) -> Vec<[f32; 2]> {
    let at = |i: u32, points: u32| i as f32 / (points - 1) as f32;
    (0..rows).flat_map(|v| (0..columns).map(move |u| [at(u, columns), at(v, rows)])).collect()
}

/// Two triangles for each cell.
pub(crate) fn triangles([columns, rows]: [u32; 2]) -> Vec<u32> {
    let cell = |u: u32, v: u32| {
        let a = v * columns + u;
        let (b, c, d) = (a + 1, a + columns, a + columns + 1);
        [a, b, c, c, b, d]
    };
    (0..rows - 1).flat_map(|v| (0..columns - 1).flat_map(move |u| cell(u, v))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_tile_the_unit_square() {
        for lattice in [[2, 2], [5, 3], [32, 32]] {
            let points = points(lattice);
            let area: f32 = triangles(lattice)
                .chunks_exact(3)
                .map(|corners| {
                    let [a, b, c] = [corners[0], corners[1], corners[2]].map(|i| points[i as usize]);
                    // Signed: all the same way round.
                    0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]))
                })
                .sum();
            assert!((area - 1.0).abs() < 1e-5, "{area}");
            assert_eq!(points.len(), (lattice[0] * lattice[1]) as usize);
        }
    }
}
