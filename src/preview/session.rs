//! State and actions of the preview, independent of the window.

use std::path::PathBuf;
use std::sync::Arc;

use super::comparison::Comparison;
use super::document::{Edits, edited, save};
use super::frame::{Frame, RenderRequest};
use super::orbit;
use super::reload::{Adjust, Reloaded, Reloader};
use super::view::View;
use super::worker::Worker;
use crate::device::{self, Wanted};
use crate::film::{self, Development, ErrorMap, Provenance};
use crate::memory;
use crate::render::identity::Identity;
use crate::scene::settings::{Direct, Radius, RadiusRule};
use crate::scene::{Allowance, Aov, Film, Loaded, Scene, SceneErrors, ToneMap};
use crate::storage;

/// A change that the user requests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// Orbits the camera about its target, in radians: across and over.
    Orbit(f64, f64),
    /// Moves the camera across the view, in image heights: right and down.
    Pan(f64, f64),
    /// Multiplies the camera's distance from the target.
    Dolly(f64),
    /// Focuses on the surface at an image position from (0, 0) to (1, 1).
    Focus(f64, f64),
    /// Opens or closes the lens by a factor.
    Aperture(f64),
    /// Restores the camera of the scene file.
    Home,
    /// Changes the exposure by a number of stops.
    Expose(f64),
    /// Selects the next tone map.
    ToneMap,
    /// Shows another view.
    View(View),
    /// Multiplies the start radius; an automatic one is replaced by its value first.
    Radius(f64),
    /// Selects the automatic start radius.
    AutoRadius,
    /// Selects the next radius rule.
    Rule,
    /// Multiplies the photons per pass.
    Photons(f64),
    /// Switches between shadow rays and photons for direct light.
    Direct,
    /// Pauses or continues the render.
    Pause,
    /// Keeps the image for comparison, or drops the comparison.
    Keep,
    /// Shows or hides the comparison.
    Split,
    /// Writes the image files.
    SavePicture,
    /// Writes camera and settings into the scene file.
    SaveScene,
}

/// Initial state of a session.
pub struct Start {
    /// The scene file.
    pub file: PathBuf,
    /// Contents of the scene file, with command-line options applied.
    pub loaded: Loaded,
    /// Allowance for loading the scene again.
    pub allowance: Allowance,
    /// Applies the command-line options to a scene that was loaded again.
    pub adjust: Adjust,
    /// Image files to write.
    pub outputs: Vec<PathBuf>,
    /// Device to render on.
    pub device: Wanted,
}

/// An interactive preview of a scene.
pub struct Session {
    file: PathBuf,
    allowance: Allowance,
    /// Image files to write.
    pub outputs: Vec<PathBuf>,
    scene: Arc<Scene>,
    /// Camera, film and settings in the scene file.
    saved: Edits,
    /// Camera, film and settings in the window.
    pub now: Edits,
    /// Device to render on.
    pub device: Wanted,
    /// View of the image.
    pub view: View,
    /// True if the full-size render is paused.
    pub paused: bool,
    /// Image to compare with.
    pub comparison: Option<Comparison>,
    /// Position of the dividing line, from 0 to 1; `None` shows only the current image.
    pub split: Option<f32>,
    /// Message about the last action.
    pub notice: String,
    /// Errors in the scene file; the last valid scene stays on screen.
    pub trouble: Option<String>,
    worker: Worker,
    sent: RenderRequest,
    number: u64,
    reloader: Reloader,
}

impl Session {
    /// Starts to render. `wake` is called on any thread when there is something new.
    pub fn start(start: Start, wake: impl Fn() + Send + Sync + Clone + 'static) -> Self {
        let Start { file, loaded, allowance, adjust, outputs, device } = start;
        let reloader = Reloader::start(
            file.clone(),
            loaded.files.clone(),
            allowance.clone(),
            adjust,
            wake.clone(),
        );
        let now = edits(&loaded);
        let scene = Arc::new(loaded.scene);
        let view = View::default();
        let sent = request(&now, view, &device);
        let mut worker = Worker::start(wake);
        let number = worker.scene(scene.clone(), sent.clone());
        Self {
            file,
            allowance,
            outputs,
            scene,
            saved: now.clone(),
            now,
            device,
            view,
            paused: false,
            comparison: None,
            split: None,
            notice: String::new(),
            trouble: None,
            worker,
            sent,
            number,
            reloader,
        }
    }

    /// Name of the scene.
    pub fn name(&self) -> &str {
        &self.scene.name
    }

    /// Returns whether camera, film or settings differ from the scene file.
    pub fn is_edited(&self) -> bool {
        self.now != self.saved
    }

    /// The newest frame.
    pub fn frame(&self) -> Option<Arc<Frame>> {
        self.worker.frame()
    }

    /// The newest full-size frame of the current request.
    pub fn whole(&self) -> Option<Arc<Frame>> {
        self.frame().filter(|frame| !frame.quick && frame.number == self.number)
    }

    /// Reason why rendering failed, if it did.
    pub fn failure(&self) -> Option<String> {
        let comparison = self.comparison.as_ref().and_then(Comparison::failure);
        self.worker.slot().failure().or(comparison)
    }

    /// Conversion of radiance to display values.
    pub fn development(&self) -> Development {
        let Film { exposure, tonemap, .. } = self.now.film;
        Development { exposure, tonemap, ..Development::default() }
    }

    /// Compares with the same scene on another device.
    pub fn beside_device(&mut self, name: &str, wake: impl Fn() + Send + Sync + 'static) {
        let mut worker = Worker::start(wake);
        let wanted = device::parse(name);
        worker.scene(
            self.scene.clone(),
            RenderRequest { device: wanted.clone(), ..self.sent.clone() },
        );
        self.hold(Comparison::device(name, worker, wanted));
    }

    /// Compares with another image.
    pub fn hold(&mut self, comparison: Comparison) {
        self.comparison = Some(comparison);
        self.split = Some(0.5);
    }

    /// Performs an action.
    pub fn act(&mut self, action: Action) {
        let Edits { camera, film, settings } = &mut self.now;
        match action {
            Action::Orbit(across, over) => *camera = orbit::orbit(camera, across, over),
            Action::Pan(right, down) => *camera = orbit::pan(camera, film, right, down),
            Action::Dolly(factor) => *camera = orbit::dolly(camera, factor),
            Action::Focus(x, y) => self.worker.look(x, y),
            Action::Aperture(factor) => *camera = orbit::aperture(camera, factor),
            Action::Home => *camera = self.saved.camera,
            Action::Expose(stops) => film.exposure += stops,
            Action::ToneMap => {
                film.tonemap = match film.tonemap {
                    ToneMap::Agx => ToneMap::Srgb,
                    ToneMap::Srgb => ToneMap::Agx,
                }
            }
            Action::View(view) => self.view = view,
            Action::Radius(factor) => {
                let chosen = self.whole().map(|frame| frame.setup.settings.radius);
                let settings = &mut self.now.settings;
                settings.radius = match (settings.radius, chosen) {
                    (Radius::Auto, None | Some(Radius::Auto)) => Radius::Auto,
                    (Radius::Auto, Some(chosen)) => times(chosen, factor),
                    (radius, _) => times(radius, factor),
                };
            }
            Action::AutoRadius => settings.radius = Radius::Auto,
            Action::Rule => {
                settings.radius_rule = match settings.radius_rule {
                    RadiusRule::Global => RadiusRule::Local,
                    RadiusRule::Local => RadiusRule::Fixed,
                    RadiusRule::Fixed => RadiusRule::Global,
                }
            }
            Action::Photons(factor) => {
                settings.photons = (f64::from(settings.photons) * factor).clamp(1.0, 1e8) as u32;
            }
            Action::Direct => {
                settings.direct = match settings.direct {
                    Direct::Sampled => Direct::Photons,
                    Direct::Photons => Direct::Sampled,
                }
            }
            Action::Pause => {
                self.paused = !self.paused;
                self.worker.pause(self.paused);
                if let Some((worker, _)) = self.comparison.as_mut().and_then(Comparison::worker) {
                    worker.pause(self.paused);
                }
            }
            Action::Keep => match (self.comparison.take(), self.frame()) {
                (None, Some(frame)) => self.hold(Comparison::kept(frame)),
                _ => self.split = None,
            },
            Action::Split => {
                self.split = match self.split {
                    None if self.comparison.is_some() => Some(0.5),
                    _ => None,
                }
            }
            Action::SavePicture => self.notice = self.save_picture().unwrap_or_else(|why| why),
            Action::SaveScene => self.notice = self.save_scene().unwrap_or_else(|why| why),
        }
    }

    /// Takes results from other threads, and sends changes to the render thread.
    pub fn tick(&mut self) {
        if let Some(reloaded) = self.reloader.take() {
            self.take(reloaded);
        }
        if let Some(depth) = self.worker.slot().take_depth() {
            self.now.camera = orbit::focus(&self.now.camera, depth);
            self.notice = format!("focus at {:.4}", self.now.camera.focus);
        }
        let request = self.request();
        if request != self.sent {
            self.number = self.worker.change(request.clone());
            self.sent = request;
            self.tell_beside(None);
        }
    }

    /// The render request for the current state. If nothing else has changed, it keeps the layers
    /// requested before, so that returning to their view does not restart the render.
    fn request(&self) -> RenderRequest {
        let mut request = request(&self.now, self.view, &self.device);
        let own = std::mem::replace(&mut request.film.aovs, self.sent.film.aovs);
        request.film.aovs =
            if request.same_passes(&self.sent) { own.union(self.sent.film.aovs) } else { own };
        request
    }

    fn tell_beside(&mut self, scene: Option<&Arc<Scene>>) {
        if let Some((worker, device)) = self.comparison.as_mut().and_then(Comparison::worker) {
            let request = RenderRequest { device: device.clone(), ..self.sent.clone() };
            match scene {
                Some(scene) => worker.scene(scene.clone(), request),
                None => worker.change(request),
            };
        }
    }

    /// Takes a scene that was loaded again. Camera, film and settings that changed in the file
    /// replace those of the window; the others stay. Errors leave everything unchanged.
    fn take(&mut self, reloaded: Reloaded) {
        let loaded = match reloaded {
            Ok(loaded) => loaded,
            Err(errors) => {
                self.trouble = Some(message(&errors));
                return;
            }
        };
        self.trouble = None;
        let read = edits(&loaded);
        if read.camera != self.saved.camera {
            self.now.camera = read.camera;
        }
        if read.film != self.saved.film {
            self.now.film = read.film;
        }
        if read.settings != self.saved.settings {
            self.now.settings = read.settings.clone();
        }
        self.saved = read;
        let mut scene = loaded.scene;
        (scene.camera, scene.film) = (self.scene.camera, self.scene.film);
        if scene != *self.scene {
            self.scene = Arc::new(scene);
            self.sent = request(&self.now, self.view, &self.device);
            self.number = self.worker.scene(self.scene.clone(), self.sent.clone());
            let scene = self.scene.clone();
            self.tell_beside(Some(&scene));
            self.notice = "the scene was reloaded".to_owned();
        }
    }

    fn save_picture(&mut self) -> Result<String, String> {
        let frame = self.whole().ok_or("not saved: the full-size image is not ready yet")?;
        film::check_outputs(&self.outputs).map_err(|error| error.to_string())?;
        let scene = Arc::make_mut(&mut self.scene);
        (scene.camera, scene.film) = (self.sent.camera, self.sent.film);
        let text = storage::read_text(&self.file, memory::readable()).unwrap_or_default();
        let made = Provenance {
            scene: scene.name.clone(),
            scene_file: self.file.display().to_string(),
            scene_text: edited(&text, &self.saved, &self.now).unwrap_or(text),
            digest: Some(Identity::of(scene).digest()),
            film: Some(self.sent.film),
            materials: scene.materials.iter().map(|material| material.name.clone()).collect(),
            asked: Some(self.sent.settings.clone()),
            settings: frame.setup.settings.clone(),
            device: frame.setup.device.clone(),
            first_pass: 0,
            passes_done: frame.passes,
            denoised: None,
        };
        let errors = frame.errors.as_deref().filter(|_| frame.estimated == frame.passes);
        let mut layers = errors.map_or_else(Vec::new, ErrorMap::layers);
        layers.extend_from_slice(&frame.layers);
        let development = self.development();
        for output in &self.outputs {
            film::write(output, &frame.picture, &layers, &development, &made)
                .map_err(|error| error.to_string())?;
        }
        let names: Vec<_> =
            self.outputs.iter().map(|output| output.display().to_string()).collect();
        let camera = if self.now.camera == self.saved.camera {
            ""
        } else {
            "; its camera is not in the scene file"
        };
        Ok(format!("saved {} after {} passes{camera}", names.join(", "), frame.passes))
    }

    fn save_scene(&mut self) -> Result<String, String> {
        save(&self.file, &self.allowance, &self.saved, &self.now)
            .map_err(|error| format!("not saved: {error}"))?;
        self.saved = self.now.clone();
        Ok(format!("saved {}", self.file.display()))
    }
}

fn edits(loaded: &Loaded) -> Edits {
    let film =
        Film { aovs: std::iter::empty::<Aov>().collect(), window: None, ..loaded.scene.film };
    Edits { camera: loaded.scene.camera, film, settings: loaded.settings.clone() }
}

fn request(now: &Edits, view: View, device: &Wanted) -> RenderRequest {
    // exposure and tone map do not affect the render
    let film = Film { aovs: view.aovs(), exposure: 0.0, tonemap: ToneMap::default(), ..now.film };
    RenderRequest {
        camera: now.camera,
        film,
        settings: now.settings.clone(),
        device: device.clone(),
    }
}

fn times(radius: Radius, factor: f64) -> Radius {
    // three digits are enough, and halving undoes doubling
    let short = |x: f64| format!("{:.2e}", x * factor).parse().unwrap_or(x);
    match radius {
        Radius::Auto => Radius::Auto,
        Radius::Pixels(pixels) => Radius::Pixels(short(pixels)),
        Radius::Units(units) => Radius::Units(short(units)),
    }
}

/// The errors of a scene, one per line.
fn message(errors: &SceneErrors) -> String {
    let line = |finding: &crate::scene::Finding| {
        let place = finding
            .line_column()
            .map_or(String::new(), |(line, column)| format!(":{line}:{column}"));
        let hint = [Some(finding.label()), finding.help()];
        let hint: Vec<_> = hint.into_iter().flatten().filter(|text| !text.is_empty()).collect();
        let hint = if hint.is_empty() { String::new() } else { format!(" ({})", hint.join("; ")) };
        format!("{}{place}: {}{hint}", finding.file(), finding.message())
    };
    errors.errors.iter().map(line).collect::<Vec<_>>().join("\n")
}
