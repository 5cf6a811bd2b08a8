//! The shadow planes of one light, from frame to frame: only what moved is found anew.

use std::collections::HashMap;
use std::sync::Arc;

use common::scene::{Mesh, Object};
use glam::{Affine3A, DAffine3, DVec3, Vec3};
use rayon::prelude::*;

use crate::bsp::{Bsp, Piece};
use crate::connectivity::Connectivity;
use crate::deepest::deepest;
use crate::order::{by_angle, violations};
use crate::silhouette::{Origin, Silhouette};
use crate::{Error, Order};

/// What a stencil of eight bits counts to.
pub(crate) const MOST_SHADOWS: u32 = 255;

/// Connectivity by mesh, found once for each.
#[derive(Default)]
pub(crate) struct Meshes {
    known: HashMap<*const Mesh, (Arc<Mesh>, Arc<Connectivity>)>,
}

// The pointers are names: what they point to is held by the `Arc` beside them.
impl Meshes {
    /// The connectivity of each caster's mesh; meshes that no caster has any longer are forgotten.
    pub(crate) fn of(&mut self, casters: &[Object]) -> Result<Vec<Arc<Connectivity>>, Error> {
        let mut new: Vec<&Arc<Mesh>> = casters.iter().map(|object| &object.mesh).collect();
        new.retain(|mesh| !self.known.contains_key(&Arc::as_ptr(mesh)));
        new.sort_by_key(|mesh| Arc::as_ptr(mesh));
        new.dedup_by_key(|mesh| Arc::as_ptr(mesh));
        for mesh in &new {
            if let Err(problem) = mesh.validate() {
                let index = casters.iter().position(|o| Arc::ptr_eq(&o.mesh, mesh)).unwrap_or(0);
                return Err(Error::Unsupported { what: "caster", index, why: format!("its mesh {problem}") });
            }
        }
        let found: Vec<_> = new.par_iter().map(|mesh| Arc::new(Connectivity::new(mesh))).collect();
        self.known.extend(new.into_iter().zip(found).map(|(mesh, c)| (Arc::as_ptr(mesh), (mesh.clone(), c))));
        let used: std::collections::HashSet<_> = casters.iter().map(|o| Arc::as_ptr(&o.mesh)).collect();
        self.known.retain(|mesh, _| used.contains(mesh));
        Ok(casters.iter().map(|object| self.known[&Arc::as_ptr(&object.mesh)].1.clone()).collect())
    }
}

/// One caster's part.
struct Cast {
    connectivity: Arc<Connectivity>,
    world_from_object: Affine3A,
    /// Light in object space.
    origin: Origin,
    silhouette: Silhouette,
    /// Ends in the world, and weight.
    edges: Vec<([Vec3; 2], u32)>,
}

impl Cast {
    fn new(connectivity: Arc<Connectivity>, world_from_object: Affine3A, origin: Origin) -> Self {
        let object_from_world = wide(world_from_object).inverse();
        let origin = origin.seen_from(&object_from_world);
        let silhouette = Silhouette::new(&connectivity, origin);
        let mirrored = world_from_object.matrix3.determinant() < 0.0;
        let at = |v: u32| world_from_object.transform_point3(connectivity.positions[v as usize]);
        let edges = silhouette.edges.iter().map(|edge| {
            let ends = [at(edge.from), at(edge.to)];
            (if mirrored { [ends[1], ends[0]] } else { ends }, edge.weight)
        });
        Self { edges: edges.collect(), connectivity, world_from_object, origin, silhouette }
    }

    fn is_of(&self, connectivity: &Arc<Connectivity>, place: Affine3A) -> bool {
        Arc::ptr_eq(&self.connectivity, connectivity) && self.world_from_object == place
    }

    fn depth_at(&self, eye: DVec3) -> u32 {
        let eye = wide(self.world_from_object).inverse().transform_point3(eye);
        self.silhouette.depth_at(&self.connectivity, self.origin, eye)
    }
}

fn wide(place: Affine3A) -> DAffine3 {
    DAffine3 { matrix3: place.matrix3.as_dmat3(), translation: place.translation.as_dvec3() }
}

/// What an eye needs of a light's shadow planes.
pub(crate) struct Walk {
    /// Indices of pieces in the order asked for.
    pub(crate) order: Vec<u32>,
    /// The eye, moved off planes that it would be in.
    pub(crate) eye: Vec3,
    /// In how many shadows the eye is.
    pub(crate) depth: u32,
}

/// The shadow planes of one light.
#[derive(Default)]
pub(crate) struct Shadows {
    origin: Origin,
    casts: Vec<Option<Cast>>,
    bsp: Option<Bsp>,
    whole: Vec<Piece>,
    edges: usize,
    deepest: u32,
}

impl Shadows {
    /// Brings everything up to date; says whether the pieces changed. Casters farther from the light than
    /// `reach` \[m\] are left out.
    pub(crate) fn update(
        &mut self,
        origin: Origin,
        casters: &[Object],
        meshes: &[Arc<Connectivity>],
        order: Order,
        reach: f64,
    ) -> bool {
        let old = std::mem::take(&mut self.casts);
        let same_light = self.origin == origin;
        self.origin = origin;
        let mut old = old.into_iter().map(|cast| cast.filter(|_| same_light)).collect::<Vec<_>>();
        let count = old.len();
        old.resize_with(casters.len(), || None);
        let mut changed = !same_light || count != casters.len();
        let updated: Vec<(Option<Cast>, bool)> = old
            .into_par_iter()
            .zip(casters.par_iter().zip(meshes))
            .map(|(cast, (object, mesh))| {
                let place = object.world_from_object;
                if distance(origin, mesh, place) > reach {
                    return (None, cast.is_some());
                }
                match cast {
                    Some(cast) if cast.is_of(mesh, place) => (Some(cast), false),
                    _ => (Some(Cast::new(mesh.clone(), place, origin)), true),
                }
            })
            .collect();
        changed |= updated.iter().any(|(_, changed)| *changed);
        self.casts = updated.into_iter().map(|(cast, _)| cast).collect();
        if changed {
            let edges: Vec<_> = self.casts.iter().flatten().flat_map(|cast| &cast.edges).copied().collect();
            self.edges = edges.len();
            self.bsp = (order == Order::Exact).then(|| Bsp::new(origin, &edges));
            self.whole =
                edges.iter().filter_map(|&(ends, weight)| Piece::new(origin, ends, weight)).collect();
            self.deepest = self.find_deepest();
        }
        changed
    }

    pub(crate) fn pieces(&self) -> &[Piece] {
        self.bsp.as_ref().map_or(&self.whole, |bsp| bsp.pieces())
    }

    /// The planes before they were split: they fit the caps exactly, corner by corner.
    pub(crate) fn whole(&self) -> &[Piece] {
        &self.whole
    }

    pub(crate) fn is_directional(&self) -> bool {
        self.origin.0.w == 0.0
    }

    /// Most shadows that any place is in, as far as that is looked for: 0 where there can't be many.
    pub(crate) fn deepest(&self) -> u32 {
        self.deepest
    }

    fn find_deepest(&self) -> u32 {
        // Along no axis of a scene.
        let pole = DVec3::new(0.301, 0.853, -0.427);
        let from = self.origin.0.truncate();
        let reach = |piece: &Piece| {
            (piece.from.as_dvec3() - from).length().max((piece.to.as_dvec3() - from).length())
        };
        let beyond = || {
            let farthest = self.whole.iter().map(reach).fold(0.0, f64::max);
            self.depth_at(from + 4.0 * farthest * pole.normalize())
        };
        deepest(self.origin, &self.whole, pole, beyond, MOST_SHADOWS)
    }

    /// Shadows that a place is in.
    pub(crate) fn depth_at(&self, place: DVec3) -> u32 {
        self.casts.par_iter().flatten().map(|cast| cast.depth_at(place)).sum()
    }

    /// Silhouette edges, whatever their weight.
    pub(crate) fn edges(&self) -> usize {
        self.edges
    }

    /// Order, eye and depth of shadow. `tolerance` \[m\] is how near to a plane the eye may not be.
    pub(crate) fn walk(&self, eye: Vec3, tolerance: f64) -> Walk {
        let place = |step: u32| {
            // Off a plane by a few tolerances, in directions that no scene prefers.
            const STEPS: [DVec3; 3] = [
                DVec3::new(0.811, 0.353, -0.467),
                DVec3::new(-0.289, 0.737, 0.611),
                DVec3::new(0.443, -0.521, 0.730),
            ];
            let away = STEPS[step as usize % 3] * f64::from(step) * 3.0 * tolerance;
            (eye.as_dvec3() + away).as_vec3()
        };
        let mut walk = Walk { order: Vec::new(), eye, depth: 0 };
        for step in 0..8 {
            walk.eye = place(step);
            walk.order.clear();
            let at = walk.eye.as_dvec3();
            let mut touches = false;
            if let Some(bsp) = &self.bsp {
                bsp.front_to_back(
                    at,
                    tolerance,
                    |piece| walk.order.push(piece),
                    |piece| touches |= piece.touches(self.origin, at, tolerance),
                );
            } else {
                touches = self.whole.iter().any(|piece| piece.touches(self.origin, at, tolerance));
                walk.order = by_angle(self.origin, &self.whole, at);
            }
            if !touches {
                break;
            }
        }
        walk.depth = self.depth_at(walk.eye.as_dvec3());
        walk
    }

    /// Mistakes of the order that `eye` is given; see [`violations`].
    pub(crate) fn violations(&self, eye: Vec3, rays: u32) -> usize {
        let walk = self.walk(eye, 0.0);
        violations(self.origin, self.pieces(), &walk.order, eye, rays)
    }

    /// Corners in the world of every casting triangle, turned towards the light.
    pub(crate) fn caps(&self) -> Vec<[Vec3; 3]> {
        let mut caps = Vec::new();
        for cast in self.casts.iter().flatten() {
            let mirrored = cast.world_from_object.matrix3.determinant() < 0.0;
            for t in 0..cast.connectivity.triangles.len() as u32 {
                if cast.silhouette.casts(&cast.connectivity, t) {
                    let [a, b, c] =
                        cast.connectivity.corners(t).map(|p| cast.world_from_object.transform_point3(p));
                    let turned = cast.silhouette.facing[t as usize] == mirrored;
                    caps.push(if turned { [a, c, b] } else { [a, b, c] });
                }
            }
        }
        caps
    }
}

/// Distance \[m\] of the light from a mesh's box; 0 for a directional light.
fn distance(origin: Origin, mesh: &Connectivity, place: Affine3A) -> f64 {
    if origin.0.w == 0.0 {
        return 0.0;
    }
    let (low, high) = mesh.bounds();
    let place = wide(place);
    let (centre, half) = (0.5 * (low + high), 0.5 * (high - low));
    let reach = place.matrix3.x_axis.abs() * half.x
        + place.matrix3.y_axis.abs() * half.y
        + place.matrix3.z_axis.abs() * half.z;
    let away = (origin.0.truncate() - place.transform_point3(centre)).abs() - reach;
    away.max(DVec3::ZERO).length()
}
