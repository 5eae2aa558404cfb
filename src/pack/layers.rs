//! Materials that consist of others: series of a texture's values, and the principled material.

use rayon::prelude::*;

use super::albedo::mean_over_hemisphere;
use super::material::{brush, colored, material};
use super::materials::Bsdf;
use super::real::{Real, Vec2};
use super::tables::Material;
use crate::double::materials::fresnel::fresnel;
use crate::math::srgb::linear_from_srgb;
use crate::scene::{MaterialKind, Principled, Reflectance, Scene, Texels, Texture, TextureKind};
use glam::DVec3;

/// Number of materials of a series per unit of roughness.
const STEPS_OF_ROUGHNESS: f64 = 64.0;
/// Least roughness of a metal with a grain, whose lobe is no mirror.
const LEAST_ROUGHNESS: f64 = 1e-3;
/// Index of refraction of clear coats.
const COAT_IOR: f64 = 1.5;

/// The material table in the making.
pub struct Entries<'s> {
    scene: &'s Scene,
    unit: f64,
    /// An entry for each material of the scene, then those that they consist of.
    pub table: Vec<Material>,
}

/// How the roughness of a material depends on the place and on the direction.
#[derive(Clone, Copy, Debug, Default)]
pub struct Grain {
    /// Texture that multiplies the roughness.
    map: Option<usize>,
    /// Roughness along v.
    along_v: Option<f64>,
    /// Strength of a metal's grain (see [`Principled::anisotropy`]).
    strength: f64,
}

impl Grain {
    /// Of a material of the scene.
    pub fn of(m: &crate::scene::Material) -> Self {
        let strength = match &m.kind {
            MaterialKind::Principled(p) => p.anisotropy,
            _ => 0.0,
        };
        Self { map: m.roughness_map, along_v: m.roughness_v, strength }
    }

    /// Widths (alpha) along u and v of a metal with the given roughness, if they differ.
    fn widths(&self, kind: &MaterialKind) -> Option<[f64; 2]> {
        let roughness = match kind {
            MaterialKind::Metal { roughness, .. } | MaterialKind::Conductor { roughness, .. } => {
                *roughness
            }
            _ => return None,
        };
        let alpha = roughness * roughness;
        match self.along_v {
            Some(v) => Some([alpha, v * v]),
            None if self.strength > 0.0 => {
                Some([alpha + (1.0 - alpha) * self.strength * self.strength, alpha])
            }
            None => None,
        }
    }
}

/// Where a material is used.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// See [`Material::planar_origin`].
    pub planar_origin: Vec2,
    /// True below a clear coat.
    pub coated: bool,
}

impl<'s> Entries<'s> {
    /// A table with empty entries for the materials of the scene.
    pub fn new(scene: &'s Scene, unit: f64) -> Self {
        Self { scene, unit, table: vec![Material::EMPTY; scene.materials.len()] }
    }

    /// Adds an entry, and returns its index.
    pub fn push(&mut self, entry: Material) -> u32 {
        self.table.push(entry);
        self.table.len() as u32 - 1
    }

    /// Entry of a kind, whose roughness a texture multiplies.
    pub fn kind(&mut self, kind: &MaterialKind, grain: Grain, place: Place) -> Material {
        match (kind, grain.map) {
            (MaterialKind::Principled(p), _) => self.principled(p, grain, place),
            (_, Some(texture)) => self.series(kind, texture, grain, place),
            (_, None) => single(kind, self.unit, grain, place),
        }
    }

    /// A series of materials whose roughness rises in equal steps over the range of a texture's
    /// values.
    fn series(
        &mut self,
        kind: &MaterialKind,
        texture: usize,
        grain: Grain,
        place: Place,
    ) -> Material {
        let factor = kind.roughness().unwrap_or_default();
        let (least, most) = range(self.scene, &self.scene.textures[texture]);
        let steps = ((most - least) * factor * STEPS_OF_ROUGHNESS).ceil();
        let first = self.table.len() as u32;
        let unit = self.unit;
        let one = |k: u32| {
            let share = if steps > 0.0 { f64::from(k) / steps } else { 0.0 };
            single(
                &kind.with_roughness((least + (most - least) * share) * factor),
                unit,
                grain,
                place,
            )
        };
        self.table.par_extend((0..=steps as u32).into_par_iter().map(one));
        Material {
            kind: Bsdf::Graded as u32,
            texture: texture as u32,
            ior: least as Real,
            alpha: if steps > 0.0 { (steps / (most - least)) as Real } else { 0.0 },
            first,
            second: steps as u32,
            planar_origin: place.planar_origin,
            ..Material::EMPTY
        }
    }

    /// The principled material (docs/materials.md): a clear coat over a mix of a metal with a mix
    /// of a sheet of glass with a dielectric.
    fn principled(&mut self, p: &Principled, grain: Grain, place: Place) -> Material {
        let below = self.metal_and_dielectric(p, grain, place);
        self.mix(&p.clearcoat, below, place, |entries| {
            let coated = Place { coated: true, ..place };
            let below = entries.metal_and_dielectric(p, grain, coated);
            let alpha = p.clearcoat_roughness;
            let coat = MaterialKind::Plastic {
                reflectance: Reflectance::Color([1.0; 3]),
                ior: COAT_IOR,
                roughness: alpha,
                nonlinear: false,
            };
            Material {
                kind: Bsdf::Clearcoat as u32,
                first: entries.push(below),
                ..single(&coat, entries.unit, Grain::default(), place)
            }
        })
    }

    fn metal_and_dielectric(&mut self, p: &Principled, grain: Grain, place: Place) -> Material {
        let Principled { base_color, roughness, ior, .. } = p;
        let (reflectance, roughness, ior) = (*base_color, *roughness, *ior);
        let diffuse = |ior| MaterialKind::Plastic {
            reflectance,
            ior,
            roughness: if ior > 1.0 { roughness } else { 0.0 },
            nonlinear: false,
        };
        // without a coat only where all of the surface reflects nothing
        let bare = single(&diffuse(1.0), self.unit, Grain::default(), place);
        let opaque =
            self.mix(&p.specular, bare, place, |entries| entries.kind(&diffuse(ior), grain, place));
        let dielectric = self.mix(&p.transmission, opaque, place, |entries| {
            let sheet = MaterialKind::ThinGlass { ior, roughness, transmittance: reflectance };
            entries.kind(&sheet, grain, place)
        });
        self.mix(&p.metallic, dielectric, place, |entries| {
            entries.kind(&MaterialKind::Metal { reflectance, roughness }, grain, place)
        })
    }

    /// A mix of `first` with a second material by an amount; only one of them for an amount of 0 or
    /// 1.
    fn mix(
        &mut self,
        amount: &Reflectance,
        first: Material,
        place: Place,
        second: impl FnOnce(&mut Self) -> Material,
    ) -> Material {
        match amount {
            Reflectance::Color([0.0, 0.0, 0.0]) => return first,
            Reflectance::Color([1.0, 1.0, 1.0]) => return second(self),
            _ => {}
        }
        let first = self.push(first);
        let second = second(self);
        let second = self.push(second);
        let mut mix = Material {
            kind: Bsdf::Mix as u32,
            first,
            second,
            planar_origin: place.planar_origin,
            ..Material::EMPTY
        };
        colored(&mut mix, Some(amount));
        mix
    }
}

/// Entry of a kind that consists of no others.
fn single(kind: &MaterialKind, unit: f64, grain: Grain, place: Place) -> Material {
    let widths = grain.widths(kind);
    let mut entry = match widths {
        None => material(kind, unit),
        // alpha is the square of the roughness
        Some([a, b]) => {
            material(&kind.with_roughness((a * b).powf(0.25).max(LEAST_ROUGHNESS)), unit)
        }
    };
    if let Some(widths) = widths {
        brush(&mut entry, widths);
    }
    entry.planar_origin = place.planar_origin;
    if place.coated {
        let eta = 1.0 / COAT_IOR;
        entry.coated = eta as Real;
        if matches!(kind, MaterialKind::Plastic { .. }) {
            // diffuse light that the clear coat sends back is not lost
            let mean = mean_over_hemisphere(|cos| DVec3::splat(fresnel(cos, eta).reflectance)).x;
            entry.mean_albedo = 1.0 - (1.0 - entry.mean_albedo) * (1.0 - mean as Real);
        }
    }
    entry
}

/// Least and greatest mean of the channels of a texture.
fn range(scene: &Scene, texture: &Texture) -> (f64, f64) {
    let image = match &texture.kind {
        TextureKind::Checker { colors, .. } => {
            let [a, b] = colors.map(|color| color.iter().sum::<f64>() / 3.0);
            return (a.min(b), a.max(b));
        }
        TextureKind::Image { image, .. } | TextureKind::Planks { image, .. } => *image,
    };
    let mean = |color: [f64; 3]| color.iter().sum::<f64>() / 3.0;
    let both = |(a, b): (f64, f64), x: f64| (a.min(x), b.max(x));
    match &scene.images[image].texels {
        Texels::Rgba8 { srgb, data } => {
            let linear: Vec<f64> = (0..256)
                .map(|i| f64::from(i) / 255.0)
                .map(|x| if *srgb { linear_from_srgb(x) } else { x })
                .collect();
            let value = |c: &[u8; 4]| mean([c[0], c[1], c[2]].map(|c| linear[usize::from(c)]));
            data.iter().map(value).fold((1.0, 0.0), both)
        }
        Texels::Float(data) => {
            data.iter().map(|color| mean(color.map(f64::from))).fold((1.0, 0.0), both)
        }
    }
}
