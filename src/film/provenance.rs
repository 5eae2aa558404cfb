//! What a picture was made from: enough to make it again.

use std::collections::BTreeMap;

use super::Picture;
use super::exr_file::Frame;
use crate::scene::settings::RenderSettings;
use crate::scene::{Aov, Aovs, Film, ToneMap};

/// How a picture came about; written into EXR files as text attributes named `caustica.*`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Provenance {
    /// The scene's name.
    pub scene: String,
    /// The scene file's name, as it was given.
    pub scene_file: String,
    /// The scene file's text.
    pub scene_text: String,
    /// [`crate::render::identity::Identity::digest`] of the scene; none where nobody is to make it again.
    pub digest: Option<String>,
    /// What it was taken on; none for a whole picture with nothing but radiance.
    pub film: Option<Film>,
    /// The materials' names, in the order of their numbers.
    pub materials: Vec<String>,
    /// All settings, with the command line's overrides, but with "auto" where the render chose.
    pub asked: Option<RenderSettings>,
    /// The same with what was chosen.
    pub settings: RenderSettings,
    /// The device's name.
    pub device: String,
    /// Number of the picture's first pass; 0 but where a range of passes was asked for.
    pub first_pass: u32,
    /// Passes in the picture; fewer than `settings.passes` when the render was stopped early.
    pub passes_done: u32,
    /// What made the layer `denoised`; none where it is not there.
    pub denoised: Option<String>,
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

    /// Reads what [`Self::attributes`] wrote, but for exposure, tone map and the materials' names;
    /// an error says what is missing or not understood.
    pub fn read(attributes: &BTreeMap<String, String>) -> Result<Self, String> {
        let get = |name: &str| attributes.get(&format!("caustica.{name}"));
        let need = |name: &str| {
            get(name).ok_or_else(|| {
                format!("it lacks the attribute caustica.{name}, which `caustica render` writes")
            })
        };
        let wrong = |name: &str, what: &str| {
            format!("its attribute caustica.{name} is not understood: {what}")
        };
        let settings = |name: &str| match get(name) {
            Some(text) => {
                serde_json::from_str(text).map(Some).map_err(|e| wrong(name, &e.to_string()))
            }
            None => Ok(None),
        };
        let numbers = |name: &str, text: &str, between: char| {
            let all: Option<Vec<u32>> =
                text.split(between).map(|number| number.parse().ok()).collect();
            all.ok_or_else(|| wrong(name, "no whole numbers"))
        };
        let [width, height] = numbers("size", need("size")?, 'x')?[..] else {
            return Err(wrong("size", "not two numbers"));
        };
        let window = match get("crop") {
            Some(text) => match numbers("crop", text, ',')?[..] {
                [x0, y0, x1, y1] if x0 < x1 && y0 < y1 && x1 <= width && y1 <= height => {
                    Some([x0, y0, x1, y1])
                }
                _ => return Err(wrong("crop", "no window of the picture")),
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
            }),
            materials: Vec::new(),
            asked: settings("asked")?,
            settings: settings("settings")?.ok_or_else(|| wrong("settings", "it is missing"))?,
            device: need("device")?.clone(),
            first_pass: first_pass.map_err(|_| wrong("first_pass", "no number of a pass"))?,
            passes_done: passes.ok_or_else(|| wrong("passes_done", "no number of passes"))?,
            denoised: get("denoised").cloned(),
        })
    }

    /// Where the picture lies in the whole that it is a window of.
    pub fn frame(&self, picture: &Picture) -> Frame {
        match self.film {
            Some(Film { width, height, window: Some([x, y, _, _]), .. }) => {
                Frame { x, y, width, height }
            }
            _ => Frame::of(picture),
        }
    }
}
