//! The rows: an extreme each, with the theory, the way it is measured, and the bound that must
//! hold.

use super::bench::Bench;

/// One extreme.
pub struct Row {
    /// What is extreme.
    pub name: &'static str,
    /// The theory and how the figure is measured.
    pub how: &'static str,
    /// What the figure counts or in which unit it is.
    pub unit: &'static str,
    /// Greatest figure that passes.
    pub bound: f64,
    /// Measures.
    pub measure: fn(&Bench) -> Figure,
}

/// What was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Held against the bound.
    pub value: f64,
    /// What else is worth telling.
    pub note: String,
}

impl From<f64> for Figure {
    fn from(value: f64) -> Self {
        Self { value, note: String::new() }
    }
}

impl Row {
    /// Whether a figure passes; what is no number does not.
    pub fn admits(&self, figure: &Figure) -> bool {
        figure.value <= self.bound
    }
}

/// All rows in their sections.
pub fn sections() -> Vec<(&'static str, Vec<Row>)> {
    vec![
        ("Scale and place", super::scale::rows()),
        (
            "Shapes and rays",
            super::rays::rows().into_iter().chain(super::grazing::rows()).collect(),
        ),
        ("Surfaces of revolution", super::surfaces::rows()),
        ("Radius, counts and means", super::counts::rows()),
        ("Light, film and camera", super::view::rows()),
    ]
}
