//! Clouds and the sky of a scene file, and voxel files.

use std::path::Path;
use std::sync::Arc;

use glam::{UVec3, Vec3};

use super::format::{CloudEntry, ShapeEntry, SkyEntry};
use crate::cloud::{Cumulus, Grid};
use crate::scene::load::{LoadError, light_map, read, short};
use crate::{Cloud, Density, Phase, Sky};

/// Bytes of a voxel file before its values.
const HEADER: usize = 48;

pub(super) fn cloud(path: &Path, entry: &CloudEntry) -> Result<Cloud, LoadError> {
    let invalid = |place: &str, problem: String| LoadError::invalid(path, place, problem);
    let phase = match &entry.phase {
        None => Phase::isotropic(),
        Some(phase) => phase.phase().map_err(|problem| invalid("cloud.phase", problem))?,
    };
    let (density, scale) = match &entry.shape {
        ShapeEntry::Slab { low, high } => (Density::Slab { low: low.0, high: high.0 }, 1.0),
        ShapeEntry::Sphere { centre, radius } => {
            (Density::Sphere { centre: centre.0, radius: radius.0 }, 1.0)
        }
        ShapeEntry::TwoDensity { centre, core, radius, shell } => {
            let (centre, core, radius, shell) = (centre.0, core.0, radius.0, shell.0);
            (Density::TwoDensity { centre, core, radius, shell }, 1.0)
        }
        ShapeEntry::Cumulus { base, size, seed } => {
            (Density::Cumulus(Cumulus::new(base.0, size.0, *seed)), 1.0)
        }
        ShapeEntry::Voxels { file } => {
            let voxels = path.with_file_name("").join(file);
            let place = "cloud.shape.voxels.file";
            let bytes = read(&voxels, HEADER as u64 + 4 * Grid::MOST_CELLS)
                .map_err(|error| invalid(place, error.to_string()))?;
            let (grid, scale) = grid(&bytes).map_err(|problem| {
                invalid(place, format!("the voxel file {} {problem}", voxels.display()))
            })?;
            (Density::Grid(Arc::new(grid)), scale)
        }
    };
    let cloud = Cloud {
        density,
        sigma_t: entry.sigma_t.0 * scale,
        albedo: entry.albedo.map_or(Vec3::ONE, |albedo| albedo.0),
        phase,
        emission: entry.emission.map_or(Vec3::ZERO, |emission| emission.0 * scale),
    };
    match cloud.problem() {
        Some(problem) => Err(invalid("cloud", format!("the cloud {problem}"))),
        None => Ok(cloud),
    }
}

pub(super) fn sky(path: &Path, entry: &SkyEntry) -> Result<Sky, LoadError> {
    let sky = match entry {
        SkyEntry::Radiance(radiance) => Sky::Constant(radiance.0),
        SkyEntry::Picture(file) => Sky::Picture(light_map(
            "the sky's picture",
            &path.with_file_name("").join(file),
            path,
            "sky.picture",
        )?),
    };
    match sky.problem() {
        Some(problem) => Err(LoadError::invalid(path, "sky", format!("the sky {problem}"))),
        None => Ok(sky),
    }
}

/// A grid from the volume format of Mitsuba 0.5, and what its largest value was before it became 1; or a
/// clause that says what is wrong.
fn grid(bytes: &[u8]) -> Result<(Grid, f32), String> {
    let Some((header, data)) = bytes.split_at_checked(HEADER) else {
        return Err(format!("has {} bytes; expected a header of {HEADER} and values", bytes.len()));
    };
    let word = |i: usize| [header[4 * i], header[4 * i + 1], header[4 * i + 2], header[4 * i + 3]];
    let int = |i: usize| i32::from_le_bytes(word(i));
    let float = |i: usize| f32::from_le_bytes(word(i));
    if header[..4] != *b"VOL\x03" {
        return Err(format!(
            "begins with `{}`; expected `VOL` and version 3",
            short(&String::from_utf8_lossy(&header[..4]))
        ));
    }
    if int(1) != 1 || int(5) != 1 {
        return Err(format!(
            "has encoding {} and {} channels; expected encoding 1, 32-bit floats, and one channel",
            int(1),
            int(5)
        ));
    }
    let sizes = [int(2), int(3), int(4)];
    let count = sizes.iter().try_fold(1u64, |count, &n| {
        let n = u64::try_from(n).ok().filter(|n| *n > 0)?;
        count.checked_mul(n).filter(|count| *count <= Grid::MOST_CELLS)
    });
    let Some(count) = count else {
        return Err(format!(
            "has {}×{}×{} voxels; expected 1 to {} in all",
            sizes[0],
            sizes[1],
            sizes[2],
            Grid::MOST_CELLS
        ));
    };
    if data.len() as u64 != 4 * count {
        return Err(format!(
            "has {} bytes of values for {count} voxels; expected {}, so export it again",
            data.len(),
            4 * count
        ));
    }
    let mut values: Vec<f32> =
        data.chunks_exact(4).map(|v| f32::from_le_bytes([v[0], v[1], v[2], v[3]])).collect();
    if let Some(wrong) = values.iter().find(|value| !(value.is_finite() && **value >= 0.0)) {
        return Err(format!("has a value of {wrong}; expected finite densities, none negative"));
    }
    let largest = values.iter().copied().fold(0.0, f32::max);
    if largest == 0.0 {
        return Err("is empty; expected a value above 0".into());
    }
    values.iter_mut().for_each(|value| *value = (*value / largest).min(1.0));
    let cells = UVec3::from_array(sizes.map(i32::unsigned_abs));
    let (low, high) = (Vec3::new(float(6), float(7), float(8)), Vec3::new(float(9), float(10), float(11)));
    Ok((Grid { cells, low, high, values }, largest))
}
