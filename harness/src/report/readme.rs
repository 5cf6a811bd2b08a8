//! Tables put into a README between their markers.

use crate::report::equal::{equal_error, winners};
use crate::report::presets::presets;
use crate::report::sources::Case;

/// A name and the Markdown that belongs between its markers.
pub(crate) type Block = (&'static str, String);

/// What a README can hold.
pub(crate) fn blocks(cases: &[Case<'_>]) -> Vec<Block> {
    let each = |body: &dyn Fn(&Case<'_>) -> String| {
        let texts = cases.iter().map(|case| {
            let first = case.first;
            let software = if first.software { ", software" } else { "" };
            let (width, height) = (first.width, first.height);
            format!(
                "**{}**, {width} × {height}, {}{software}\n\n{}",
                case.title(cases),
                first.adapter,
                body(case)
            )
        });
        texts.collect::<Vec<_>>().join("\n")
    };
    vec![
        ("equal-error", each(&|case| equal_error(case).markdown())),
        ("presets", each(&|case| presets(case).markdown())),
        (
            "winners",
            each(&|case| {
                let line = |w: &crate::report::equal::Winner| {
                    format!("- at most {}: **{}** {}\n", w.bound, w.who, w.how)
                };
                winners(case).iter().map(line).collect()
            }),
        ),
    ]
}

/// `text` with each block between its markers; one marker at least has to be there, and each has to be closed.
pub(crate) fn splice(text: &str, blocks: &[Block]) -> Result<String, String> {
    let (mut text, mut found) = (text.to_owned(), false);
    for (name, block) in blocks {
        let (open, close) = (format!("<!-- harness:{name} -->"), format!("<!-- /harness:{name} -->"));
        let mut done = 0;
        while let Some(at) = text[done..].find(&open) {
            let start = done + at + open.len();
            let Some(length) = text[start..].find(&close) else {
                return Err(format!("`{open}` is not closed by `{close}`"));
            };
            text.replace_range(start..start + length, &format!("\n\n{}\n\n", block.trim()));
            done = start;
            found = true;
        }
    }
    let names: Vec<String> = blocks.iter().map(|(name, _)| format!("<!-- harness:{name} -->")).collect();
    if found {
        Ok(text)
    } else {
        Err(format!("there is no marker in it; expected one of {}", names.join(", ")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::tests::example;
    use crate::report::sources::cases;

    #[test]
    fn what_stands_between_markers_is_replaced_and_twice_is_once() {
        let records = [example("ray-march-64", 2.0, 0.04), example("billeter-plv", 1.0, 0.01)];
        let blocks = blocks(&cases(&records));
        let text = "before\n<!-- harness:winners -->stale<!-- /harness:winners -->\nafter\n";
        let once = splice(text, &blocks).unwrap();
        assert!(
            once.starts_with("before\n") && once.ends_with("\nafter\n") && !once.contains("stale"),
            "{once}"
        );
        assert!(once.contains("- at most 5 %: **billeter-plv** (64 steps in 1.00 ms)"), "{once}");
        assert_eq!(splice(&once, &blocks).unwrap(), once);
    }

    #[test]
    fn markers_that_are_missing_are_said() {
        let blocks = vec![("winners", "x".to_owned())];
        assert!(splice("nothing", &blocks).unwrap_err().contains("<!-- harness:winners -->"));
        let open = "<!-- harness:winners -->\n";
        assert!(splice(open, &blocks).unwrap_err().contains("not closed"));
    }
}
