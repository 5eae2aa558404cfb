//! Materials and their parameters.

use super::albedo::{Albedo, mean_over_hemisphere};
use super::image::{period, reduced};
use super::layers::{Entries, Grain, Place};
use super::materials::microfacet::ALPHA_MIN;
use super::materials::{Bsdf, LAYERS};
use super::real::{Real, ToReal, Vec3};
use super::rgb;
use super::tables::*;
use crate::double::materials::fresnel::{fresnel, fresnel_conductor};
use crate::prepare::normalize::Normalization;
use crate::scene::{self, MaterialKind, Reflectance, numbers};
use glam::{DVec2, DVec3};

const _: () = assert!(LAYERS == numbers::LAYERS);

/// Microfacets that lose no more than this fraction of diffuse light by single scattering do
/// without its compensation: their loss is confined to grazing angles, where the polynomial is too
/// coarse.
const NEGLIGIBLE_LOSS: f64 = 0.003;
/// The same for glass, whose inside light meets many times.
const NEGLIGIBLE_LOSS_OF_GLASS: f64 = 0.0003;
/// Difference of indices of refraction below which rough glass is treated as smooth.
const EQUAL_MEDIA: f64 = 1e-3;

/// Fills the material table: an entry for each material, at its index, then entries for the
/// materials that these consist of.
pub fn pack_materials(scene: &scene::Scene, n: &Normalization, out: &mut SceneTables) {
    let mut entries = Entries::new(scene, n.unit);
    for (i, m) in scene.materials.iter().enumerate() {
        let origin = reduced(DVec2::new(n.center.x, n.center.z), period(scene, m)).to_real();
        let place = Place { planar_origin: origin, coated: false };
        let mut entry = entries.kind(&m.kind, Grain::of(m), place);
        if let Some(opacity) = &m.opacity {
            let cutoff = opacity.cutoff.map_or(0.0, |cutoff| cutoff.max(f64::MIN_POSITIVE));
            let mut cover = Material {
                kind: Bsdf::Opacity as u32,
                ior: (cutoff as Real).min(1.0),
                first: entries.push(entry),
                planar_origin: origin,
                ..Material::EMPTY
            };
            colored(&mut cover, Some(&opacity.amount));
            entry = cover;
        }
        bend(&mut entry, m, n.unit);
        entries.table[i] = entry;
    }
    out.materials = entries.table;
    for i in 0..out.materials.len() {
        out.materials[i].stores = stores(&out.materials, i, LAYERS) as u32;
        out.materials[i].textured = textured(&out.materials, i, LAYERS) as u32;
    }
}

/// Returns whether one of the lobes of an entry is rough.
fn stores(materials: &[Material], index: usize, depth: usize) -> bool {
    let Some(m) = materials.get(index).filter(|_| depth > 0) else { return false };
    let below = |index: u32| stores(materials, index as usize, depth - 1);
    match Bsdf::of(m.kind) {
        Bsdf::Mix | Bsdf::TwoSided => below(m.first) || below(m.second),
        Bsdf::Opacity => below(m.first),
        Bsdf::Clearcoat => m.alpha > 0.0 || below(m.first),
        Bsdf::Graded => (m.first..=m.first + m.second).any(below),
        bsdf => !bsdf.is_specular(),
    }
}

/// Returns whether an entry or one of those that it chooses from has a texture.
fn textured(materials: &[Material], index: usize, depth: usize) -> bool {
    let Some(m) = materials.get(index).filter(|_| depth > 0) else { return false };
    let below = |index: u32| textured(materials, index as usize, depth - 1);
    m.texture != NONE
        || m.bent != 0
        || Bsdf::of(m.kind) == Bsdf::Brushed
        || match Bsdf::of(m.kind) {
            Bsdf::Mix | Bsdf::TwoSided => below(m.first) || below(m.second),
            Bsdf::Opacity | Bsdf::Graded | Bsdf::Clearcoat => below(m.first),
            _ => false,
        }
}

/// Sets the textures that bend the normal.
fn bend(out: &mut Material, m: &scene::Material, unit: f64) {
    if let Some(map) = &m.normal_map {
        out.normal_map = map.texture as u32;
        out.normal_strength = map.strength as Real;
    }
    if let Some(map) = &m.bump_map {
        out.bump_map = map.texture as u32;
        out.bump_height = (map.height / unit) as Real;
    }
    out.bent = u32::from(m.normal_map.is_some() || m.bump_map.is_some());
}

pub fn colored(out: &mut Material, color: Option<&Reflectance>) {
    match color {
        Some(Reflectance::Color(c)) => out.reflectance = rgb(*c),
        Some(Reflectance::Texture(t)) => out.texture = *t as u32,
        None => {}
    }
}

/// Entry of a material of one kind.
pub fn material(kind: &MaterialKind, unit: f64) -> Material {
    let mut out = Material::EMPTY;
    colored(&mut out, kind.color());
    let alpha = |roughness: f64| ((roughness * roughness) as Real).max(ALPHA_MIN);
    let bsdf = match kind {
        MaterialKind::Diffuse { roughness, .. } if *roughness > 0.0 => {
            out.alpha = *roughness as Real;
            Bsdf::RoughDiffuse
        }
        MaterialKind::Diffuse { .. } => Bsdf::Diffuse,
        MaterialKind::Translucent { transmission, .. } => {
            out.alpha = *transmission as Real;
            Bsdf::Translucent
        }
        MaterialKind::Mirror { .. } => Bsdf::Mirror,
        MaterialKind::Glass { ior, roughness, absorption, .. } => {
            out.ior = *ior as Real;
            out.absorption = rgb(absorption.map(|a| a * unit));
            // facets between equal media do not bend light
            if *roughness == 0.0 || (ior - 1.0).abs() < EQUAL_MEDIA {
                Bsdf::Glass
            } else {
                out.alpha = alpha(*roughness);
                compensate_glass(&mut out, *ior);
                Bsdf::RoughGlass
            }
        }
        MaterialKind::Metal { roughness, .. } if *roughness == 0.0 => Bsdf::SmoothMetal,
        MaterialKind::Metal { roughness, .. } => {
            out.alpha = alpha(*roughness);
            compensate(&mut out);
            Bsdf::Metal
        }
        MaterialKind::Conductor { eta, k, roughness } => {
            out.reflectance = rgb([1.0; 3]);
            let (eta, k) = (DVec3::from(*eta), DVec3::from(*k));
            out.eta = eta.to_real();
            out.k = k.to_real();
            out.mean_fresnel = mean_over_hemisphere(|cos| fresnel_conductor(cos, eta, k)).to_real();
            if *roughness == 0.0 {
                Bsdf::SmoothMetal
            } else {
                out.alpha = alpha(*roughness);
                compensate(&mut out);
                Bsdf::Conductor
            }
        }
        MaterialKind::Plastic { ior, roughness, nonlinear, .. } => {
            out.ior = *ior as Real;
            out.first = u32::from(*nonlinear);
            let reflected = |cos| fresnel(cos, 1.0 / ior).reflectance;
            let mean = mean_over_hemisphere(|cos| DVec3::splat(reflected(cos))).x;
            out.mean_albedo = mean as Real;
            if *roughness > 0.0 {
                out.alpha = alpha(*roughness);
                Albedo::of(f64::from(out.alpha), reflected).store(&mut out);
            }
            Bsdf::Plastic
        }
        MaterialKind::ThinGlass { ior, roughness, .. } => {
            out.ior = *ior as Real;
            if *roughness == 0.0 {
                Bsdf::ThinGlass
            } else {
                out.alpha = alpha(*roughness);
                compensate(&mut out);
                Bsdf::RoughPane
            }
        }
        MaterialKind::Mix { materials: [first, second], .. } => {
            (out.first, out.second) = (*first as u32, *second as u32);
            Bsdf::Mix
        }
        MaterialKind::TwoSided { front, back } => {
            (out.first, out.second) = (*front as u32, *back as u32);
            Bsdf::TwoSided
        }
        // made of other kinds
        MaterialKind::Principled(_) => Bsdf::Diffuse,
        MaterialKind::Null => {
            out.reflectance = rgb([1.0; 3]);
            Bsdf::Null
        }
    };
    Material { kind: bsdf as u32, ..out }
}

/// The same for both sides of a rough dielectric.
fn compensate_glass(out: &mut Material, ior: f64) {
    let alpha = f64::from(out.alpha);
    let [outer, inner] = [1.0 / ior, ior].map(|eta| Albedo::of_dielectric(alpha, eta));
    if outer.mean().min(inner.mean()) < 1.0 - NEGLIGIBLE_LOSS_OF_GLASS {
        outer.store(out);
        let [a, b, c, d, e, f, g, h] = inner.terms.map(|term| term as Real);
        out.eta = Vec3::new(a, b, c);
        out.k = Vec3::new(d, e, f);
        out.mean_fresnel = Vec3::new(g, h, 0.0);
    }
}

/// Gives a metal other widths along u and along v.
pub fn brush(out: &mut Material, [along_u, along_v]: [f64; 2]) {
    let albedo = Albedo::of_brushed([along_u, along_v].map(|a| a.max(f64::from(ALPHA_MIN))));
    if albedo.mean() < 1.0 - NEGLIGIBLE_LOSS {
        albedo.store(out);
    }
    out.first = u32::from(out.kind == Bsdf::Conductor as u32);
    out.alpha = (along_u as Real).max(ALPHA_MIN);
    out.ior = (along_v as Real).max(ALPHA_MIN);
    out.kind = Bsdf::Brushed as u32;
}

/// Adds the light that microfacets scatter several times, unless it is negligible.
fn compensate(out: &mut Material) {
    let albedo = Albedo::of(f64::from(out.alpha), |_| 1.0);
    if albedo.mean() < 1.0 - NEGLIGIBLE_LOSS {
        albedo.store(out);
    }
}
