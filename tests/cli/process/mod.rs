//! The program and the operating system: special files, terminals, signals.
//!
//! Theory: the program follows the conventions of Unix. Output through links goes to their targets,
//! modes and owners are kept, pipes and devices are neither replaced nor waited for, terminals show
//! printable text only, and a signal ends a render with the documented exit code.

mod compiling;
mod drivers;
mod limits;
mod outputs;
mod readers;
mod sharing;
mod signals;
mod terminal;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use crate::support::{DISC, LAMP, ball, folder_with, interruptible, words};

static SCENE: LazyLock<String> =
    LazyLock::new(|| ball((12, 8), "passes = 2\nphotons = 500", &[DISC, LAMP]));

/// A fresh folder with a small scene in it.
fn folder(name: &str) -> PathBuf {
    folder_with(name, &[("ball.toml", &SCENE)])
}

/// A CPU render of the scene, with the words of `line` as further arguments.
fn render(folder: &Path, line: &str) -> Command {
    let line = format!("render ball.toml --device cpu {line}");
    interruptible(folder, &words(&line))
}

/// Makes a named pipe.
fn fifo(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}
