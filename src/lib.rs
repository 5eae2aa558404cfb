//! caustica: a photon mapper.

pub mod build;
pub mod engine;
pub mod film;
pub mod math;
pub mod scene;
pub mod settings;
pub mod shapes;
