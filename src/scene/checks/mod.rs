//! Checks of the meaning of a scene's parts, for every importer: degenerate shapes, directions
//! without a direction, emitting planes, limits, unused parts, a scene without light.
//!
//! The checks read the description, and report at positions that a [`Part`](super::parts::Part)
//! provides. The ranges of single numbers are checked by the importers, against `numbers`.

mod camera;
mod direction;
mod light;
mod material;
mod profile;
mod scene;
mod settings;
mod shape;

pub(crate) use camera::{camera, film};
pub(crate) use direction::unit;
pub(crate) use light::light;
pub(crate) use material::composition;
pub(crate) use profile::{Curve, profile};
pub(crate) use scene::{Named, lit, shape_count, unused};
pub(crate) use settings::{SETTINGS, setting};
pub(crate) use shape::{moved, shapes};
