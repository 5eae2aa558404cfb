//! `caustica render --denoise`: a denoised image for viewing, in addition to the render.

use std::path::PathBuf;

use caustica::low_level::film::denoise::{DenoiseError, Denoiser, guides};
use caustica::low_level::film::file::Format;
use caustica::low_level::scene::{Aovs, Film};

use super::Failure;
use super::rendered::Made;

/// Initializes the denoiser before rendering, and adds its auxiliary layers to the film.
///
/// # Errors
/// If no denoiser is available, or no output can store its result.
pub fn begin(film: &mut Film, outputs: &[PathBuf]) -> Result<Denoiser, Failure> {
    let denoiser = Denoiser::open()?;
    let holds = |output: &PathBuf| matches!(Format::of(output), Some(Format::Png | Format::Exr));
    if !outputs.iter().any(holds) {
        return Err(Failure::wrong_use(
            "--denoise: .pfm and .hdr files store only the render",
            "add an output with the extension .png, or .exr, which stores both",
        ));
    }
    film.aovs = film.aovs.union(guides());
    Ok(denoiser)
}

/// Denoises, and removes auxiliary layers that are not in `asked`.
///
/// # Errors
/// Errors of the library. The render is unaffected.
pub fn end(denoiser: &Denoiser, made: &mut Made, asked: Aovs) -> Result<(), DenoiseError> {
    let denoised = denoiser.denoise(&made.picture, &made.layers);
    let dropped = guides().iter().filter(|aov| !asked.has(*aov));
    let dropped: Vec<_> = dropped.map(|aov| format!("{}.", aov.word())).collect();
    made.layers.retain(|channel| !dropped.iter().any(|layer| channel.name.starts_with(layer)));
    made.denoised = Some(denoised?);
    Ok(())
}
