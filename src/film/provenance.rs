//! What a picture was made from: enough to make it again.

use std::collections::BTreeMap;

use crate::settings::RenderSettings;

/// How a picture came about; written into EXR files as text attributes named `caustica.*`.
#[derive(Clone, Debug, PartialEq)]
pub struct Provenance {
    /// The scene's name.
    pub scene: String,
    /// The scene file's text.
    pub scene_text: String,
    /// All settings, with the command line's overrides.
    pub settings: RenderSettings,
    /// The device's name.
    pub device: String,
    /// Number of the picture's first pass; 0 but where a range of passes was asked for.
    pub first_pass: u32,
    /// Passes in the picture; fewer than `settings.passes` when the render was stopped early.
    pub passes_done: u32,
}

/// This program's version, as written into files.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

impl Provenance {
    /// Attribute names and values. `caustica.settings` holds all settings as one JSON object, and
    /// `caustica.<setting>` each of them as a JSON value (strings without quotes).
    pub fn attributes(&self) -> BTreeMap<String, String> {
        let settings = serde_json::json!(self.settings);
        let mut attributes = BTreeMap::from([
            ("caustica.scene".to_owned(), self.scene.clone()),
            ("caustica.scene_text".to_owned(), self.scene_text.clone()),
            ("caustica.device".to_owned(), self.device.clone()),
            ("caustica.version".to_owned(), VERSION.to_owned()),
            ("caustica.passes_done".to_owned(), self.passes_done.to_string()),
            ("caustica.settings".to_owned(), settings.to_string()),
        ]);
        if self.first_pass > 0 {
            attributes.insert("caustica.first_pass".to_owned(), self.first_pass.to_string());
        }
        for (key, value) in settings.as_object().into_iter().flatten() {
            let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
            attributes.insert(format!("caustica.{key}"), text);
        }
        attributes
    }
}
