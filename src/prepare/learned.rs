//! Results of the pilot paths before a render, in f64, so that an engine of another precision can
//! render the same.

use super::normalize::{Normalization, extent};
use crate::scene::{Light, Scene, ShapeKind};

/// Scene element that a light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightSource {
    /// The emitting shape with this index.
    Shape(usize),
    /// The light with this index.
    Light(usize),
    /// The environment.
    Environment,
}

impl LightSource {
    /// Describes the light in terms of the scene file.
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
                    ShapeKind::Instance { .. } => "instance",
                };
                let middle = extent(&shape.kind).map(|(low, high)| (0.5 * (low + high)).to_array());
                let place = middle.map_or(String::new(), |p| format!(" about {p:.3?}"));
                format!("the emitting {kind}{place}")
            }
        }
    }
}

/// All results of the pilot paths.
#[derive(Clone, Debug, PartialEq)]
pub struct Learned {
    /// Normalization of scene space.
    pub normalization: Normalization,
    /// Center of the near sphere, in scene space.
    pub near_center: [f64; 3],
    /// Radius of the near sphere, in scene units.
    pub near_radius: f64,
    /// Radius of the narrowest emission disc, in scene units.
    pub disc_radius: f64,
    /// Number of emission discs.
    pub disc_levels: u32,
    /// 1 if surfaces lie far outside the near sphere, else 0.
    pub far: u32,
    /// 1 if any light has a map, else 0.
    pub guided: u32,
    /// Cumulative emission probabilities of the lights.
    pub lights: Vec<f64>,
    /// Entries to append to the distributions.
    pub distributions: Vec<f64>,
    /// Index of the discs' first probability in `distributions`.
    pub disc_first: u32,
    /// Index of each light's map in `distributions`.
    pub guides: Vec<Option<u32>>,
    /// Split position, axis and first child of each cell; for a leaf, its first entry in
    /// `distributions` in place of the child.
    pub cells: Vec<(f64, u32, u32)>,
}
