//! caustica: a photon mapper for caustics, soft shadows and depth of field, on GPU, lavapipe and CPU.
//!
//! A scene file becomes a [`scene::Scene`] (f64, as written), [`pack::pack`] flattens it into the tables that the
//! kernels read (f32, moved to its own centre), [`plan::Plan`] says what a pass does, and an [`engine::Engine`]
//! carries it out: [`cpu::CpuEngine`] in Rust, [`gpu::GpuEngine`] in WGSL.
//!
//! ```
//! use caustica::{device, scene};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut loaded = scene::load("scenes/cornell.toml".as_ref())?;
//! (loaded.scene.film.width, loaded.scene.film.height) = (32, 32);
//! loaded.settings.photons = 1000;
//! let mut engine = device::open(&device::Wanted::Cpu, &loaded.scene, &loaded.settings)?.engine;
//! engine.pass()?;
//! assert!(engine.picture()?.rgb.iter().flatten().any(|radiance| *radiance > 0.0));
//! # Ok(())
//! # }
//! ```
//!
//! Modules depend on one another one way: [`real`] and [`math`], then [`tables`], [`shapes`], [`materials`], [`lights`],
//! [`camera`] and [`grid`], then [`scene`], [`build`], [`limits`], [`pack`], then [`kernels`], [`radius`], [`sobol`], [`probe`], [`readout`], [`plan`], then [`cpu`]
//! and [`gpu`], then [`identity`], [`device`], [`quality`], [`calibration`], [`showing`], [`render`] and [`checkpoint`], and last [`bench`](mod@bench), [`burden`], [`hold`], [`study`] and, where it is not left out, `preview`.
//! Those from [`real`] to [`cpu`] are compiled twice: [`double`] is the same in f64.

pub mod bench;
pub mod build;
pub mod burden;
pub mod calibration;
pub mod camera;
pub mod checkpoint;
pub mod clock;
pub mod cpu;
pub mod device;
pub mod double;
pub mod engine;
pub mod error;
pub mod features;
pub mod film;
pub mod gpu;
pub mod grid;
pub mod hold;
pub mod identity;
pub mod kernels;
pub mod layers;
pub mod lights;
pub mod limits;
pub mod materials;
pub mod math;
pub mod pack;
pub mod plan;
#[cfg(feature = "preview")]
pub mod preview;
pub mod probe;
pub mod quality;
pub mod radius;
pub mod readout;
pub mod real;
pub mod render;
pub mod scene;
pub mod settings;
pub mod shapes;
pub mod showing;
pub mod sobol;
pub mod study;
pub mod tables;
