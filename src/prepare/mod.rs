//! Preparation of a scene in f64 before it is packed: normalization, glass bodies, coincident
//! surfaces, orientation.

use super::math;

pub mod bodies;
pub mod contact;
pub mod distribution;
pub mod learned;
pub mod limits;
pub mod normalize;
pub mod orientation;
pub mod parts;
pub mod radius;
