//! Everything below the public API: the parts of the renderer and the tools around it.
//!
//! The command line, tests and benchmarks use these modules. They may change with every version.
//! `docs/architecture.md` explains how they fit together and in which direction they depend on one
//! another.

#[path = "accel/mod.rs"]
pub mod accel;
#[path = "bench/mod.rs"]
pub mod bench;
#[path = "camera.rs"]
pub mod camera;
#[path = "checkpoint/mod.rs"]
pub mod checkpoint;
#[path = "cpu/mod.rs"]
pub mod cpu;
#[path = "device/mod.rs"]
pub mod device;
#[path = "double/mod.rs"]
pub mod double;
#[path = "engine/mod.rs"]
pub mod engine;
#[path = "film/mod.rs"]
pub mod film;
#[path = "geometry/mod.rs"]
pub mod geometry;
#[path = "gpu/mod.rs"]
pub mod gpu;
#[path = "kernels/mod.rs"]
pub mod kernels;
#[path = "lights/mod.rs"]
pub mod lights;
#[path = "materials/mod.rs"]
pub mod materials;
#[path = "math/mod.rs"]
pub mod math;
#[path = "memory/mod.rs"]
pub mod memory;
#[path = "pack/mod.rs"]
pub mod pack;
#[path = "pilots/mod.rs"]
pub mod pilots;
#[path = "plan/mod.rs"]
pub mod plan;
#[path = "prepare/mod.rs"]
pub mod prepare;
#[cfg(feature = "preview")]
#[path = "preview/mod.rs"]
pub mod preview;
#[path = "real.rs"]
pub mod real;
#[path = "render/mod.rs"]
pub mod render;
#[path = "scene/mod.rs"]
pub mod scene;
#[path = "shapes/mod.rs"]
pub mod shapes;
#[path = "storage.rs"]
pub mod storage;
#[path = "study/mod.rs"]
pub mod study;
#[path = "tables.rs"]
pub mod tables;
#[path = "telemetry/mod.rs"]
pub mod telemetry;
#[path = "validation/mod.rs"]
pub mod validation;
