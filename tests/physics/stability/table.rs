//! The rows of the table: an extreme with its theory, its measurement, and its bound.

use super::bench::Bench;

/// One row: an extreme.
pub struct Row {
    /// The extreme quantity.
    pub name: &'static str,
    /// The theory and how the figure is measured.
    pub how: &'static str,
    /// Unit of the figure.
    pub unit: &'static str,
    /// Largest figure that passes.
    pub bound: f64,
    /// The measurement.
    pub measure: fn(&Bench) -> Figure,
}

/// A result of a measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The number compared with the bound.
    pub value: f64,
    /// Further information for the table.
    pub note: String,
}

impl From<f64> for Figure {
    fn from(value: f64) -> Self {
        Self { value, note: String::new() }
    }
}

impl Row {
    /// Whether a figure passes; NaN and infinity do not.
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
