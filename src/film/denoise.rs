//! Denoising with [Open Image Denoise](https://www.openimagedenoise.org) 2, a C library that is
//! linked only with the cargo feature `denoise`. The result is for viewing: it has an unknown bias
//! that no error estimate covers.
//!
//! The filter `RT` takes HDR radiance, with the layers `albedo` and `normal` as auxiliary images,
//! which may be noisy.

use thiserror::Error;

use super::exr_file::Channel;
use super::{Picture, Plane};
use crate::scene::{Aov, Aovs};

/// Name of the denoiser as written to files. The Rust bindings do not expose the minor version.
pub const NAME: &str = "Open Image Denoise 2";

/// Reason why an image could not be denoised.
#[derive(Debug, Error)]
pub enum DenoiseError {
    /// The feature is not compiled in.
    #[error("this build of caustica has no denoiser")]
    NotBuilt,
    /// An auxiliary layer is missing.
    #[error("the denoiser needs the layer {0}, which is missing")]
    NoLayer(&'static str),
    /// The library reported an error.
    #[error("{NAME}: {what}")]
    Library {
        /// The library's error message.
        what: String,
    },
}

/// The auxiliary layers that the denoiser needs.
pub fn guides() -> Aovs {
    [Aov::Albedo, Aov::Normal].into_iter().collect()
}

/// An initialized CPU device of the library.
pub struct Denoiser(backend::Device);

impl Denoiser {
    /// Initializes the library on the CPU.
    ///
    /// # Errors
    /// If the feature is not compiled in, or the library does not support this CPU.
    pub fn open() -> Result<Self, DenoiseError> {
        backend::open().map(Self)
    }

    /// Denoises the image and keeps its unit. `layers` must contain [`guides`] for the same pixels.
    ///
    /// # Errors
    /// If a layer is missing or has a different size, or the library fails.
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

/// The channels of the EXR layer `denoised`.
pub fn layer(denoised: &Picture) -> [Channel; 3] {
    let plane = |c: usize| Plane::of(denoised, |rgb| f64::from(rgb[c]));
    [("denoised.R", 0), ("denoised.G", 1), ("denoised.B", 2)]
        .map(|(name, c)| Channel::float(name, plane(c)))
}

/// Interleaves three channels.
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

    /// Opens the CPU device, never a GPU, so that results do not depend on the machine.
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

    /// Uninhabited: there is no device without the feature.
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
