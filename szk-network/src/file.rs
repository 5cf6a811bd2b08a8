//! Particles from a file.

use std::path::Path;

use common::Lobe;
use glam::Vec3;
use serde::Deserialize;

use crate::{Error, Particle, Particles};

/// A line of a file of particles.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    x: f32,
    y: f32,
    z: f32,
    size: f32,
    sigma_t: f32,
    #[serde(default = "white")]
    albedo_r: f32,
    #[serde(default = "white")]
    albedo_g: f32,
    #[serde(default = "white")]
    albedo_b: f32,
    #[serde(default)]
    emission_r: f32,
    #[serde(default)]
    emission_g: f32,
    #[serde(default)]
    emission_b: f32,
    #[serde(default)]
    g: f32,
}

fn white() -> f32 {
    1.0
}

impl Particles {
    /// Particles from a file of comma-separated values: `x,y,z,size,sigma_t`, and if wanted
    /// `albedo_r,albedo_g,albedo_b` (1 unless given), `emission_r,emission_g,emission_b` (0) and `g`, the asymmetry
    /// of a Henyey-Greenstein phase function (0), of which there may be [`Particles::MOST_PHASES`] different ones.
    /// The first line names the columns. Units as in [`Particle`].
    ///
    /// # Errors
    /// [`Error::File`], with the line, for a file that can't be read or whose particles [`Particles::new`] refuses.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let wrong = |problem: String| Error::File { path: path.into(), problem };
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_path(path)
            .map_err(|error| wrong(error.to_string()))?;
        let mut list = Vec::new();
        let mut asymmetries: Vec<f32> = Vec::new();
        for (index, line) in reader.deserialize().enumerate() {
            let line: Line = line.map_err(|error| wrong(error.to_string()))?;
            if list.len() == Self::MOST as usize {
                return Err(wrong(format!("has more than {} particles; expected fewer", Self::MOST)));
            }
            let phase = asymmetries.iter().position(|g| *g == line.g).unwrap_or_else(|| {
                asymmetries.push(line.g);
                asymmetries.len() - 1
            });
            if asymmetries.len() > Self::MOST_PHASES {
                let most = Self::MOST_PHASES;
                return Err(wrong(format!(
                    "has more than {most} different g by line {}; expected fewer",
                    index + 2
                )));
            }
            let particle = Particle {
                position: Vec3::new(line.x, line.y, line.z),
                size: line.size,
                sigma_t: line.sigma_t,
                albedo: Vec3::new(line.albedo_r, line.albedo_g, line.albedo_b),
                emission: Vec3::new(line.emission_r, line.emission_g, line.emission_b),
                phase: phase as u32,
            };
            if let Some(problem) = particle.problem() {
                return Err(wrong(format!("line {}: the particle {problem}", index + 2)));
            }
            list.push(particle);
        }
        let lobe = |g: &f32| match *g {
            0.0 => Lobe::Isotropic,
            g => Lobe::HenyeyGreenstein { g: f64::from(g) },
        };
        let phases = asymmetries.iter().map(|g| lobe(g).into()).collect();
        Self::new(list, phases).map_err(|error| match error {
            Error::Cloud { problem } => wrong(problem),
            other => other,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_or_refused_with_its_line() {
        let path = std::env::temp_dir().join(format!("szk-network-{}.csv", std::process::id()));
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            Particles::read(&path)
        };
        let head = "x,y,z,size,sigma_t,albedo_r,g\n";
        let found = read(&format!("{head}0,1,2,0.5,3,0.9,0\n1,1,1,0.5,3,1,0.5\n")).unwrap();
        assert_eq!((found.list.len(), found.phases.len()), (2, 2));
        assert_eq!(found.list[0].albedo, Vec3::new(0.9, 1.0, 1.0));
        assert_eq!((found.list[1].phase, found.list[0].position), (1, Vec3::new(0.0, 1.0, 2.0)));
        for (text, what) in [
            ("0,1,2,0.5,-3,0.9,0\n", "line 2"),
            ("0,1,2,0.5,3,1.9,0\n", "albedo"),
            ("0,1,fog,0.5,3,0.9,0\n", "line: 2"),
            ("0,1,2,0.5,3,0.9,1.5\n", "asymmetry"),
            ("", "0 particles"),
        ] {
            let error = read(&format!("{head}{text}")).unwrap_err().to_string();
            assert!(error.contains(what), "{error}");
        }
        std::fs::remove_file(&path).unwrap();
        assert!(Particles::read(&path).is_err());
    }
}
