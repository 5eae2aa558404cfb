//! Theory: modules import only lower layers, in the order that docs/architecture.md states.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use crate::support::{files, repository};

/// Reads the layer of each module from the code block after "in the order of these layers".
fn layers() -> BTreeMap<String, usize> {
    let text = fs::read_to_string(repository("docs/architecture.md")).unwrap();
    let block = text.split("in the order of these layers").nth(1).expect("the list of layers");
    let lines = block.lines().skip(1).skip_while(|line| line.trim().is_empty());
    let lines = lines.take_while(|line| line.starts_with("      "));
    lines
        .enumerate()
        .flat_map(|(k, line)| line.split_whitespace().map(move |name| (name.to_owned(), k)))
        .collect()
}

/// Root modules that a file imports: by `crate::name`, or by `super::name` if its own folder has no
/// such file.
fn named(text: &str, own: &BTreeSet<String>, known: &BTreeMap<String, usize>) -> BTreeSet<String> {
    let code: String = text
        .split("#[cfg(test)]\nmod ")
        .next()
        .unwrap_or_default()
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default().to_owned() + "\n")
        .collect();
    let mut found = BTreeSet::new();
    for (prefix, local) in [("crate::", false), ("super::", true)] {
        for rest in code.split(prefix).skip(1) {
            let names = match rest.strip_prefix('{') {
                Some(list) => list.split('}').next().unwrap_or_default().split(',').collect(),
                None => vec![rest],
            };
            for name in names {
                let name: String =
                    name.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                if known.contains_key(&name) && !(local && own.contains(&name)) {
                    found.insert(name);
                }
            }
        }
    }
    found
}

/// Lists the imports that violate the order, as "file names module".
fn violations(sources: &[(String, String)], known: &BTreeMap<String, usize>) -> Vec<String> {
    let mut list = Vec::new();
    for (file, text) in sources {
        let parts: Vec<&str> = file.trim_end_matches(".rs").split('/').collect();
        let Some(layer) = known.get(parts[0]) else {
            list.push(format!("{file} is in no layer"));
            continue;
        };
        let prefix = format!("{}/", parts[0]);
        let own = sources.iter().filter_map(|(other, _)| other.strip_prefix(&prefix));
        let own = own.filter_map(|rest| rest.split(['/', '.']).next()).map(str::to_owned).collect();
        for name in named(text, &own, known) {
            if known[&name] >= *layer && name != parts[0] {
                list.push(format!("{file} names {name}"));
            }
        }
    }
    list
}

#[test]
fn dependencies_follow_the_layers() {
    let known = layers();
    assert!(known.len() > 30, "{known:?}");
    let src = repository("src");
    let mut sources: Vec<(String, String)> = files(&src, "rs")
        .iter()
        .map(|path| {
            let name = path.strip_prefix(&src).unwrap().to_str().unwrap().replace('\\', "/");
            (name, fs::read_to_string(path).unwrap())
        })
        // skip the program, the roots, and the copy of the lower layers in f64
        .filter(|(name, _)| {
            !["double/", "main.rs", "lib.rs", "low_level.rs"]
                .iter()
                .any(|start| name.starts_with(start))
        })
        .collect();
    let found = violations(&sources, &known);
    assert!(found.is_empty(), "{}", found.join("\n"));
    // the check detects planted imports from a higher layer and from the same one
    for (file, text) in [
        ("math/rng.rs", "use crate::cpu::CpuEngine;"),
        ("scene/obj.rs", "use super::super::gpu;"),
        ("shapes/ray.rs", "use crate::scene::Scene;"),
    ] {
        sources.push((file.to_owned(), text.to_owned()));
        assert_eq!(violations(&sources, &known).len(), 1, "{file}");
        sources.pop();
    }
}

/// Paths that the code of a module names from `crate`, `self` or `super`, from the root, with
/// braces expanded.
fn paths(text: &str, module: &[&str]) -> Vec<Vec<String>> {
    let code = text.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let code: String = code
        .lines()
        .map(|line| line.split("//").next().unwrap_or_default().to_owned() + "\n")
        .collect();
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut found = Vec::new();
    for start in ["crate::", "self::", "super::"] {
        for (at, _) in code.match_indices(start) {
            if !code[..at].ends_with(|c| is_name(c) || c == ':') {
                let module = module.iter().map(|&name| name.to_owned()).collect();
                expand(module, &code[at..], &mut found);
            }
        }
    }
    found
}

/// Adds the paths that `rest` names, a path relative to `prefix`.
fn expand(mut prefix: Vec<String>, rest: &str, found: &mut Vec<Vec<String>>) {
    let rest = rest.trim_start();
    if let Some(list) = rest.strip_prefix('{') {
        let (mut depth, mut from) = (0, 0);
        for (at, c) in list.char_indices() {
            match c {
                ',' | '}' if depth == 0 => {
                    expand(prefix.clone(), &list[from..at], found);
                    from = at + 1;
                }
                '{' => depth += 1,
                '}' => depth -= 1,
                _ => {}
            }
            if c == '}' && depth == 0 && from == at + 1 {
                return;
            }
        }
        return;
    }
    let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    match name.as_str() {
        "crate" => prefix.clear(),
        "super" => drop(prefix.pop()),
        "" | "self" | "low_level" => {}
        _ => prefix.push(name.clone()),
    }
    match rest[name.len()..].strip_prefix("::") {
        Some(rest) if !name.is_empty() => expand(prefix, rest, found),
        _ => found.push(prefix),
    }
}

/// The imports in `src/scene` that tie it to a file format, as "file names path": those of another
/// importer in an importer, and those of any importer in what all of them share.
fn ties(sources: &[(String, String)], importers: &BTreeSet<String>) -> Vec<String> {
    let mut list = Vec::new();
    for (file, text) in sources {
        let mut module: Vec<&str> = file.trim_end_matches(".rs").split('/').collect();
        let own = match module[1..] {
            ["importers", own, _, ..] => Some(own),
            ["builder" | "checks" | "diagnostics" | "images", ..] => None,
            _ => continue,
        };
        if module.last() == Some(&"mod") {
            module.pop();
        }
        for path in paths(text, &module) {
            let names: Vec<&str> = path.iter().map(String::as_str).collect();
            let is_tie = match names[..] {
                ["scene", "importers"] => true,
                ["scene", "importers", name, ..] => {
                    own.is_none_or(|own| own != name && importers.contains(name))
                }
                _ => false,
            };
            if is_tie {
                list.push(format!("{file} names {}", names.join("::")));
            }
        }
    }
    list
}

/// Importers do not import one another, and what they share imports none of them.
#[test]
fn importers_stand_alone() {
    let src = repository("src");
    let mut sources: Vec<(String, String)> = files(&src.join("scene"), "rs")
        .iter()
        .map(|path| {
            let name = path.strip_prefix(&src).unwrap().to_str().unwrap().replace('\\', "/");
            (name, fs::read_to_string(path).unwrap())
        })
        .collect();
    let importers: BTreeSet<String> = sources
        .iter()
        .filter_map(|(file, _)| file.strip_prefix("scene/importers/")?.split_once('/'))
        .map(|(name, _)| name.to_owned())
        .collect();
    assert!(importers.len() > 1, "{importers:?}");
    let found = ties(&sources, &importers);
    assert!(found.is_empty(), "{}", found.join("\n"));
    // planted imports are found
    for (file, text) in [
        ("scene/importers/toml/mod.rs", "use super::obj::Obj;"),
        ("scene/importers/toml/shape.rs", "use crate::scene::{importers::{obj, Importer}, Mesh};"),
        ("scene/importers/obj/mtl.rs", "let item = super::super::toml::document::Item;"),
        ("scene/checks/shape.rs", "use crate::low_level::scene::importers::toml;"),
        ("scene/diagnostics/mod.rs", "use super::importers::Importer;"),
    ] {
        sources.push((file.to_owned(), text.to_owned()));
        assert_eq!(ties(&sources, &importers).len(), 1, "{file}");
        sources.pop();
    }
    // an importer may name its own folder and the traits
    let text = "use super::Importer; use crate::scene::importers::{Importer, toml::file};";
    let own = [("scene/importers/toml/mod.rs".to_owned(), text.to_owned())];
    assert_eq!(ties(&own, &importers), [""; 0]);
}
