//! The tables as textures: built anew only where the phase function changes.

use common::gpu::upload_tables;
use common::{Lobe, Medium};
use rayon::prelude::*;

use crate::table::{build_airlight, build_lambert, build_phong};
use crate::{Airlight, Indirect, Options};

/// Tables of the lobes that they were built for.
#[derive(Default)]
pub(crate) struct Tables {
    airlight: Option<(Vec<Lobe>, wgpu::TextureView)>,
    /// Lambert, Phong.
    indirect: Option<(Vec<Lobe>, [wgpu::TextureView; 2])>,
}

impl Tables {
    /// Airlight, Lambert and Phong tables, once they are prepared.
    pub(crate) fn views(&self) -> Option<[&wgpu::TextureView; 3]> {
        let [lambert, phong] = &self.indirect.as_ref()?.1;
        Some([&self.airlight.as_ref()?.1, lambert, phong])
    }

    /// Tables of the medium's phase function, or a few texels that stand for none.
    pub(crate) fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        medium: &Medium,
        options: &Options,
        indirect: bool,
    ) {
        let lobes: Vec<Lobe> = medium.phase.lobes.iter().map(|(_, lobe)| *lobe).collect();
        let upload = |label, tables: &[common::table::Table2], format| {
            upload_tables(device, queue, label, &tables.iter().collect::<Vec<_>>(), format)
        };
        let f32 = common::gpu::TableFormat::F32;
        let (wanted, size, rest, format) = match options.airlight {
            Airlight::Gamma { width, height, format } => (lobes.clone(), [width, height], false, format),
            Airlight::GammaRest { width, height, format } => (lobes.clone(), [width, height], true, format),
            Airlight::Quadrature { .. } => (Vec::new(), [4, 4], true, f32),
        };
        if self.airlight.as_ref().is_none_or(|(built, _)| *built != wanted) {
            let size = size.map(|n| n as usize);
            let shown = if wanted.is_empty() { &[Lobe::Isotropic][..] } else { &wanted };
            let tables: Vec<_> = shown.iter().map(|&lobe| build_airlight(lobe, size, rest)).collect();
            self.airlight = Some((wanted, upload("biri-ss: airlight tables", &tables, format)));
        }
        let wanted = if indirect { lobes } else { Vec::new() };
        let built = self.indirect.as_ref();
        // Tables that are there may stay while nobody asks for them.
        if built.is_some_and(|(built, _)| *built == wanted || wanted.is_empty()) {
            return;
        }
        let clamped = options.indirect == Indirect::Clamped;
        let lambert: Vec<[_; 2]> = wanted.par_iter().map(|&lobe| build_lambert(lobe, clamped)).collect();
        let phong: Vec<_> = wanted.iter().flat_map(|&lobe| build_phong(lobe, clamped)).collect();
        // Those of point lights first.
        let mut by_light: Vec<_> = lambert.iter().map(|[point, _]| point.clone()).collect();
        by_light.extend(lambert.into_iter().map(|[_, directional]| directional));
        let none = || vec![build_airlight(Lobe::Isotropic, [4, 4], true)];
        let or_none = |tables: Vec<_>| if tables.is_empty() { none() } else { tables };
        let views = [
            upload("biri-ss: Lambert tables", &or_none(by_light), f32),
            upload("biri-ss: Phong tables", &or_none(phong), f32),
        ];
        self.indirect = Some((wanted, views));
    }
}
