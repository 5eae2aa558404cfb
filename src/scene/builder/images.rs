//! Images that parts of a scene name, with the findings about them.

use std::path::Path;

use super::SceneBuilder;
use crate::scene::diagnostics::nearest_file;
use crate::scene::images::{Channel, ColorSpace, ImageFault};
use crate::scene::limits::Missing;
use crate::scene::parts::Part;

impl SceneBuilder<'_> {
    /// Loads the image that a part names under `file`; returns its index.
    pub fn image(
        &mut self,
        part: &dyn Part,
        file: &str,
        color_space: Option<ColorSpace>,
    ) -> Option<usize> {
        let path = self.resolve(file);
        match self.images.load(&path, color_space, None) {
            Ok(image) => {
                self.warn_of_image(part, file, image);
                Some(image)
            }
            Err(fault) => {
                self.image_error(part, &path, fault, "");
                None
            }
        }
    }

    /// Like [`Self::image`], for reflectances and amounts, or for one channel: no texel may exceed
    /// 1. A gray image may replace a file that does not exist.
    pub fn reflectance_image(
        &mut self,
        part: &dyn Part,
        file: &str,
        color_space: Option<ColorSpace>,
        channel: Option<Channel>,
    ) -> Option<usize> {
        let path = self.resolve(file);
        let loaded = self.images.load(&path, color_space, channel).and_then(|image| {
            self.images.bound_by_one(&path, image)?;
            Ok(image)
        });
        match loaded {
            Ok(image) => {
                self.warn_of_image(part, file, image);
                Some(image)
            }
            Err(fault) if fault.missing && self.allowance.missing == Missing::Warn => {
                self.report.warn(part.span_of(fault.key), fault.message, "rendered in gray");
                Some(self.images.stand_in(&path))
            }
            Err(fault) => {
                let advice = if fault.missing { Missing::ADVICE } else { "" };
                self.image_error(part, &path, fault, advice);
                None
            }
        }
    }

    /// Warns about image data that is clamped or ignored.
    fn warn_of_image(&mut self, part: &dyn Part, file: &str, image: usize) {
        let at = part.span_of("file");
        if self.images.is_transparent(image) {
            let message = format!("the alpha channel of {file} is not used");
            self.report.warn(at.clone(), message, "every texel counts as opaque");
        }
        for (message, label) in self.images.take_notes(image) {
            self.report.warn(at.clone(), message, label);
        }
    }

    fn image_error(&mut self, part: &dyn Part, path: &Path, fault: ImageFault, advice: &str) {
        let near = (fault.missing && !self.report.errors.is_full()).then(|| nearest_file(path));
        let help =
            fault.help.or_else(|| near.flatten().map(|near| format!("did you mean {near}?")));
        let help = match (help, advice) {
            (help, "") => help,
            (Some(help), advice) => Some(format!("{help} {advice}")),
            (None, advice) => Some(format!("name a file that exists, {advice}")),
        };
        self.report.error(part.span_of(fault.key), fault.message, fault.expected, help);
    }
}
