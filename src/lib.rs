//! caustica renders scenes by photon mapping: caustics, soft shadows, depth of field, on a GPU, on
//! Mesa's software driver or on the CPU.
//!
//! # Render a scene file
//!
//! ```
//! use caustica::{Development, Device, Provenance, Stop, open, render, scene, write_image};
//! use std::sync::atomic::AtomicBool;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut loaded = scene::load("scenes/cornell.toml".as_ref())?;
//! (loaded.scene.film.width, loaded.scene.film.height) = (32, 32);
//! loaded.settings.photons = 1000;
//! let mut engine = open(&Device::Cpu, &loaded.scene, &loaded.settings)?.engine;
//! // stops after 8 passes, or once the stated error is below 2 %
//! let stop = Stop { passes: 8, time: None, target_error: Some(0.02) };
//! let cancel = AtomicBool::new(false);
//! let outcome = render(engine.as_mut(), stop, &cancel, &mut |progress| {
//!     println!("{} passes", progress.passes);
//! })?;
//! assert!(outcome.picture.rgb.iter().flatten().any(|radiance| *radiance > 0.0));
//! println!("error {:.1} %", 100.0 * engine.errors()?.relative().stated);
//!
//! let file = std::env::temp_dir().join("cornell.png");
//! let development = Development::of(&loaded.scene.film);
//! write_image(&file, &outcome.picture, &[], &development, &Provenance::default())?;
//! # Ok(())
//! # }
//! ```
//!
//! # Build a scene in Rust
//!
//! ```
//! use caustica::scene::{
//!     Camera, Light, Material, MaterialKind, Reflectance, Scene, Shape, ShapeKind,
//! };
//! use caustica::{Device, RenderSettings, open};
//! use glam::DVec3;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut scene = Scene::new(Camera::look_at(DVec3::new(0.0, 1.5, 4.0), DVec3::Y * 0.5, 40.0));
//! (scene.film.width, scene.film.height) = (24, 16);
//! let material = |name: &str, kind| Material { name: name.to_owned(), ..Material::new(kind) };
//! let white = MaterialKind::Diffuse { reflectance: Reflectance::Color([0.7; 3]), roughness: 0.0 };
//! let glass = MaterialKind::Glass {
//!     ior: 1.5, roughness: 0.0, absorption: [0.0; 3], priority: 0,
//! };
//! scene.materials = vec![material("white", white), material("glass", glass)];
//! let floor = ShapeKind::Plane { point: DVec3::ZERO, normal: DVec3::Y };
//! let ball = ShapeKind::Sphere { center: DVec3::Y * 0.5, radius: 0.5 };
//! scene.shapes = vec![Shape::new(floor, 0), Shape::new(ball, 1)];
//! scene.lights =
//!     vec![Light::Point { position: DVec3::new(1.0, 3.0, 1.0), intensity: [20.0; 3] }];
//!
//! let settings = RenderSettings { photons: 1000, ..RenderSettings::default() };
//! let mut engine = open(&Device::Cpu, &scene, &settings)?.engine;
//! engine.pass()?;
//! assert!(engine.picture()?.rgb.iter().flatten().any(|radiance| *radiance > 0.0));
//! # Ok(())
//! # }
//! ```
//!
//! # Compare two devices
//!
//! Mesa's lavapipe gives the same bits as the CPU. GPUs may round differently, so compare their
//! relMSE with a threshold instead.
//!
//! ```
//! use caustica::{Device, Stop, compare, open, render, scene};
//! use std::sync::atomic::AtomicBool;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut loaded = scene::load("scenes/cornell.toml".as_ref())?;
//! (loaded.scene.film.width, loaded.scene.film.height) = (16, 16);
//! loaded.settings.photons = 1000;
//! let stop = Stop { passes: 2, time: None, target_error: None };
//! let picture = |device| -> Result<_, Box<dyn std::error::Error>> {
//!     let mut engine = open(&device, &loaded.scene, &loaded.settings)?.engine;
//!     Ok(render(engine.as_mut(), stop, &AtomicBool::new(false), &mut |_| ())?.picture)
//! };
//! let (gpu, cpu) = (picture(Device::Software)?, picture(Device::Cpu)?);
//! let difference = compare(&gpu, &cpu)?;
//! assert_eq!(difference.pixels_differing, 0, "relMSE {:.1e}", difference.rel_mse);
//! # Ok(())
//! # }
//! ```
//!
//! Everything else, from the kernels to the file formats, is in [`low_level`].

pub mod low_level;

// the modules name one another from the root
#[allow(unused_imports)]
use low_level::{
    accel, bench, camera, checkpoint, cpu, device, double, engine, film, geometry, gpu, kernels,
    lights, materials, math, memory, pack, pilots, plan, prepare, real, render, shapes, storage,
    study, tables, telemetry, validation,
};

pub use device::{DeviceError, DeviceInfo, Opened, Wanted as Device, list as devices, open};
pub use engine::{Cancel, Engine, EngineError, PassReport};
pub use film::metrics::compare;
pub use film::{
    Development, ErrorMap, FileError, Picture, Provenance, read as read_image, write as write_image,
};
pub use low_level::scene;
pub use render::{Ending, Outcome, Progress, Stop, render};
pub use scene::settings::{Direct, Method, Radius, RadiusRule, RenderSettings};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
