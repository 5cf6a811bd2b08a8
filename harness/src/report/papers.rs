//! What `harness papers` made, as a part of the page.

use std::path::{Path, PathBuf};

use pulldown_cmark::{CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd, html};
use serde::Deserialize;

use crate::failure::Failure;
use crate::report::html::escaped;
use crate::report::pictures::Album;
use crate::report::tables::{Cell, Table};

/// How folders that are found without being named begin.
const PREFIX: &str = "papers-";

/// A paper's results.
#[derive(Clone, Debug)]
pub(crate) struct Paper {
    /// The folder's name without what it begins with.
    pub name: String,
    folder: PathBuf,
    markdown: String,
    claims: Vec<Claim>,
    adapter: String,
}

/// A claim of its text.
#[derive(Clone, Debug, Deserialize)]
struct Claim {
    letter: String,
    claim: String,
    measured: String,
    verdict: String,
}

#[derive(Deserialize)]
struct Claims {
    #[serde(default)]
    adapter: String,
    claims: Vec<Claim>,
}

/// Folders of papers in a run's folder and beside it.
pub(crate) fn find(folder: &Path) -> Vec<PathBuf> {
    let parent = match folder.parent() {
        Some(parent) if parent.as_os_str().is_empty() => Path::new("."),
        Some(parent) => parent,
        None => folder,
    };
    let mut found: Vec<PathBuf> = Vec::new();
    for place in [folder, parent] {
        let Ok(entries) = place.read_dir() else { continue };
        let paths = entries.flatten().map(|entry| entry.path());
        let is_paper = |path: &PathBuf| {
            path.is_dir() && path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(PREFIX))
        };
        found.extend(paths.filter(is_paper));
    }
    found.sort();
    found
}

impl Paper {
    /// What is in `folder`: its `index.md`, or all of its Markdown, and its claims.
    pub(crate) fn read(folder: &Path) -> Result<Self, Failure> {
        let unreadable = |path: &Path, error: &dyn std::fmt::Display| {
            Failure::Input(format!("can't read {}: {error}", path.display()))
        };
        let text = |path: &Path| std::fs::read_to_string(path).map_err(|error| unreadable(path, &error));
        let index = folder.join("index.md");
        let markdown = if index.is_file() {
            text(&index)?
        } else {
            let entries = folder.read_dir().map_err(|error| unreadable(folder, &error))?;
            let mut files: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
            files.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
            files.sort();
            files.iter().map(|path| text(path)).collect::<Result<Vec<_>, _>>()?.join("\n\n")
        };
        let path = folder.join("claims.json");
        let claims = if path.is_file() {
            serde_json::from_str(&text(&path)?).map_err(|error| unreadable(&path, &error))?
        } else {
            Claims { adapter: String::new(), claims: Vec::new() }
        };
        if markdown.trim().is_empty() && claims.claims.is_empty() {
            return Err(Failure::Input(format!("{} holds no results of a paper", folder.display())));
        }
        let name = folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let name = name.strip_prefix(PREFIX).unwrap_or(&name).to_owned();
        Ok(Self { name, folder: folder.into(), markdown, claims: claims.claims, adapter: claims.adapter })
    }

    /// Files of its pictures.
    pub(crate) fn pictures(&self) -> Vec<String> {
        let parser = Parser::new_ext(&self.markdown, Options::ENABLE_TABLES);
        let files = parser.filter_map(|event| match event {
            Event::Start(Tag::Image { dest_url, .. }) => Some(self.file(&dest_url)),
            _ => None,
        });
        files.collect()
    }

    /// A file beside the Markdown.
    fn file(&self, name: &str) -> String {
        self.folder.join(name).to_string_lossy().into_owned()
    }

    /// Its first heading.
    fn title(&self) -> String {
        let line = self.markdown.lines().find_map(|line| line.strip_prefix("# "));
        line.unwrap_or(&self.name).trim().to_owned()
    }

    /// As HTML: no raw HTML, no links, headings below the page's own.
    pub(crate) fn html(&self, album: &Album) -> String {
        let mut events: Vec<Event<'_>> = Vec::new();
        let mut image: Option<(String, String)> = None;
        let raw = |html: String| Event::Html(CowStr::from(html));
        for event in Parser::new_ext(&self.markdown, Options::ENABLE_TABLES) {
            match (event, &mut image) {
                (Event::Start(Tag::Image { dest_url, .. }), _) => {
                    image = Some((dest_url.into_string(), String::new()));
                }
                (Event::End(TagEnd::Image), Some((file, alt))) => {
                    let alt = escaped(alt);
                    events.push(match album.get(&self.file(file)) {
                        Some(picture) => raw(format!("<img data-picture=\"{picture}\" alt=\"{alt}\">")),
                        None => raw(format!("<em>picture: {alt}</em>")),
                    });
                    image = None;
                }
                (Event::Text(text) | Event::Code(text), Some((_, alt))) => alt.push_str(&text),
                (_, Some(_)) => {}
                (Event::Html(text) | Event::InlineHtml(text), None) => events.push(Event::Text(text)),
                (Event::Start(Tag::Link { .. }) | Event::End(TagEnd::Link), None) => {}
                (Event::Start(Tag::Heading { level, .. }), None) => {
                    events.push(raw(format!("<h{}>", below(level))));
                }
                (Event::End(TagEnd::Heading(level)), None) => {
                    events.push(raw(format!("</h{}>", below(level))))
                }
                (start @ Event::Start(Tag::Table(_)), None) => {
                    events.extend([raw("<div class=\"scroll\">".into()), start]);
                }
                (end @ Event::End(TagEnd::Table), None) => events.extend([end, raw("</div>".into())]),
                (other, None) => events.push(other),
            }
        }
        let mut body = String::new();
        html::push_html(&mut body, events.into_iter());
        format!("<details class=\"paper\"><summary>{}</summary>\n{body}</details>\n", escaped(&self.title()))
    }
}

fn below(level: HeadingLevel) -> usize {
    (level as usize + 2).min(6)
}

/// All claims of all papers.
pub(crate) fn claims(papers: &[Paper]) -> Table {
    let mut table = Table::new(6, ["paper", "", "claim", "measured", "verdict", "adapter"]);
    for paper in papers {
        for claim in &paper.claims {
            let verdict = claim.verdict.replace('-', " ");
            table.rows.push(vec![
                paper.name.as_str().into(),
                claim.letter.as_str().into(),
                claim.claim.as_str().into(),
                claim.measured.as_str().into(),
                Cell { strong: claim.verdict == "does-not-hold", ..verdict.into() },
                paper.adapter.as_str().into(),
            ]);
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_paper_is_found_and_nothing_in_it_is_believed() {
        let place = tempfile::tempdir().unwrap();
        let (run, beside) = (place.path().join("run"), place.path().join("papers-x"));
        std::fs::create_dir_all(run.join("papers-y")).unwrap();
        std::fs::create_dir(&beside).unwrap();
        std::fs::create_dir(place.path().join("other")).unwrap();
        assert_eq!(find(&run), [beside.clone(), run.join("papers-y")]);
        assert!(Paper::read(&run.join("papers-y")).unwrap_err().to_string().contains("no results"));

        std::fs::write(
            beside.join("index.md"),
            "# A title\n\n<script>evil()</script>\n\n[x](http://example.org)\n\n![of <i>](gone.png)\n\n| a | b |\n| - | - |\n| 1 | <b>2 |\n",
        )
        .unwrap();
        std::fs::write(
            beside.join("claims.json"),
            r#"{"schema":1,"claims":[{"letter":"a","claim":"fast","measured":"slow","verdict":"does-not-hold","more":1}]}"#,
        )
        .unwrap();
        let paper = Paper::read(&beside).unwrap();
        let html = paper.html(&Album::default());
        for wanted in
            ["<summary>A title", "<h3>A title</h3>", "<td>1</td>", "&lt;script&gt;", "<em>picture: of"]
        {
            assert!(html.contains(wanted), "{wanted}: {html}");
        }
        for unwanted in ["<script", "href", "<b>", "<i>"] {
            assert!(!html.contains(unwanted), "{unwanted}: {html}");
        }
        assert_eq!(paper.pictures().len(), 1);
        let table = claims(&[paper]);
        let texts: Vec<&str> = table.rows[0].iter().map(|cell| cell.text.as_str()).collect();
        assert_eq!(texts[..5], ["x", "a", "fast", "slow", "does not hold"]);
        std::fs::write(beside.join("claims.json"), "{").unwrap();
        assert_eq!(Paper::read(&beside).unwrap_err().exit_code(), 2);
    }
}
