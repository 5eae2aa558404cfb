//! A picture made smooth by [Open Image Denoise](https://www.openimagedenoise.org) 2, a C library
//! that only the cargo feature `denoise` links. What it makes is to be looked at: it is no
//! estimate, its bias is not known, and nothing here measures it.
//!
//! The filter `RT` takes radiance as it is (HDR), with the layers `albedo` and `normal` as
//! auxiliary pictures that may be noisy themselves.

use thiserror::Error;

use super::exr_file::Channel;
use super::{Picture, Plane};
use crate::scene::{Aov, Aovs};

/// What made a denoised picture, as files tell it. The library's safe interface in Rust does not
/// give the rest of its version.
pub const NAME: &str = "Open Image Denoise 2";

/// Why there is no denoised picture.
#[derive(Debug, Error)]
pub enum DenoiseError {
    /// The feature is not compiled in.
    #[error("this caustica is built without a denoiser")]
    NotBuilt,
    /// A layer that guides the filter is not there.
    #[error("the layer {0} is missing, which guides the denoiser")]
    NoLayer(&'static str),
    /// The library says so.
    #[error("{NAME}: {what}")]
    Library {
        /// In its words.
        what: String,
    },
}

/// The layers that a picture needs to be denoised.
pub fn guides() -> Aovs {
    [Aov::Albedo, Aov::Normal].into_iter().collect()
}

/// The library, ready to work on the processor.
pub struct Denoiser(backend::Device);

impl Denoiser {
    /// Prepares it.
    ///
    /// # Errors
    /// Where the feature is not compiled in, or the library finds no processor that it can use.
    pub fn open() -> Result<Self, DenoiseError> {
        backend::open().map(Self)
    }

    /// The picture without its noise, in the same unit. `layers` hold [`guides`] of the same
    /// pixels.
    ///
    /// # Errors
    /// Where a layer is missing or of another size, or the library fails.
    pub fn denoise(&self, picture: &Picture, layers: &[Channel]) -> Result<Picture, DenoiseError> {
        let albedo = vectors(layers, ["albedo.R", "albedo.G", "albedo.B"])?;
        let normal = vectors(layers, ["normal.X", "normal.Y", "normal.Z"])?;
        let mut rgb = picture.rgb.clone();
        let size = (picture.width as usize, picture.height as usize);
        backend::filter(
            &self.0,
            size,
            [albedo.as_flattened(), normal.as_flattened()],
            rgb.as_flattened_mut(),
        )?;
        Ok(Picture { rgb, ..*picture })
    }
}

/// A denoised picture as the layer `denoised`.
pub fn layer(denoised: &Picture) -> [Channel; 3] {
    let plane = |c: usize| Plane::of(denoised, |rgb| f64::from(rgb[c]));
    [("denoised.R", 0), ("denoised.G", 1), ("denoised.B", 2)]
        .map(|(name, c)| Channel::float(name, plane(c)))
}

/// Three channels, pixel by pixel.
fn vectors(layers: &[Channel], names: [&'static str; 3]) -> Result<Vec<[f32; 3]>, DenoiseError> {
    let values = |name| {
        let channel = layers.iter().find(|channel| channel.name == name);
        channel.map(|channel| &channel.plane.values).ok_or(DenoiseError::NoLayer(name))
    };
    let [x, y, z] = names.map(values);
    Ok(x?.iter().zip(y?).zip(z?).map(|((&x, &y), &z)| [x as f32, y as f32, z as f32]).collect())
}

#[cfg(feature = "denoise")]
mod backend {
    pub use oidn::Device;
    use oidn::{Error, RayTracing};

    use super::DenoiseError;

    /// The processor, and no GPU: the same picture wherever it is made.
    pub fn open() -> Result<Device, DenoiseError> {
        Ok(Device::cpu()?)
    }

    /// Filters `rgb` in place.
    pub fn filter(
        device: &Device,
        (width, height): (usize, usize),
        [albedo, normal]: [&[f32]; 2],
        rgb: &mut [f32],
    ) -> Result<(), DenoiseError> {
        let mut filter = RayTracing::try_new(device)?;
        filter.image_dimensions(width, height).hdr(true).srgb(false);
        filter
            .albedo_normal_buffer(device.create_buffer(albedo)?, device.create_buffer(normal)?)?;
        Ok(filter.filter_in_place(rgb)?)
    }

    impl From<Error> for DenoiseError {
        fn from(error: Error) -> Self {
            Self::Library { what: error.to_string() }
        }
    }
}

#[cfg(not(feature = "denoise"))]
mod backend {
    use super::DenoiseError;

    /// There is none.
    pub enum Device {}

    pub fn open() -> Result<Device, DenoiseError> {
        Err(DenoiseError::NotBuilt)
    }

    pub fn filter(
        device: &Device,
        _: (usize, usize),
        _: [&[f32]; 2],
        _: &mut [f32],
    ) -> Result<(), DenoiseError> {
        match *device {}
    }
}
