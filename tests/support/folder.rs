//! Folders that tests write to.

use std::fs;
use std::panic::Location;
use std::path::{Path, PathBuf};

/// A fresh, empty folder in Cargo's folder for test files. Its path contains the program and the
/// source file of the caller, so that `name` need only be unique in one file. (A wrapper without
/// `#[track_caller]` counts as the caller.)
#[track_caller]
pub fn folder(name: &str) -> PathBuf {
    let caller = Path::new(Location::caller().file()).with_extension("");
    let caller = caller.strip_prefix("tests").expect("a caller in tests/");
    let caller = caller.to_string_lossy().replace(['/', '\\'], "-");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(caller).join(name);
    if folder.exists() {
        fs::remove_dir_all(&folder).unwrap();
    }
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// A fresh folder with these files in it.
#[track_caller]
pub fn folder_with(name: &str, files: &[(&str, &str)]) -> PathBuf {
    let folder = folder(name);
    for (file, text) in files {
        fs::write(folder.join(file), text).unwrap();
    }
    folder
}
