//! Materials and textures. Twins: `shaders/materials/`.
//!
//! A material is one file pair and one line in the list below. The dispatch over materials is
//! generated from the list: the enum [`Bsdf`] with its exhaustive matches here, and the WGSL of
//! `gpu/bsdf.rs`.
//!
//! A *specular* material scatters into discrete directions; its file has `scatter_X`. A *rough* one
//! has `eval_X`, `sample_X`, `pdf_X` and the constants `WIDE` and `TRANSMITS`. `eval_X` includes
//! the cosine between `wi` and the shading normal. A *layered* material is a sum of several others:
//! its `choose_X` chooses one of them for the path, with a probability that does not depend on the
//! scattered direction, so that eye paths, photons and shadow rays need only know one lobe at a
//! time. Directions are unit vectors that point away from the surface. Tests of densities, energy,
//! reciprocity and engine agreement run over the `EXAMPLES` of every file.

use super::{geometry, math, real, shapes, tables};
use brushed::grain_angle;
use interior::{Interior, interior_beyond};
use maps::mapped_normal;
use real::{Real, Vec3};
use shading::{
    ADJOINT_COS_MIN, IMPORTANCE, Layer, Lobe, NARROW, NARROW_GLASS, RADIANCE, Sample, Scatter,
    ShadingPoint, facing_normal, lobe_at, set_normals,
};
use shapes::ray::Hit;
use tables::{Material, SceneTables};

pub mod enclosing;
pub mod fresnel;
pub mod interior;
pub mod maps;
pub mod microfacet;
pub mod shading;
pub mod texture;

macro_rules! materials {
    (
        rough { $($(#[$rough_doc:meta])* $rough:ident = $rough_name:ident,
            $eval:ident, $sample:ident, $pdf:ident;)* }
        specular { $($(#[$specular_doc:meta])* $specular:ident = $specular_name:ident,
            $scatter:ident;)* }
        layered { $($(#[$layered_doc:meta])* $layered:ident = $layered_name:ident,
            $choose:ident;)* }
    ) => {
        $(pub mod $rough_name;)*
        $(pub mod $specular_name;)*
        $(pub mod $layered_name;)*

        /// Kind of a material.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u32)]
        pub enum Bsdf {
            $($(#[$rough_doc])* $rough,)*
            $($(#[$specular_doc])* $specular,)*
            $($(#[$layered_doc])* $layered,)*
        }

        impl Bsdf {
            /// All materials.
            pub const ALL: &[Self] =
                &[$(Self::$rough,)* $(Self::$specular,)* $(Self::$layered,)*];

            /// Stem of the material's file pair, and suffix of its functions.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$rough => stringify!($rough_name),)*
                    $(Self::$specular => stringify!($specular_name),)*
                    $(Self::$layered => stringify!($layered_name),)*
                }
            }

            /// Material with the number `kind` in the material table.
            #[inline(always)]
            pub const fn of(kind: u32) -> Self {
                $(if kind == Self::$specular as u32 {
                    return Self::$specular;
                })*
                $(if kind == Self::$rough as u32 {
                    return Self::$rough;
                })*
                $(if kind == Self::$layered as u32 {
                    return Self::$layered;
                })*
                Self::Diffuse
            }

            /// Example parameters of the material, used by tests.
            pub fn examples(self) -> impl Iterator<Item = Material> {
                let examples = match self {
                    $(Self::$rough => $rough_name::EXAMPLES,)*
                    $(Self::$specular => $specular_name::EXAMPLES,)*
                    $(Self::$layered => $layered_name::EXAMPLES,)*
                };
                examples.iter().map(move |m| Material { kind: self as u32, ..*m })
            }

            /// Returns true if the material scatters into discrete directions only.
            #[inline(always)]
            pub const fn is_specular(self) -> bool {
                match self {
                    $(Self::$rough => false,)*
                    $(Self::$specular => true,)*
                    $(Self::$layered => false,)*
                }
            }

            /// Returns true if the material is a sum of several others.
            #[inline(always)]
            pub const fn is_layered(self) -> bool {
                match self {
                    $(Self::$rough => false,)*
                    $(Self::$specular => false,)*
                    $(Self::$layered => true,)*
                }
            }

            /// Returns true if a rough material scatters roughly evenly into a hemisphere, so that
            /// light sampling alone estimates direct light well.
            #[inline(always)]
            pub const fn is_wide(self) -> bool {
                match self {
                    $(Self::$rough => $rough_name::WIDE,)*
                    $(Self::$specular => false,)*
                    $(Self::$layered => false,)*
                }
            }

            /// Returns true if light passes through a rough material.
            #[inline(always)]
            pub const fn transmits(self) -> bool {
                match self {
                    $(Self::$rough => $rough_name::TRANSMITS,)*
                    $(Self::$specular => false,)*
                    $(Self::$layered => false,)*
                }
            }
        }

        /// Shader files of the materials: path below `shaders/`, text, and the condition under
        /// which a kernel needs it.
        pub const SHADERS: &[(&str, &str, &str)] = &[
            $((
                concat!("materials/", stringify!($rough_name), ".wgsl"),
                include_str!(concat!(
                    env!("CARGO_MANIFEST_DIR"), "/shaders/materials/",
                    stringify!($rough_name), ".wgsl"
                )),
                concat!(
                    "scene && ", stringify!($rough_name),
                    " || gather && lobes && ", stringify!($rough_name)
                ),
            ),)*
            $((
                concat!("materials/", stringify!($specular_name), ".wgsl"),
                include_str!(concat!(
                    env!("CARGO_MANIFEST_DIR"), "/shaders/materials/",
                    stringify!($specular_name), ".wgsl"
                )),
                concat!("scene && ", stringify!($specular_name)),
            ),)*
            $((
                concat!("materials/", stringify!($layered_name), ".wgsl"),
                include_str!(concat!(
                    env!("CARGO_MANIFEST_DIR"), "/shaders/materials/",
                    stringify!($layered_name), ".wgsl"
                )),
                concat!("scene && ", stringify!($layered_name)),
            ),)*
        ];

        /// See [`eval_rough`].
        #[inline(never)]
        fn eval_any(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
            match lobe.bsdf {
                $(Bsdf::$rough => $rough_name::$eval(lobe, n, wo, wi),)*
                $(Bsdf::$specular => Vec3::ZERO,)*
                $(Bsdf::$layered => Vec3::ZERO,)*
            }
        }

        /// See [`pdf_rough`].
        #[inline(never)]
        fn pdf_any(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Real {
            match lobe.bsdf {
                $(Bsdf::$rough => $rough_name::$pdf(lobe, n, wo, wi),)*
                $(Bsdf::$specular => 0.0,)*
                $(Bsdf::$layered => 0.0,)*
            }
        }

        /// See [`sample_rough`].
        #[inline(never)]
        fn sample_any(p: &ShadingPoint, u: Vec3, mode: u32) -> Sample {
            match p.lobe.bsdf {
                $(Bsdf::$rough => $rough_name::$sample(p, u, mode),)*
                $(Bsdf::$specular => Sample { direction: p.wo, weight: Vec3::ZERO },)*
                $(Bsdf::$layered => Sample { direction: p.wo, weight: Vec3::ZERO },)*
            }
        }

        /// See [`scatter_specular`].
        #[inline(never)]
        fn scatter_any(
            scene: &SceneTables,
            p: &ShadingPoint,
            interior: &Interior,
            u: Real,
            mode: u32,
        ) -> Scatter {
            match p.lobe.bsdf {
                $(Bsdf::$specular => $specular_name::$scatter(scene, p, interior, u, mode),)*
                $(Bsdf::$rough => Scatter {
                    direction: p.wo,
                    interior: *interior,
                    weight: Vec3::ZERO,
                },)*
                $(Bsdf::$layered => Scatter {
                    direction: p.wo,
                    interior: *interior,
                    weight: Vec3::ZERO,
                },)*
            }
        }

        /// Chooses one of the materials of a layered one by the random number `u`.
        #[inline(always)]
        fn choose_once<'a>(scene: &'a SceneTables, p: &ShadingPoint<'a>, u: Real) -> Layer<'a> {
            match p.lobe.bsdf {
                $(Bsdf::$layered => $layered_name::$choose(scene, p, u),)*
                $(Bsdf::$rough => Layer { lobe: p.lobe, weight: 1.0, u },)*
                $(Bsdf::$specular => Layer { lobe: p.lobe, weight: 1.0, u },)*
            }
        }
    };
}

materials! {
    rough {
        /// Lambertian reflection.
        Diffuse = diffuse, eval_diffuse, sample_diffuse, pdf_diffuse;
        /// Diffuse reflection by rough microfacets (Oren & Nayar).
        RoughDiffuse = rough_diffuse, eval_rough_diffuse, sample_rough_diffuse, pdf_rough_diffuse;
        /// Diffuse reflection and transmission.
        Translucent = translucent, eval_translucent, sample_translucent, pdf_translucent;
        /// GGX conductor.
        Metal = metal, eval_metal, sample_metal, pdf_metal;
        /// GGX conductor with a complex index of refraction.
        Conductor = conductor, eval_conductor, sample_conductor, pdf_conductor;
        /// GGX conductor with two widths.
        Brushed = brushed, eval_brushed, sample_brushed, pdf_brushed;
        /// Rough dielectric coat of plastic.
        Coat = coat, eval_coat, sample_coat, pdf_coat;
        /// Diffuse base of plastic.
        PlasticBase = plastic_base, eval_plastic_base, sample_plastic_base, pdf_plastic_base;
        /// Rough dielectric.
        RoughGlass = rough_glass, eval_rough_glass, sample_rough_glass, pdf_rough_glass;
        /// Thin sheet with rough faces.
        RoughPane = rough_pane, eval_rough_pane, sample_rough_pane, pdf_rough_pane;
    }
    specular {
        /// Perfect mirror.
        Mirror = mirror, scatter_mirror;
        /// Smooth conductor.
        SmoothMetal = smooth_metal, scatter_smooth_metal;
        /// Smooth dielectric.
        Glass = glass, scatter_glass;
        /// Thin sheet of a dielectric.
        ThinGlass = thin_glass, scatter_thin_glass;
        /// No material.
        Null = null, scatter_null;
    }
    layered {
        /// Diffuse base below a dielectric coat.
        Plastic = plastic, choose_plastic;
        /// Mix of two materials.
        Mix = mix, choose_mix;
        /// A material for each side.
        TwoSided = two_sided, choose_two_sided;
        /// A material that is partly transparent.
        Opacity = opacity, choose_opacity;
        /// A series of materials, by the value of a texture.
        Graded = graded, choose_graded;
        /// A clear coat over another material.
        Clearcoat = clearcoat, choose_clearcoat;
    }
}

/// Greatest depth of layered materials that contain others.
pub const LAYERS: usize = 12;

impl Bsdf {
    /// Lobes that the entry `m` of this kind, itself not counted, chooses from; other entries of
    /// the table have theirs.
    pub fn lobes(self, m: &Material) -> &'static [Self] {
        match self {
            Self::Plastic if m.alpha > 0.0 => &[Self::PlasticBase, Self::Coat],
            Self::Plastic => &[Self::PlasticBase, Self::Mirror],
            Self::Clearcoat if m.alpha > 0.0 => &[Self::Coat],
            Self::Clearcoat => &[Self::Mirror],
            Self::Opacity => &[Self::Null],
            Self::Mix | Self::TwoSided | Self::Graded => &[],
            Self::Diffuse | Self::RoughDiffuse | Self::Translucent | Self::Metal => &[],
            Self::Conductor | Self::Coat | Self::PlasticBase | Self::RoughGlass => &[],
            Self::RoughPane | Self::Brushed => &[],
            Self::Mirror | Self::SmoothMetal | Self::Glass | Self::ThinGlass | Self::Null => &[],
        }
    }

    /// Returns true if the lobe of the entry `m` has parameters that visible points do not store,
    /// so that the gather reads the material table.
    #[inline(always)]
    pub fn reads_table(self, m: &Material) -> bool {
        self.is_parametric() || m.coated > 0.0 || self == Self::Metal && m.mean_albedo < 1.0
    }

    /// Returns true for the surface of a glass body, with a medium inside.
    #[inline(always)]
    pub const fn is_body(self) -> bool {
        matches!(self, Self::Glass | Self::RoughGlass)
    }

    /// Returns true for a rough material that reflects about the mirror direction only, by facets
    /// of one width.
    #[inline(always)]
    pub const fn is_reflector(self) -> bool {
        matches!(self, Self::Metal | Self::Conductor | Self::Coat)
    }

    /// Greatest width of the lobe of the entry `m` of this kind.
    #[inline(always)]
    pub fn width(self, m: &Material) -> Real {
        if self == Self::Brushed { m.alpha.max(m.ior) } else { m.alpha }
    }

    /// Returns true if a lobe of the width `alpha` is so narrow that eye paths continue at it.
    #[inline(always)]
    pub const fn is_narrow(self, alpha: Real) -> bool {
        let limit = if self.is_body() { NARROW_GLASS } else { NARROW };
        !self.is_wide() && !self.is_specular() && !self.is_layered() && alpha < limit
    }

    /// Returns true if every lobe of the kind has such parameters.
    #[inline(always)]
    pub const fn is_parametric(self) -> bool {
        match self {
            Self::Conductor | Self::Coat | Self::PlasticBase | Self::Plastic => true,
            Self::RoughGlass | Self::RoughPane | Self::Clearcoat | Self::Brushed => true,
            Self::Diffuse | Self::RoughDiffuse | Self::Translucent | Self::Metal => false,
            Self::Mirror | Self::SmoothMetal | Self::Glass | Self::ThinGlass | Self::Null => false,
            Self::Mix | Self::TwoSided | Self::Opacity | Self::Graded => false,
        }
    }
}

/// Chooses a lobe if the material at `hit` is layered, by the random number `u`. Returns the factor
/// of the path's throughput.
#[inline(always)]
pub fn choose_layer<'a>(
    scene: &'a SceneTables,
    hit: &Hit,
    p: &mut ShadingPoint<'a>,
    u: Real,
) -> Real {
    let (chosen, weight) = chosen_layer(scene, *hit, &{ *p }, u);
    *p = chosen;
    weight
}

#[inline(never)]
fn chosen_layer<'a>(
    scene: &'a SceneTables,
    hit: Hit,
    p: &ShadingPoint<'a>,
    u: Real,
) -> (ShadingPoint<'a>, Real) {
    let mut p = *p;
    let mut layer = Layer { lobe: p.lobe, weight: 1.0, u };
    let mut weight = 1.0;
    let mut depth = 0;
    while depth < LAYERS && p.lobe.bsdf.is_layered() {
        layer = choose_once(scene, &p, layer.u);
        if layer.lobe.material != p.lobe.material {
            layer.lobe = lobe_at(scene, layer.lobe.material, p.s.uv);
        }
        p.lobe = layer.lobe;
        weight *= layer.weight;
        depth += 1;
    }
    if p.lobe.m.bent != 0 && p.lobe.material != p.s.material {
        p.s.shading = mapped_normal(scene, p.lobe.m, hit, p.s);
        p.bent = true;
    }
    set_normals(&mut p);
    if p.lobe.bsdf == Bsdf::Brushed {
        p.lobe.alpha = grain_angle(scene, hit, &p);
    }
    (p, weight)
}

// The most common materials are inlined into kernels, the others called: code of materials that a
// scene lacks would slow it down. They are called with copies, so that kernels can keep the
// originals in registers.

/// BSDF of a rough material times the cosine between `wi` and the shading normal `n`, which is on
/// the side of `wo`.
#[inline(always)]
pub fn eval_rough(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
    if lobe.bsdf == Bsdf::Diffuse {
        return diffuse::eval_diffuse(lobe, n, wo, wi);
    }
    let f = eval_any(&{ *lobe }, n, wo, wi);
    if lobe.m.coated > 0.0 { f * coated(lobe, wi.dot(n)) } else { f }
}

/// Samples a direction at a rough surface from three random numbers.
#[inline(always)]
pub fn sample_rough(p: &ShadingPoint, u: Vec3, mode: u32) -> Sample {
    if p.lobe.bsdf == Bsdf::Diffuse {
        return diffuse::sample_diffuse(p, u, mode);
    }
    let mut drawn = sample_any(&{ *p }, u, mode);
    if p.lobe.m.coated > 0.0 {
        drawn.weight *= coated(&p.lobe, drawn.direction.dot(p.n));
    }
    drawn
}

/// Fraction of the light of a lobe below a clear coat that passes the coat in a direction with
/// cosine `cos` (see [`clearcoat`]).
#[inline(always)]
fn coated(lobe: &Lobe, cos: Real) -> Real {
    1.0 - fresnel::fresnel(cos.abs(), lobe.m.coated).reflectance
}

/// Samples the direction of a photon at a surface with maps. The shading normal of a reflector
/// depends on the viewer, whose direction is sampled: the adjoint follows from the BSDF that the
/// viewer sees (Veach 1997, eq. 5.19).
#[inline(never)]
fn sample_adjoint(p: &ShadingPoint, u: Vec3) -> Sample {
    if !p.lobe.bsdf.is_reflector() {
        return sample_rough(p, u, IMPORTANCE);
    }
    let Sample { direction, .. } = sample_rough(p, u, RADIANCE);
    let cos = direction.dot(p.ng);
    let pdf = pdf_rough(&p.lobe, p.n, p.wo, direction);
    if cos <= 0.0 || pdf <= 0.0 {
        return Sample { direction, weight: Vec3::ZERO };
    }
    let n = facing_normal(p.ns, p.ng, direction, p.lobe.alpha);
    let f = eval_rough(&p.lobe, n, direction, p.wo);
    let arrived = p.wo.dot(p.ng).max(ADJOINT_COS_MIN);
    Sample { direction, weight: f * (cos / (arrived * pdf)) }
}

/// Density of [`sample_rough`], sr^-1.
#[inline(always)]
pub fn pdf_rough(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Real {
    pdf_any(&{ *lobe }, n, wo, wi)
}

/// Scatters at a specular surface. `interior` is the list in front of it; `u` chooses between
/// reflection and refraction.
#[inline(always)]
pub fn scatter_specular(
    scene: &SceneTables,
    p: &ShadingPoint,
    interior: &Interior,
    u: Real,
    mode: u32,
) -> Scatter {
    match p.lobe.bsdf {
        Bsdf::Glass => glass::scatter_glass(scene, p, interior, u, mode),
        Bsdf::Mirror if p.lobe.m.coated == 0.0 => {
            mirror::scatter_mirror(scene, p, interior, u, mode)
        }
        _ => {
            let mut scattered = scatter_any(scene, &{ *p }, &{ *interior }, u, mode);
            if p.lobe.m.coated > 0.0 {
                scattered.weight *= coated(&p.lobe, scattered.direction.dot(p.n));
            }
            scattered
        }
    }
}

/// Scatters at a rough surface. `interior` is the list in front of it.
#[inline(always)]
pub fn scatter_rough(
    scene: &SceneTables,
    p: &ShadingPoint,
    interior: &Interior,
    u: Vec3,
    mode: u32,
) -> Scatter {
    let Sample { direction, weight } = if mode == IMPORTANCE && p.bent {
        sample_adjoint(&{ *p }, u)
    } else {
        sample_rough(p, u, mode)
    };
    let mut interior = *interior;
    if p.lobe.bsdf.is_body() && direction.dot(p.ng) < 0.0 {
        interior = interior_beyond(scene, &p.s, p.wo, &interior);
    }
    Scatter { direction, interior, weight }
}
