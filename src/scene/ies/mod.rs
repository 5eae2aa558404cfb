//! IES files (ANSI/IES LM-63-1986 to 2019) of photometric type C, and their conversion to images of
//! radiant intensity.

mod parse;
mod table;

use glam::DQuat;

use super::appearance::{ImageData, Texels};
use super::builder::SceneBuilder;
use super::diagnostics::nearest_file;
use super::parts::Part;
use parse::parse;

/// Luminous efficacy in lm/W by which candela become W/sr: that of monochromatic light at 555 nm,
/// so that the luminance of an image, times 683, is in candela per square metre.
pub const LUMENS_PER_WATT: f64 = 683.0;

impl SceneBuilder<'_> {
    /// Reads the IES file that a part names under `file`, and adds the image of its intensity in
    /// W/sr; `turn` turns the luminaire, whose nadir is -y and whose horizontal angle 0 is +x.
    /// Returns the index of the image.
    pub(crate) fn ies(&mut self, part: &dyn Part, file: &str, turn: DQuat) -> Option<usize> {
        let path = self.resolve(file);
        let shown = path.display();
        self.images.files.push(path.clone());
        let bytes = match self.allowance.read(&path, ("scene-bytes", self.allowance.scene_bytes)) {
            Ok(bytes) => bytes,
            Err(refusal) => {
                let near = nearest_file(&path).map(|near| format!("did you mean {near}?"));
                let message = format!("cannot read {shown}: {refusal}");
                let help = refusal.help().or(near);
                self.report.error(part.span_of("file"), message, "expected an IES file", help);
                return None;
            }
        };
        match parse(&String::from_utf8_lossy(&bytes)) {
            Ok(table) => {
                let (width, height) = (table::WIDTH, table::HEIGHT);
                let texels = Texels::Float(table.image(turn));
                let path = path.display().to_string();
                self.images.images.push(ImageData { path, width, height, texels });
                Some(self.images.images.len() - 1)
            }
            Err(fault) => {
                let message = format!("{shown}:{}: {}", fault.line, fault.message);
                let help = Some("export the luminaire as LM-63 of photometric type C".to_owned());
                self.report.error(part.span_of("file"), message, fault.expected, help);
                None
            }
        }
    }
}
