//! The list of planted errors fits the sources.
//!
//! Theory: `tests/mutants/run` can plant an error only if its text occurs once in its file, and can
//! run only programs that exist. A row of docs/stability.md that names another file is stale.

use crate::support::repository;
use std::collections::BTreeMap;
use std::fs;

/// Reports the lines of the list that cannot be planted, or whose row in `docs` is missing or
/// names another file.
fn faults(list: &str, docs: &str, read: &dyn Fn(&str) -> Option<String>) -> Vec<String> {
    let rows: BTreeMap<&str, &str> = docs
        .lines()
        .filter_map(|line| line.strip_prefix("| ")?.split_once(" | "))
        .filter_map(|(name, rest)| Some((name, rest.split_once(": `")?.0)))
        .collect();
    let mut found = Vec::new();
    for line in list.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
        let columns: Vec<&str> = line.split('\t').collect();
        let [name, file, from, to, tests] = columns[..] else {
            found.push(format!("{line}: expected five columns"));
            continue;
        };
        match read(file).map(|text| text.matches(&from.replace("\\n", "\n")).count()) {
            Some(1) if from != to => {}
            Some(1) => found.push(format!("{name}: changes nothing")),
            Some(count) => found.push(format!("{name}: {count} times in {file}")),
            None => found.push(format!("{name}: no file {file}")),
        }
        for (_, program) in
            tests.match_indices("--test ").map(|(at, s)| (at, &tests[at + s.len()..]))
        {
            let program = program.split(' ').next().unwrap_or_default();
            if read(&format!("tests/{program}/main.rs")).is_none() {
                found.push(format!("{name}: no test program {program}"));
            }
        }
        if rows.get(name) != Some(&file) {
            found.push(format!("{name}: the row of docs/stability.md names {:?}", rows.get(name)));
        }
    }
    found
}

#[test]
fn planted_errors_fit_the_sources() {
    let read = |file: &str| fs::read_to_string(repository(file)).ok();
    let list = read("tests/mutants/list").unwrap();
    let docs = read("docs/stability.md").unwrap();
    assert!(list.lines().count() > 100);
    let found = faults(&list, &docs, &read);
    assert!(found.is_empty(), "{}", found.join("\n"));
    // each kind of fault is found
    let row = "\n| x | src/camera.rs: `a` -> `b` | t |";
    for (line, expected) in [
        ("x\tsrc/camera.rs\tno such text\tb\t--test film", "0 times"),
        ("x\tsrc/gone.rs\ta\tb\t--test film", "no file"),
        ("x\tsrc/camera.rs\tpub fn \tpub fn \t--test film", "x: "),
        ("x\tsrc/camera.rs\taperture\tb\t--test gone", "no test program"),
        ("y\tsrc/camera.rs\ta\tb\t--test film", "the row"),
        ("x\tsrc/camera.rs", "five columns"),
    ] {
        let found = faults(line, &format!("{docs}{row}"), &read);
        assert!(found.iter().any(|fault| fault.contains(expected)), "{line}: {found:?}");
    }
}
