//! Materials that an OBJ file brings along in its MTL file.

use std::path::Path;

use super::appearance::{Filter, Material, MaterialKind, Reflectance, Texels, Texture, TextureKind, Wrap};
use super::images::ImageStore;
use super::obj::{argument, words};
use super::report::Fault;

/// Index of refraction of a transparent MTL material that gives none.
const DEFAULT_IOR: f64 = 1.5;
/// Diffuse reflectance of an MTL material that gives none.
const DEFAULT_DIFFUSE: [f64; 3] = [0.8; 3];

/// Faults that tobj does not see, or sees without a line.
pub(super) fn scan(text: &str, folder: &Path, images: &mut ImageStore) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut start = 0;
    for full in text.split_inclusive('\n') {
        let line = full.split('#').next().unwrap_or("");
        let mut words = words(line, start);
        if let Some((keyword, span)) = words.next() {
            let rest: Vec<_> = words.collect();
            let (count, most) = match keyword {
                "Kd" | "Ks" => (3, 1.0),
                "Ka" | "Ke" => (3, f64::MAX),
                "Ni" | "Ns" => (1, f64::MAX),
                "d" => (1, 1.0),
                _ => (0, 0.0),
            };
            if count > 0 && rest.len() != count {
                let expected = format!("expected {count} number{}", if count == 1 { "" } else { "s" });
                faults.push(Fault {
                    span: span.clone(),
                    message: format!("`{keyword}` has {}", rest.len()),
                    expected,
                });
            }
            for (word, span) in rest.iter().take(count) {
                if !word.parse().is_ok_and(|number| (0.0..=most).contains(&number)) {
                    let message = format!("`{word}` is out of range or no number");
                    let expected = match most {
                        1.0 => "expected a number from 0 to 1",
                        _ => "expected a number that is not negative",
                    };
                    faults.push(Fault { span: span.clone(), message, expected: expected.into() });
                }
            }
            let (name, at) = argument(line, start, keyword, &span);
            match keyword {
                "newmtl" if name.is_empty() => {
                    faults.push(Fault {
                        span,
                        message: "`newmtl` names no material".into(),
                        expected: "expected a name".into(),
                    });
                }
                "illum" if rest.first().is_none_or(|word| word.0.parse::<u8>().is_err()) => {
                    faults.push(Fault {
                        span,
                        message: "`illum` has no model".into(),
                        expected: "expected a whole number".into(),
                    });
                }
                "map_Kd" if name.starts_with('-') => {
                    let message = "options of `map_Kd` are not supported".into();
                    faults.push(Fault { span: at, message, expected: "expected a file name".into() });
                }
                "map_Kd" => match images.load(&folder.join(name), None) {
                    Err(fault) => faults.push(Fault {
                        span: at,
                        message: fault.message,
                        expected: fault.expected.into(),
                    }),
                    Ok(image) if exceeds_one(images, image) => {
                        let message = format!("{name} has a texel above 1");
                        faults.push(Fault {
                            span: at,
                            message,
                            expected: "expected values from 0 to 1".into(),
                        });
                    }
                    Ok(_) => {}
                },
                _ => {}
            }
        }
        start += full.len();
    }
    faults
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
                unused.push("d");
            }
            let image =
                mtl.diffuse_texture.as_ref().and_then(|file| images.load(&folder.join(file), None).ok());
            let reflectance = match image {
                Some(image) => Reflectance::Texture(texture(&name, image, textures)),
                None => Reflectance::Color(mtl.diffuse.unwrap_or(DEFAULT_DIFFUSE)),
            };
            MaterialKind::Diffuse { reflectance }
        }
    };
    let maps = [
        ("map_Ks", &mtl.specular_texture),
        ("map_Bump", &mtl.normal_texture),
        ("map_Ns", &mtl.shininess_texture),
        ("map_d", &mtl.dissolve_texture),
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
