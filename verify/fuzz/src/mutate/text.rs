//! Mutations of texts: tokens, lines and paragraphs.

use super::token::{Class, Token, tokens};
use crate::dictionary::{NUMBERS, WORDS};
use fastrand::Rng;

/// Longest text that repeated parts may grow to \[byte\].
const MOST_REPEATED: usize = 200_000;

/// A changed copy; `donor` is another text of the kind.
pub(crate) fn mutated(text: &str, donor: &str, rng: &mut Rng) -> String {
    match rng.usize(..20) {
        0..9 => with_other_token(text, donor, rng),
        9..11 => with_swapped_tokens(text, rng),
        11..15 => with_other_parts(text, donor, "\n", rng),
        15..18 => with_other_parts(text, donor, "\n\n", rng),
        18 => with_repeated_token(text, rng),
        _ => with_inserted_word(text, rng),
    }
}

fn replaced(text: &str, token: &Token, new: &str) -> String {
    format!("{}{new}{}", &text[..token.1.start], &text[token.1.end..])
}

fn some<'a, T>(all: &'a [T], rng: &mut Rng) -> &'a T {
    &all[rng.usize(..all.len())]
}

fn of_class(text: &str, class: Class) -> Vec<Token> {
    tokens(text).into_iter().filter(|token| token.0 == class).collect()
}

fn with_other_token(text: &str, donor: &str, rng: &mut Rng) -> String {
    let class = *some(
        &[Class::Number, Class::Number, Class::Number, Class::Quoted, Class::Word, Class::Other],
        rng,
    );
    let all = of_class(text, class);
    if all.is_empty() {
        return with_inserted_word(text, rng);
    }
    let token = some(&all, rng);
    let donors = of_class(donor, class);
    let new = match class {
        _ if rng.usize(..4) == 0 && !donors.is_empty() => {
            donor[some(&donors, rng).1.clone()].to_string()
        }
        Class::Number if rng.bool() => scaled(&text[token.1.clone()], rng),
        Class::Number => some(NUMBERS, rng).to_string(),
        Class::Quoted if rng.usize(..3) == 0 => {
            "\"".to_string() + &"ab".repeat(1 << rng.usize(..13)) + "\""
        }
        Class::Quoted => format!("\"{}\"", some(WORDS, rng)),
        Class::Word => some(WORDS, rng).to_string(),
        Class::Other => {
            some(&["", "[", "]", "{", "}", ",", "=", ".", ":", "#", "[[", "\""], rng).to_string()
        }
    };
    replaced(text, token, &new)
}

/// A number near another, or some powers of ten away.
fn scaled(number: &str, rng: &mut Rng) -> String {
    let Ok(value) = number.replace('_', "").parse::<f64>() else { return "1".into() };
    let new = match rng.usize(..6) {
        0 => -value,
        1 => value + 1.0,
        2 => value - 1.0,
        3 => value * (1.0 + 1e-9),
        _ => value * 10f64.powi(rng.i32(-6..7)),
    };
    match rng.bool() && !number.contains(['.', 'e']) {
        true => format!("{}", new as i64),
        false => format!("{new:?}"),
    }
}

fn with_swapped_tokens(text: &str, rng: &mut Rng) -> String {
    let class = *some(&[Class::Number, Class::Quoted, Class::Word], rng);
    let all = of_class(text, class);
    if all.len() < 2 {
        return with_inserted_word(text, rng);
    }
    let (mut a, mut b) = (rng.usize(..all.len()), rng.usize(..all.len()));
    if a > b {
        (a, b) = (b, a);
    }
    let (first, second) = (&text[all[a].1.clone()], &text[all[b].1.clone()]);
    match a == b {
        true => text.to_string(),
        // From behind, so that the first range stays right.
        false => replaced(&replaced(text, &all[b], first), &all[a], second),
    }
}

/// Lines or paragraphs removed, doubled, moved or taken from another text.
fn with_other_parts(text: &str, donor: &str, separator: &str, rng: &mut Rng) -> String {
    let mut parts: Vec<&str> = text.split(separator).collect();
    let at = rng.usize(..parts.len());
    match rng.usize(..6) {
        0 => drop(parts.remove(at)),
        1 => parts.insert(at, parts[at]),
        2 => {
            let to = rng.usize(..parts.len());
            parts.swap(at, to);
        }
        3 => {
            let grown = MOST_REPEATED / (parts[at].len() + 1);
            let copies = (1 << rng.usize(..13)).min(grown);
            parts.splice(at..at, std::iter::repeat_n(parts[at], copies));
        }
        _ => {
            let others: Vec<&str> = donor.split(separator).collect();
            parts.insert(at, others[rng.usize(..others.len())]);
        }
    }
    parts.join(separator)
}

/// Deep nesting, or very many elements.
fn with_repeated_token(text: &str, rng: &mut Rng) -> String {
    let all = tokens(text);
    if all.is_empty() {
        return with_inserted_word(text, rng);
    }
    let first = rng.usize(..all.len());
    let last = (first + rng.usize(..4)).min(all.len() - 1);
    let part = &text[all[first].1.start..all[last].1.end];
    let copies = (1usize << rng.usize(..14)).min(MOST_REPEATED / part.len().max(1)).max(1);
    replaced(text, &(Class::Other, all[first].1.start..all[last].1.end), &part.repeat(copies))
}

fn with_inserted_word(text: &str, rng: &mut Rng) -> String {
    let borders: Vec<usize> = text.char_indices().map(|(at, _)| at).chain([text.len()]).collect();
    let at = *some(&borders, rng);
    format!("{}{}{}", &text[..at], some(WORDS, rng), &text[at..])
}
