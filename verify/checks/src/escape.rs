//! Texts that come from files, made harmless for the place where they are shown.

/// Whether a character moves the cursor, breaks a line, hides or reorders what is around it.
fn is_invisible(c: char) -> bool {
    let reorders =
        matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    c.is_control() || reorders || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}')
}

/// A text for one line of a terminal: line breaks, control characters and escape sequences
/// appear as `\n`, `\u{1b}` and so on.
pub fn printable(text: &str) -> String {
    shown(text, &[])
}

/// The same for a text of several lines: its line breaks and tabs stay.
pub fn printable_lines(text: &str) -> String {
    shown(text, &['\n', '\t'])
}

/// Text for a terminal or a log whose lines no runner of workflows takes for commands: those
/// begin with `::`, older ones contain `##[`.
pub fn without_commands(text: &str) -> String {
    let line = |line: &str| {
        let start = line.len() - line.trim_start().len();
        let line = match line[start..].strip_prefix("::") {
            Some(rest) => format!("{}\\u{{3a}}:{rest}", &line[..start]),
            None => line.to_string(),
        };
        line.replace("##[", "##\\u{5b}")
    };
    text.split_inclusive('\n').map(line).collect()
}

fn shown(text: &str, kept: &[char]) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if is_invisible(c) && !kept.contains(&c) {
            shown.extend(c.escape_default())
        } else {
            shown.push(c)
        }
    }
    shown
}

/// A JSON document of the same content whose invisible characters are escapes: serialisers
/// leave those beyond ASCII as they are.
pub fn printable_json(document: &str) -> String {
    let mut shown = String::with_capacity(document.len());
    for c in document.chars() {
        if is_invisible(c) && !matches!(c, '\n' | '\r' | '\t') {
            shown += &format!("\\u{:04x}", c as u32);
        } else {
            shown.push(c)
        }
    }
    shown
}

/// A text for a cell of a CSV file, which no spreadsheet takes for a formula. Quotation marks
/// are left to the writer of the file.
pub fn csv_text(text: &str) -> String {
    let text = printable(text);
    if text.trim_start().starts_with(['=', '+', '-', '@']) { format!("'{text}") } else { text }
}

/// The name of a file made of a text: what separates folders, what some system forbids in a
/// name and dots in front become `-`.
pub fn file_name(text: &str) -> String {
    let forbidden = |c: char| {
        is_invisible(c) || matches!(c, '/' | '\\' | ':' | '*' | '?' | '"' | '<' | '>' | '|')
    };
    let name = text.replace(forbidden, "-");
    let rest = name.trim_start_matches('.');
    if name.is_empty() { "-".to_string() } else { "-".repeat(name.len() - rest.len()) + rest }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_obey_is_shown_as_an_escape() {
        assert_eq!(printable("a\u{1b}[2Jb\nc\td\u{9b}e"), "a\\u{1b}[2Jb\\nc\\td\\u{9b}e");
        assert_eq!(printable("\u{202e}txt.exe"), "\\u{202e}txt.exe");
        assert_eq!(printable_lines("a\n\tb\r\u{7}"), "a\n\tb\\r\\u{7}");
        assert_eq!(printable("10⁻³ ≤ “Größe”"), "10⁻³ ≤ “Größe”");
    }

    #[test]
    fn no_line_is_a_command_of_a_workflow() {
        let shown = without_commands("::error::x\n a\n\t::warning ::y\nb ##[group]::z\n");
        assert_eq!(shown, "\\u{3a}:error::x\n a\n\t\\u{3a}:warning ::y\nb ##\\u{5b}group]::z\n");
        assert_eq!(without_commands("a::b\n"), "a::b\n");
    }

    #[test]
    fn a_json_document_keeps_its_content() {
        let text = serde_json::to_string_pretty(&["a\u{9b}\u{7f}\u{202e}\n"]).unwrap();
        let shown = printable_json(&text);
        assert!(shown.chars().all(|c| c == '\n' || !is_invisible(c)), "{shown:?}");
        assert_eq!(
            serde_json::from_str::<[String; 1]>(&shown).unwrap(),
            ["a\u{9b}\u{7f}\u{202e}\n"]
        );
    }

    #[test]
    fn no_cell_of_a_spreadsheet_is_a_formula() {
        for text in ["=1+1", "+1", "-1", "@SUM(A1)", " =1"] {
            assert_eq!(csv_text(text), format!("'{text}"));
        }
        assert_eq!(csv_text("top.ux_m"), "top.ux_m");
        assert_eq!(csv_text("\t=1"), "\\t=1");
    }

    #[test]
    fn a_file_name_stays_in_its_folder() {
        assert_eq!(file_name("../../etc/x"), "---..-etc-x");
        assert_eq!(file_name(".."), "--");
        assert_eq!(file_name(""), "-");
        assert_eq!(file_name("C:\\x\ny"), "C--x-y");
        assert_eq!(file_name("brain/tumour/shift"), "brain-tumour-shift");
    }
}
