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
