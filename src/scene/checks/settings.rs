//! Ranges of the render settings.

use std::ops::Range;

use crate::scene::diagnostics::Report;
use crate::scene::numbers::{LARGEST, SMALLEST};
use crate::scene::parts::Part;

/// A number of [`RenderSettings`](crate::scene::settings::RenderSettings) with a range.
pub(crate) struct Setting {
    /// Name of the field.
    pub key: &'static str,
    expected: &'static str,
    holds: fn(f64) -> bool,
}

const AT_LEAST_1: Setting =
    Setting { key: "", expected: "at least 1", holds: |count| count != 0.0 };

/// The settings with a range; importers check negative counts.
pub(crate) const SETTINGS: [Setting; 6] = [
    Setting { key: "passes", ..AT_LEAST_1 },
    Setting { key: "photons", ..AT_LEAST_1 },
    Setting { key: "batch", ..AT_LEAST_1 },
    Setting {
        key: "radius",
        expected: "a number from 1e-15 to 1e15",
        holds: |radius| (SMALLEST..=LARGEST).contains(&radius),
    },
    Setting {
        key: "indirect_radius",
        expected: "a number from 1 to 16",
        holds: |times| (1.0..=16.0).contains(&times),
    },
    Setting {
        key: "alpha",
        expected: "a number greater than 0 and at most 1",
        holds: |alpha| alpha > 0.0 && alpha <= 1.0,
    },
];

/// Reports a finite number, written at `span` of the source, that is out of the range of a setting.
pub(crate) fn setting(
    report: &mut Report,
    part: &dyn Part,
    setting: &Setting,
    number: f64,
    span: Range<usize>,
) {
    if number.is_finite() && !(setting.holds)(number) {
        let message = format!("`{}.{}` is out of range", part.place(), setting.key);
        report.error(span, message, format!("expected {}", setting.expected), None);
    }
}
