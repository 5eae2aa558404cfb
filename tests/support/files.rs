//! Files of the repository, and files in folders.

use std::fs;
use std::path::{Path, PathBuf};

/// A path in the repository.
pub fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// A file in `tests/data`.
pub fn data(name: &str) -> PathBuf {
    repository("tests/data").join(name)
}

/// The path of a shipped scene file, as an argument of a command.
pub fn shipped(name: &str) -> String {
    repository("scenes").join(name).display().to_string()
}

/// The names in a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string();
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| name(entry).expect("a name in UTF-8")).collect();
    names.sort();
    names
}

/// The files below a folder with this extension, sorted.
pub fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut list = Vec::new();
    for path in names(folder).iter().map(|name| folder.join(name)) {
        if path.is_dir() {
            list.extend(files(&path, extension));
        } else if path.extension().is_some_and(|found| found == extension) {
            list.push(path);
        }
    }
    list.sort();
    list
}
