//! Preview window: shows a scene as it converges, and changes its camera and settings.
//!
//! These modules do not need a window: [`orbit`] (camera), [`packed_cache`] (a packed scene that is
//! kept while the camera moves), [`frame`] (images in progress), [`quick`] and [`full`] (a small
//! image at once, then the full-size one), [`worker`] (scheduling of both), [`view`] (conversion
//! for display), [`comparison`] (comparison images), [`document`] and [`reload`] (the scene file),
//! and [`session`], which combines them. [`keys`], `panels` and [`window`] are the user interface.

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
