//! One device after another, and what is told where one fails.

use caustica::low_level::device::{Candidates, Opened};
use caustica::low_level::engine::{Engine, EngineError, State};
use caustica::low_level::memory::Memory;
use caustica::low_level::scene::Scene;
use caustica::low_level::scene::settings::RenderSettings;
use serde_json::json;

use super::output::{message, paragraph, result};

/// The devices of one render.
pub struct Succession<'a> {
    candidates: Candidates,
    scene: &'a Scene,
    settings: RenderSettings,
    memory: Memory,
    json: bool,
    /// The one that was tried last.
    last: String,
    /// Those that have rendered.
    rendered: Vec<String>,
}

impl<'a> Succession<'a> {
    /// Those that may be tried.
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

    /// An engine on the first device that can render this.
    pub fn first(&mut self) -> Result<Opened, EngineError> {
        let mut refused = |name: &str, error: &EngineError| {
            paragraph(format_args!("warning: {name} cannot render this: {error}"));
        };
        let opened =
            self.candidates.open(self.scene, &self.settings, &self.memory, &mut refused)?;
        // the devices after it are to round alike
        self.settings.batch = opened.settings.batch;
        self.memory.same_batches = true;
        self.take(opened.name.clone());
        Ok(opened)
    }

    /// After the last one failed: an engine on the next one, which is to go on from `state`;
    /// nothing where there is none.
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
        message(format_args!("going on with {name} after the {passes} passes that were kept"));
        if self.json {
            // Standard output that takes nothing fails the results at the end.
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

    /// The settings as asked for, with the batches of photons that memory allows.
    pub fn asked(&self) -> &RenderSettings {
        &self.settings
    }

    /// The devices that have rendered, in their order.
    pub fn device(&self) -> String {
        self.rendered.join(", ")
    }
}
