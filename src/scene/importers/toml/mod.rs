//! TOML scene files, and profile files.
//!
//! [`mod@file`] declares the format as types, from which the JSON Schema follows. A file is parsed
//! into a tree with positions, checked against the schema, and read part by part as these types,
//! which the other modules convert to the description.

mod camera;
mod document;
pub mod file;
mod light;
mod material;
pub mod numbers;
mod parse;
mod profile;
mod profile_file;
mod schema;
mod shape;
mod tree;
mod validate;

use std::sync::LazyLock;

use serde_json::Value as Json;

pub use self::profile_file::{LoadedProfile, ProfileFile, load_profile, load_profile_within};
pub use self::schema::schema_json;

use self::document::Document;
use self::file::{EnvironmentFile, LightFile, MaterialFile, SceneFile, ShapeFile, TextureFile};
use self::tree::Node;
use self::validate::document;
use crate::scene::builder::SceneBuilder;
use crate::scene::checks;
use crate::scene::diagnostics::{Report, SceneErrors, list};
use crate::scene::importers::Importer;
use crate::scene::load::{InputFile, Loaded};
use crate::scene::parts::Part;

static SCHEMA: LazyLock<Json> = LazyLock::new(schema::of::<SceneFile>);

/// Imports TOML scene files.
pub(crate) struct Toml;

impl Importer for Toml {
    fn accepts(&self, file: &InputFile) -> bool {
        file.path.extension().is_some_and(|extension| extension == "toml")
    }

    fn import(&self, file: &InputFile) -> Result<Loaded, SceneErrors> {
        let (text, mut report) = file.decode()?;
        let root = parse::parse(&text, &mut report);
        let mut builder = SceneBuilder::new(file, report);
        if let Some(root) = &root {
            scene(&mut builder, Node::new(root));
        }
        builder.finish()
    }
}

/// Reads the parts of a scene.
fn scene(builder: &mut SceneBuilder, root: Node) {
    let count = root.get("shapes").map_or(0, |shapes| shapes.elements().count() as u64);
    let span = root.span_of("shapes");
    if !checks::shape_count(&mut builder.report, builder.allowance, count, span) {
        return;
    }
    let document = &document(&SCHEMA, root, &mut builder.report);
    version(&mut builder.report, document);
    undefined(&mut builder.report, document, "materials", "shapes", "material");
    undefined(&mut builder.report, document, "textures", "materials", "reflectance");
    undefined(&mut builder.report, document, "textures", "shapes", "emission");
    undefined(&mut builder.report, document, "textures", "lights", "texture");
    camera::camera(builder, document);
    camera::film(builder, document);
    camera::settings(builder, document);
    for item in document.items("textures") {
        if let Some(file) = item.read::<TextureFile>(&mut builder.report) {
            material::texture(builder, document, item, file);
        }
    }
    for item in document.items("materials") {
        if let Some(file) = item.read::<MaterialFile>(&mut builder.report) {
            material::material(builder, document, item, file);
        }
    }
    for item in document.items("shapes") {
        if let Some(file) = item.read::<ShapeFile>(&mut builder.report) {
            shape::shapes(builder, document, item, file);
        }
    }
    for item in document.items("lights") {
        if let Some(file) = item.read::<LightFile>(&mut builder.report) {
            light::light(builder, document, item, file);
        }
    }
    if let Some(item) = document.item("environment")
        && let Some(file) = item.read::<EnvironmentFile>(&mut builder.report)
    {
        light::environment(builder, item, &file);
    }
}

/// Reports another version of the format.
fn version(report: &mut Report, document: &Document) {
    if let Some(item) = document.item("version")
        && let Some(version) = item.read::<u32>(report)
        && version != 1
    {
        let message = format!("scene format version {version} is not supported");
        report.error(item.span(), message, "expected 1", None);
    }
}

/// Index of a named part; 0 for an unknown name, which [`undefined`] has reported.
fn index(document: &Document, section: &str, name: &str) -> usize {
    document.index(section, name).unwrap_or(0)
}

/// Reports names that parts of `user` reference under `key` and that `section` does not define.
fn undefined(report: &mut Report, document: &Document, section: &str, user: &str, key: &str) {
    let singular = section.trim_end_matches('s');
    let known: Vec<_> = document.items(section).map(|item| item.name).collect();
    for node in document.items(user).filter_map(|item| item.node.get(key)) {
        let Some(name) = node.str().filter(|name| document.index(section, name).is_none()) else {
            continue;
        };
        let label =
            report.did_you_mean(name, known.iter().copied(), &format!("no such {singular}"));
        let help = match known[..] {
            [] => format!("define it: [{section}.{name}]"),
            _ => {
                format!("define [{section}.{name}], or use one of {}", list(known.iter().copied()))
            }
        };
        let message = format!("{singular} `{name}` is not defined");
        report.error(node.span(), message, label, Some(help));
    }
}
