//! Images: file formats, tone mapping, metrics, layers and denoising.

#[path = "../support/mod.rs"]
mod support;

mod aovs;
#[cfg(feature = "denoise")]
mod denoise;
mod difference;
mod files;
mod metrics;
mod tonemap;
