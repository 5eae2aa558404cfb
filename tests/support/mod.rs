//! Helpers that tests share: folders and files, the program as a user calls it, scenes, images, and
//! the software driver.

#![allow(dead_code)] // each program uses its part

mod ball;
mod files;
mod folder;
mod head;
mod pictures;
#[cfg(unix)]
mod processes;
mod program;
mod software;

#[allow(unused_imports)] // each program uses its part
pub use {ball::*, files::*, folder::*, head::*, pictures::*, program::*, software::*};

#[cfg(unix)]
#[allow(unused_imports)] // each program uses its part
pub use processes::*;
