//! Airlight up to what a depth buffer holds.
//!
//! A rasteriser rounds corners to a fraction of a pixel, so at edges it now and then sees another surface than
//! the ray through the pixel's centre does. Who is given its depth buffer integrates to that surface.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::{Error, Rays, Reference, check_view};
use crate::View;
use crate::image::Image;

/// Distances that differ by less than this, relative, are of one surface: single-precision depth is a
/// thousand times as precise.
const SAME: f64 = 1e-3;

impl Reference {
    /// `airlight`, this reference's own picture of `view`, drawn again where the depth buffer ends the ray at
    /// another surface; and the number of those pixels. `distances` \[m\] go from the eye, along the ray of each pixel, row
    /// by row from the top, infinite where nothing is seen ([`View::distance`]).
    ///
    /// # Errors
    /// [`Error::Scene`], for a view that is not valid and for a scene with a cloud; [`Error::Cancelled`] once `cancel` is set.
    ///
    /// # Panics
    /// When picture or distances are not of the view's size.
    pub fn airlight_as_seen(
        &self,
        view: &View,
        airlight: &Image,
        distances: &[f32],
        cancel: &AtomicBool,
    ) -> Result<(Image, usize), Error> {
        check_view(view)?;
        if self.cloud.is_some() {
            return Err(Error::Scene(
                "airlight of a cloud comes from paths and has no ends to change".into(),
            ));
        }
        let pixels = view.width as usize * view.height as usize;
        assert_eq!((airlight.width, airlight.height), (view.width, view.height), "of one size");
        assert_eq!(distances.len(), pixels, "a distance for each pixel");
        let rays = Rays::new(view);
        let optics = self.optics();
        let again = (0..pixels)
            .into_par_iter()
            .map_init(
                || self.scratch(),
                |scratch, index| {
                    if cancel.load(Ordering::Relaxed) {
                        return Err(Error::Cancelled);
                    }
                    let ray = rays.through(index as u32 % view.width, index as u32 / view.width);
                    let [eye, direction] = ray;
                    let hit = self.geometry.nearest(&mut scratch.stack, eye, direction, [0.0, f64::INFINITY]);
                    let own = hit.map_or(f64::INFINITY, |hit| hit.distance);
                    let seen = f64::from(distances[index]);
                    if own == seen || (own - seen).abs() <= SAME * own.min(seen) {
                        return Ok(None);
                    }
                    let tolerance = self.options.tolerance;
                    let of = |source: &super::Source| {
                        source.airlight(&self.geometry, &optics, ray, seen, tolerance, scratch)
                    };
                    Ok(Some(self.sources.iter().map(of).sum::<glam::DVec3>().as_vec3()))
                },
            )
            .collect::<Result<Vec<_>, _>>()?;
        let mut picture = airlight.clone();
        for (pixel, again) in picture.pixels.iter_mut().zip(&again) {
            *pixel = again.unwrap_or(*pixel);
        }
        Ok((picture, again.iter().flatten().count()))
    }
}
