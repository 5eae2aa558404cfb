//! Fallback to other devices, and its messages.

use caustica::low_level::device::{Candidates, Opened};
use caustica::low_level::engine::{Engine, EngineError, State};
use caustica::low_level::memory::Memory;
use caustica::low_level::scene::Scene;
use caustica::low_level::scene::settings::RenderSettings;
use serde_json::json;

use super::output::{message, paragraph, result};

/// Devices of one render, in order of preference.
pub struct Succession<'a> {
    candidates: Candidates,
    scene: &'a Scene,
    settings: RenderSettings,
    memory: Memory,
    json: bool,
    /// Device that was tried last.
    last: String,
    /// Devices that have rendered.
    rendered: Vec<String>,
}

impl<'a> Succession<'a> {
    /// Creates the sequence of candidate devices.
    pub fn new(
        candidates: Candidates,
        scene: &'a Scene,
        settings: &RenderSettings,
        memory: Memory,
        json: bool,
    ) -> Self {
        let settings = settings.clone();
        Self {
            candidates,
            scene,
            settings,
            memory,
            json,
            last: String::new(),
            rendered: Vec::new(),
        }
    }

    /// Opens an engine on the first device that can render the scene.
    pub fn first(&mut self) -> Result<Opened, EngineError> {
        let mut refused = |name: &str, error: &EngineError| {
            paragraph(format_args!("warning: {name} cannot render this scene: {error}"));
        };
        let opened =
            self.candidates.open(self.scene, &self.settings, &self.memory, &mut refused)?;
        // later devices use the same batches, so that rounding does not change
        self.settings.batch = opened.settings.batch;
        self.memory.same_batches = true;
        self.take(opened.name.clone());
        Ok(opened)
    }

    /// Opens an engine on the next device after the last one failed; it continues from `state`.
    /// Returns `None` if no device is left.
    pub fn next(
        &mut self,
        error: &EngineError,
        state: &State,
    ) -> Option<Result<Box<dyn Engine>, EngineError>> {
        let (name, opened) = self.candidates.next(self.scene, &self.settings, &self.memory)?;
        paragraph(format_args!("warning: {}: {error}", self.last));
        let failed = std::mem::replace(&mut self.last, name.clone());
        let opened = match opened {
            Ok(opened) => opened,
            Err(error) => return Some(Err(error)),
        };
        let passes = state.passes;
        message(format_args!("continuing on {name} after {passes} recovered passes"));
        if self.json {
            // a failure of standard output is reported with the results at the end
            let _ = result(json!({
                "event": "device",
                "device": name,
                "passes": passes,
                "failed": failed,
                "why": error.to_string(),
            }));
        }
        self.take(name);
        Some(Ok(opened.engine))
    }

    fn take(&mut self, name: String) {
        self.last = name.clone();
        self.rendered.push(name);
    }

    /// Requested settings, with the photon batches that fit into memory.
    pub fn asked(&self) -> &RenderSettings {
        &self.settings
    }

    /// Names of the devices that have rendered, in order.
    pub fn device(&self) -> String {
        self.rendered.join(", ")
    }
}
