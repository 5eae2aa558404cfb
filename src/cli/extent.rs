//! Options for the crop window, layers and bit depth of images.

use std::path::PathBuf;

use caustica::low_level::film::file::Format;
use caustica::low_level::film::tonemap::Bits;
use caustica::low_level::scene::{Aovs, Film};
use clap::Args;

use super::Failure;

/// Options for the content of image files.
#[derive(Args, Debug)]
pub struct Extent {
    /// Layers of .exr files in addition to radiance, comma-separated, or all
    #[arg(long, value_name = "NAME,...", value_parser = Aovs::parse)]
    pub aov: Option<Aovs>,
    /// Render only columns x0 to x1 and rows y0 to y1 from the top left, x1 and y1 excluded
    #[arg(long, value_name = "x0,y0,x1,y1", value_parser = window, allow_hyphen_values = true)]
    pub crop: Option<[u32; 4]>,
    /// Bits per channel of .png files
    #[arg(long, value_name = "8|16", value_parser = bits, default_value = "8")]
    pub bits: Bits,
}

impl Extent {
    /// Applies the options to a film of final size. Layers that no output can store are dropped;
    /// this is an error if the options request them.
    pub fn apply(&self, film: &mut Film, outputs: &[PathBuf]) -> Result<(), Failure> {
        film.aovs = self.aov.unwrap_or(film.aovs);
        if !outputs.iter().any(|output| Format::of(output) == Some(Format::Exr)) {
            if self.aov.is_some() {
                let help = "add an output with the extension .exr, e.g. -o picture.exr";
                return Err(Failure::wrong_use("--aov: no output can store layers", help));
            }
            film.aovs = Aovs::default();
        }
        film.window = self.crop.or(film.window);
        match film.window {
            Some([_, _, x1, y1]) if x1 > film.width || y1 > film.height => Err(Failure::wrong_use(
                &format!("--crop: columns up to {x1} and rows up to {y1} extend beyond the image"),
                &format!(
                    "the image has {} columns and {} rows, counted from 0",
                    film.width, film.height
                ),
            )),
            _ => Ok(()),
        }
    }
}

fn bits(text: &str) -> Result<Bits, String> {
    match text {
        "8" => Ok(Bits::Eight),
        "16" => Ok(Bits::Sixteen),
        _ => Err("expected 8 or 16".to_owned()),
    }
}

/// Parses a window such as `100,40,180,120`.
pub fn window(text: &str) -> Result<[u32; 4], String> {
    let numbers: Option<Vec<u32>> =
        text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok([x0, y0, x1, y1]),
        _ => {
            Err("expected four whole numbers with x0 < x1 and y0 < y1, e.g. 100,40,180,120"
                .to_owned())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_have_four_numbers_in_order() {
        assert_eq!(window("1, 2,3,4"), Ok([1, 2, 3, 4]));
        for bad in [
            "",
            "1,2,3",
            "1,2,3,4,5",
            "3,2,1,4",
            "1,2,3,2",
            "1,2,1,4",
            "-1,0,2,2",
            "0,0,1.5,2",
            "a,b,c,d",
        ] {
            assert!(window(bad).is_err(), "{bad}");
        }
    }
}
