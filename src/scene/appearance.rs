//! Appearance of surfaces: images, textures and materials.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Linear Rec. 709 color.
pub type Rgb = [f64; 3];

/// Pixels of an image file; row 0 is the top.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageData {
    /// Path of the file, for messages.
    pub path: String,
    /// Texels per row, >= 1.
    pub width: u32,
    /// Number of rows, >= 1.
    pub height: u32,
    /// `width * height` texels, row by row.
    pub texels: Texels,
}

/// Texels with 8 bits per channel or as linear f32.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// 8 bits per channel.
    Rgba8 {
        /// True if the color channels are sRGB-encoded; else linear in [0, 1].
        srgb: bool,
        /// Red, green, blue, alpha; renderers ignore alpha.
        data: Vec<[u8; 4]>,
    },
    /// Linear RGB, finite and >= 0.
    Float(Vec<[f32; 3]>),
}

/// A named color as a function of the surface's (u, v).
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Name in the scene file; for an MTL map, the name of its material.
    pub name: String,
    /// Pattern and its parameters.
    pub kind: TextureKind,
}

/// Pattern of a texture.
#[derive(Clone, Debug, PartialEq)]
pub enum TextureKind {
    /// An image that covers one uv unit after scaling; v = 0 is the bottom row.
    Image {
        /// Index into [`super::Scene::images`].
        image: usize,
        /// Interpolation between texels.
        filter: Filter,
        /// Addressing outside [0, 1].
        wrap: Wrap,
        /// Factor on (u, v).
        scale: [f64; 2],
    },
    /// A checkerboard of squares one uv unit wide after scaling; square (0, 0) has the first color.
    Checker {
        /// Reflectances in [0, 1].
        colors: [Rgb; 2],
        /// Factor on (u, v).
        scale: [f64; 2],
    },
    /// An image laid as staggered floor boards: every second row is shifted by half a board.
    Planks {
        /// Index into [`super::Scene::images`].
        image: usize,
        /// Width (u) and length (v) of one board in uv units, > 0.
        size: [f64; 2],
        /// Interpolation between texels.
        filter: Filter,
    },
}

/// Texture interpolation between texel centres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Filter {
    /// Bilinear between the four nearest texels, after decoding to linear.
    #[default]
    Bilinear,
    /// The nearest texel.
    Nearest,
}

/// Texture addressing outside [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Wrap {
    /// Repeats the image.
    #[default]
    Repeat,
    /// Extends the border texels.
    Clamp,
}

/// A named scattering model.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name in the scene file; `file.obj:name` for a material from a mesh's MTL file.
    pub name: String,
    /// Scattering model and its parameters.
    pub kind: MaterialKind,
    /// Fraction of the surface that is there, if not all of it; not for glass and not for lights.
    pub opacity: Option<Opacity>,
    /// Index of a texture in [`super::Scene::textures`] whose values, the means of the channels,
    /// are factors of the kind's roughness.
    pub roughness_map: Option<usize>,
    /// Roughness of a metal along v, if it differs from that along u.
    pub roughness_v: Option<f64>,
    /// Texture that gives the shading normal.
    pub normal_map: Option<NormalMap>,
    /// Texture that gives the height of bumps.
    pub bump_map: Option<BumpMap>,
}

impl Material {
    /// An opaque material without a name.
    pub const fn new(kind: MaterialKind) -> Self {
        Self {
            name: String::new(),
            kind,
            opacity: None,
            roughness_map: None,
            roughness_v: None,
            normal_map: None,
            bump_map: None,
        }
    }

    /// Indices of the textures that the material uses.
    pub fn textures(&self) -> impl Iterator<Item = usize> {
        let opacity = self.opacity.as_ref().map(|opacity| &opacity.amount);
        let of = |color: &Reflectance| match color {
            Reflectance::Texture(index) => Some(*index),
            Reflectance::Color(_) => None,
        };
        let colors: Vec<_> = self.kind.colors().into_iter().chain(opacity).filter_map(of).collect();
        let (normal, bump) = (self.normal_map.as_ref(), self.bump_map.as_ref());
        let maps = [self.roughness_map, normal.map(|map| map.texture), bump.map(|map| map.texture)];
        colors.into_iter().chain(maps.into_iter().flatten())
    }
}

/// A texture that gives the shading normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// Index into [`super::Scene::textures`]. Its channels are `(x + 1) / 2` of the components
    /// along the directions in which u and v increase, and along the normal.
    pub texture: usize,
    /// Factor on the first two components.
    pub strength: f64,
}

/// A texture that gives the height of bumps, along the outer normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BumpMap {
    /// Index into [`super::Scene::textures`]; the mean of the channels counts.
    pub texture: usize,
    /// Height at the value 1, scene units; negative for dents.
    pub height: f64,
}

/// Opacity of a surface, for holes in leaves, nets and lace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opacity {
    /// Fraction of light that meets the surface; the rest passes straight through. The mean of the
    /// channels counts.
    pub amount: Reflectance,
    /// If given, the surface is a mask: opaque where the amount is at least this, else absent.
    pub cutoff: Option<f64>,
}

/// Scattering model of a material. All reflectances lie in [0, 1].
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialKind {
    /// Two-sided diffuse reflection.
    Diffuse {
        /// Albedo.
        reflectance: Reflectance,
        /// Roughness in [0, 1]: 0 is Lambertian, otherwise Fujii's form of the Oren-Nayar model.
        roughness: f64,
    },
    /// Diffuse reflection and transmission by a thin surface.
    Translucent {
        /// Fraction of light that is scattered, to both sides together.
        reflectance: Reflectance,
        /// Fraction of the scattered light that is transmitted, in [0, 1].
        transmission: f64,
    },
    /// Perfect two-sided mirror.
    Mirror {
        /// Fraction of light reflected, at every angle.
        reflectance: Reflectance,
    },
    /// Dielectric with air outside; the normal points to the outside.
    Glass {
        /// Index of refraction inside, > 0.
        ior: f64,
        /// Roughness in [0, 1]; GGX `alpha = roughness^2`. 0 is smooth.
        roughness: f64,
        /// Absorption coefficient inside, per scene unit (Beer-Lambert), >= 0.
        absorption: Rgb,
        /// Rank where glass bodies overlap: the medium is the glass with the highest priority, or
        /// that of the smaller body if priorities are equal.
        priority: i32,
    },
    /// Two-sided GGX microfacet conductor with Schlick's Fresnel term.
    Metal {
        /// Reflectance at normal incidence, `F_0`.
        reflectance: Reflectance,
        /// Roughness in [0, 1]; GGX `alpha = roughness^2`. 0 is a mirror.
        roughness: f64,
    },
    /// Two-sided GGX microfacet conductor with the exact Fresnel term.
    Conductor {
        /// Index of refraction per channel, > 0.
        eta: Rgb,
        /// Extinction coefficient per channel, >= 0.
        k: Rgb,
        /// Roughness in [0, 1]; GGX `alpha = roughness^2`. 0 is a mirror.
        roughness: f64,
    },
    /// Two-sided diffuse base below a dielectric coat.
    Plastic {
        /// Albedo of the base.
        reflectance: Reflectance,
        /// Index of refraction of the coat, > 1.
        ior: f64,
        /// Roughness of the coat in [0, 1]; GGX `alpha = roughness^2`. 0 is a smooth coat.
        roughness: f64,
        /// If true, light takes on the color of the base each time that the coat reflects it back
        /// inside.
        nonlinear: bool,
    },
    /// Thin sheet of a dielectric, which does not bend light.
    ThinGlass {
        /// Index of refraction, > 0.
        ior: f64,
        /// Roughness of both faces in [0, 1]; GGX `alpha = roughness^2`. 0 is smooth.
        roughness: f64,
        /// Fraction of the transmitted light that is left.
        transmittance: Reflectance,
    },
    /// Mix of two materials.
    Mix {
        /// Indices into [`super::Scene::materials`].
        materials: [usize; 2],
        /// Fraction of the second material; the mean of the channels counts.
        amount: Reflectance,
    },
    /// A material for each side of a surface.
    TwoSided {
        /// Index into [`super::Scene::materials`], for the side that the normal points to.
        front: usize,
        /// Likewise for the other side.
        back: usize,
    },
    /// Dielectric and metal with common parameters.
    Principled(Principled),
    /// No material: light passes straight through.
    Null,
}

/// Parameters of the principled material. Of textures for amounts the mean of the channels counts.
#[derive(Clone, Debug, PartialEq)]
pub struct Principled {
    /// Albedo of the dielectric, and reflectance of the metal at normal incidence.
    pub base_color: Reflectance,
    /// Amount of metal; the rest is dielectric.
    pub metallic: Reflectance,
    /// Roughness in [0, 1] of all facets but those of the clear coat; GGX `alpha = roughness^2`.
    pub roughness: f64,
    /// Strength `s` in [0, 1] of the metal's grain: alpha along u is `alpha + (1 - alpha) s^2`.
    pub anisotropy: f64,
    /// Index of refraction of the dielectric, >= 1.
    pub ior: f64,
    /// Amount of the dielectric's surface that reflects.
    pub specular: Reflectance,
    /// Amount of the dielectric that is a thin sheet of glass with the base color.
    pub transmission: Reflectance,
    /// Amount of the surface with a clear coat.
    pub clearcoat: Reflectance,
    /// Roughness of the clear coat in [0, 1].
    pub clearcoat_roughness: f64,
}

impl Principled {
    /// All parameters that may be textures.
    fn colors(&self) -> [&Reflectance; 5] {
        [&self.base_color, &self.metallic, &self.specular, &self.transmission, &self.clearcoat]
    }
}

impl MaterialKind {
    /// The reflectances, transmittances and amounts, which may be textures.
    pub fn colors(&self) -> Vec<&Reflectance> {
        match self {
            Self::Principled(principled) => principled.colors().to_vec(),
            _ => self.color().into_iter().collect(),
        }
    }

    /// The reflectance, transmittance or amount of a kind that has only one.
    pub fn color(&self) -> Option<&Reflectance> {
        match self {
            Self::Diffuse { reflectance, .. }
            | Self::Translucent { reflectance, .. }
            | Self::Mirror { reflectance }
            | Self::Metal { reflectance, .. }
            | Self::Plastic { reflectance, .. } => Some(reflectance),
            Self::ThinGlass { transmittance, .. } => Some(transmittance),
            Self::Mix { amount, .. } => Some(amount),
            Self::Glass { .. }
            | Self::Conductor { .. }
            | Self::TwoSided { .. }
            | Self::Principled(_)
            | Self::Null => None,
        }
    }

    /// The roughness, if the kind has one.
    pub fn roughness(&self) -> Option<f64> {
        match self {
            Self::Diffuse { roughness, .. }
            | Self::Glass { roughness, .. }
            | Self::Metal { roughness, .. }
            | Self::Conductor { roughness, .. }
            | Self::Plastic { roughness, .. }
            | Self::ThinGlass { roughness, .. }
            | Self::Principled(Principled { roughness, .. }) => Some(*roughness),
            Self::Translucent { .. }
            | Self::Mirror { .. }
            | Self::Mix { .. }
            | Self::TwoSided { .. }
            | Self::Null => None,
        }
    }

    /// The kind with another roughness, if it has one.
    #[must_use]
    pub fn with_roughness(&self, value: f64) -> Self {
        let mut kind = self.clone();
        if let Self::Diffuse { roughness, .. }
        | Self::Glass { roughness, .. }
        | Self::Metal { roughness, .. }
        | Self::Conductor { roughness, .. }
        | Self::Plastic { roughness, .. }
        | Self::ThinGlass { roughness, .. }
        | Self::Principled(Principled { roughness, .. }) = &mut kind
        {
            *roughness = value;
        }
        kind
    }

    /// Indices of the materials that this one consists of.
    pub fn parts(&self) -> Option<[usize; 2]> {
        match self {
            Self::Mix { materials, .. } => Some(*materials),
            Self::TwoSided { front, back } => Some([*front, *back]),
            Self::Diffuse { .. }
            | Self::Translucent { .. }
            | Self::Mirror { .. }
            | Self::Glass { .. }
            | Self::Metal { .. }
            | Self::Conductor { .. }
            | Self::Plastic { .. }
            | Self::ThinGlass { .. }
            | Self::Principled(_)
            | Self::Null => None,
        }
    }
}

/// Reflectance per channel, in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflectance {
    /// A constant color.
    Color(Rgb),
    /// Index into [`super::Scene::textures`].
    Texture(usize),
}
