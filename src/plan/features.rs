//! Features that a scene and its settings require; nothing else is compiled or allocated.

use super::super::camera::ProjectionKind;
use super::super::geometry::intersect::has_patch_set;
use super::super::lights::LightKind;
use super::super::materials::Bsdf;
use super::super::math::pixel_filter::FilterKind;
use super::super::tables::*;
use crate::scene::settings::{Direct, Method, RadiusRule, RenderSettings};

macro_rules! features {
    ($($(#[$doc:meta])* $feature:ident = $name:literal,)*) => {
        /// Optional part of the renderer.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Feature {
            $($(#[$doc])* $feature,)*
            /// A kind of material.
            Material(Bsdf),
        }

        /// Bit positions of the features in a set; the materials follow.
        enum Place {
            $($feature,)*
            Materials,
        }

        /// Features other than materials.
        const SHARED: &[Feature] = &[$(Feature::$feature),*];

        impl Feature {
            /// Name that fences optional code in shaders (`//#if name`).
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$feature => $name,)*
                    Self::Material(bsdf) => bsdf.name(),
                }
            }

            const fn place(self) -> u32 {
                match self {
                    $(Self::$feature => Place::$feature as u32,)*
                    Self::Material(bsdf) => Place::Materials as u32 + bsdf as u32,
                }
            }
        }
    };
}

features! {
    /// Triangles.
    Triangle = "triangle",
    /// Triangles with corner normals, texture coordinates or an outline.
    Attributes = "attributes",
    /// Spheres.
    Sphere = "sphere",
    /// Rectangles.
    Rectangle = "rectangle",
    /// Flat discs.
    Disc = "disc",
    /// Axis-parallel boxes.
    Cuboid = "cuboid",
    /// Infinite planes.
    Plane = "plane",
    /// Bézier surfaces of revolution.
    Revolution = "revolution",
    /// Instances of groups of shapes.
    Instances = "instances",
    /// Patches of surfaces of revolution are deferred to the end of the kd-tree traversal.
    PatchSet = "patch_set",
    /// Outlines of flat shapes, which clip the gather disc.
    Outlines = "outlines",
    /// Shapes that are tested outside of the kd-tree.
    Unbounded = "unbounded",
    /// A kd-tree with more than one leaf, with many shapes, or with a surface of revolution in its
    /// leaf.
    KdTree = "kdtree",
    /// A few shapes, which shaders test one after another without a kd-tree.
    Few = "few",
    /// Textures of any kind.
    Textures = "textures",
    /// Checker textures.
    Checker = "checker",
    /// Image textures.
    Texels = "texels",
    /// Textures that bend the shading normal.
    Maps = "maps",
    /// Textures that bend the normal of parts of layered materials.
    PartMaps = "part_maps",
    /// Textures that give the shading normal.
    NormalMap = "normal_map",
    /// Textures that give the height of bumps.
    BumpMap = "bump_map",
    /// Materials below a clear coat.
    Coated = "coated",
    /// Glass bodies that may overlap.
    Nested = "nested",
    /// A lamp or lens that a glass surface crosses, so that its medium is determined point by
    /// point.
    Astride = "astride",
    /// Rough materials whose BRDF is not constant.
    Lobes = "lobes",
    /// Materials with parameters that the gather reads from the material table.
    LobeParameters = "lobe_parameters",
    /// Materials that are sums of others.
    Layered = "layered",
    /// Materials that scatter into discrete directions.
    Specular = "specular",
    /// Dielectrics that absorb.
    Absorption = "absorption",
    /// Any light.
    Lights = "lights",
    /// Light probabilities that depend on the shading point.
    Cells = "cells",
    /// Guide maps of photon emission.
    Guided = "guided",
    /// Emitting triangles.
    AreaTriangle = "area_triangle",
    /// Emitting spheres.
    AreaSphere = "area_sphere",
    /// Emitting rectangles.
    AreaRectangle = "area_rectangle",
    /// Emitting discs.
    AreaDisc = "area_disc",
    /// Emitting boxes.
    AreaCuboid = "area_cuboid",
    /// Emitting surfaces of revolution.
    AreaRevolution = "area_revolution",
    /// Point lights.
    Point = "point",
    /// Spot lights.
    Spot = "spot",
    /// Light from infinity: suns and environments.
    Infinite = "infinite",
    /// Suns with an angular size.
    SunDisc = "sun_disc",
    /// Light from infinity that reaches distant surfaces; photons that scatter there are redirected
    /// to the scene.
    Far = "far",
    /// An environment, constant or from an image.
    Environment = "environment",
    /// An environment image.
    EnvironmentImage = "environment_image",
    /// An environment image rotated about another axis than y.
    TiltedSky = "tilted_sky",
    /// A thin lens.
    Lens = "lens",
    /// A camera other than a perspective one.
    Projection = "projection",
    /// A pixel filter other than the pixel itself.
    Filter = "filter",
    /// A pixel filter with negative lobes.
    SignedFilter = "signed_filter",
    /// Direct light from shadow rays.
    Sampled = "sampled",
    /// Eye paths that continue at narrow lobes.
    Continued = "continued",
    /// The local radius rule.
    Local = "local",
    /// Separate gather radii for caustic and indirect photons.
    Split = "split",
    /// Photon tracing.
    Photons = "photons",
    /// Photons that no diffuse surface has scattered are stored, too.
    First = "first",
    /// The layer of direct light.
    DirectLayer = "direct_layer",
}

impl Feature {
    /// All features.
    pub fn all() -> impl Iterator<Item = Self> {
        SHARED.iter().copied().chain(Bsdf::ALL.iter().copied().map(Self::Material))
    }
}

/// A set of [`Feature`]s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Features(u128);

/// one bit per feature
const _: () = assert!(SHARED.len() + Bsdf::ALL.len() <= u128::BITS as usize);

/// Greatest number of shapes that shaders test one after another, without a kd-tree.
const FEW: usize = 16;

/// Shapes of a kd-tree with a single leaf, if they are few and have short intersection code;
/// shaders test each of them by a constant reference. Empty otherwise.
pub fn few(scene: &SceneTables) -> &[u32] {
    match scene.nodes.first() {
        Some(root) if root.is_leaf() => {
            let refs = scene.refs.get(root.range()).unwrap_or_default();
            let long = |kind| matches!(kind, KIND_REVOLUTION | KIND_INSTANCE);
            let short = !refs.iter().any(|reference| long(kind_of(*reference)));
            if short && refs.len() <= FEW { refs } else { &[] }
        }
        _ => &[],
    }
}

impl Features {
    /// Features that `scene` rendered with `settings` requires.
    pub fn of(scene: &SceneTables, settings: &RenderSettings) -> Self {
        let mut set = Self::default();
        let mut put = |feature, needed| {
            if needed {
                set = set.with(feature);
            }
        };
        put(Feature::Triangle, !scene.triangles.is_empty());
        put(Feature::Attributes, !scene.attributes.is_empty());
        put(Feature::Sphere, !scene.spheres.is_empty());
        put(Feature::Rectangle, !scene.rectangles.is_empty());
        put(Feature::Disc, !scene.discs.is_empty());
        put(Feature::Cuboid, !scene.cuboids.is_empty());
        put(Feature::Plane, !scene.planes.is_empty());
        put(Feature::Outlines, !scene.outlines.is_empty());
        put(Feature::Revolution, !scene.revolutions.is_empty());
        put(Feature::Instances, !scene.instances.is_empty());
        put(Feature::Unbounded, !scene.unbounded.is_empty());
        let few = !few(scene).is_empty();
        let kdtree = !scene.nodes.is_empty() && !few;
        put(Feature::KdTree, kdtree);
        put(Feature::PatchSet, kdtree && has_patch_set(scene));
        put(Feature::Few, few);
        let entries = || scene.materials.iter().map(|m| (Bsdf::of(m.kind), m));
        let bsdfs = || {
            entries().flat_map(|(bsdf, m)| [bsdf].into_iter().chain(bsdf.lobes(m).iter().copied()))
        };
        Bsdf::ALL
            .iter()
            .for_each(|bsdf| put(Feature::Material(*bsdf), bsdfs().any(|b| b == *bsdf)));
        let constant = |b: Bsdf| b == Bsdf::Diffuse || b.is_specular() || b.is_layered();
        put(Feature::Lobes, !bsdfs().all(constant));
        put(Feature::LobeParameters, entries().any(|(bsdf, m)| bsdf.reads_table(m)));
        put(Feature::Layered, bsdfs().any(Bsdf::is_layered));
        put(Feature::Specular, bsdfs().any(Bsdf::is_specular));
        put(Feature::Nested, scene.world.nested != 0);
        let astride = scene.lights.iter().any(|l| l.medium == ASTRIDE);
        put(Feature::Astride, astride || scene.camera.medium == ASTRIDE);
        put(Feature::Absorption, scene.materials.iter().any(|m| m.absorption.max_element() > 0.0));
        put(Feature::Textures, !scene.textures.is_empty());
        put(Feature::Checker, scene.textures.iter().any(|t| t.kind == TEXTURE_CHECKER));
        put(Feature::Texels, !scene.texels.is_empty());
        put(Feature::Coated, scene.materials.iter().any(|m| m.coated > 0.0));
        put(Feature::Maps, scene.materials.iter().any(|m| m.bent != 0));
        put(Feature::PartMaps, has_part_maps(scene));
        put(Feature::NormalMap, scene.materials.iter().any(|m| m.normal_map != NONE));
        put(Feature::BumpMap, scene.materials.iter().any(|m| m.bump_map != NONE));
        let lights = || scene.lights.iter().map(|l| LightKind::of(l.kind));
        let light = |kind| lights().any(|k| k == kind);
        let area = |kind| {
            scene
                .lights
                .iter()
                .any(|l| l.kind == LightKind::Area as u32 && kind_of(l.reference) == kind)
        };
        put(Feature::Lights, !scene.lights.is_empty());
        put(Feature::Cells, !scene.cells.is_empty());
        put(Feature::AreaTriangle, area(KIND_TRIANGLE));
        put(Feature::AreaSphere, area(KIND_SPHERE));
        put(Feature::AreaRectangle, area(KIND_RECTANGLE));
        put(Feature::AreaDisc, area(KIND_DISC));
        put(Feature::AreaCuboid, area(KIND_CUBOID));
        put(Feature::AreaRevolution, area(KIND_REVOLUTION));
        put(Feature::Guided, scene.world.guided != 0);
        put(Feature::Point, light(LightKind::Point));
        put(Feature::Spot, light(LightKind::Spot));
        put(Feature::Infinite, lights().any(LightKind::is_infinite));
        put(Feature::SunDisc, light(LightKind::SunDisc));
        put(Feature::Far, scene.world.far != 0);
        put(Feature::Environment, lights().any(LightKind::is_environment));
        put(Feature::EnvironmentImage, light(LightKind::Image));
        let tilted = |l: &Light| l.kind == LightKind::Image as u32 && l.patch_count != 0;
        put(Feature::TiltedSky, scene.lights.iter().any(tilted));
        put(Feature::Lens, scene.camera.aperture > 0.0);
        let filter = FilterKind::of(scene.camera.filter_kind);
        put(Feature::Projection, scene.camera.projection != ProjectionKind::Perspective as u32);
        put(Feature::Filter, filter != FilterKind::Pixel);
        put(Feature::SignedFilter, filter == FilterKind::Mitchell);
        put(Feature::Sampled, settings.direct == Direct::Sampled && !scene.lights.is_empty());
        put(Feature::Local, settings.radius_rule == RadiusRule::Local);
        let photons = !scene.lights.is_empty() && settings.method != Method::Path;
        let narrow = entries().any(|(bsdf, m)| {
            [bsdf].iter().chain(bsdf.lobes(m)).any(|lobe| lobe.is_narrow(lobe.width(m)))
        });
        put(Feature::Continued, narrow && photons && settings.method == Method::Sppm);
        // photons that no wide surface has scattered are stored
        let first =
            settings.direct == Direct::Photons || !bsdfs().all(|b| b.is_wide() || b.is_layered());
        put(Feature::Photons, photons);
        put(Feature::First, photons && first);
        put(Feature::Split, photons && first && settings.has_wider());
        set
    }

    /// Returns the set with `feature` added.
    pub const fn with(self, feature: Feature) -> Self {
        Self(self.0 | 1 << feature.place())
    }

    /// Returns true if `feature` is required.
    pub const fn has(self, feature: Feature) -> bool {
        self.0 >> feature.place() & 1 == 1
    }

    /// Iterates over the required features in the order of [`Feature::all`].
    pub fn iter(self) -> impl Iterator<Item = Feature> {
        Feature::all().filter(move |feature| self.has(*feature))
    }
}

/// Returns true if a material that a layered one contains bends the normal.
fn has_part_maps(scene: &SceneTables) -> bool {
    let bends = |index: u32| scene.materials.get(index as usize).is_some_and(|m| m.bent != 0);
    scene.materials.iter().any(|m| match Bsdf::of(m.kind) {
        Bsdf::Mix | Bsdf::TwoSided => bends(m.first) || bends(m.second),
        _ => false,
    })
}

impl FromIterator<Feature> for Features {
    fn from_iter<I: IntoIterator<Item = Feature>>(features: I) -> Self {
        features.into_iter().fold(Self::default(), Self::with)
    }
}
