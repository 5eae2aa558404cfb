//! Textures and materials.

use schemars::JsonSchema;
use serde::Deserialize;

use super::super::numbers::{Amount, GrainedAmount, NonNegative, Paint, Positive, Share, Spectrum};
use super::super::schema::close_variants;
use crate::scene::{Channel, ColorSpace, Filter, Wrap};

/// A color as a function of a surface's (u, v).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum TextureFile {
    /// An image; v = 0 is its bottom row.
    Image {
        /// A png, jpg, hdr or exr file.
        file: String,
        /// Encoding of its values; the file type gives the default.
        color_space: Option<ColorSpace>,
        /// The only channel that is read, as gray values; such as alpha, for an opacity.
        channel: Option<Channel>,
        /// Interpolation between texels.
        #[serde(default)]
        filter: Filter,
        /// Addressing outside [0, 1].
        #[serde(default)]
        wrap: Wrap,
        /// Factor on (u, v).
        #[serde(default = "ones")]
        scale: [f64; 2],
    },
    /// A checkerboard of squares one uv unit wide after scaling.
    Checker {
        /// Colors of square (0, 0) and of its neighbours.
        colors: [Spectrum<Share>; 2],
        /// Factor on (u, v).
        #[serde(default = "ones")]
        scale: [f64; 2],
    },
    /// An image laid as floor boards; every second row is shifted by half a board.
    Planks {
        /// A png, jpg, hdr or exr file.
        file: String,
        /// Width (u) and length (v) of a board in uv units.
        size: [Positive; 2],
        /// Encoding of its values; the file type gives the default.
        color_space: Option<ColorSpace>,
        /// Interpolation between texels.
        #[serde(default)]
        filter: Filter,
    },
}

/// A material: how a surface scatters light.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "type", rename_all = "snake_case")]
#[schemars(transform = close_variants)]
pub enum MaterialFile {
    /// Two-sided diffuse reflection.
    Diffuse {
        /// Albedo.
        reflectance: Paint,
        /// Roughness, from 0 (Lambertian) to 1 (Oren-Nayar).
        #[serde(default)]
        roughness: Amount,
        /// Opacity and maps.
        #[serde(flatten)]
        common: CommonFile,
    },
    /// Diffuse reflection and transmission by a thin surface such as paper.
    Translucent {
        /// Fraction of light that is scattered, to both sides together.
        reflectance: Paint,
        /// Fraction of the scattered light that is transmitted.
        transmission: Share,
        /// Opacity and maps.
        #[serde(flatten)]
        common: CommonFile,
    },
    /// A perfect two-sided mirror.
    Mirror {
        /// Fraction of light reflected.
        reflectance: Paint,
        /// Opacity and maps.
        #[serde(flatten)]
        common: CommonFile,
    },
    /// A smooth dielectric. Outside is air or, where bodies overlap, the other glass.
    Glass {
        /// Index of refraction.
        ior: Option<Positive>,
        /// Name of a material that has the index, such as bk7, water or diamond.
        material: Option<String>,
        /// Roughness of the surface, from 0 (smooth) to 1; GGX alpha is its square.
        #[serde(default)]
        roughness: Share,
        /// Absorption coefficient inside, per scene unit (Beer-Lambert); 0 by default.
        absorption: Option<Spectrum<NonNegative>>,
        /// Fraction of light that is left at the attenuation distance; replaces `absorption`.
        attenuation_color: Option<Spectrum<Share>>,
        /// Distance in scene units at which the attenuation color is reached; 1 by default.
        attenuation_distance: Option<Positive>,
        /// Rank where glass bodies overlap: the medium is the glass with the highest priority, or
        /// that of the smaller body if priorities are equal.
        priority: Option<i32>,
        /// If true, the surface is a thin sheet without an inside, such as a window pane, and does
        /// not bend light.
        #[serde(default)]
        thin: bool,
        /// Fraction of the transmitted light that a thin sheet lets through; 1 by default.
        transmittance: Option<Paint>,
        /// Opacity and maps.
        #[serde(flatten)]
        common: CommonFile,
    },
    /// A two-sided GGX microfacet conductor. Its color is given by `reflectance`, by `eta` and `k`,
    /// or by the name of a metal.
    Metal {
        /// Fraction of light reflected at normal incidence; towards grazing angles it rises to 1
        /// (Schlick).
        reflectance: Option<Paint>,
        /// Index of refraction per channel, for the exact Fresnel equations.
        eta: Option<Spectrum<Positive>>,
        /// Extinction coefficient per channel.
        k: Option<Spectrum<NonNegative>>,
        /// Name of a metal, such as gold, copper or aluminium.
        material: Option<String>,
        /// Roughness, from 0 (mirror) to 1, or two along u and v; GGX alpha is its square.
        #[serde(default)]
        roughness: GrainedAmount,
        /// Opacity and maps.
        #[serde(flatten)]
        common: CommonFile,
    },
    /// A diffuse base below a clear dielectric coat, as on plastic, glazed ceramics or varnish.
    Plastic {
        /// Albedo of the base.
        reflectance: Paint,
        /// Index of refraction of the coat, above 1; 1.5 by default.
        #[serde(default = "coat_ior")]
        #[schemars(extend("exclusiveMinimum" = 1))]
        ior: f64,
        /// Roughness of the coat, from 0 (smooth) to 1; GGX alpha is its square.
        #[serde(default)]
        roughness: Amount,
        /// If true, light takes on the color of the base each time that the coat reflects it back
        /// inside, which saturates the color.
        #[serde(default)]
        nonlinear: bool,
        /// Opacity and maps.
        #[serde(flatten)]
        common: CommonFile,
    },
    /// Dielectric and metal with common parameters, like the material of glTF.
    Principled {
        /// Albedo of the dielectric, and reflectance of the metal at normal incidence.
        base_color: Paint,
        /// Amount of metal; the rest is dielectric.
        #[serde(default)]
        metallic: Amount,
        /// Roughness, from 0 (smooth) to 1; GGX alpha is its square. 0.5 by default.
        #[serde(default = "half")]
        roughness: Amount,
        /// Strength of the metal's grain along u.
        #[serde(default)]
        anisotropy: Share,
        /// Index of refraction of the dielectric, above 1; 1.5 by default.
        #[serde(default = "coat_ior")]
        #[schemars(extend("exclusiveMinimum" = 1))]
        ior: f64,
        /// Amount of the dielectric's surface that reflects; 1 by default.
        #[serde(default = "all")]
        specular: Amount,
        /// Amount of the dielectric that is a thin sheet of glass with the base color.
        #[serde(default)]
        transmission: Amount,
        /// Amount of the surface with a clear coat.
        #[serde(default)]
        clearcoat: Amount,
        /// Roughness of the clear coat.
        #[serde(default)]
        clearcoat_roughness: Share,
        /// Opacity and maps.
        #[serde(flatten)]
        common: CommonFile,
    },
    /// A mix of two materials, which must not be glass with an inside.
    Mix {
        /// Names of the two materials.
        materials: [String; 2],
        /// Fraction of the second material; of a texture the mean of the channels counts.
        amount: Paint,
        /// Opacity and maps.
        #[serde(flatten)]
        common: CommonFile,
    },
    /// A material for each side of a surface.
    TwoSided {
        /// Name of the material on the side that the normal points to.
        front: String,
        /// Name of the material on the other side.
        back: String,
        /// Opacity and maps.
        #[serde(flatten)]
        common: CommonFile,
    },
    /// No material: light passes straight through.
    Null {},
}

/// Keys that every material accepts, except `null`.
#[derive(Debug, Default, Deserialize, JsonSchema)]
pub struct CommonFile {
    /// Fraction of light that meets the surface; the rest passes straight through. Of a texture the
    /// mean of the channels counts. 1 by default.
    pub opacity: Option<Paint>,
    /// Makes the surface a mask: opaque where the opacity is at least this, else absent.
    pub opacity_cutoff: Option<Share>,
    /// Name of an image texture in linear color space that gives the shading normal: red, green and
    /// blue are half of one plus its components along u, v and the surface's normal.
    pub normal_map: Option<String>,
    /// Factor on the components of the normal map along u and v; 1 by default.
    pub normal_strength: Option<f64>,
    /// Name of a texture in linear color space that gives the height of bumps; the mean of the
    /// channels counts.
    pub bump_map: Option<String>,
    /// Height of bumps at the value 1, along the surface's normal; negative for dents.
    pub bump_height: Option<f64>,
}

fn coat_ior() -> f64 {
    1.5
}

fn half() -> Amount {
    Amount::Number(Share(0.5))
}

fn all() -> Amount {
    Amount::Number(Share(1.0))
}

fn ones() -> [f64; 2] {
    [1.0, 1.0]
}
