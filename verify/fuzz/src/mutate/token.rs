//! Texts as tokens: numbers, words, quoted strings, single other characters.

use std::ops::Range;

/// Kind of token.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Class {
    /// Digits, with sign, point and exponent.
    Number,
    /// Letters, digits and underscores.
    Word,
    /// With its quotation marks.
    Quoted,
    /// One character of anything else but white space.
    Other,
}

/// A token and its bytes.
pub(crate) type Token = (Class, Range<usize>);

/// The tokens of a text, white space left out.
pub(crate) fn tokens(text: &str) -> Vec<Token> {
    let bytes = text.as_bytes();
    let mut all = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let start = at;
        let class = match bytes[at] {
            byte if byte.is_ascii_whitespace() => {
                at += 1;
                continue;
            }
            b'"' => {
                at += 1 + bytes[at + 1..].iter().take_while(|b| !matches!(b, b'"' | b'\n')).count();
                at = (at + 1).min(bytes.len());
                Class::Quoted
            }
            byte if byte.is_ascii_digit() || is_sign_of_number(bytes, at) => {
                at += 1;
                while at < bytes.len() && continues_number(bytes, at) {
                    at += 1;
                }
                Class::Number
            }
            byte if byte.is_ascii_alphabetic() || byte == b'_' => {
                at += bytes[at..]
                    .iter()
                    .take_while(|b| b.is_ascii_alphanumeric() || **b == b'_')
                    .count();
                Class::Word
            }
            _ => {
                at += text[at..].chars().next().map_or(1, char::len_utf8);
                Class::Other
            }
        };
        all.push((class, start..at));
    }
    all
}

fn is_sign_of_number(bytes: &[u8], at: usize) -> bool {
    matches!(bytes[at], b'-' | b'+' | b'.')
        && bytes.get(at + 1).is_some_and(|byte| byte.is_ascii_digit() || *byte == b'.')
}

fn continues_number(bytes: &[u8], at: usize) -> bool {
    let exponent = |at: usize| matches!(bytes[at], b'e' | b'E');
    match bytes[at] {
        b'0'..=b'9' | b'.' | b'_' => true,
        b'e' | b'E' => {
            bytes.get(at + 1).is_some_and(|b| b.is_ascii_digit() || *b == b'-' || *b == b'+')
        }
        b'-' | b'+' => exponent(at - 1),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_a_case_file_has_its_tokens() {
        let text = "min = [-1.5e-3, 2], name = \"ä b\" é";
        let shown: Vec<(Class, &str)> =
            tokens(text).into_iter().map(|(class, range)| (class, &text[range])).collect();
        use Class::{Number, Other, Quoted, Word};
        let expected = [
            (Word, "min"),
            (Other, "="),
            (Other, "["),
            (Number, "-1.5e-3"),
            (Other, ","),
            (Number, "2"),
            (Other, "]"),
            (Other, ","),
            (Word, "name"),
            (Other, "="),
            (Quoted, "\"ä b\""),
            (Other, "é"),
        ];
        assert_eq!(shown, expected);
    }

    #[test]
    fn an_open_quotation_ends_with_the_text() {
        assert_eq!(tokens("\"ab"), [(Class::Quoted, 0..3)]);
        assert_eq!(tokens("\""), [(Class::Quoted, 0..1)]);
    }
}
