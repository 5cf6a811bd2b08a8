//! `harness report`: the page of a run, made again from its records.

use std::path::Path;

use crate::failure::Failure;
use crate::record;
use crate::report;

/// Writes table, charts and page of the run in `folder`; gives what to print.
pub(crate) fn run(folder: &Path) -> Result<String, Failure> {
    let records = record::read_all(folder)?;
    report::write(folder, &records)?;
    let page = folder.join(report::PAGE);
    Ok(format!(
        "{}\n{}wrote {}\n",
        report::table::table(&records),
        report::table::legend(&records),
        page.display()
    ))
}
