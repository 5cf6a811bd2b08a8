//! Tables that a page can sort and a README can hold.

use crate::report::html::escaped;
use crate::report::markdown;

/// A table of measurements.
#[derive(Clone, Debug, Default)]
pub(crate) struct Table {
    pub head: Vec<String>,
    /// How many columns, from the left, hold words and not numbers.
    pub words: usize,
    pub rows: Vec<Vec<Cell>>,
}

/// What stands in one place of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Cell {
    pub text: String,
    /// Below it, in small letters.
    pub small: String,
    /// What it is sorted by, if not by its text; infinity is last.
    pub key: Option<f64>,
    /// Whether it is to be seen at once.
    pub strong: bool,
}

impl Cell {
    /// A number as `text` shows it.
    pub(crate) fn number(text: String, key: f64) -> Self {
        Self { text, key: Some(if key.is_finite() { key } else { f64::INFINITY }), ..Self::default() }
    }

    /// With something below it.
    pub(crate) fn with(self, small: impl Into<String>) -> Self {
        Self { small: small.into(), ..self }
    }

    fn html(&self, header: bool) -> String {
        let key = self.key.map_or(String::new(), |key| {
            format!(" data-key=\"{}\"", if key.is_finite() { key } else { f64::MAX })
        });
        let text = escaped(&self.text);
        let text = if self.strong { format!("<strong>{text}</strong>") } else { text };
        let small = if self.small.is_empty() {
            String::new()
        } else {
            format!("<small>{}</small>", escaped(&self.small))
        };
        if header {
            format!("<th scope=\"row\"{key}>{text}{small}</th>")
        } else {
            format!("<td{key}>{text}{small}</td>")
        }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self { text: text.into(), ..Self::default() }
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self { text, ..Self::default() }
    }
}

impl Table {
    /// An empty table whose first `words` columns hold words.
    pub(crate) fn new(words: usize, head: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self { head: head.into_iter().map(Into::into).collect(), words, rows: Vec::new() }
    }

    /// As HTML that the page's script makes sortable; nothing of a table without rows.
    pub(crate) fn html(&self, caption: &str) -> String {
        if self.rows.is_empty() {
            return String::new();
        }
        let class = |column: usize| if column < self.words { " class=\"words\"" } else { "" };
        let head: String = (0..).zip(&self.head).fold(String::new(), |text, (column, head)| {
            text + &format!("<th scope=\"col\"{}>{}</th>", class(column), escaped(head))
        });
        let mut text = format!(
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{0}\"><table class=\"sortable words-{1}\">\n<caption>{0}</caption>\n\
             <thead><tr>{head}</tr></thead>\n<tbody>\n",
            escaped(caption),
            self.words
        );
        for row in &self.rows {
            let cells: String = (0..).zip(row).map(|(column, cell)| cell.html(column == 0)).collect();
            text += &format!("<tr>{cells}</tr>\n");
        }
        text + "</tbody></table></div>\n"
    }

    /// As Markdown; the small letters stand behind, in brackets.
    pub(crate) fn markdown(&self) -> String {
        let cell = |cell: &Cell| {
            let text = cell.text.replace('|', "\\|");
            let text = if cell.strong { format!("**{text}**") } else { text };
            let small = cell.small.replace('|', "\\|");
            if small.is_empty() { text } else { format!("{text} ({small})") }
        };
        let rows = self.rows.iter().map(|row| row.iter().map(cell).collect());
        markdown::table(&std::iter::once(self.head.clone()).chain(rows).collect::<Vec<_>>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_html_and_markdown() {
        let mut table = Table::new(1, ["who", "ms"]);
        assert_eq!(table.html("none"), "");
        table
            .rows
            .push(vec!["<a|b>".into(), Cell { strong: true, ..Cell::number("1.0".into(), 1.0) }.with("x")]);
        table.rows.push(vec!["c".into(), Cell::number("never".into(), f64::INFINITY)]);
        let html = table.html("times & more");
        for wanted in
            ["&lt;a|b&gt;", "data-key=\"1\"><strong>1.0</strong><small>x</small>", "times &amp; more"]
        {
            assert!(html.contains(wanted), "{wanted}: {html}");
        }
        assert!(!html.contains("inf"), "{html}");
        assert!(table.markdown().contains("| <a\\|b> | **1.0** (x) |"), "{}", table.markdown());
    }
}
