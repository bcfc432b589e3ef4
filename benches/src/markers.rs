//! Text between `<!-- NAME:begin -->` and `<!-- NAME:end -->`.

use anyhow::{Result, anyhow};

/// Whether a page has a place for this table.
pub fn has(text: &str, name: &str) -> bool {
    text.contains(&format!("<!-- {name}:begin -->"))
}

/// `text` with new content between the markers of `name`.
pub fn fill(text: &str, name: &str, content: &str) -> Result<String> {
    let (begin, end) = (format!("<!-- {name}:begin -->"), format!("<!-- {name}:end -->"));
    let missing = |marker: &str| anyhow!("the marker {marker} is missing");
    let (before, rest) = text.split_once(&begin).ok_or_else(|| missing(&begin))?;
    let (_, after) = rest.split_once(&end).ok_or_else(|| missing(&end))?;
    Ok(format!("{before}{begin}\n{content}{end}{after}"))
}

/// The first table of a Markdown page.
pub fn first_table(page: &str) -> Result<String> {
    let row = |line: &&str| line.starts_with('|');
    let rows = page.lines().skip_while(|line| !row(line)).take_while(row);
    let table = rows.fold(String::new(), |text, line| text + line + "\n");
    if table.is_empty() { Err(anyhow!("the page has no table")) } else { Ok(table) }
}

/// The head of a table, and its rows with a text.
pub fn rows_with(table: &str, text: &str) -> String {
    let (head, rows): (Vec<_>, Vec<_>) = table.lines().enumerate().partition(|(n, _)| *n < 2);
    let chosen = rows.iter().filter(|(_, row)| row.contains(text));
    head.iter().chain(chosen).fold(String::new(), |all, (_, line)| all + line + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_a_table_keep_its_head() {
        let table = "| a | b |\n|---|---|\n| 1 | 2 |\n| 3 | 4 |\n";
        assert_eq!(rows_with(table, "| 3 |"), "| a | b |\n|---|---|\n| 3 | 4 |\n");
    }

    #[test]
    fn the_first_table_ends_where_its_rows_do() {
        let page = "# title\n\n| a | b |\n|---|---|\n| 1 | 2 |\n\n| c |\n";
        assert_eq!(first_table(page).unwrap(), "| a | b |\n|---|---|\n| 1 | 2 |\n");
        assert!(first_table("no table\n").is_err());
    }

    const PAGE: &str = "a\n<!-- bench:begin -->\nold\n<!-- bench:end -->\nb\n";

    #[test]
    fn filling_replaces_what_was_there_and_can_be_repeated() {
        let once = fill(PAGE, "bench", "new\n").unwrap();
        assert_eq!(once, "a\n<!-- bench:begin -->\nnew\n<!-- bench:end -->\nb\n");
        assert_eq!(fill(&once, "bench", "new\n").unwrap(), once);
    }

    #[test]
    fn a_missing_marker_is_named() {
        let error = fill(PAGE, "verify", "").unwrap_err().to_string();
        assert!(error.contains("<!-- verify:begin -->"), "{error}");
        assert!(!has(PAGE, "verify") && has(PAGE, "bench"));
    }
}
