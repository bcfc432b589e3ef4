//! Fingerprint of a problem: it does not depend on the recipe, the wording and the
//! layout of a case file.
//!
//! The TOML is parsed; of the top level `title`, `description`, `source`,
//! `discretisation` and `output` are dropped, of `time` only `method`, `end`,
//! `load_end` and `damping` are kept. What is left is written as text:
//!
//! - a table as `{`, its keys in the order of their code points each as a
//!   string with its value behind it, `}`;
//! - an array as `[`, its values, `]`;
//! - a string as `s`, its length in bytes, `:`, the string;
//! - a number, whole or not, as `n` and the 16 hexadecimal digits of its
//!   double, −0 as 0;
//! - a boolean as `b1` or `b0`;
//! - a string under a key `file` as `f` and the SHA-256 of that file.
//!
//! The fingerprint is the SHA-256 of this text. The Python side of the
//! references computes the same; `reference/tests/problem_hash.json` holds
//! answers for both.

use mtled_io::files::visit_bytes;
use sha2::{Digest, Sha256};
use std::path::Path;
use toml_edit::{DocumentMut, Item, TableLike};

const DROPPED: [&str; 5] = ["title", "description", "source", "discretisation", "output"];
const KEPT_OF_TIME: [&str; 4] = ["method", "end", "load_end", "damping"];

/// The fingerprint of the text of a case file, in hexadecimal; files that it
/// names are looked for from `base_dir`. The error says what could not be read.
pub fn problem_hash(text: &str, base_dir: &Path) -> Result<String, String> {
    let mut document: DocumentMut = text.parse().map_err(|error| format!("{error}"))?;
    document.retain(|key, _| !DROPPED.contains(&key));
    if let Some(time) = document.get_mut("time").and_then(Item::as_table_like_mut) {
        let keys: Vec<String> = time.iter().map(|(key, _)| key.to_string()).collect();
        for key in keys.iter().filter(|key| !KEPT_OF_TIME.contains(&key.as_str())) {
            time.remove(key);
        }
    }
    let mut canonical = String::new();
    write_item(document.as_item(), base_dir, &mut canonical)?;
    Ok(hexadecimal(&Sha256::digest(canonical.as_bytes())))
}

fn hexadecimal(digest: &[u8]) -> String {
    digest.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn write_table(table: &dyn TableLike, base_dir: &Path, out: &mut String) -> Result<(), String> {
    // UTF-8 sorts by bytes as by code points.
    let mut entries: Vec<(&str, &Item)> = table.iter().collect();
    entries.sort_by_key(|(key, _)| *key);
    out.push('{');
    for (key, item) in entries {
        write_string(key, out);
        match item.as_str() {
            Some(file) if key == "file" => write_file(&base_dir.join(file), out)?,
            _ => write_item(item, base_dir, out)?,
        }
    }
    out.push('}');
    Ok(())
}

fn write_item(item: &Item, base_dir: &Path, out: &mut String) -> Result<(), String> {
    if let Some(table) = item.as_table_like() {
        return write_table(table, base_dir, out);
    }
    if item.is_array() || item.is_array_of_tables() {
        out.push('[');
        for element in (0..).map_while(|index| item.get(index)) {
            write_item(element, base_dir, out)?;
        }
        out.push(']');
    } else if let Some(text) = item.as_str() {
        write_string(text, out);
    } else if let Some(number) = item.as_integer() {
        write_number(number as f64, out);
    } else if let Some(number) = item.as_float() {
        write_number(number, out);
    } else if let Some(boolean) = item.as_bool() {
        out.push_str(if boolean { "b1" } else { "b0" });
    } else {
        return Err(format!("the date {item} is not part of a problem"));
    }
    Ok(())
}

fn write_string(text: &str, out: &mut String) {
    out.push_str(&format!("s{}:{text}", text.len()));
}

fn write_number(number: f64, out: &mut String) {
    // −0 + 0 is +0.
    out.push_str(&format!("n{:016x}", (number + 0.0).to_bits()));
}

fn write_file(path: &Path, out: &mut String) -> Result<(), String> {
    let mut hash = Sha256::new();
    visit_bytes(path, |bytes| hash.update(bytes)).map_err(|error| error.to_string())?;
    out.push('f');
    out.push_str(&hexadecimal(&hash.finalize()));
    Ok(())
}
