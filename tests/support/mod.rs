//! What tests have in common: folders of their own, the program as a user calls it, and a scene to
//! call it with.

#![allow(dead_code)] // each test file uses its part

mod ball;
mod folder;
mod head;
mod program;

#[allow(unused_imports)] // each test file uses its part
pub use {ball::*, folder::*, head::*, program::*};
