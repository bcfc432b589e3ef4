//! Text between `<!-- NAME:begin -->` and `<!-- NAME:end -->`.

use anyhow::{Result, anyhow};

/// `text` with what stands between the markers of `name` replaced.
pub fn fill(text: &str, name: &str, content: &str) -> Result<String> {
    let (begin, end) = (format!("<!-- {name}:begin -->"), format!("<!-- {name}:end -->"));
    let missing = |marker: &str| anyhow!("the marker {marker} is missing");
    let (before, rest) = text.split_once(&begin).ok_or_else(|| missing(&begin))?;
    let (_, after) = rest.split_once(&end).ok_or_else(|| missing(&end))?;
    Ok(format!("{before}{begin}\n{content}{end}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

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
    }
}
