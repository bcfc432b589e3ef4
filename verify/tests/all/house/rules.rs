//! Rules on imports: no circles, and nothing from a room further down.

use super::imports::Module;
use std::collections::{BTreeMap, BTreeSet};

type Imports = BTreeSet<(Module, Module)>;

/// Circles of imports between the entries of a folder, at every level.
pub fn circles(imports: &Imports) -> Vec<String> {
    let folders: BTreeSet<&[String]> = imports
        .iter()
        .flat_map(|(from, to)| [from, to])
        .flat_map(|module| (0..module.len()).map(|length| &module[..length]))
        .collect();
    folders.into_iter().flat_map(|folder| circles_in(folder, imports)).collect()
}

/// The entry of a folder to which a module belongs: a file, a folder or its `mod.rs`.
fn entry<'a>(folder: &[String], module: &'a [String]) -> Option<&'a str> {
    let inside = module.strip_prefix(folder)?;
    Some(inside.first().map_or("mod", String::as_str))
}

fn circles_in(folder: &[String], imports: &Imports) -> Vec<String> {
    let mut edges: BTreeMap<&str, BTreeMap<&str, String>> = BTreeMap::new();
    for (from, to) in imports {
        let (Some(a), Some(b)) = (entry(folder, from), entry(folder, to)) else { continue };
        let root = folder.is_empty() && a == "mod";
        if a != b && !root {
            let example = format!("{} -> {}", from.join("::"), to.join("::"));
            edges.entry(a).or_default().entry(b).or_insert(example);
        }
    }
    let reached: BTreeMap<&str, BTreeSet<&str>> =
        edges.keys().map(|&start| (start, reachable(start, &edges))).collect();
    let mutual =
        |a: &str, b: &str| reached[a].contains(b) && reached.get(b).is_some_and(|r| r.contains(a));
    let place = if folder.is_empty() { "the crate".into() } else { folder.join("::") };
    let mut circles = BTreeSet::new();
    for &start in edges.keys() {
        let members: Vec<&str> =
            reached[start].iter().copied().filter(|&b| mutual(start, b)).collect();
        if members.is_empty() {
            continue;
        }
        let mut text = format!("circle in {place}: {}", members.join(", "));
        for a in &members {
            let inside = edges[a].iter().filter(|(b, _)| members.contains(b));
            inside.for_each(|(_, example)| text += &format!("\n    {example}"));
        }
        circles.insert(text);
    }
    circles.into_iter().collect()
}

fn reachable<'a>(
    start: &'a str,
    edges: &BTreeMap<&'a str, BTreeMap<&'a str, String>>,
) -> BTreeSet<&'a str> {
    let (mut seen, mut open) = (BTreeSet::new(), vec![start]);
    while let Some(entry) = open.pop() {
        for &next in edges.get(entry).into_iter().flat_map(BTreeMap::keys) {
            if seen.insert(next) {
                open.push(next);
            }
        }
    }
    seen
}

/// Imports of rooms that stand further down in `lib.rs`, whose text this is.
pub fn downward_imports(lib: &str, imports: &Imports) -> Vec<String> {
    let modules = lib.lines().filter_map(|line| {
        line.strip_prefix("pub mod ").or(line.strip_prefix("mod "))?.strip_suffix(';')
    });
    let rooms: Vec<&str> = modules.collect();
    let place = |module: &Module| {
        rooms.iter().position(|room| Some(*room) == module.first().map(String::as_str))
    };
    let downward = |(from, to): &&(Module, Module)| matches!((place(from), place(to)), (Some(a), Some(b)) if a < b);
    let describe = |(from, to): &(Module, Module)| {
        format!("{} imports {}, which stands further down", from.join("::"), to.join("::"))
    };
    imports.iter().filter(downward).map(describe).collect()
}
