//! What was learned from pilots before a render, in f64: for an engine of another precision that is
//! to render the same.

use super::normalize::{Normalization, extent};
use crate::scene::{Light, Scene, ShapeKind};

/// Where a light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightSource {
    /// The scene's shape of this index emits.
    Shape(usize),
    /// The scene's light of this index.
    Light(usize),
    /// The scene's environment.
    Environment,
}

impl LightSource {
    /// What a reader of the scene file calls it.
    pub fn describe(self, scene: &Scene) -> String {
        match self {
            Self::Environment => "the environment".to_owned(),
            Self::Light(index) => {
                let kind = match scene.lights.get(index) {
                    Some(Light::Point { .. }) => "point light",
                    Some(Light::Spot { .. }) => "spot light",
                    Some(Light::Sun { .. }) => "sun",
                    None => "light",
                };
                format!("the {kind} lights[{index}]")
            }
            Self::Shape(index) => {
                let Some(shape) = scene.shapes.get(index) else {
                    return format!("shapes[{index}]");
                };
                let kind = match &shape.kind {
                    ShapeKind::Sphere { .. } => "sphere",
                    ShapeKind::Rectangle { .. } => "rectangle",
                    ShapeKind::Disc { .. } => "disc",
                    ShapeKind::Plane { .. } => "plane",
                    ShapeKind::Cuboid { .. } => "box",
                    ShapeKind::Mesh(_) => "mesh",
                    ShapeKind::Revolution { .. } => "revolution",
                };
                let middle = extent(&shape.kind).map(|(low, high)| (0.5 * (low + high)).to_array());
                let place = middle.map_or(String::new(), |p| format!(" about {p:.3?}"));
                format!("the emitting {kind}{place}")
            }
        }
    }
}

/// Everything that pilots decide.
#[derive(Clone, Debug, PartialEq)]
pub struct Learned {
    /// Place and unit of scene space.
    pub normalization: Normalization,
    /// Center of what the camera sees, scene space.
    pub near_center: [f64; 3],
    /// Radius of what the camera sees, scene units.
    pub near_radius: f64,
    /// Radius of the narrowest emission disc, scene units.
    pub disc_radius: f64,
    /// Number of emission discs.
    pub disc_levels: u32,
    /// Whether surfaces lie far outside of the near sphere.
    pub far: u32,
    /// Whether any light has a map.
    pub guided: u32,
    /// Cumulative probabilities of the lights of photons.
    pub lights: Vec<f64>,
    /// What is appended to the distributions.
    pub distributions: Vec<f64>,
    /// Where the discs' probabilities begin in `distributions`.
    pub disc_first: u32,
    /// Where each light's map begins in `distributions`.
    pub guides: Vec<Option<u32>>,
    /// Plane, axis and first entry of each cell; of a leaf the entry in `distributions`.
    pub cells: Vec<(f64, u32, u32)>,
}
