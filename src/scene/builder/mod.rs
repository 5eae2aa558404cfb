//! Collects the parts of a scene from an importer, checks them, and makes the [`Scene`].

mod images;
mod placed;

use std::path::{Path, PathBuf};

pub(crate) use self::placed::GroupParts;
use super::checks::Named;
use super::diagnostics::{Report, SceneErrors};
use super::images::ImageStore;
use super::limits::Allowance;
use super::load::{InputFile, Loaded};
use super::meshes::MeshState;
use super::parts::Part;
use super::settings::RenderSettings;
use super::{Camera, Environment, Film, Light, Material, Scene, Shape, Spans, Texture, checks};

/// A scene in the making.
///
/// Importers add parts of the description in the order of the scene's indices. Every method that
/// adds a part runs the checks on it, reports what is wrong at the part's position, and records
/// that position. Loading continues after an error, so that one run shows all errors.
pub(crate) struct SceneBuilder<'a> {
    pub report: Report,
    pub allowance: &'a Allowance,
    pub images: ImageStore,
    /// What the meshes of the scene share during loading.
    pub meshes: MeshState,
    path: &'a Path,
    spans: Spans,
    named: Named,
    camera: Option<Camera>,
    film: Option<Film>,
    settings: Option<RenderSettings>,
    textures: Vec<Texture>,
    materials: Vec<Material>,
    shapes: Vec<Shape>,
    /// Number of shapes that instances made, including those in groups; the greatest number after
    /// the error that they are too many.
    instanced: u64,
    lights: Vec<Light>,
    environment: Option<Environment>,
}

impl<'a> SceneBuilder<'a> {
    /// An empty scene from a file; `report` may contain findings already.
    pub fn new(file: &InputFile<'a>, report: Report) -> Self {
        Self {
            images: ImageStore::new(file.allowance),
            meshes: MeshState::default(),
            spans: Spans::new(file.path, report.source.clone()),
            named: Named::default(),
            report,
            allowance: file.allowance,
            path: file.path,
            camera: None,
            film: None,
            settings: None,
            textures: Vec::new(),
            materials: Vec::new(),
            shapes: Vec::new(),
            instanced: 0,
            lights: Vec::new(),
            environment: None,
        }
    }

    /// Resolves a path relative to the scene file.
    pub fn resolve(&self, file: &str) -> PathBuf {
        self.allowance.find(self.path.parent().unwrap_or(Path::new("")), file)
    }

    /// Sets the camera.
    pub fn set_camera(&mut self, part: &dyn Part, camera: Camera) {
        checks::camera(&mut self.report, part, &camera);
        self.spans.add(part);
        self.camera = Some(camera);
    }

    /// Sets the film.
    pub fn set_film(&mut self, part: &dyn Part, film: Film) {
        checks::film(&mut self.report, self.allowance, part, &film);
        self.spans.add(part);
        self.film = Some(film);
    }

    /// Sets the render settings.
    pub fn set_settings(&mut self, part: &dyn Part, settings: RenderSettings) {
        self.spans.add(part);
        self.settings = Some(settings);
    }

    /// Adds a texture, and returns its index.
    pub fn add_texture(&mut self, part: &dyn Part, texture: Texture) -> usize {
        self.spans.add(part);
        self.named.textures.push((self.textures.len(), part.span()));
        self.add_own_texture(texture)
    }

    /// Adds a texture that a mesh file defines, and returns its index.
    pub fn add_own_texture(&mut self, texture: Texture) -> usize {
        self.textures.push(texture);
        self.textures.len() - 1
    }

    /// Adds a material, and returns its index.
    pub fn add_material(&mut self, part: &dyn Part, material: Material) -> usize {
        self.spans.add(part);
        let index = self.materials.len();
        // Materials from mesh files before this one have no place.
        self.spans.materials.resize(index, "materials".to_owned());
        self.spans.materials.push(part.place().to_owned());
        self.named.materials.push((index, part.span()));
        self.add_own_material(material)
    }

    /// Adds a material that a mesh file defines, and returns its index.
    pub fn add_own_material(&mut self, material: Material) -> usize {
        self.materials.push(material);
        self.materials.len() - 1
    }

    /// Adds the shapes of one part: usually one, or one per material of a mesh.
    #[allow(dead_code)] // for importers of formats without transforms
    pub fn add_shapes(&mut self, part: &dyn Part, shapes: Vec<Shape>) {
        let shapes = self.checked(part, shapes, None);
        self.push_shapes(part, shapes);
    }

    /// Adds shapes that were checked.
    pub fn push_shapes(&mut self, part: &dyn Part, shapes: Vec<Shape>) {
        self.spans.add(part);
        self.shapes.extend(shapes);
        self.spans.shapes.resize(self.shapes.len(), part.place().to_owned());
    }

    /// Adds a light.
    pub fn add_light(&mut self, part: &dyn Part, light: Light) {
        checks::light(&mut self.report, part, &light);
        self.spans.add(part);
        self.lights.push(light);
    }

    /// Sets the environment.
    pub fn set_environment(&mut self, part: &dyn Part, environment: Environment) {
        self.spans.add(part);
        self.environment = Some(environment);
    }

    /// Makes the scene. Reports a missing camera, and warns about unused parts and a scene without
    /// light.
    ///
    /// # Errors
    /// All errors that were reported.
    pub fn finish(mut self) -> Result<Loaded, SceneErrors> {
        self.report.files.append(&mut self.images.files);
        let Some(camera) = self.camera else {
            if self.report.errors.is_empty() {
                self.report.error(0..0, "the scene has no camera", "expected a camera", None);
            }
            return Err(self.report.into_errors());
        };
        let name =
            self.path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into());
        let scene = Scene {
            name,
            camera,
            film: self.film.unwrap_or_default(),
            images: self.images.images,
            textures: self.textures,
            materials: self.materials,
            shapes: self.shapes,
            lights: self.lights,
            environment: self.environment,
        };
        if self.report.errors.is_empty() {
            checks::composition(&mut self.report, &scene, &self.named, &self.spans);
            checks::unused(&mut self.report, &scene, &self.named);
            checks::lit(&mut self.report, &scene);
        }
        let files = self.report.files.clone();
        let (scene, warnings) = self.report.conclude(Some(scene))?;
        let settings = self.settings.unwrap_or_default();
        Ok(Loaded { scene, settings, warnings, places: self.spans, files })
    }
}
