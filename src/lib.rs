//! caustica: a photon mapper.

pub mod device;
pub mod engine;
pub mod film;
pub mod math;
pub mod render;
pub mod scene;
pub mod settings;
