//! Pages of parts: text, links, figures and tables, without verdicts of their own.

use super::super::svg;
use super::figures::figure_value;
use super::template::{SCRIPT, STYLE, pages, table_value};
use crate::escape::printable_lines;
use crate::study::{Figure, Table};
use minijinja::{Value, context};

/// A page.
#[derive(Debug, Clone, Default)]
pub struct Page {
    /// Heading.
    pub title: String,
    /// The page that it belongs to.
    pub back: Option<Link>,
    /// Paragraphs below the heading.
    pub lead: Vec<String>,
    /// What is on it.
    pub parts: Vec<Part>,
    /// Paragraphs in small letters at its end.
    pub foot: Vec<String>,
}

/// A part of a page.
#[derive(Debug, Clone, Default)]
pub struct Part {
    /// Heading.
    pub title: String,
    /// Paragraphs.
    pub texts: Vec<String>,
    /// Other pages.
    pub links: Vec<Link>,
    /// Something to copy.
    pub code: Option<String>,
    /// Figures side by side.
    pub figures: Vec<Figure>,
    /// Tables one after the other.
    pub tables: Vec<Table>,
    /// Whether the tables are folded away, each under its title.
    pub folded: bool,
}

/// A link to another page of the same folder or below it.
#[derive(Debug, Clone, Default)]
pub struct Link {
    /// Where it leads.
    pub href: String,
    /// What is clicked on.
    pub text: String,
    /// What stands behind it; may be empty.
    pub remark: String,
}

/// The page as one file that needs no network.
pub fn page_to_html(page: &Page) -> anyhow::Result<String> {
    let value = context! {
        style => Value::from_safe_string(format!("{STYLE}{}", svg::STYLE)),
        script => Value::from_safe_string(SCRIPT.to_string()),
        title => page.title.as_str(),
        back => page.back.as_ref().map(link_value),
        lead => page.lead.clone(),
        parts => page.parts.iter().map(part_value).collect::<Vec<_>>(),
        foot => page.foot.clone(),
    };
    Ok(printable_lines(&pages()?.get_template("plain.html")?.render(value)?))
}

fn part_value(part: &Part) -> Value {
    let table = |table: &Table| context! { folded => part.folded, ..table_value(table) };
    context! {
        title => part.title.as_str(),
        texts => part.texts.clone(),
        links => part.links.iter().map(link_value).collect::<Vec<_>>(),
        code => part.code.as_deref(),
        figures => part.figures.iter().map(figure_value).collect::<Vec<_>>(),
        tables => part.tables.iter().map(table).collect::<Vec<_>>(),
    }
}

fn link_value(link: &Link) -> Value {
    context! { href => link.href.as_str(), text => link.text.as_str(), remark => link.remark.as_str() }
}
