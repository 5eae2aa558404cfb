//! What surfaces look like: images, textures and materials.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Linear Rec. 709.
pub type Rgb = [f64; 3];

/// The pixels of an image file, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageData {
    /// The file's path, for messages.
    pub path: String,
    /// Texels per row, >= 1.
    pub width: u32,
    /// Rows, >= 1.
    pub height: u32,
    /// `width * height` texels, row by row.
    pub texels: Texels,
}

/// Texels as the file stores them.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// Eight bits a channel.
    Rgba8 {
        /// Whether the color channels carry the sRGB curve; else linear in [0, 1].
        srgb: bool,
        /// Red, green, blue, alpha; renderers do not use alpha.
        data: Vec<[u8; 4]>,
    },
    /// Linear; finite and not negative.
    Float(Vec<[f32; 3]>),
}

/// A named color over the surface's (u, v).
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Its name in the file.
    pub name: String,
    /// What it shows.
    pub kind: TextureKind,
}

/// What a texture shows.
#[derive(Clone, Debug, PartialEq)]
pub enum TextureKind {
    /// One image per uv unit after scaling; v = 0 is the bottom row.
    Image {
        /// Index into [`super::Scene::images`].
        image: usize,
        /// Between texels.
        filter: Filter,
        /// Outside [0, 1].
        wrap: Wrap,
        /// (u, v) is multiplied by it.
        scale: [f64; 2],
    },
    /// Squares of one uv unit after scaling; square (0, 0) has the first color.
    Checker {
        /// Reflectances in [0, 1].
        colors: [Rgb; 2],
        /// (u, v) is multiplied by it.
        scale: [f64; 2],
    },
    /// The image laid as staggered floor boards: every second row is shifted by half a board.
    Planks {
        /// Index into [`super::Scene::images`].
        image: usize,
        /// Width (u) and length (v) of one board in uv units, > 0.
        size: [f64; 2],
        /// Between texels.
        filter: Filter,
    },
}

/// How a texture is read between texel centres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Filter {
    /// Linear in u and v between the four nearest texels, after decoding to linear.
    #[default]
    Bilinear,
    /// The nearest texel.
    Nearest,
}

/// How a texture is read outside [0, 1].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Wrap {
    /// Tiled.
    #[default]
    Repeat,
    /// The border texels go on.
    Clamp,
}

/// A named way of scattering light.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the file; `file.obj:name` when it comes from a mesh's own MTL.
    pub name: String,
    /// What it does.
    pub kind: MaterialKind,
}

/// What a material does with light. All reflectances lie in [0, 1].
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialKind {
    /// Diffuse reflection, two-sided.
    Diffuse {
        /// Albedo.
        reflectance: Reflectance,
        /// In [0, 1]; 0 is Lambertian, otherwise Oren-Nayar's model in Fujii's form.
        roughness: f64,
    },
    /// Diffuse reflection and transmission by a thin surface.
    Translucent {
        /// Share of light that is scattered to both sides.
        reflectance: Reflectance,
        /// Share of that which is transmitted, in [0, 1].
        transmission: f64,
    },
    /// Perfect mirror, two-sided.
    Mirror {
        /// Share reflected at every angle.
        reflectance: Reflectance,
    },
    /// Smooth dielectric with air outside; outside is where the normal points.
    Glass {
        /// Index of refraction inside, > 0.
        ior: f64,
        /// Absorption coefficient inside, per scene unit (Beer-Lambert), >= 0.
        absorption: Rgb,
        /// Where glass bodies overlap, the medium is the one with the highest priority, or the
        /// smaller one if priorities are equal.
        priority: i32,
    },
    /// GGX microfacet conductor with Schlick's Fresnel term, two-sided.
    Metal {
        /// Reflectance at normal incidence, `F_0`.
        reflectance: Reflectance,
        /// In [0, 1]; GGX `alpha = roughness^2`.
        roughness: f64,
    },
}

impl MaterialKind {
    /// The reflectance, which may be a texture.
    pub fn reflectance(&self) -> Option<&Reflectance> {
        match self {
            Self::Diffuse { reflectance, .. }
            | Self::Translucent { reflectance, .. }
            | Self::Mirror { reflectance }
            | Self::Metal { reflectance, .. } => Some(reflectance),
            Self::Glass { .. } => None,
        }
    }
}

/// A share of light per channel, in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reflectance {
    /// The same everywhere.
    Color(Rgb),
    /// Index into [`super::Scene::textures`].
    Texture(usize),
}
