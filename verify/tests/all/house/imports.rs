//! Which module of a crate imports which other one.

use super::tokens::tokens;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The path of a module from the root of its crate; a `mod.rs` and `lib.rs` has that of its
/// folder.
pub type Module = Vec<String>;

/// Keywords in front of the name of a definition.
const DEFINE: [&str; 9] =
    ["fn", "struct", "enum", "trait", "type", "const", "static", "union", "mod"];

#[derive(Default)]
struct Content {
    definitions: BTreeSet<String>,
    /// Path behind each name of a `pub use`.
    reexports: BTreeMap<String, Vec<String>>,
    /// Paths of `use` and in expressions and types.
    uses: Vec<Vec<String>>,
}

/// Imports (from, to) between the modules of a crate; of re-exported names to the module
/// that defines them. `files` are paths from the source folder with their texts.
pub fn imports(files: &[(String, String)]) -> BTreeSet<(Module, Module)> {
    let sources: BTreeMap<Module, Vec<String>> =
        files.iter().filter_map(|(path, text)| Some((module(path)?, tokens(text)))).collect();
    let modules: BTreeSet<Module> = sources.keys().cloned().collect();
    let contents: BTreeMap<Module, Content> = sources
        .iter()
        .map(|(module, tokens)| (module.clone(), content(module, tokens, &modules)))
        .collect();
    let mut imports = BTreeSet::new();
    for (from, content) in &contents {
        for path in content.uses.iter().chain(content.reexports.values()) {
            let to = resolve(path, &contents, 0);
            if to != *from && !to.is_empty() {
                imports.insert((from.clone(), to));
            }
        }
    }
    imports
}

/// The module of a file; none for tests and programs.
fn module(path: &str) -> Option<Module> {
    let mut parts: Module = Path::new(path)
        .with_extension("")
        .iter()
        .map(|p| p.to_string_lossy().into_owned())
        .collect();
    let last = parts.last()?;
    if last == "tests" || last.ends_with("_tests") || parts == ["main"] {
        return None;
    }
    if last == "mod" || last == "lib" {
        parts.pop();
    }
    Some(parts)
}

fn content(module: &Module, tokens: &[String], modules: &BTreeSet<Module>) -> Content {
    let mut content = Content::default();
    let mut at = 0;
    while at < tokens.len() {
        let token = tokens[at].as_str();
        let next = tokens.get(at + 1).map_or("", String::as_str);
        if token == "use" && (is_word(next) || next == "{" || next == "::") {
            let end = at + tokens[at..].iter().position(|t| t == ";").unwrap_or(0);
            let public = at > 0 && (tokens[at - 1] == "pub" || tokens[at - 1] == ")");
            for (path, name) in expand(&tokens[at + 1..end]) {
                let Some(path) = absolute(module, &path, modules) else { continue };
                if public {
                    drop(content.reexports.insert(name, path))
                } else {
                    content.uses.push(path)
                }
            }
            at = end.max(at) + 1;
            continue;
        }
        if DEFINE.contains(&token) && is_word(next) && token != "mod" {
            content.definitions.insert(next.to_string());
        }
        if token == "macro_rules"
            && let Some(name) = tokens.get(at + 2)
        {
            content.definitions.insert(name.clone());
        }
        let continues = at > 0 && ["::", "."].contains(&tokens[at - 1].as_str());
        if is_word(token) && next == "::" && !continues {
            let path = path_at(&tokens[at..]);
            content.uses.extend(absolute(module, &path, modules));
        }
        at += 1;
    }
    content
}

fn is_word(token: &str) -> bool {
    token.chars().next().is_some_and(|c| c.is_alphabetic() || c == '_')
}

/// `a::b::c` at the start of some tokens.
fn path_at(tokens: &[String]) -> Vec<String> {
    let mut path = vec![tokens[0].clone()];
    for pair in tokens[1..].chunks_exact(2) {
        if pair[0] != "::" || !is_word(&pair[1]) {
            break;
        }
        path.push(pair[1].clone());
    }
    path
}

/// The paths of the tree of a `use`, each with the name that it gets.
fn expand(tree: &[String]) -> Vec<(Vec<String>, String)> {
    let Some(open) = tree.iter().position(|token| token == "{") else {
        let path: Vec<String> = tree.iter().filter(|token| *token != "::").cloned().collect();
        let (mut path, name) = match path.iter().position(|token| token == "as") {
            Some(at) => (path[..at].to_vec(), path.get(at + 1).cloned()),
            None => (path.clone(), path.iter().rfind(|token| *token != "self").cloned()),
        };
        if path.len() > 1 && path.last().is_some_and(|token| token == "self") {
            path.pop();
        }
        return vec![(path, name.unwrap_or_default())];
    };
    let prefix = &tree[..open];
    let mut paths = Vec::new();
    let (mut depth, mut start) = (0, open + 1);
    for (at, token) in tree.iter().enumerate().skip(open) {
        match token.as_str() {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ => {}
        }
        if (token == "," && depth == 1) || depth == 0 {
            if start < at {
                paths.extend(expand(&[prefix, &tree[start..at]].concat()));
            }
            start = at + 1;
        }
    }
    paths
}

/// A path from the root of the crate; none for paths into other crates.
fn absolute(module: &Module, path: &[String], modules: &BTreeSet<Module>) -> Option<Vec<String>> {
    let child = || [module.as_slice(), &path[..1]].concat();
    let base = match path[0].as_str() {
        "crate" => return Some(path[1..].to_vec()),
        "self" => return Some([module.as_slice(), &path[1..]].concat()),
        "super" => {
            let ups = path.iter().take_while(|part| *part == "super").count();
            let base = &module[..module.len().saturating_sub(ups)];
            return Some([base, &path[ups..]].concat());
        }
        _ if modules.contains(&child()) => module,
        _ => return None,
    };
    Some([base.as_slice(), path].concat())
}

/// The module that defines what a path names, through re-exports.
fn resolve(path: &[String], contents: &BTreeMap<Module, Content>, depth: usize) -> Module {
    let found = (0..=path.len()).rev().find_map(|length| {
        let (module, rest) = path.split_at(length);
        Some((module, rest, contents.get(module)?))
    });
    let Some((module, rest, content)) = found else { return Module::new() };
    match rest.first() {
        Some(name) if !content.definitions.contains(name) && depth < 8 => {
            match content.reexports.get(name) {
                Some(target) => resolve(&[target, &rest[1..]].concat(), contents, depth + 1),
                None => module.to_vec(),
            }
        }
        _ => module.to_vec(),
    }
}
