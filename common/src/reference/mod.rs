//! The CPU reference: pictures that techniques are judged by, and how sure it is of them.
//!
//! One ray per pixel centre, in f64. Terms:
//!
//! - **airlight**: direct single scattering with shadows. The lit intervals of a ray are found
//!   exactly (`shadow`), with no marching, and each is integrated adaptively in the angle at the
//!   light ([`crate::airlight`]). No noise, no step size.
//! - **surface**: direct light on the first surface, a closed form of one shadow ray per light.
//! - **indirect airlight**: light that the medium scatters once and that then lights the first
//!   surface, attenuated on its way to the eye, by one of two models ([`IndirectModel`]). The exact one
//!   integrates, over the directions above the surface, the very airlight of the first term along the
//!   ray from the surface to the next one, with all shadows, by a lattice of directions that is dense
//!   where the light is. The other takes the medium to have no bounds and nothing in it to cast a
//!   shadow, which is what tables can hold ([`crate::indirect`]); it has no spots, and its gloss counts
//!   what comes from below the horizon.
//!
//! - **multiple**: everything else that the medium has scattered, by paths ([`multiple`]). In a scene
//!   with a cloud all terms are of paths; their uncertainty is their standard error.
//!
//! The airlight is checked by a second method that shares neither the search for visibility nor
//! its plane geometry (`scan`): shadow rays on a stratified scan of some rays, each change of
//! visibility bisected. How far the two are apart is the reference's uncertainty. The indirect term
//! has one of its own: how far some pixels are from the same pixels by other directions.
//!
//! Assumptions: a homogeneous medium or a cloud, light of point, spot and directional sources (no area),
//! opaque surfaces without thickness, black where there is neither surface nor medium. A ray that
//! passes a light nearer than 1 µm is taken to pass it at 1 µm, because through the light itself
//! the radiance is infinite.

#[cfg(feature = "files")]
mod cache;
mod fan;
mod geometry;
mod indirect;
mod lights;
pub mod multiple;
mod scan;
mod seen;
mod shadow;
mod source;
mod surface;

use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::airlight::Optics;
use crate::image::Image;
use crate::scene::Material;
use crate::{Cloud, Light, Medium, Scene, Sky, Term, Terms, View};
use geometry::Geometry;
pub use indirect::IndirectModel;
use indirect::Unbounded;
pub(crate) use lights::ByLight;
use source::Source;
use surface::Place;

/// What can go wrong with a reference picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The scene can't be drawn; the text is a whole sentence.
    #[error("no reference picture: {0}")]
    Scene(String),
    /// The caller asked to stop.
    #[error("the reference picture was stopped before it was finished")]
    Cancelled,
}

/// Settings of the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Relative tolerance of every integral over a lit interval, above 0.
    pub tolerance: f64,
    /// Number of rays that the second method checks; fewer if there are fewer pixels.
    pub checked_rays: u32,
    /// Most strata that the second method divides a ray into, per light.
    pub scan_limit: u32,
    /// How indirect airlight is computed.
    pub indirect: IndirectModel,
    /// Which of the equally good choices of directions the exact model takes.
    pub seed: u64,
    /// The paths of the term `multiple` and, in a scene with a cloud, of all terms.
    pub multiple: multiple::Options,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            tolerance: 1e-6,
            checked_rays: 512,
            scan_limit: 4096,
            indirect: IndirectModel::default(),
            seed: 0,
            multiple: multiple::Options::default(),
        }
    }
}

/// A finished reference picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendered {
    /// The term `surface` \[W m⁻² sr⁻¹\] as all of them; `None` if it was not asked for.
    pub surface: Option<Image>,
    /// The term `airlight`; `None` if it was not asked for.
    pub airlight: Option<Image>,
    /// The term `indirect_airlight`; `None` if it was not asked for.
    pub indirect_airlight: Option<Image>,
    /// The term `multiple`; `None` if it was not asked for.
    pub multiple: Option<Image>,
    /// Relative RMS error that surface and airlight may have: difference of the two methods over the
    /// checked rays, relative to the mean airlight there, and never less than the tolerance of the
    /// integrals (airlight) or the rounding of the stored numbers (surface). In a scene with a cloud
    /// the standard error of surface, airlight and indirect airlight together.
    pub uncertainty: f64,
    /// Relative RMS error that the indirect airlight may have: of the exact model the difference from
    /// other directions over some pixels, relative to the mean there, of the other the error of its
    /// tables; 0 if the term was not asked for.
    pub indirect_uncertainty: f64,
    /// Relative RMS standard error of the term `multiple`; 0 if it was not asked for.
    pub multiple_uncertainty: f64,
    /// Number of rays that the second method checked.
    pub checked_rays: u32,
    /// Time that it took to compute \[s\], when it was computed.
    pub seconds: f64,
    /// Whether it came from the cache (`Reference::render_cached`, feature `files`).
    pub cached: bool,
    /// Why the picture could not be put into the cache; `None` if it could, or was not to be.
    pub cache_problem: Option<String>,
}

impl Rendered {
    /// The sum of the terms.
    ///
    /// # Panics
    /// When there is no term at all, which [`Reference::render`] never returns.
    pub fn total(&self) -> Image {
        let terms = [&self.surface, &self.airlight, &self.indirect_airlight, &self.multiple];
        let total = terms.into_iter().flatten().cloned().reduce(|sum, term| sum.plus(&term));
        total.expect("a picture has a term")
    }
}

/// A scene, made ready for rays.
pub struct Reference {
    geometry: Geometry,
    sources: Vec<Source>,
    #[cfg_attr(
        not(feature = "files"),
        expect(dead_code, reason = "what the cache on disk knows a picture by")
    )]
    lights: Vec<Light>,
    materials: Vec<Material>,
    medium: Medium,
    cloud: Option<Cloud>,
    sky: Sky,
    options: Options,
}

/// Room that a thread works in.
struct Scratch {
    stack: Vec<u32>,
    shadows: Vec<[f64; 2]>,
    lit: Vec<[f64; 2]>,
}

/// One pixel of each term.
#[derive(Clone, Copy, Default)]
struct Pixel {
    surface: DVec3,
    airlight: DVec3,
    indirect: DVec3,
}

impl Reference {
    /// Builds the acceleration structure. What moves has to be in its place ([`Scene::at`]).
    ///
    /// # Errors
    /// [`Error::Scene`], for a scene that has something wrong with it ([`Scene::problem`]).
    pub fn new(scene: &Scene) -> Result<Self, Error> {
        Self::with_options(scene, Options::default())
    }

    /// As [`Reference::new`], with settings.
    ///
    /// # Errors
    /// As [`Reference::new`].
    pub fn with_options(scene: &Scene, options: Options) -> Result<Self, Error> {
        if let Some(problem) = scene.problem() {
            return Err(Error::Scene(problem));
        }
        if let Some(problem) = multiple::problem(scene) {
            return Err(Error::Scene(problem));
        }
        let triangles = scene.world_triangles();
        if triangles.iter().flat_map(|triangle| triangle.positions).any(|p| !p.is_finite()) {
            return Err(Error::Scene("a triangle has a corner that is not a finite number".into()));
        }
        Ok(Self {
            geometry: Geometry::new(triangles),
            sources: scene.lights.iter().map(Source::new).collect(),
            lights: scene.lights.clone(),
            materials: scene.materials.clone(),
            medium: scene.medium.clone(),
            cloud: scene.cloud.clone(),
            sky: scene.sky.clone(),
            options,
        })
    }

    /// Draws the asked terms. `progress` is told the finished fraction, in [0, 1], from any thread; `cancel`
    /// is looked at before every pixel.
    ///
    /// # Errors
    /// [`Error::Scene`], without a term and for a view that is not valid; [`Error::Cancelled`] once `cancel` is set.
    pub fn render(
        &self,
        view: &View,
        terms: Terms,
        progress: &(dyn Fn(f32) + Sync),
        cancel: &AtomicBool,
    ) -> Result<Rendered, Error> {
        if terms.is_empty() {
            return Err(Error::Scene("no term of light transport was asked for".into()));
        }
        check_view(view)?;
        let started = std::time::Instant::now();
        if self.cloud.is_some() {
            let mut rendered = self.by_paths(view, terms, progress, cancel)?;
            rendered.seconds = started.elapsed().as_secs_f64();
            return Ok(rendered);
        }
        // Paths take most of the time where there are any.
        let (paths, rest) = if terms.contains(Term::Multiple) { (0.8, 0.2) } else { (0.0, 1.0) };
        let multiple = match terms.contains(Term::Multiple) {
            true => Some(self.paths(view, &self.options.multiple, &|done| progress(paths * done), cancel)?),
            false => None,
        };
        let progress = &|done: f32| progress(paths + rest * done);
        let unbounded = match self.options.indirect {
            IndirectModel::Unbounded if terms.contains(Term::IndirectAirlight) => {
                Some(Unbounded::new(&self.sources, &self.materials, &self.medium.phase)?)
            }
            _ => None,
        };
        let rays = Rays::new(view);
        let done = AtomicU32::new(0);
        let rows: Vec<Vec<Pixel>> = (0..view.height)
            .into_par_iter()
            .map_init(
                || self.scratch(),
                |scratch, y| {
                    let row = (0..view.width)
                        .map(|x| {
                            if cancel.load(Ordering::Relaxed) {
                                return Err(Error::Cancelled);
                            }
                            let pattern = self.pattern(&rays, [x, y], 0);
                            Ok(self.pixel(rays.through(x, y), terms, unbounded.as_ref(), pattern, scratch))
                        })
                        .collect::<Result<_, _>>()?;
                    // The last tenth is the check.
                    let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                    progress(0.9 * done as f32 / view.height as f32);
                    Ok(row)
                },
            )
            .collect::<Result<_, _>>()?;
        let pixels = || rows.iter().flatten();
        let picture = |of: fn(&Pixel) -> DVec3| Image {
            width: view.width,
            height: view.height,
            pixels: pixels().map(|pixel| of(pixel).as_vec3()).collect(),
        };
        let mut rendered = Rendered {
            surface: terms.contains(Term::Surface).then(|| picture(|pixel| pixel.surface)),
            airlight: terms.contains(Term::Airlight).then(|| picture(|pixel| pixel.airlight)),
            indirect_airlight: terms
                .contains(Term::IndirectAirlight)
                .then(|| picture(|pixel| pixel.indirect)),
            multiple_uncertainty: multiple
                .as_ref()
                .map_or(0.0, |paths| multiple::relative(&paths.multiple_error, &paths.multiple)),
            multiple: multiple.map(|paths| paths.multiple),
            uncertainty: f64::from(f32::EPSILON),
            indirect_uncertainty: 0.0,
            checked_rays: 0,
            seconds: 0.0,
            cached: false,
            cache_problem: None,
        };
        if terms.contains(Term::Airlight) {
            let check = scan::check(self, &rays, &rows, cancel)?;
            rendered.uncertainty = check.difference.max(self.options.tolerance);
            rendered.checked_rays = check.rays;
        }
        if terms.contains(Term::IndirectAirlight) {
            rendered.indirect_uncertainty = match self.options.indirect {
                IndirectModel::Exact { .. } => indirect::check(self, &rays, &rows, cancel)?,
                IndirectModel::Unbounded => crate::indirect::Table::ERROR,
            };
        }
        progress(1.0);
        rendered.seconds = started.elapsed().as_secs_f64();
        Ok(rendered)
    }

    /// Every term of a scene with a cloud comes from paths.
    fn by_paths(
        &self,
        view: &View,
        terms: Terms,
        progress: &(dyn Fn(f32) + Sync),
        cancel: &AtomicBool,
    ) -> Result<Rendered, Error> {
        let paths = self.paths(view, &self.options.multiple, progress, cancel)?;
        let direct = paths.surface.plus(&paths.airlight).plus(&paths.indirect_airlight);
        let wanted = |term, image| terms.contains(term).then_some(image);
        let error = |wanted: bool, error, of| if wanted { multiple::relative(error, of) } else { 0.0 };
        Ok(Rendered {
            uncertainty: error(terms != Term::Multiple.into(), &paths.direct_error, &direct)
                .max(f64::from(f32::EPSILON)),
            indirect_uncertainty: error(terms.contains(Term::IndirectAirlight), &paths.direct_error, &direct),
            multiple_uncertainty: error(
                terms.contains(Term::Multiple),
                &paths.multiple_error,
                &paths.multiple,
            ),
            surface: wanted(Term::Surface, paths.surface),
            airlight: wanted(Term::Airlight, paths.airlight),
            indirect_airlight: wanted(Term::IndirectAirlight, paths.indirect_airlight),
            multiple: wanted(Term::Multiple, paths.multiple),
            checked_rays: 0,
            seconds: 0.0,
            cached: false,
            cache_problem: None,
        })
    }

    fn scratch(&self) -> Scratch {
        Scratch { stack: self.geometry.stack(), shadows: Vec::new(), lit: Vec::new() }
    }

    fn optics(&self) -> Optics<'_> {
        // The sum in f64: the f32 sum of the medium's own method would be rounded.
        let sigma_s = self.medium.sigma_s.as_dvec3();
        Optics { sigma_t: sigma_s + self.medium.sigma_a.as_dvec3(), sigma_s, phase: &self.medium.phase }
    }

    fn pixel(
        &self,
        ray: [DVec3; 2],
        terms: Terms,
        unbounded: Option<&Unbounded>,
        pattern: u64,
        scratch: &mut Scratch,
    ) -> Pixel {
        let [eye, direction] = ray;
        let optics = self.optics();
        let hit = self.geometry.nearest(&mut scratch.stack, eye, direction, [0.0, f64::INFINITY]);
        let mut pixel = Pixel::default();
        if terms.contains(Term::Airlight) && optics.sigma_s != DVec3::ZERO {
            let end = hit.map_or(f64::INFINITY, |hit| hit.distance);
            pixel.airlight = self
                .sources
                .iter()
                .map(|source| {
                    source.airlight(&self.geometry, &optics, ray, end, self.options.tolerance, scratch)
                })
                .sum();
        }
        let Some(hit) = hit else {
            return pixel;
        };
        let Some(place) = Place::new(&self.geometry, &self.materials, ray, &hit) else {
            return pixel;
        };
        if terms.contains(Term::Surface) {
            let Self { geometry, sources, .. } = self;
            pixel.surface =
                surface::shade(geometry, sources, &optics, &place, hit.distance, &mut scratch.stack);
        }
        if terms.contains(Term::IndirectAirlight) && optics.sigma_s != DVec3::ZERO {
            let lit = match (self.options.indirect, unbounded) {
                (_, Some(unbounded)) => unbounded.reflected(&self.sources, &optics, &place),
                (IndirectModel::Exact { directions }, None) => {
                    self.indirect(&place, directions, pattern, scratch)
                }
                (IndirectModel::Unbounded, None) => DVec3::ZERO,
            };
            pixel.indirect = lit * (-optics.sigma_t * hit.distance).exp();
        }
        pixel
    }
}

fn check_view(view: &View) -> Result<(), Error> {
    if let Some(problem) = view.camera.problem() {
        return Err(Error::Scene(format!("the camera {problem}")));
    }
    if view.width == 0 || view.height == 0 {
        return Err(Error::Scene("the picture has no pixels".into()));
    }
    Ok(())
}

/// The rays through a view's pixel centres: [`View::ray_direction`] in f64.
struct Rays {
    eye: DVec3,
    corner: DVec3,
    right: DVec3,
    down: DVec3,
    width: u32,
    height: u32,
}

impl Rays {
    fn new(view: &View) -> Self {
        let camera = &view.camera;
        let wide = Vec3::as_dvec3;
        let forward = (wide(camera.target) - wide(camera.eye)).normalize();
        let right = forward.cross(wide(camera.up)).normalize();
        let up = right.cross(forward);
        let (width, height) = (f64::from(view.width), f64::from(view.height));
        let half_y = (0.5 * f64::from(camera.fov_y)).tan();
        let half_x = half_y * width / height;
        let (right, down) = (right * (2.0 * half_x / width), -up * (2.0 * half_y / height));
        let corner = forward - (0.5 * width - 0.5) * right - (0.5 * height - 0.5) * down;
        Self { eye: wide(camera.eye), corner, right, down, width: view.width, height: view.height }
    }

    /// Eye and unit direction of the ray through the centre of pixel (`x`, `y`).
    fn through(&self, x: u32, y: u32) -> [DVec3; 2] {
        let direction = self.corner + f64::from(x) * self.right + f64::from(y) * self.down;
        [self.eye, direction.normalize()]
    }
}
