//! Materials and textures. Twins: `shaders/materials/`.
//!
//! A material is one file pair and one line in the list below. The dispatch over materials is
//! generated from the list: the enum [`Bsdf`] with its exhaustive matches here, and the WGSL of
//! `gpu/bsdf.rs`.
//!
//! A *specular* material scatters into discrete directions; its file has `scatter_X`. A *rough* one
//! has `eval_X`, `sample_X`, `pdf_X` and the constants `WIDE` and `TRANSMITS`. `eval_X` includes
//! the cosine between `wi` and the shading normal. Directions are unit vectors that point away from
//! the surface. Tests of densities, energy, reciprocity and engine agreement run over the
//! `EXAMPLES` of every file.

use super::{geometry, math, real, shapes, tables};
use interior::Interior;
use real::{Real, Vec2, Vec3};
use shading::{Lobe, Sample, Scatter, ShadingPoint};
use tables::{Material, SceneTables};

pub mod enclosing;
pub mod interior;
pub mod shading;
pub mod texture;

macro_rules! materials {
    (
        rough { $($(#[$rough_doc:meta])* $rough:ident = $rough_name:ident,
            $eval:ident, $sample:ident, $pdf:ident;)* }
        specular { $($(#[$specular_doc:meta])* $specular:ident = $specular_name:ident,
            $scatter:ident;)* }
    ) => {
        $(pub mod $rough_name;)*
        $(pub mod $specular_name;)*

        /// Kind of a material.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[repr(u32)]
        pub enum Bsdf {
            $($(#[$rough_doc])* $rough,)*
            $($(#[$specular_doc])* $specular,)*
        }

        impl Bsdf {
            /// All materials.
            pub const ALL: &[Self] = &[$(Self::$rough,)* $(Self::$specular,)*];

            /// Stem of the material's file pair, and suffix of its functions.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$rough => stringify!($rough_name),)*
                    $(Self::$specular => stringify!($specular_name),)*
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
                Self::Diffuse
            }

            /// Example parameters of the material, used by tests.
            pub fn examples(self) -> impl Iterator<Item = Material> {
                let examples = match self {
                    $(Self::$rough => $rough_name::EXAMPLES,)*
                    $(Self::$specular => $specular_name::EXAMPLES,)*
                };
                examples.iter().map(move |m| Material { kind: self as u32, ..*m })
            }

            /// Returns true if the material scatters into discrete directions only.
            #[inline(always)]
            pub const fn is_specular(self) -> bool {
                match self {
                    $(Self::$rough => false,)*
                    $(Self::$specular => true,)*
                }
            }

            /// Returns true if a rough material scatters roughly evenly into a hemisphere, so that
            /// light sampling alone estimates direct light well.
            #[inline(always)]
            pub const fn is_wide(self) -> bool {
                match self {
                    $(Self::$rough => $rough_name::WIDE,)*
                    $(Self::$specular => false,)*
                }
            }

            /// Returns true if light passes through a rough material.
            #[inline(always)]
            pub const fn transmits(self) -> bool {
                match self {
                    $(Self::$rough => $rough_name::TRANSMITS,)*
                    $(Self::$specular => false,)*
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
        ];

        /// BSDF of a rough material times the cosine between `wi` and the shading normal `n`, which
        /// is on the side of `wo`.
        #[inline(always)]
        pub fn eval_rough(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Vec3 {
            match lobe.bsdf {
                $(Bsdf::$rough => $rough_name::$eval(lobe, n, wo, wi),)*
                $(Bsdf::$specular => Vec3::ZERO,)*
            }
        }

        /// Density of [`sample_rough`], sr^-1.
        #[inline(always)]
        pub fn pdf_rough(lobe: &Lobe, n: Vec3, wo: Vec3, wi: Vec3) -> Real {
            match lobe.bsdf {
                $(Bsdf::$rough => $rough_name::$pdf(lobe, n, wo, wi),)*
                $(Bsdf::$specular => 0.0,)*
            }
        }

        /// Samples a direction at a rough surface from two random numbers.
        #[inline(always)]
        pub fn sample_rough(p: &ShadingPoint, u: Vec2, mode: u32) -> Sample {
            match p.lobe.bsdf {
                $(Bsdf::$rough => $rough_name::$sample(p, u, mode),)*
                $(Bsdf::$specular => Sample { direction: p.wo, weight: Vec3::ZERO },)*
            }
        }

        /// Scatters at a specular surface. `interior` is the list in front of it; `u` chooses
        /// between reflection and refraction.
        #[inline(always)]
        pub fn scatter_specular(
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
    }
    specular {
        /// Perfect mirror.
        Mirror = mirror, scatter_mirror;
        /// Smooth dielectric.
        Glass = glass, scatter_glass;
    }
}

/// Scatters at a rough surface, which leaves the interior list unchanged.
#[inline(always)]
pub fn scatter_rough(p: &ShadingPoint, interior: &Interior, u: Vec2, mode: u32) -> Scatter {
    let Sample { direction, weight } = sample_rough(p, u, mode);
    Scatter { direction, interior: *interior, weight }
}
