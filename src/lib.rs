//! caustica: a photon mapper.

pub mod build;
pub mod camera;
pub mod cpu;
pub mod device;
pub mod engine;
pub mod features;
pub mod film;
pub mod gpu;
pub mod grid;
pub mod kernels;
pub mod lights;
pub mod materials;
pub mod math;
pub mod pack;
pub mod plan;
pub mod probe;
pub mod render;
pub mod scene;
pub mod settings;
pub mod shapes;
pub mod tables;
