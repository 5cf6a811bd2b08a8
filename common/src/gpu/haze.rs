//! Kinds of medium that pipelines are made for: where a processor executes all branches of a shader, those of the other
//! kinds would cost as much as the one that is wanted.

use super::lobe_code;
use crate::Medium;

/// Values of the overrides in [`crate::shader::HAZE`]: whether the medium is grey, and the kinds of its lobes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Haze {
    grey: bool,
    lobes: u32,
    lobe_kinds: [u32; 4],
}

impl Haze {
    /// What `medium` needs.
    pub(crate) fn new(medium: &Medium) -> Self {
        let mut lobe_kinds = [0; 4];
        for (slot, (_, lobe)) in lobe_kinds.iter_mut().zip(&medium.phase.lobes) {
            *slot = lobe_code(lobe).0;
        }
        Self { grey: medium.is_grey(), lobes: medium.phase.lobes.len() as u32, lobe_kinds }
    }

    /// Names and values of the overrides.
    pub(crate) fn constants(&self) -> Vec<(&'static str, f64)> {
        let [a, b, c, d] = self.lobe_kinds.map(f64::from);
        let grey = u8::from(self.grey).into();
        let lobes = self.lobes.into();
        vec![("GREY", grey), ("LOBES", lobes), ("LOBE_0", a), ("LOBE_1", b), ("LOBE_2", c), ("LOBE_3", d)]
    }
}
