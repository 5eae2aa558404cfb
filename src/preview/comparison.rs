//! What the picture is held against: one from a file, one kept from before, or the same scene on
//! another device.

use std::path::Path;
use std::sync::Arc;

use super::frame::Frame;
use super::view::{Scale, Shown, View, developed, show};
use super::worker::Worker;
use crate::device::Wanted;
use crate::film::{Coding, Development, FileError, Picture, read_any};
use crate::math::srgb::srgb_from_linear;

/// A picture to hold another against.
pub struct Beside {
    /// What it is, for the label.
    pub name: String,
    what: What,
}

enum What {
    File(Picture, Coding),
    Kept(Arc<Frame>),
    Device(Box<Worker>, Wanted),
}

impl Beside {
    /// Reads a picture file.
    pub fn file(path: &Path) -> Result<Self, FileError> {
        let (picture, coding) = read_any(path)?;
        let name =
            path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        Ok(Self { name, what: What::File(picture, coding) })
    }

    /// Keeps a picture as it is.
    pub fn kept(frame: Arc<Frame>) -> Self {
        let name = format!("kept, {} passes", frame.passes);
        Self { name, what: What::Kept(frame) }
    }

    /// Another device, which is to be told of wishes.
    pub fn device(name: &str, worker: Worker, wanted: Wanted) -> Self {
        Self { name: name.to_owned(), what: What::Device(Box::new(worker), wanted) }
    }

    /// The worker of another device, and which that is.
    pub fn worker(&mut self) -> Option<(&mut Worker, &Wanted)> {
        match &mut self.what {
            What::Device(worker, wanted) => Some((worker, wanted)),
            _ => None,
        }
    }

    /// Why there is nothing to see.
    pub fn failure(&self) -> Option<String> {
        match &self.what {
            What::Device(worker, _) => worker.board().failure(),
            _ => None,
        }
    }

    /// What it was made of, to tell whether there is something new.
    pub fn frame(&self) -> Option<Arc<Frame>> {
        match &self.what {
            What::File(..) => None,
            What::Kept(frame) => Some(frame.clone()),
            What::Device(worker, _) => worker.frame(),
        }
    }

    /// What there is to see of it, by the scale of the picture that it is held against. A file has
    /// radiance, or display values that are shown as they are, and nothing else.
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
