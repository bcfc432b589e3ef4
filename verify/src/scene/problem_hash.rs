//! A fingerprint of what is solved: the same for every recipe, wording and
//! layout of a case file, another one for every other problem.
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
//! - a truth value as `b1` or `b0`;
//! - a string under a key `file` as `f` and the SHA-256 of that file.
//!
//! The fingerprint is the SHA-256 of this text. The Python side of the
//! references computes the same; `reference/tests/problem_hash.json` holds
//! answers for both.

use sha2::{Digest, Sha256};
use std::path::Path;
use toml::{Table, Value};

const DROPPED: [&str; 5] = ["title", "description", "source", "discretisation", "output"];
const KEPT_OF_TIME: [&str; 4] = ["method", "end", "load_end", "damping"];

/// The fingerprint of the text of a case file, in hexadecimal; files that it
/// names are looked for from `base_dir`. The error says what could not be read.
pub fn problem_hash(text: &str, base_dir: &Path) -> Result<String, String> {
    let mut table: Table = text.parse().map_err(|error| format!("{error}"))?;
    table.retain(|key, _| !DROPPED.contains(&key));
    if let Some(Value::Table(time)) = table.get_mut("time") {
        time.retain(|key, _| KEPT_OF_TIME.contains(&key));
    }
    let mut canonical = String::new();
    write_table(&table, base_dir, &mut canonical)?;
    Ok(hexadecimal(canonical.as_bytes()))
}

/// SHA-256 of some bytes.
fn hexadecimal(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn write_table(table: &Table, base_dir: &Path, out: &mut String) -> Result<(), String> {
    // UTF-8 sorts by bytes as by code points.
    let mut keys: Vec<&String> = table.keys().collect();
    keys.sort();
    out.push('{');
    for key in keys {
        write_string(key, out);
        match &table[key] {
            Value::String(file) if key == "file" => write_file(&base_dir.join(file), out)?,
            value => write_value(value, base_dir, out)?,
        }
    }
    out.push('}');
    Ok(())
}

fn write_value(value: &Value, base_dir: &Path, out: &mut String) -> Result<(), String> {
    match value {
        Value::Table(table) => write_table(table, base_dir, out)?,
        Value::Array(values) => {
            out.push('[');
            for value in values {
                write_value(value, base_dir, out)?;
            }
            out.push(']');
        }
        Value::String(text) => write_string(text, out),
        Value::Integer(number) => write_number(*number as f64, out),
        Value::Float(number) => write_number(*number, out),
        Value::Boolean(truth) => out.push_str(if *truth { "b1" } else { "b0" }),
        Value::Datetime(date) => return Err(format!("the date {date} is no part of a problem")),
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
    let bytes =
        std::fs::read(path).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    out.push('f');
    out.push_str(&hexadecimal(&bytes));
    Ok(())
}
