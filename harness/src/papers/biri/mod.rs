//! Biri et al. 2006: Table II, Figures 3, 10 and 11, and the claims of the text.

mod claims;
mod gamma;
mod pictures;
mod table;

use super::{PAGE, Press};
use crate::failure::Failure;
use crate::report::table::SOFTWARE;

/// The paper's pictures \[pixels\].
pub(super) const SIZE: (u32, u32) = (800, 600);

/// Steps of progress: two figures of Γ, one grid, three snapshots, three scenes in two settings, and the claims.
pub(super) const STEPS: u64 = 12 + claims::STEPS;

/// Makes everything; gives what to print.
pub(super) fn make(press: &Press<'_>) -> Result<String, Failure> {
    gamma::make(press)?;
    let (shares, indirect) = pictures::grid(press)?;
    let snapshots = pictures::snapshots(press)?;
    let (table, rows) = table::make(press)?;
    let origin = press.origin();
    let software = if origin.software { format!("\n{SOFTWARE}\n") } else { String::new() };
    let heading = format!("{}\n{software}", origin.line());
    let claims = claims::make(press, &heading, &rows, indirect)?;
    let mut page = format!(
        "# Biri 2006: the results again\n\n\
         V. Biri, *Real time single scattering effects*, CGAMES 2006. The paper's models are not to be had: the scenes are our own with the same number of \
         triangles and the same things happening in them.\n\n{heading}\n\
         ## Table II: frames per second\n\n{table}\n\
         ## What the text claims\n\n{claims}\n\
         ## Figure 3: Γ(λ, γ)\n\n\
         ![isotropic](figure-3-isotropic.png) ![hazy](figure-3-hazy.png)\n\n\
         As the table of the renderer's `paper` setting holds it: λ across, γ up, the phase function's mean \
         is 1.\n\n\
         ## Figure 10: what each term adds\n\n![terms](figure-10.png)\n\n{shares}\n\
         ## Figure 11: snapshots\n\n"
    );
    for (file, what) in snapshots {
        page += &format!("![{what}]({file})\n\n{what}\n\n");
    }
    press.text(PAGE, &page)?;
    Ok(format!("{table}\n{claims}\npage: {}\n", press.folder.join(PAGE).display()))
}
