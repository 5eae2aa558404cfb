//! TOML scene files, and profile files.
//!
//! [`mod@file`] declares the format as types, from which the JSON Schema follows. A file is parsed
//! into a tree with positions, checked against the schema, and read part by part as these types,
//! which the other modules convert to the description.

mod axial;
mod camera;
mod document;
pub mod file;
mod film;
mod group;
mod light;
mod material;
mod named;
pub mod numbers;
mod parse;
mod profile;
mod profile_file;
mod schema;
mod shape;
pub mod transform;
mod tree;
mod validate;

use std::sync::LazyLock;

use serde_json::Value as Json;

pub use self::profile_file::{LoadedProfile, ProfileFile, load_profile, load_profile_within};
pub use self::schema::schema_json;

use self::document::Document;
use self::file::{
    EnvironmentFile, InstanceFile, LightFile, MaterialFile, SceneFile, ShapeFile, TextureFile,
};
use self::tree::Node;
use self::validate::document;
use crate::scene::builder::SceneBuilder;
use crate::scene::checks;
use crate::scene::diagnostics::{Report, SceneErrors, list};
use crate::scene::importers::Importer;
use crate::scene::load::{InputFile, Loaded};
use crate::scene::parts::Part;

static SCHEMA: LazyLock<Json> = LazyLock::new(schema::of::<SceneFile>);

/// Keys of materials that may name a texture.
const TEXTURED: [&str; 12] = [
    "reflectance",
    "transmittance",
    "amount",
    "opacity",
    "roughness",
    "normal_map",
    "bump_map",
    "base_color",
    "metallic",
    "specular",
    "transmission",
    "clearcoat",
];

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
    let count = |node: Node, key| node.get(key).map_or(0, |list| list.elements().count() as u64);
    let own = |node: Node| count(node, "shapes") + count(node, "instances");
    let groups = root.get("groups").into_iter().flat_map(|groups| groups.entries());
    let count = own(root) + groups.map(|(_, _, group)| own(group)).sum::<u64>();
    let span = root.span_of("shapes");
    if !checks::shape_count(&mut builder.report, builder.allowance, count, span) {
        return;
    }
    let document = &document(&SCHEMA, root, &mut builder.report);
    version(&mut builder.report, document);
    let all = |key| document.items(key).map(|item| item.node).chain(group::nodes(document, key));
    undefined(&mut builder.report, document, "materials", (all("shapes"), "material"));
    undefined(&mut builder.report, document, "groups", (all("instances"), "group"));
    let materials = || document.items("materials").map(|item| item.node);
    for key in ["materials", "front", "back"] {
        undefined(&mut builder.report, document, "materials", (materials(), key));
    }
    for key in TEXTURED {
        undefined(&mut builder.report, document, "textures", (materials(), key));
    }
    camera::camera(builder, document);
    film::film(builder, document);
    film::settings(builder, document);
    for item in document.items("textures") {
        if let Some(file) = item.read::<TextureFile>(&mut builder.report) {
            material::texture(builder, item, file);
        }
    }
    for item in document.items("materials") {
        if let Some(file) = item.read::<MaterialFile>(&mut builder.report) {
            material::material(builder, document, item, file);
        }
    }
    for item in document.items("shapes") {
        if let Some(file) = item.read::<ShapeFile>(&mut builder.report)
            && let Some(shapes) = shape::shapes(builder, document, item, file)
        {
            builder.push_shapes(item, shapes);
        }
    }
    let groups = group::groups(builder, document);
    for item in document.items("instances") {
        if let Some(file) = item.read::<InstanceFile>(&mut builder.report)
            && let Some(shapes) = group::instance(builder, document, item, &file, &groups)
        {
            builder.push_shapes(item, shapes);
        }
    }
    for item in document.items("lights") {
        if let Some(file) = item.read::<LightFile>(&mut builder.report) {
            light::light(builder, item, file);
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

/// Reports names that nodes reference under `key` and that `section` does not define.
fn undefined<'n>(
    report: &mut Report,
    document: &Document,
    section: &str,
    (nodes, key): (impl Iterator<Item = Node<'n>>, &str),
) {
    let singular = section.trim_end_matches('s');
    let known: Vec<_> = document.items(section).map(|item| item.name).collect();
    let nodes = nodes.filter_map(|node| node.get(key));
    // a name or a list of names
    for node in nodes.flat_map(|node| [node].into_iter().chain(node.elements())) {
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
