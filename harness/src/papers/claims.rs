//! What a paper's text claims, each claim beside what was measured of it.

use serde::Serialize;
use serde_json::{Map, Value};

use super::verdict::Verdict;
use super::{Origin, Press, cells};
use crate::failure::Failure;
use crate::report::markdown;

/// Version of `claims.json`, described in results/README.md.
const SCHEMA: u32 = 1;

#[derive(Debug, Serialize)]
pub(super) struct Claim {
    pub letter: char,
    pub claim: &'static str,
    pub measured: String,
    pub verdict: Verdict,
}

#[derive(Debug, Serialize)]
struct Claims<'a> {
    schema: u32,
    #[serde(flatten)]
    origin: Origin,
    claims: &'a [Claim],
    #[serde(flatten)]
    more: Map<String, Value>,
}

/// Writes `claims.json`, with `more` in it, and `claims.md`: `heading`, `about` and the table. Gives the last two as
/// Markdown.
pub(super) fn write(
    press: &Press<'_>,
    heading: &str,
    about: &str,
    claims: &[Claim],
    more: Map<String, Value>,
) -> Result<String, Failure> {
    press.json("claims.json", &Claims { schema: SCHEMA, origin: press.origin(), claims, more })?;
    let mut rows = vec![cells(["", "the paper's claim", "measured", "verdict"])];
    for claim in claims {
        let letter = claim.letter.to_string();
        rows.push(vec![letter, claim.claim.into(), claim.measured.clone(), claim.verdict.text().into()]);
    }
    let text = format!("{about}\n\n{}", markdown::table(&rows));
    press.text("claims.md", &format!("# What the text claims\n\n{heading}\n{text}"))?;
    Ok(text)
}
