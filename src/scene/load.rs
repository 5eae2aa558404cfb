//! Loads a scene file as a [`Scene`]: parses it, validates it against the schema, resolves names,
//! and checks the meaning of the parts.

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use serde_json::Value as Json;

use super::diagnostics::{Finding, Report, SceneErrors, list};
use super::file::{EnvironmentFile, LightFile, MaterialFile, SceneFile, ShapeFile, TextureFile};
use super::images::ImageStore;
use super::libraries::{Own, OwnKey};
use super::limits::{Allowance, within};
use super::spans::Spans;
use super::validate::{Document, document};
use super::{Scene, camera, material, mesh, schema, surfaces, text};
use crate::scene::settings::RenderSettings;
use crate::telemetry::stage::stage;

/// Contents of a scene file.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The validated scene.
    pub scene: Scene,
    /// The file's `[render]` section, with defaults filled in.
    pub settings: RenderSettings,
    /// Warnings about the scene.
    pub warnings: Vec<Finding>,
    /// Positions of the parts in the file.
    pub places: Spans,
    /// Files that were read in addition to the scene file.
    pub files: Vec<PathBuf>,
}

static SCHEMA: LazyLock<Json> = LazyLock::new(schema::of::<SceneFile>);

/// Reads a scene file and all files that it names.
///
/// # Errors
/// All errors in these files together.
pub fn load(path: &Path) -> Result<Loaded, SceneErrors> {
    load_within(path, &Allowance::default())
}

/// Like [`load`], within an allowance.
///
/// # Errors
/// As [`load`], and everything that the allowance forbids.
pub fn load_within(path: &Path, allowance: &Allowance) -> Result<Loaded, SceneErrors> {
    parse_within(path, &text::read(path, allowance)?, allowance)
}

/// Reads a scene from a file's bytes. `path` names the scene in messages, and file names in the
/// scene are relative to it.
///
/// # Errors
/// As [`load`].
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Loaded, SceneErrors> {
    parse_within(path, bytes, &Allowance::default())
}

/// Like [`parse`], within an allowance. `bytes` may have any length.
///
/// # Errors
/// As [`load_within`].
pub fn parse_within(
    path: &Path,
    bytes: &[u8],
    allowance: &Allowance,
) -> Result<Loaded, SceneErrors> {
    let _stage = stage("parse");
    let ((scene, settings, places, files), warnings) =
        text::parse(path, bytes, allowance, |root, report| {
            let count = root.get("shapes").map_or(0, |shapes| shapes.elements().count() as u64);
            if let Err(refusal) = within("shapes", "shapes", count, allowance.shapes) {
                report.error(
                    root.span_of("shapes"),
                    format!("the scene is too large: {refusal}"),
                    "here",
                    refusal.help(),
                );
                return None;
            }
            let document = document(&SCHEMA, root, report);
            Loader::new(path, allowance, &document, report).load()
        })?;
    Ok(Loaded { scene, settings, warnings, places, files })
}

/// State that the parts of a scene share during loading.
pub(crate) struct Loader<'l, 'a> {
    pub document: &'l Document<'a>,
    pub report: &'l mut Report,
    pub images: ImageStore,
    pub allowance: &'l Allowance,
    /// Amounts of the allowance that meshes have used.
    pub spent: mesh::Spent,
    /// Materials from MTL files so far.
    pub own_materials: HashMap<OwnKey, Own>,
    path: &'l Path,
}

impl<'l, 'a> Loader<'l, 'a> {
    fn new(
        path: &'l Path,
        allowance: &'l Allowance,
        document: &'l Document<'a>,
        report: &'l mut Report,
    ) -> Self {
        let images = ImageStore::new(allowance);
        let (spent, own_materials) = Default::default();
        Self { document, report, images, allowance, spent, own_materials, path }
    }

    fn load(mut self) -> Option<(Scene, RenderSettings, Spans, Vec<PathBuf>)> {
        let document = self.document;
        if let Some(item) = document.item("version")
            && let Some(version) = item.read::<u32>(self.report)
            && version != 1
        {
            let message = format!("scene format version {version} is not supported");
            self.report.error(item.node.span(), message, "expected 1", None);
        }
        self.undefined("materials", "shapes", "material");
        self.undefined("textures", "materials", "reflectance");
        let mut places = Spans::new(self.path, self.report.source.clone());
        for section in ["camera", "render", "materials", "shapes", "lights"] {
            document.items(section).for_each(|item| places.add(item));
        }
        let camera = camera::camera(&mut self);
        let film = camera::film(&mut self);
        let settings = camera::settings(&mut self);
        let mut textures = Vec::new();
        for item in document.items("textures") {
            if let Some(file) = item.read::<TextureFile>(self.report) {
                textures.extend(material::texture(&mut self, item, file));
            }
        }
        let mut materials = Vec::new();
        for item in document.items("materials") {
            if let Some(file) = item.read::<MaterialFile>(self.report) {
                materials.push(material::material(&self, item, file));
                places.materials.push(item.path.clone());
            }
        }
        let mut shapes = Vec::new();
        for item in document.items("shapes") {
            if let Some(file) = item.read::<ShapeFile>(self.report) {
                let made = surfaces::shapes(&mut self, item, file, &mut textures, &mut materials);
                shapes.extend(made.into_iter().flatten());
                places.shapes.resize(shapes.len(), item.path.clone());
            }
        }
        let mut lights = Vec::new();
        for item in document.items("lights") {
            if let Some(file) = item.read::<LightFile>(self.report) {
                lights.extend(camera::light(&mut self, item, file));
            }
        }
        let environment = document.item("environment").and_then(|item| {
            let file = item.read::<EnvironmentFile>(self.report)?;
            camera::environment(&mut self, item, &file)
        });
        self.report.files.append(&mut self.images.files);
        let scene = Scene {
            name: self
                .path
                .file_stem()
                .map_or(String::new(), |stem| stem.to_string_lossy().into_owned()),
            camera: camera?,
            film: film?,
            images: std::mem::take(&mut self.images.images),
            textures,
            materials,
            shapes,
            lights,
            environment,
        };
        if self.report.errors.is_empty() {
            self.unused("materials", "shapes", "material");
            self.unused("textures", "materials", "reflectance");
            if !scene.is_lit() {
                let message = "the scene has no light; the image will be black";
                let label = "expected an emission above 0, [[lights]] or [environment]";
                self.report.warn(0..0, message, label);
            }
        }
        Some((scene, settings?, places, self.report.files.clone()))
    }

    /// Index of a named part; 0 for an unknown name, which [`Self::undefined`] has reported.
    pub fn index(&self, section: &str, name: &str) -> usize {
        self.document.index(section, name).unwrap_or(0)
    }

    /// Resolves a path relative to the scene file.
    pub fn resolve(&self, file: &str) -> PathBuf {
        self.allowance.find(self.path.parent().unwrap_or(Path::new("")), file)
    }

    /// Reports names that parts of `user` reference under `key` and that `section` does not define.
    fn undefined(&mut self, section: &str, user: &str, key: &str) {
        let singular = section.trim_end_matches('s');
        let known: Vec<_> = self.document.items(section).map(|item| item.name).collect();
        for node in self.document.items(user).filter_map(|item| item.node.get(key)) {
            let Some(name) = node.str().filter(|name| self.document.index(section, name).is_none())
            else {
                continue;
            };
            let label = self.report.did_you_mean(
                name,
                known.iter().copied(),
                &format!("no such {singular}"),
            );
            let help = match known[..] {
                [] => format!("define it: [{section}.{name}]"),
                _ => format!(
                    "define [{section}.{name}], or use one of {}",
                    list(known.iter().copied())
                ),
            };
            let message = format!("{singular} `{name}` is not defined");
            self.report.error(node.span(), message, label, Some(help));
        }
    }

    /// Warns about parts of `section` that no part of `user` references under `key`.
    fn unused(&mut self, section: &str, user: &str, key: &str) {
        let users = self.document.items(user).filter_map(|item| item.node.get(key)?.str());
        let used: BTreeSet<_> = users.collect();
        for item in self.document.items(section).filter(|item| !used.contains(item.name)) {
            let message = format!("{} `{}` is not used", section.trim_end_matches('s'), item.name);
            self.report.warn(item.node.span(), message, "defined here");
        }
    }
}

impl Scene {
    /// Returns whether the scene contains any light source.
    pub fn is_lit(&self) -> bool {
        !self.lights.is_empty()
            || self.environment.is_some()
            || self.shapes.iter().any(super::Shape::is_emitter)
    }
}
