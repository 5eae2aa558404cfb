//! caustica: a photon mapper for caustics, soft shadows and depth of field, on GPU, lavapipe and
//! CPU.
//!
//! A scene file becomes a [`scene::Scene`] (f64, as written), [`pack::pack`] flattens it into the
//! tables that the kernels read (f32, moved to its own centre), [`plan::Plan`] says what a pass
//! does, and an [`engine::Engine`] carries it out: [`cpu::CpuEngine`] in Rust, [`gpu::GpuEngine`]
//! in WGSL.
//!
//! A render from Rust, in 20 lines:
//!
//! ```
//! use caustica::film::{self, Development, Provenance, tonemap::Bits};
//! use caustica::{device, scene};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut loaded = scene::load("scenes/cornell.toml".as_ref())?;
//! (loaded.scene.film.width, loaded.scene.film.height) = (32, 32);
//! loaded.settings.photons = 1000;
//! let mut engine = device::open(&device::Wanted::Cpu, &loaded.scene, &loaded.settings)?.engine;
//! for _ in 0..4 {
//!     engine.pass()?;
//! }
//! let picture = engine.picture()?;
//! assert!(picture.rgb.iter().flatten().any(|radiance| *radiance > 0.0));
//! println!("error {:.1} %", 100.0 * engine.errors()?.relative().stated);
//!
//! let scene::Film { exposure, tonemap, .. } = loaded.scene.film;
//! let development = Development { exposure, tonemap, bits: Bits::Eight };
//! let file = std::env::temp_dir().join("cornell.png");
//! film::write(&file, &picture, &[], &development, &Provenance::default())?;
//! # Ok(())
//! # }
//! ```
//!
//! A test of one's own that holds a GPU, or any driver, against the CPU. The bits are the same on
//! the software driver lavapipe; GPUs may round otherwise, so that a share of relMSE is what to ask
//! of them:
//!
//! ```
//! use caustica::film::metrics::compare;
//! use caustica::render::{Stop, render};
//! use caustica::{device, scene};
//! use std::sync::atomic::AtomicBool;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut loaded = scene::load("scenes/cornell.toml".as_ref())?;
//! (loaded.scene.film.width, loaded.scene.film.height) = (16, 16);
//! loaded.settings.photons = 1000;
//! let stop = Stop { passes: 2, time: None, target_error: None };
//! let picture = |wanted| -> Result<_, Box<dyn std::error::Error>> {
//!     let mut engine = device::open(&wanted, &loaded.scene, &loaded.settings)?.engine;
//!     Ok(render(engine.as_mut(), stop, &AtomicBool::new(false), &mut |_| ())?.picture)
//! };
//! let (gpu, cpu) = (picture(device::Wanted::Software)?, picture(device::Wanted::Cpu)?);
//! let difference = compare(&gpu, &cpu)?;
//! assert_eq!(difference.pixels_differing, 0, "relMSE {:.1e}", difference.rel_mse);
//! # Ok(())
//! # }
//! ```
//!
//! Modules depend on one another one way: [`stage`], [`compilation`], [`storage`], [`srgb`],
//! [`memory`], [`real`] and [`math`], then [`tables`], [`shapes`], [`materials`], [`lights`],
//! [`camera`] and [`grid`], then [`scene`], [`accel`], [`prepare`], [`limits`], [`pack`], then [`kernels`],
//! [`radius`], [`sobol`], [`probe`], [`film_readback`], [`plan`], then [`cpu`] and [`gpu`], then
//! [`identity`], [`device`], [`failover`], [`quality`], [`calibration`], [`observers`], [`render`] and
//! [`checkpoint`], and last [`bench`](mod@bench), [`ablation`], [`validation`], [`study`] and, where it is
//! not left out, `preview`. Those from [`real`] to [`cpu`] are compiled twice: [`double`] is the
//! same in f64.

pub mod ablation;
pub mod accel;
pub mod bench;
pub mod calibration;
pub mod camera;
pub mod checkpoint;
pub mod clock;
pub mod compilation;
pub mod cpu;
pub mod device;
pub mod double;
pub mod engine;
pub mod error;
pub mod failover;
pub mod features;
pub mod film;
pub mod film_readback;
pub mod gpu;
pub mod grid;
pub mod identity;
pub mod kernels;
pub mod layers;
pub mod lights;
pub mod limits;
pub mod materials;
pub mod math;
pub mod memory;
pub mod observers;
pub mod pack;
pub mod plan;
pub mod prepare;
#[cfg(feature = "preview")]
pub mod preview;
pub mod probe;
pub mod quality;
pub mod radius;
pub mod real;
pub mod render;
pub mod scene;
pub mod settings;
pub mod shapes;
pub mod sobol;
pub mod srgb;
pub mod stage;
pub mod storage;
pub mod study;
pub mod tables;
pub mod validation;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
