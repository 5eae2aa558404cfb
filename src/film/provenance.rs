//! Provenance of an image: all that is needed to render it again.

use std::collections::BTreeMap;

use super::Picture;
use super::exr_file::Frame;
use crate::scene::settings::RenderSettings;
use crate::scene::{Aov, Aovs, Film, ToneMap};

/// Scene, settings and device of a render, written to EXR files as text attributes `caustica.*`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Provenance {
    /// Scene name.
    pub scene: String,
    /// Scene file name as given by the user.
    pub scene_file: String,
    /// Text of the scene file.
    pub scene_text: String,
    /// [`crate::render::identity::Identity::digest`] of the scene; `None` if the render need not be
    /// reproducible.
    pub digest: Option<String>,
    /// Film settings; `None` for an uncropped image without AOVs.
    pub film: Option<Film>,
    /// Material names, indexed by material ID.
    pub materials: Vec<String>,
    /// Requested settings, including command-line overrides, with "auto" unresolved.
    pub asked: Option<RenderSettings>,
    /// Effective settings, with "auto" resolved.
    pub settings: RenderSettings,
    /// Device name.
    pub device: String,
    /// Index of the first pass; 0 unless a range of passes was requested.
    pub first_pass: u32,
    /// Number of passes in the image; less than `settings.passes` if the render stopped early.
    pub passes_done: u32,
    /// Name of the denoiser that produced the layer `denoised`; `None` without that layer.
    pub denoised: Option<String>,
}

/// Version of caustica, as written to files.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

impl Provenance {
    /// Attribute names and values. `caustica.settings` contains all settings as one JSON object;
    /// `caustica.<setting>` contains each setting as a JSON value (strings without quotes).
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
        let mut put =
            |name: &str, value: String| attributes.insert(format!("caustica.{name}"), value);
        if let Some(digest) = &self.digest {
            put("scene_file", self.scene_file.clone());
            put("scene_digest", digest.clone());
        }
        if let Some(denoised) = &self.denoised {
            put("denoised", denoised.clone());
        }
        if let Some(asked) = &self.asked {
            put("asked", serde_json::json!(asked).to_string());
        }
        if let Some(film) = &self.film {
            put("size", format!("{}x{}", film.width, film.height));
            if !film.aovs.is_empty() {
                put("aov", film.aovs.to_string());
            }
            if film.aovs.has(Aov::Material) {
                put("materials", serde_json::json!(self.materials).to_string());
            }
            if let Some([x0, y0, x1, y1]) = film.window {
                put("crop", format!("{x0},{y0},{x1},{y1}"));
            }
        }
        attributes
    }

    /// Parses the output of [`Self::attributes`], except exposure, tone map and material names.
    ///
    /// # Errors
    /// The first attribute that is missing or invalid.
    pub fn read(attributes: &BTreeMap<String, String>) -> Result<Self, String> {
        let get = |name: &str| attributes.get(&format!("caustica.{name}"));
        let need = |name: &str| {
            get(name).ok_or_else(|| {
                format!("the attribute caustica.{name}, written by `caustica render`, is missing")
            })
        };
        let wrong =
            |name: &str, what: &str| format!("the attribute caustica.{name} is invalid: {what}");
        let settings = |name: &str| match get(name) {
            Some(text) => {
                serde_json::from_str(text).map(Some).map_err(|e| wrong(name, &e.to_string()))
            }
            None => Ok(None),
        };
        let numbers = |name: &str, text: &str, between: char| {
            let all: Option<Vec<u32>> =
                text.split(between).map(|number| number.parse().ok()).collect();
            all.ok_or_else(|| wrong(name, "not whole numbers"))
        };
        let [width, height] = numbers("size", need("size")?, 'x')?[..] else {
            return Err(wrong("size", "not two numbers"));
        };
        let window = match get("crop") {
            Some(text) => match numbers("crop", text, ',')?[..] {
                [x0, y0, x1, y1] if x0 < x1 && y0 < y1 && x1 <= width && y1 <= height => {
                    Some([x0, y0, x1, y1])
                }
                _ => return Err(wrong("crop", "not a window of the image")),
            },
            None => None,
        };
        let aovs = get("aov").map_or(Ok(Aovs::default()), |text| Aovs::parse(text));
        let first_pass = get("first_pass").map_or(Ok(0), |text| text.parse());
        let passes = need("passes_done")?.parse::<u32>().ok().filter(|passes| *passes > 0);
        Ok(Self {
            scene: need("scene")?.clone(),
            scene_file: need("scene_file")?.clone(),
            scene_text: need("scene_text")?.clone(),
            digest: Some(need("scene_digest")?.clone()),
            film: Some(Film {
                width,
                height,
                exposure: 0.0,
                tonemap: ToneMap::default(),
                aovs: aovs.map_err(|what| wrong("aov", &what))?,
                window,
                ..Film::default()
            }),
            materials: Vec::new(),
            asked: settings("asked")?,
            settings: settings("settings")?.ok_or_else(|| wrong("settings", "it is missing"))?,
            device: need("device")?.clone(),
            first_pass: first_pass.map_err(|_| wrong("first_pass", "not a pass number"))?,
            passes_done: passes.ok_or_else(|| wrong("passes_done", "not a number of passes"))?,
            denoised: get("denoised").cloned(),
        })
    }

    /// Position of the image in the whole frame, if it is a crop window.
    pub fn frame(&self, picture: &Picture) -> Frame {
        match self.film {
            Some(Film { width, height, window: Some([x, y, _, _]), .. }) => {
                Frame { x, y, width, height }
            }
            _ => Frame::of(picture),
        }
    }
}
