//! Each light's part of a picture by itself, with and without shadows in the air.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use rayon::prelude::*;

use super::surface::{Place, shade};
use super::{Error, Rays, Reference, check_view};
use crate::image::Image;
use crate::{Medium, View};

/// What one light adds to a picture; linear radiance \[W m⁻² sr⁻¹\].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ByLight {
    /// The term `surface`.
    pub surface: Image,
    /// The term `airlight`.
    pub airlight: Image,
    /// The airlight up to the same surfaces if nothing threw a shadow into the air.
    pub unshadowed: Image,
}

impl Reference {
    /// The same scene in another medium: nothing is built anew.
    #[must_use]
    pub(crate) fn in_medium(self, medium: Medium) -> Self {
        Self { medium, ..self }
    }

    /// The picture taken apart by lights, in the scene's order. The sums over the lights are the terms `surface` and
    /// `airlight` of [`Reference::render`]. `cancel` is looked at before every row. Not of a cloud, which lights and
    /// shadows itself.
    pub(crate) fn by_light(&self, view: &View, cancel: &AtomicBool) -> Result<Vec<ByLight>, Error> {
        check_view(view)?;
        if self.cloud.is_some() {
            return Err(Error::Scene("a cloud's light comes from paths, not light by light".into()));
        }
        let (rays, optics) = (Rays::new(view), self.optics());
        let foggy = optics.sigma_s != DVec3::ZERO;
        let rows = (0..view.height)
            .into_par_iter()
            .map_init(
                || self.scratch(),
                |scratch, y| {
                    if cancel.load(Ordering::Relaxed) {
                        return Err(Error::Cancelled);
                    }
                    let mut row = Vec::with_capacity(view.width as usize * self.sources.len());
                    for x in 0..view.width {
                        let ray = rays.through(x, y);
                        let [eye, direction] = ray;
                        let hit =
                            self.geometry.nearest(&mut scratch.stack, eye, direction, [0.0, f64::INFINITY]);
                        let end = hit.as_ref().map_or(f64::INFINITY, |hit| hit.distance);
                        let place =
                            hit.and_then(|hit| Place::new(&self.geometry, &self.materials, ray, &hit));
                        for source in &self.sources {
                            let one = std::slice::from_ref(source);
                            let surface = place.as_ref().map_or(DVec3::ZERO, |place| {
                                shade(&self.geometry, one, &optics, place, end, &mut scratch.stack)
                            });
                            let (mut airlight, mut unshadowed) = (DVec3::ZERO, DVec3::ZERO);
                            if foggy {
                                let tolerance = self.options.tolerance;
                                airlight =
                                    source.airlight(&self.geometry, &optics, ray, end, tolerance, scratch);
                                unshadowed = source.integrate(&optics, ray, &[[0.0, end]], tolerance);
                            }
                            row.push([surface, airlight, unshadowed].map(|term| term.as_vec3()));
                        }
                    }
                    Ok(row)
                },
            )
            .collect::<Result<Vec<_>, _>>()?;
        let count = self.sources.len();
        let picture = |light: usize, term: usize| Image {
            width: view.width,
            height: view.height,
            pixels: rows
                .iter()
                .flat_map(|row| row.iter().skip(light).step_by(count))
                .map(|terms| terms[term])
                .collect(),
        };
        Ok((0..count)
            .map(|light| ByLight {
                surface: picture(light, 0),
                airlight: picture(light, 1),
                unshadowed: picture(light, 2),
            })
            .collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;
    use crate::{Terms, metrics};

    #[test]
    fn lights_add_up_to_the_whole() {
        let scene = builtin::build("amphora", Some(1000)).unwrap();
        let view = scene.camera.view(24, 20);
        let reference = Reference::new(&scene).unwrap();
        let never = AtomicBool::new(false);
        let whole = reference.render(&view, Terms::DIRECT, &|_| (), &never).unwrap();
        let lights = reference.by_light(&view, &never).unwrap();
        assert_eq!(lights.len(), scene.lights.len());
        let sum = |of: fn(&ByLight) -> &Image| {
            lights.iter().map(of).cloned().reduce(|sum, one| sum.plus(&one)).unwrap()
        };
        let off = |image: &Image, of: &Option<Image>| {
            metrics::compare(image, of.as_ref().unwrap()).unwrap().rel_rmse
        };
        assert!(off(&sum(|light| &light.airlight), &whole.airlight) < 1e-6);
        assert!(off(&sum(|light| &light.surface), &whole.surface) < 1e-6);
        // Shadows only take light away, and here they take some.
        let pairs = lights.iter().flat_map(|l| l.airlight.pixels.iter().zip(&l.unshadowed.pixels));
        assert!(pairs.clone().all(|(with, without)| (*without - *with).min_element() > -1e-6));
        assert!(pairs.clone().any(|(with, without)| with.y < 0.5 * without.y));
    }
}
