//! Comparison images: an image from a file, a kept image, or the same scene on another device.

use std::path::Path;
use std::sync::Arc;

use super::frame::Frame;
use super::view::{Scale, Shown, View, developed, show};
use super::worker::Worker;
use crate::device::Wanted;
use crate::film::{Coding, Development, FileError, Picture, read_any};
use crate::math::srgb::srgb_from_linear;

/// An image that the window compares with the current one.
pub struct Comparison {
    /// Label in the window.
    pub name: String,
    what: What,
}

enum What {
    File(Picture, Coding),
    Kept(Arc<Frame>),
    Device(Box<Worker>, Wanted),
}

impl Comparison {
    /// Reads an image file.
    pub fn file(path: &Path) -> Result<Self, FileError> {
        let (picture, coding) = read_any(path)?;
        let name =
            path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        Ok(Self { name, what: What::File(picture, coding) })
    }

    /// Keeps the current image.
    pub fn kept(frame: Arc<Frame>) -> Self {
        let name = format!("kept, {} passes", frame.passes);
        Self { name, what: What::Kept(frame) }
    }

    /// Compares with another device, whose worker receives the same render requests.
    pub fn device(name: &str, worker: Worker, wanted: Wanted) -> Self {
        Self { name: name.to_owned(), what: What::Device(Box::new(worker), wanted) }
    }

    /// The worker of another device, and the device that it uses.
    pub fn worker(&mut self) -> Option<(&mut Worker, &Wanted)> {
        match &mut self.what {
            What::Device(worker, wanted) => Some((worker, wanted)),
            _ => None,
        }
    }

    /// Reason why there is no image, if rendering failed.
    pub fn failure(&self) -> Option<String> {
        match &self.what {
            What::Device(worker, _) => worker.slot().failure(),
            _ => None,
        }
    }

    /// The frame that it shows; `None` for a file. A different frame means that there is a new
    /// image.
    pub fn frame(&self) -> Option<Arc<Frame>> {
        match &self.what {
            What::File(..) => None,
            What::Kept(frame) => Some(frame.clone()),
            What::Device(worker, _) => worker.frame(),
        }
    }

    /// Converts it for display, in the color scale of the current image. A file contains only
    /// radiance, or display values that are shown unchanged, so it has no other views.
    pub fn show(
        &self,
        view: View,
        development: &Development,
        scale: Option<Scale>,
    ) -> Option<Shown> {
        let (picture, coding) = match &self.what {
            What::File(picture, coding) => (picture, coding),
            _ => return show(&*self.frame()?, view, development, scale),
        };
        let coded = |x: f32| (255.0 * srgb_from_linear(f64::from(x))).round() as u8;
        let rgb = match coding {
            Coding::Radiance => developed(picture, development),
            Coding::Display => picture.rgb.iter().map(|rgb| rgb.map(coded)).collect(),
        };
        let Picture { width, height, .. } = *picture;
        (view == View::Picture).then_some(Shown { width, height, rgb, scale: None })
    }
}
