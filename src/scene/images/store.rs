//! Images read so far, with the warnings about them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::fault::{ImageFault, fault};
use super::texel_range::{Clamped, clamp};
use super::{Channel, ColorSpace};
use crate::scene::appearance::{ImageData, Texels};
use crate::scene::limits::{Allowance, Missing};

/// A warning about an image, and the interpretation of the affected values.
pub(crate) type Note = (String, &'static str);

/// Images read so far, one for each (file, color space, channel).
#[derive(Debug, Default)]
pub(crate) struct ImageStore {
    pub images: Vec<ImageData>,
    /// Every file requested.
    pub files: Vec<PathBuf>,
    known: BTreeMap<(PathBuf, Option<ColorSpace>, Option<Channel>), usize>,
    transparent: BTreeSet<usize>,
    /// Texels clamped into their range, by image.
    moved: BTreeMap<usize, Clamped>,
    /// Warnings about ignored channels, by image.
    unread: BTreeMap<usize, String>,
    stand_ins: BTreeMap<PathBuf, usize>,
    pub(super) allowance: Allowance,
    /// Bytes of texels of all images, including those that could not be used.
    pub(super) spent: u64,
}

impl ImageStore {
    pub fn new(allowance: &Allowance) -> Self {
        Self { allowance: allowance.clone(), ..Self::default() }
    }

    /// Index of the image in a file, or of one of its channels as gray values; reads the file on
    /// first use.
    pub fn load(
        &mut self,
        path: &Path,
        space: Option<ColorSpace>,
        channel: Option<Channel>,
    ) -> Result<usize, ImageFault> {
        let canonical = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let key = (canonical, space, channel);
        if let Some(&index) = self.known.get(&key) {
            return Ok(index);
        }
        self.files.push(path.to_owned());
        let (mut image, transparent, unread) = self.read(path, space)?;
        if let Some(channel) = channel {
            select(&mut image.texels, channel).map_err(|why| ImageFault {
                key: "channel",
                expected: "expected a channel that the file has",
                ..fault(path, why)
            })?;
        }
        let index = self.images.len();
        let mut moved = Clamped::default();
        clamp(&mut image, f32::MAX, &mut moved).map_err(|bad| fault(path, bad))?;
        self.moved.insert(index, moved);
        if !unread.is_empty() {
            let message = format!("the channels {} are not used", unread.join(", "));
            self.unread.insert(index, message);
        }
        self.images.push(image);
        self.known.insert(key, index);
        if transparent && channel != Some(Channel::Alpha) {
            self.transparent.insert(index);
        }
        Ok(index)
    }

    /// Clamps texels that exceed 1 by a rounding error.
    ///
    /// # Errors
    /// A texel that exceeds 1 by more.
    pub fn bound_by_one(&mut self, path: &Path, index: usize) -> Result<(), ImageFault> {
        let moved = self.moved.entry(index).or_default();
        clamp(&mut self.images[index], 1.0, moved).map_err(|bad| fault(path, bad))
    }

    /// Warnings about an image that is not used as it is; returns each once.
    pub fn take_notes(&mut self, index: usize) -> Vec<Note> {
        let moved = self.moved.remove(&index).and_then(|moved| moved.message());
        let moved = moved.map(|message| (message, "read as the limit"));
        let unread = self.unread.remove(&index).map(|message| (message, "read in gray"));
        let notes = moved.into_iter().chain(unread);
        notes
            .map(|(message, label)| (format!("{}: {message}", self.images[index].path), label))
            .collect()
    }

    /// An image of one gray texel that replaces a file that does not exist.
    pub fn stand_in(&mut self, path: &Path) -> usize {
        let images = &mut self.images;
        *self.stand_ins.entry(path.to_owned()).or_insert_with(|| {
            let texels = Texels::Float(vec![[Missing::STAND_IN as f32; 3]]);
            images.push(ImageData {
                path: path.display().to_string(),
                width: 1,
                height: 1,
                texels,
            });
            images.len() - 1
        })
    }

    /// Returns whether an image has alpha below 1 anywhere.
    pub fn is_transparent(&self, index: usize) -> bool {
        self.transparent.contains(&index)
    }
}

/// Replaces all channels by one of them.
fn select(texels: &mut Texels, channel: Channel) -> Result<(), &'static str> {
    match texels {
        Texels::Rgba8 { srgb, data } => {
            *srgb &= channel != Channel::Alpha;
            for texel in data {
                let value = texel[channel as usize];
                *texel = [value, value, value, u8::MAX];
            }
        }
        Texels::Float(data) => {
            if channel == Channel::Alpha {
                return Err("its alpha channel has more than 8 bits, or is missing");
            }
            for texel in data {
                *texel = [texel[channel as usize]; 3];
            }
        }
    }
    Ok(())
}
