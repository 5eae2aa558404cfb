//! What was learned from pilots before a render, in f64: for an engine of another precision that is to
//! render the same.

use super::normalize::Normalization;

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
