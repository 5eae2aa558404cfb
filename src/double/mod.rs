//! The CPU engine in f64: the sources of the f32 engine, compiled a second time with
//! `double/real.rs` in place of `real.rs`. It draws the same random numbers, packs the scene
//! without rounding it to f32 and does not quantize directions, so its images differ from those of
//! [`crate::cpu`] only by the error of single precision.

#![allow(clippy::duplicate_mod, clippy::useless_conversion, clippy::unnecessary_cast)]

pub mod real;

#[path = "../math"]
pub mod math {
    //! f64 version of [`crate::math`].

    use super::real;

    #[path = "../double/octahedral.rs"]
    pub mod octahedral;
    pub mod pixel_filter;
    pub mod rng;
    pub mod sampling;
    #[path = "../double/trig.rs"]
    pub mod trig;
    pub mod vector;

    pub use octahedral::*;
    pub use vector::*;
}

#[path = "../accel"]
pub mod accel {
    //! f64 version of the precision-dependent modules of [`crate::accel`].

    use super::{math, real, shapes};

    pub mod kdtree;
    mod kdtree_bins;
    mod kdtree_clip;
    mod kdtree_layout;
    mod kdtree_sweep;
    pub mod revolution;
}

#[path = "../camera.rs"]
pub mod camera;
#[path = "../cpu/mod.rs"]
pub mod cpu;
#[path = "../geometry/mod.rs"]
pub mod geometry;
#[path = "../kernels/mod.rs"]
pub mod kernels;
#[path = "../lights/mod.rs"]
pub mod lights;
#[path = "../materials/mod.rs"]
pub mod materials;
#[path = "../pack/mod.rs"]
pub mod pack;
#[path = "../pilots/mod.rs"]
pub mod pilots;
#[path = "../plan/mod.rs"]
pub mod plan;
#[path = "../shapes/mod.rs"]
pub mod shapes;
#[path = "../tables.rs"]
pub mod tables;
