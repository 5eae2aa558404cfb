//! Materials that an OBJ file brings along in its MTL file.

use std::ops::Range;
use std::path::Path;

use super::appearance::{Filter, Material, MaterialKind, Reflectance, Texels, Texture, TextureKind, Wrap};
use super::images::ImageStore;
use super::numbers::{BRIGHTEST, LARGEST};
use super::obj::{Word, argument, words};
use super::report::Faults;

/// Index of refraction of a transparent MTL material that gives none.
const DEFAULT_IOR: f64 = 1.5;
/// Diffuse reflectance of an MTL material that gives none.
const DEFAULT_DIFFUSE: [f64; 3] = [0.8; 3];

/// What a first look at an MTL file finds.
#[derive(Debug, Default)]
pub(super) struct Scan<'t> {
    /// Statements for tobj to read.
    pub cleaned: String,
    /// What tobj does not see, stops at without a line, or panics at.
    pub faults: Faults,
    /// Names of the materials.
    pub names: Vec<&'t str>,
}

/// Looks through an MTL file, and reads the images that it names relative to `folder`.
pub(super) fn scan<'t>(text: &'t str, folder: &Path, images: &mut ImageStore) -> Scan<'t> {
    let mut scan = Scan::default();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let statement = line.split('#').next().unwrap_or("");
        let mut words = words(statement, start);
        if let Some((keyword, at)) = words.next() {
            scan.numbers(keyword, &at, &words.collect::<Vec<_>>());
            let argument = argument(statement, start, keyword, &at);
            scan.name(keyword, &at, argument, folder, images);
            scan.cleaned.push_str(statement.trim());
            scan.cleaned.push('\n');
        }
        start += line.len();
    }
    scan
}

impl<'t> Scan<'t> {
    fn fault(&mut self, span: &Range<usize>, message: impl Into<String>, expected: impl Into<String>) {
        self.faults.push(span.clone(), message, expected);
    }

    /// Checks the statements that consist of numbers.
    fn numbers(&mut self, keyword: &str, at: &Range<usize>, rest: &[Word]) {
        let (count, most) = match keyword {
            "Kd" | "Ks" => (3, 1.0),
            "Ka" | "Ke" => (3, BRIGHTEST),
            "Ni" | "Ns" => (1, LARGEST),
            "d" => (1, 1.0),
            "illum" => (1, 255.0),
            _ => return,
        };
        if rest.len() != count {
            let plural = if count == 1 { "" } else { "s" };
            let message = format!("`{keyword}` has {} values", rest.len());
            self.fault(at, message, format!("expected {count} number{plural}"));
        }
        for (word, at) in rest.iter().take(count) {
            let number = word.parse().ok().filter(|number| (0.0..=most).contains(number));
            if number.is_none_or(|number| keyword == "illum" && number.fract() != 0.0) {
                let expected = match keyword {
                    "illum" => "expected a whole number".to_owned(),
                    _ => format!("expected a number from 0 to {most:e}"),
                };
                self.fault(at, format!("`{word}` is out of range or no number"), expected);
            }
        }
    }

    /// Checks the statements that hold a name.
    fn name(
        &mut self,
        keyword: &str,
        at: &Range<usize>,
        (name, name_at): Word<'t>,
        folder: &Path,
        images: &mut ImageStore,
    ) {
        let is_name = keyword == "newmtl" || keyword.starts_with("map_") || keyword == "bump";
        if is_name && name.is_empty() {
            self.fault(at, format!("`{keyword}` names nothing"), "expected a name");
        } else if keyword == "newmtl" {
            self.names.push(name);
        } else if keyword == "map_Kd" && name.starts_with('-') {
            self.fault(&name_at, "options of `map_Kd` are not supported", "expected a file name");
        } else if keyword == "map_Kd" {
            match images.load(&folder.join(name), None) {
                Err(fault) => {
                    let expected = fault.help.unwrap_or_else(|| fault.expected.to_owned());
                    self.fault(&name_at, fault.message, expected);
                }
                Ok(image) if exceeds_one(images, image) => {
                    self.fault(
                        &name_at,
                        format!("{name} has a texel above 1"),
                        "expected values from 0 to 1",
                    );
                }
                Ok(_) => {}
            }
        }
    }
}

fn exceeds_one(images: &ImageStore, image: usize) -> bool {
    match &images.images[image].texels {
        Texels::Float(texels) => texels.iter().flatten().any(|&value| value > 1.0),
        Texels::Rgba8 { .. } => false,
    }
}

/// An MTL material as a scene's: glass when `illum` is 4, 6, 7 or 9, or `d` is below 1 with an `Ni` other than 1; a
/// mirror of `Ks` when `illum` is 3 or 5; else diffuse of `map_Kd`, which replaces `Kd`. Returns what is not used.
pub(super) fn material(
    name: String,
    mtl: &tobj::Material,
    folder: &Path,
    images: &mut ImageStore,
    textures: &mut Vec<Texture>,
) -> (Material, Vec<&'static str>) {
    let mut unused = Vec::new();
    let ior = mtl.optical_density.filter(|&ior| ior > 0.0);
    let refracts = mtl.dissolve.is_some_and(|d| d < 1.0) && ior.is_some_and(|ior| ior != 1.0);
    let kind = match mtl.illumination_model {
        Some(4 | 6 | 7 | 9) => glass(ior),
        _ if refracts => glass(ior),
        Some(3 | 5) => MaterialKind::Mirror {
            reflectance: Reflectance::Color(mtl.specular.or(mtl.diffuse).unwrap_or([1.0; 3])),
        },
        _ => {
            if mtl.dissolve.is_some_and(|d| d < 1.0) {
                unused.push("`d`");
            }
            let image =
                mtl.diffuse_texture.as_ref().and_then(|file| images.load(&folder.join(file), None).ok());
            let reflectance = match image {
                Some(image) => {
                    if images.is_transparent(image) {
                        unused.push("the alpha channel of map_Kd");
                    }
                    Reflectance::Texture(texture(&name, image, textures))
                }
                None => Reflectance::Color(mtl.diffuse.unwrap_or(DEFAULT_DIFFUSE)),
            };
            MaterialKind::Diffuse { reflectance }
        }
    };
    let maps = [
        ("`map_Ks`", &mtl.specular_texture),
        ("`map_Bump`", &mtl.normal_texture),
        ("`map_Ns`", &mtl.shininess_texture),
        ("`map_d`", &mtl.dissolve_texture),
    ];
    unused.extend(maps.into_iter().filter(|(_, map)| map.is_some()).map(|(key, _)| key));
    (Material { name, kind }, unused)
}

fn glass(ior: Option<f64>) -> MaterialKind {
    MaterialKind::Glass { ior: ior.unwrap_or(DEFAULT_IOR), absorption: [0.0; 3] }
}

fn texture(name: &str, image: usize, textures: &mut Vec<Texture>) -> usize {
    let kind =
        TextureKind::Image { image, filter: Filter::default(), wrap: Wrap::default(), scale: [1.0; 2] };
    textures.push(Texture { name: name.to_owned(), kind });
    textures.len() - 1
}
