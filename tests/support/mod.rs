//! Helpers that tests share: folders, the program as a user calls it, scenes, and the software
//! driver.

#![allow(dead_code)] // each program uses its part

mod ball;
mod folder;
mod head;
mod program;
mod software;

#[allow(unused_imports)] // each program uses its part
pub use {ball::*, folder::*, head::*, program::*, software::*};
