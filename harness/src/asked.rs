//! What a run was asked for, kept in its folder.

use serde::{Deserialize, Serialize};

use crate::cli;
use crate::failure::Failure;
use crate::output::{RunFolder, write_text};
use crate::record::Study;

/// What a run was asked for, so that it goes on with nothing else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Asked {
    full: bool,
    improvements: bool,
    scenes: Vec<String>,
    /// Hashes of what those scenes held: a file may have been edited since.
    contents: Vec<String>,
    only: Vec<String>,
    studies: Vec<Study>,
    size: (u32, u32),
    frames: Option<u32>,
    triangles: Option<u32>,
    shadow_map_size: Option<u32>,
}

impl Asked {
    /// Its file in a run's folder.
    const FILE: &'static str = "run.json";

    pub(crate) fn of(arguments: &cli::Run, contents: Vec<String>, size: (u32, u32)) -> Self {
        Self {
            full: arguments.full,
            improvements: arguments.improvements,
            scenes: arguments.scenes.clone(),
            contents,
            only: arguments.only.clone(),
            studies: arguments.studies.clone(),
            size,
            frames: arguments.frames,
            triangles: arguments.ground.triangles,
            shadow_map_size: arguments.ground.shadow_map_size,
        }
    }

    /// Writes it into a run's folder.
    pub(crate) fn write(&self, folder: &RunFolder) -> Result<(), Failure> {
        let text = serde_json::to_string_pretty(self).map_err(|error| Failure::Run(error.to_string()))?;
        write_text(folder.path(), Self::FILE, &(text + "\n"))
    }

    /// Fails where the run that was stopped is another one.
    pub(crate) fn check(&self, folder: &RunFolder) -> Result<(), Failure> {
        let path = folder.path().join(Self::FILE);
        let failed = |what: String| Failure::Input(format!("can't go on with {}: {what}", path.display()));
        let text = std::fs::read_to_string(&path).map_err(|error| failed(error.to_string()))?;
        let stopped: Self = serde_json::from_str(&text).map_err(|error| failed(error.to_string()))?;
        if stopped == *self {
            return Ok(());
        }
        if (Self { contents: self.contents.clone(), ..stopped.clone() }) == *self {
            let changed = self.contents.iter().zip(&stopped.contents).position(|(is, was)| is != was);
            let scene = changed.and_then(|index| self.scenes.get(index)).map_or("its scene", String::as_str);
            return Err(failed(format!(
                "{scene} has changed since then; start another run without --resume"
            )));
        }
        let [was, is] = [&stopped, self].map(|asked| serde_json::to_string(asked).unwrap_or_default());
        Err(failed(format!("that run was asked for {was}, this one for {is}; give the same options")))
    }
}
