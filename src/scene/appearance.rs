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
}

impl Material {
    /// An opaque material without a name.
    pub const fn new(kind: MaterialKind) -> Self {
        Self { name: String::new(), kind, opacity: None }
    }

    /// Indices of the textures that the material uses.
    pub fn textures(&self) -> impl Iterator<Item = usize> {
        let opacity = self.opacity.as_ref().map(|opacity| &opacity.amount);
        [self.kind.color(), opacity].into_iter().flatten().filter_map(|color| match color {
            Reflectance::Texture(index) => Some(*index),
            Reflectance::Color(_) => None,
        })
    }
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
    /// Thin sheet of a smooth dielectric, which does not bend light.
    ThinGlass {
        /// Index of refraction, > 0.
        ior: f64,
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
    /// No material: light passes straight through.
    Null,
}

impl MaterialKind {
    /// The reflectance, transmittance or amount, which may be a texture.
    pub fn color(&self) -> Option<&Reflectance> {
        match self {
            Self::Diffuse { reflectance, .. }
            | Self::Translucent { reflectance, .. }
            | Self::Mirror { reflectance }
            | Self::Metal { reflectance, .. }
            | Self::Plastic { reflectance, .. } => Some(reflectance),
            Self::ThinGlass { transmittance, .. } => Some(transmittance),
            Self::Mix { amount, .. } => Some(amount),
            Self::Glass { .. } | Self::Conductor { .. } | Self::TwoSided { .. } | Self::Null => {
                None
            }
        }
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
