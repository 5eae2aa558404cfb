//! Reference images as means over blocks of pixels, and their files.

use std::io::Cursor;
use std::path::Path;

use exr::prelude::*;

use crate::film::file::{read_exr, write_whole};
use crate::film::{FileError, Picture};

/// Edge of the blocks of [`BlockTruth::from_picture`], in pixels of the reference image.
pub const BLOCK: u32 = 8;

/// Values per block and channel, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Blocks {
    /// Blocks per row.
    pub width: u32,
    /// Rows of blocks.
    pub height: u32,
    /// `width * height` blocks, row by row.
    pub rgb: Vec<[f64; 3]>,
}

impl Blocks {
    /// Averages `picture` over `width * height` equal square blocks. Returns `None` if they do not
    /// tile the image. Box-filtered images of any such size give the same blocks except for noise.
    pub fn of(picture: &Picture, width: u32, height: u32) -> Option<Self> {
        let edge = picture.width / width.max(1);
        if edge == 0 || (picture.width, picture.height) != (width * edge, height * edge) {
            return None;
        }
        let pixels = f64::from(edge * edge);
        Some(Self::from_fn(width, height, |x, y| {
            let mut sum = [0.0; 3];
            for i in 0..edge * edge {
                let (column, row) = (x * edge + i % edge, y * edge + i / edge);
                let rgb = picture.rgb[row as usize * picture.width as usize + column as usize];
                (0..3).for_each(|c| sum[c] += f64::from(rgb[c]));
            }
            sum.map(|value| value / pixels)
        }))
    }

    /// Creates blocks whose value in column `x` and row `y` is `value(x, y)`.
    pub fn from_fn(width: u32, height: u32, mut value: impl FnMut(u32, u32) -> [f64; 3]) -> Self {
        let rgb = (0..width * height).map(|i| value(i % width, i / width)).collect();
        Self { width, height, rgb }
    }

    /// Averages squares of `edge * edge` blocks, fewer at the right and bottom borders.
    pub fn coarser(&self, edge: u32) -> Self {
        let size = |blocks: u32| blocks.div_ceil(edge);
        Self::from_fn(size(self.width), size(self.height), |x, y| {
            let (mut sum, mut count) = ([0.0; 3], 0.0);
            for row in y * edge..((y + 1) * edge).min(self.height) {
                for column in x * edge..((x + 1) * edge).min(self.width) {
                    let rgb = self.rgb[(row * self.width + column) as usize];
                    (0..3).for_each(|c| sum[c] += rgb[c]);
                    count += 1.0;
                }
            }
            sum.map(|value| value / count)
        })
    }

    /// Mean over the blocks.
    pub fn mean(&self) -> [f64; 3] {
        [0, 1, 2].map(|c| self.rgb.iter().map(|rgb| rgb[c]).sum::<f64>() / self.rgb.len() as f64)
    }

    /// Image with one pixel per block.
    pub fn picture(&self) -> Picture {
        let rgb = self.rgb.iter().map(|rgb| rgb.map(|value| value as f32)).collect();
        Picture { width: self.width, height: self.height, rgb }
    }

    fn read(picture: Picture) -> Self {
        let rgb = picture.rgb.iter().map(|rgb| rgb.map(f64::from)).collect();
        Self { width: picture.width, height: picture.height, rgb }
    }
}

/// Block means of a reference image and their standard errors.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockTruth {
    /// Mean radiance.
    pub mean: Blocks,
    /// Standard error of each mean; errors of different blocks are independent.
    pub standard_error: Blocks,
}

/// Source of the standard errors of an image.
#[derive(Clone, Debug)]
pub enum PixelNoise {
    /// Image of standard errors.
    Known(Picture),
    /// relMSE `e` of the whole image: a pixel of value `v` is assumed to have the variance
    /// `e (v^2 + 0.01)`.
    RelMse(f64),
}

impl BlockTruth {
    /// Averages an image with independent pixel errors over blocks of [`BLOCK`] x [`BLOCK`] pixels.
    /// Returns `None` if the blocks do not tile the image.
    pub fn from_picture(picture: &Picture, noise: &PixelNoise) -> Option<Self> {
        let (width, height) = (picture.width / BLOCK, picture.height / BLOCK);
        let mean = Blocks::of(picture, width, height)?;
        let variance = |index: usize| match noise {
            PixelNoise::Known(errors) => errors.rgb[index].map(|e| e * e),
            PixelNoise::RelMse(e) => {
                picture.rgb[index].map(|v| (e * (f64::from(v * v) + 0.01)) as f32)
            }
        };
        if matches!(noise, PixelNoise::Known(e) if (e.width, e.height) != (picture.width, picture.height))
        {
            return None;
        }
        let rgb = (0..picture.rgb.len()).map(variance).collect();
        let variances = Blocks::of(&Picture { rgb, ..*picture }, width, height)?;
        let error = |variance: f64| (variance / f64::from(BLOCK * BLOCK)).sqrt();
        let standard_error =
            Blocks { rgb: variances.rgb.iter().map(|v| v.map(error)).collect(), ..variances };
        Some(Self { mean, standard_error })
    }

    /// Reference of squares of `edge * edge` blocks.
    pub fn coarser(&self, edge: u32) -> Self {
        let map = |blocks: &Blocks, f: &dyn Fn(f64) -> f64| Blocks {
            rgb: blocks.rgb.iter().map(|rgb| rgb.map(f)).collect(),
            ..*blocks
        };
        let variance = map(&self.standard_error, &|e| e * e).coarser(edge);
        // variance of the mean of n blocks: mean variance divided by n
        let count = Blocks::from_fn(variance.width, variance.height, |x, y| {
            let side = |at: u32, blocks: u32| f64::from(((at + 1) * edge).min(blocks) - at * edge);
            [side(x, self.mean.width) * side(y, self.mean.height); 3]
        });
        let error = |(v, n): (&[f64; 3], &[f64; 3])| [0, 1, 2].map(|c| (v[c] / n[c]).sqrt());
        let rgb = variance.rgb.iter().zip(&count.rgb).map(error).collect();
        Self { mean: self.mean.coarser(edge), standard_error: Blocks { rgb, ..variance } }
    }

    /// Standard error of the mean over the whole image.
    pub fn mean_error(&self) -> [f64; 3] {
        let errors = &self.standard_error.rgb;
        [0, 1, 2]
            .map(|c| errors.iter().map(|e| e[c] * e[c]).sum::<f64>().sqrt() / errors.len() as f64)
    }

    /// Reads a file written by [`BlockTruth::write`].
    ///
    /// # Errors
    /// If the file cannot be read or a channel is missing.
    pub fn read(file: &Path) -> std::result::Result<Self, FileError> {
        let exr = read_exr(file)?;
        let blocks = |prefix: &str| {
            exr.picture(prefix).map(Blocks::read).ok_or_else(|| FileError::Malformed {
                file: file.to_owned(),
                what: format!("channels {prefix}R, {prefix}G and {prefix}B are missing"),
            })
        };
        Ok(Self { mean: blocks("")?, standard_error: blocks("SE.")? })
    }

    /// Writes an EXR file with one pixel per block: means as R, G, B and standard errors as SE.R,
    /// SE.G, SE.B.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, file: &Path) -> std::result::Result<(), FileError> {
        let channel = |prefix: &str, c: usize, blocks: &Blocks| {
            let values = blocks.rgb.iter().map(|rgb| rgb[c] as f32).collect();
            AnyChannel::new(
                Text::from(format!("{prefix}{}", ["R", "G", "B"][c]).as_str()),
                FlatSamples::F32(values),
            )
        };
        let channels = [("", &self.mean), ("SE.", &self.standard_error)]
            .into_iter()
            .flat_map(|(prefix, blocks)| [0, 1, 2].map(|c| channel(prefix, c, blocks)));
        let layer = Layer::new(
            (self.mean.width as usize, self.mean.height as usize),
            LayerAttributes::default(),
            Encoding::SMALL_LOSSLESS,
            AnyChannels::sort(channels.collect()),
        );
        let mut bytes = Vec::new();
        Image::from_layer(layer)
            .write()
            .non_parallel()
            .to_buffered(Cursor::new(&mut bytes))
            .map_err(|error| FileError::Encode {
                file: file.to_owned(),
                what: error.to_string(),
            })?;
        write_whole(file, &bytes)
    }
}
