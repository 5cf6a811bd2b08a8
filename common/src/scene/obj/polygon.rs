//! Cutting concave polygons into triangles.

use glam::DVec3;

/// Most corners of a polygon that is cut with care; the work grows faster than their number.
const MAX_CORNERS: usize = 64;

/// Corners of the triangles of a concave polygon, by ear clipping; `None` where a fan around corner
/// 0 is as good: for convex polygons, and for those that are too odd or too large to be cut.
pub(super) fn cut_concave(points: &[DVec3]) -> Option<Vec<[usize; 3]>> {
    let count = points.len();
    if !(4..=MAX_CORNERS).contains(&count) || !points.iter().all(|p| p.is_finite()) {
        return None;
    }
    // Newell's normal: twice the vector area.
    let from = points[0];
    let normal: DVec3 = (1..count - 1).map(|i| (points[i] - from).cross(points[i + 1] - from)).sum();
    let area = normal.length();
    let turn = |a: usize, b: usize, c: usize| {
        (points[b] - points[a]).cross(points[c] - points[b]).dot(normal) / area
    };
    let tolerance = 1e-6 * area;
    let is_convex = (0..count).all(|i| turn(i, (i + 1) % count, (i + 2) % count) >= -tolerance);
    if !area.is_normal() || is_convex {
        return None;
    }

    // Clip one ear after the other: a convex corner whose triangle holds no other corner.
    let mut left: Vec<usize> = (0..count).collect();
    let mut triangles = Vec::with_capacity(count - 2);
    while left.len() > 3 {
        let ear = (0..left.len()).find(|&i| {
            let [a, b, c] = around(&left, i);
            turn(a, b, c) > tolerance
                && !left.iter().any(|&p| {
                    ![a, b, c].contains(&p)
                        && turn(a, b, p) >= 0.0
                        && turn(b, c, p) >= 0.0
                        && turn(c, a, p) >= 0.0
                })
        })?;
        triangles.push(around(&left, ear));
        left.remove(ear);
    }
    triangles.push([left[0], left[1], left[2]]);
    Some(triangles)
}

/// The corner before, at and after `i`.
fn around(left: &[usize], i: usize) -> [usize; 3] {
    let count = left.len();
    [left[(i + count - 1) % count], left[i], left[(i + 1) % count]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[DVec3], triangles: &[[usize; 3]]) -> f64 {
        let each = |&[a, b, c]: &[usize; 3]| 0.5 * (points[b] - points[a]).cross(points[c] - points[a]).z;
        assert!(triangles.iter().all(|t| each(t) > -1e-12), "every triangle faces the polygon's way");
        triangles.iter().map(each).sum()
    }

    #[test]
    fn an_l_is_cut_into_its_area_and_a_square_is_left_alone() {
        let l = [(0., 0.), (2., 0.), (2., 1.), (1., 1.), (1., 2.), (0., 2.)];
        // From every first corner, as a fan from some of them would be right by luck.
        for first in 0..l.len() {
            let points: Vec<DVec3> =
                (0..l.len()).map(|i| l[(i + first) % l.len()]).map(|(x, y)| DVec3::new(x, y, 0.)).collect();
            let triangles = cut_concave(&points).expect("an L is concave");
            assert_eq!(triangles.len(), 4);
            assert!((area(&points, &triangles) - 3.0).abs() < 1e-12);
        }
        let square = [(0., 0.), (1., 0.), (1., 1.), (0., 1.)].map(|(x, y)| DVec3::new(x, y, 0.));
        assert_eq!(cut_concave(&square), None);
        assert_eq!(cut_concave(&[DVec3::ZERO; 5]), None);
    }
}
