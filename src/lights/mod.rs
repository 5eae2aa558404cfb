//! Lights: choice, shadow-ray samples and photon emission. Twins: `shaders/lights/`.

use super::{materials, math, real, shapes, tables};

pub mod aim;
pub mod emission;
pub mod guide;
pub mod light;
pub mod select;
pub mod shape;
