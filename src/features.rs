//! What a scene and its settings require; whatever is not named here is neither compiled nor
//! allocated.

use super::shapes::intersect::has_patch_set;
use super::tables::*;
use crate::settings::{Direct, Method, RadiusRule, RenderSettings};
use std::collections::BTreeSet;

/// Names that fence optional code in shaders (`//#if name`).
pub const ALL: [&str; 42] = [
    "triangle",
    "attributes",
    "sphere",
    "rectangle",
    "disc",
    "cuboid",
    "plane",
    "revolution",
    "patch_set",
    "facets",
    "unbounded",
    "kdtree",
    "few",
    "textures",
    "checker",
    "texels",
    "mirror",
    "glass",
    "nested",
    "astride",
    "metal",
    "specular",
    "absorption",
    "lights",
    "cells",
    "guided",
    "area_triangle",
    "area_sphere",
    "area_rectangle",
    "area_disc",
    "area_cuboid",
    "area_revolution",
    "point",
    "spot",
    "infinite",
    "far",
    "environment",
    "environment_image",
    "lens",
    "sampled",
    "local",
    "split",
];

/// A set of names from [`ALL`], and "photons" where photons are traced at all, "first" where such
/// are stored that no diffuse surface has scattered, and "direct_layer" where direct light is to be
/// told by itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Features(BTreeSet<&'static str>);

/// Most shapes that shaders test one after another, without a kd-tree.
const FEW: usize = 16;

/// The shapes of a kd-tree that is one leaf, where they are few and the code to test one is short:
/// shaders name each of them.
pub fn few(scene: &Scene) -> &[u32] {
    match scene.nodes.first() {
        Some(root) if root.is_leaf() => {
            let refs = scene.refs.get(root.range()).unwrap_or_default();
            let short = refs.iter().all(|reference| reference >> REFERENCE_BITS != KIND_REVOLUTION);
            if short && refs.len() <= FEW { refs } else { &[] }
        }
        _ => &[],
    }
}

impl Features {
    /// What `scene` rendered with `settings` requires.
    pub fn of(scene: &Scene, settings: &RenderSettings) -> Self {
        let mut set = BTreeSet::new();
        let mut put = |name: &'static str, needed: bool| {
            if needed {
                set.insert(name);
            }
        };
        put("triangle", !scene.triangles.is_empty());
        put("attributes", !scene.attributes.is_empty());
        put("sphere", !scene.spheres.is_empty());
        put("rectangle", !scene.rectangles.is_empty());
        put("disc", !scene.discs.is_empty());
        put("cuboid", !scene.cuboids.is_empty());
        put("plane", !scene.planes.is_empty());
        put("facets", !scene.facets.is_empty());
        put("revolution", !scene.revolutions.is_empty());
        put("unbounded", !scene.unbounded.is_empty());
        let few = !few(scene).is_empty();
        let kdtree = !scene.nodes.is_empty() && !few;
        put("kdtree", kdtree);
        put("patch_set", kdtree && has_patch_set(scene));
        put("few", few);
        let material = |kind| scene.materials.iter().any(|m| m.kind == kind);
        put("mirror", material(MATERIAL_MIRROR));
        put("glass", material(MATERIAL_GLASS));
        put("nested", scene.world.nested != 0);
        let astride = scene.lights.iter().any(|l| l.medium == ASTRIDE);
        put("astride", astride || scene.camera.medium == ASTRIDE);
        put("metal", material(MATERIAL_METAL));
        put("specular", material(MATERIAL_MIRROR) || material(MATERIAL_GLASS));
        put("absorption", scene.materials.iter().any(|m| m.absorption.max_element() > 0.0));
        put("textures", !scene.textures.is_empty());
        put("checker", scene.textures.iter().any(|t| t.kind == TEXTURE_CHECKER));
        put("texels", !scene.texels.is_empty());
        let light = |kind| scene.lights.iter().any(|l| l.kind == kind);
        let area = |kind| {
            scene
                .lights
                .iter()
                .any(|l| l.kind == LIGHT_AREA && l.reference >> REFERENCE_BITS == kind)
        };
        put("lights", !scene.lights.is_empty());
        put("cells", !scene.cells.is_empty());
        put("area_triangle", area(KIND_TRIANGLE));
        put("area_sphere", area(KIND_SPHERE));
        put("area_rectangle", area(KIND_RECTANGLE));
        put("area_disc", area(KIND_DISC));
        put("area_cuboid", area(KIND_CUBOID));
        put("area_revolution", area(KIND_REVOLUTION));
        put("guided", scene.world.guided != 0);
        put("point", light(LIGHT_POINT));
        put("spot", light(LIGHT_SPOT));
        put("infinite", light(LIGHT_SUN) || light(LIGHT_CONSTANT) || light(LIGHT_IMAGE));
        put("far", scene.world.far != 0);
        put("environment", light(LIGHT_CONSTANT) || light(LIGHT_IMAGE));
        put("environment_image", light(LIGHT_IMAGE));
        put("lens", scene.camera.aperture > 0.0);
        put("sampled", settings.direct == Direct::Sampled && !scene.lights.is_empty());
        put("local", settings.radius_rule == RadiusRule::Local);
        let photons = !scene.lights.is_empty() && settings.method != Method::Path;
        // photons that no diffuse surface has scattered are stored
        let rough = scene.materials.iter().all(|m| m.kind == MATERIAL_DIFFUSE);
        let first = settings.direct == Direct::Photons || !rough;
        put("photons", photons);
        put("first", photons && first);
        put("split", photons && first && settings.has_wider());
        Self(set)
    }

    /// The same and `name`.
    pub fn with(mut self, name: &'static str) -> Self {
        self.0.insert(name);
        self
    }

    /// Whether `name` is required.
    pub fn has(&self, name: &str) -> bool {
        self.0.contains(name)
    }

    /// The names, sorted.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.0.iter().copied()
    }
}

impl<const N: usize> From<[&'static str; N]> for Features {
    fn from(names: [&'static str; N]) -> Self {
        Self(names.into_iter().collect())
    }
}
