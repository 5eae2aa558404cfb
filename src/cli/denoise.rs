//! `caustica render --denoise`: a picture to look at beside the one that is measured.

use std::path::PathBuf;

use caustica::low_level::film::denoise::{DenoiseError, Denoiser, guides};
use caustica::low_level::film::file::Format;
use caustica::low_level::scene::{Aovs, Film};

use super::Failure;
use super::rendered::Made;

/// Prepares the denoiser before the work, and adds the layers that it needs to the film's.
///
/// # Errors
/// Where there is none, or no output would hold what it makes.
pub fn begin(film: &mut Film, outputs: &[PathBuf]) -> Result<Denoiser, Failure> {
    let denoiser = Denoiser::open()?;
    let holds = |output: &PathBuf| matches!(Format::of(output), Some(Format::Png | Format::Exr));
    if !outputs.iter().any(holds) {
        return Err(Failure::wrong_use(
            "--denoise: .pfm and .hdr files hold the render alone",
            "add an output with the extension .png, or .exr, which holds both",
        ));
    }
    film.aovs = film.aovs.union(guides());
    Ok(denoiser)
}

/// Denoises, and drops the layers that nobody but the denoiser has `asked` for.
///
/// # Errors
/// Those of the library; what was made is as it was.
pub fn end(denoiser: &Denoiser, made: &mut Made, asked: Aovs) -> Result<(), DenoiseError> {
    let denoised = denoiser.denoise(&made.picture, &made.layers);
    let dropped = guides().iter().filter(|aov| !asked.has(*aov));
    let dropped: Vec<_> = dropped.map(|aov| format!("{}.", aov.word())).collect();
    made.layers.retain(|channel| !dropped.iter().any(|layer| channel.name.starts_with(layer)));
    made.denoised = Some(denoised?);
    Ok(())
}
