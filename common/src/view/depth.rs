//! What the values of a depth buffer mean.

/// How the depth of a perspective projection runs between its near and its far plane.
///
/// Distance along the viewing direction is `scale / (depth − offset)`, whatever the convention; only what an empty
/// pixel holds stands for infinitely far, also where there is a far plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthRange {
    /// Distance of the near plane along the viewing direction \[m\], more than 0.
    pub near: f32,
    /// Distance of the far plane \[m\], more than `near`; `f32::INFINITY` where there is none.
    pub far: f32,
    /// Reversed: 1 at the near plane, 0 where nothing is. Else standard: 0 at the near plane, 1 where nothing is.
    pub reversed: bool,
}

impl DepthRange {
    /// Reversed, without a far plane: what everything in this workspace draws for itself.
    pub const fn reversed(near: f32) -> Self {
        Self { near, far: f32::INFINITY, reversed: true }
    }

    /// Scale \[m\] and offset: distance = scale / (depth − offset). The scale is negative for standard depth.
    pub fn coefficients(&self) -> [f32; 2] {
        let (near, far) = (f64::from(self.near), f64::from(self.far));
        let share = if far.is_finite() { near / (far - near) } else { 0.0 };
        let [scale, offset] =
            if self.reversed { [near * (1.0 + share), -share] } else { [-near * (1.0 + share), 1.0 + share] };
        [scale as f32, offset as f32]
    }

    /// What a pixel holds where nothing is: what the buffer is cleared to.
    pub const fn empty(&self) -> f32 {
        if self.reversed { 0.0 } else { 1.0 }
    }

    /// Distance along the viewing direction \[m\] that a stored depth stands for; infinite where nothing is. Twin
    /// of WGSL `view_distance`, but for the ray's direction.
    pub fn distance(&self, depth: f32) -> f32 {
        let [scale, offset] = self.coefficients();
        let empty = if scale > 0.0 { depth <= 0.0 } else { depth >= 1.0 };
        if empty { f32::INFINITY } else { scale / (depth - offset) }
    }

    /// Depth that is stored for a distance along the viewing direction \[m\]: the inverse.
    pub fn depth(&self, distance: f32) -> f32 {
        let [scale, offset] = self.coefficients();
        offset + scale / distance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_are_those_of_the_planes() {
        let range = |far, reversed| DepthRange { near: 0.1, far, reversed };
        for (range, at_near, at_far) in [
            (range(50.0, false), 0.0, 1.0),
            (range(f32::INFINITY, false), 0.0, 1.0),
            (range(50.0, true), 1.0, 0.0),
            (DepthRange::reversed(0.1), 1.0, 0.0),
        ] {
            assert!((range.depth(0.1) - at_near).abs() < 1e-6, "{range:?}");
            assert!((range.depth(range.far) - at_far).abs() < 1e-6, "{range:?}");
            assert_eq!(range.empty(), at_far);
            assert_eq!(range.distance(range.empty()), f32::INFINITY, "{range:?}");
            for distance in [0.1, 0.3, 7.0, 49.0] {
                let back = range.distance(range.depth(distance));
                // Standard depth has used most of its digits up by then.
                assert!((back / distance - 1.0).abs() < 1e-6 * distance / 0.1, "{range:?}: {back}");
            }
        }
    }
}
