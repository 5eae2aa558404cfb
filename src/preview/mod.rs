//! A window on a scene: the picture as it converges, under the hand.
//!
//! What can do without a window comes first: [`orbit`] (the camera), [`packed_cache`] (a flattened
//! scene, kept while the camera moves), [`frame`] (what there is to see), [`quick`] and [`full`] (a
//! small picture at once, the whole one after it), [`worker`] (which of them, when), [`view`] (how
//! a picture is shown), [`comparison`] (what it is held against), [`document`] and [`reload`] (the
//! scene file), and [`session`], which is all of it. [`keys`], `panels` and [`window`] lay hands on
//! that.

pub mod comparison;
pub mod document;
pub mod frame;
pub mod full;
pub mod keys;
pub mod orbit;
pub mod packed_cache;
mod panels;
pub mod quick;
pub mod reload;
pub mod session;
pub mod view;
pub mod window;
pub mod worker;
