//! The rows: an extreme each, with the theory, the way it is measured, and the bound that must hold.

use super::bench::{Bench, On};

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
        ("Shapes and rays", super::rays::rows()),
        ("Surfaces of revolution", super::surfaces::rows()),
        ("Radius, counts and means", super::counts::rows()),
        ("Light, film and camera", super::view::rows()),
    ]
}

/// The table as Markdown, measured on both devices; and whether every row holds. `told` hears each row's name.
pub fn markdown(long: bool, only: &str, mut told: impl FnMut(&str)) -> (String, bool) {
    let benches = [On::Cpu, On::Software].map(|on| Bench::new(on, long));
    let mut text = String::new();
    let mut holds = true;
    for (section, rows) in sections() {
        text += &format!(
            "## {section}\n\n| extreme | figure | CPU | lavapipe | bound |\n|---|---|---|---|---|\n"
        );
        let mut notes = String::new();
        for row in rows.iter().filter(|row| row.name.contains(only)) {
            told(row.name);
            let figures = benches.each_ref().map(|bench| (row.measure)(bench));
            holds &= figures.iter().all(|figure| row.admits(figure));
            let [cpu, software] = figures.each_ref().map(|figure| {
                let mark = if row.admits(figure) { "" } else { " **fails**" };
                format!("{}{mark}", number(figure.value))
            });
            text +=
                &format!("| {} | {} | {cpu} | {software} | {} |\n", row.name, row.unit, number(row.bound));
            notes += &format!("- *{}*: {}", row.name, row.how);
            let [cpu, software] = figures.map(|figure| figure.note);
            if !cpu.is_empty() {
                notes += &format!(" {cpu}");
            }
            if software != cpu && !software.is_empty() {
                notes += &format!(" lavapipe: {software}");
            }
            notes += "\n";
        }
        text += &format!("\n{notes}\n");
    }
    (text, holds)
}

fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        1e-2..1e4 if value.fract() == 0.0 => format!("{value}"),
        0.1..1e4 => format!("{value:.2}"),
        _ => format!("{value:.1e}"),
    }
}
