//! Compatibility of a checkpoint with a render or another checkpoint, and their differences.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::Value;

use super::{Checkpoint, CheckpointError, Origin};
use crate::scene::Aovs;
use crate::scene::settings::RenderSettings;

impl Checkpoint {
    /// Checks that a render of `expected` at a precision of `bits` bits with the passes
    /// `first_pass..end` gives bit-identical results if resumed from this checkpoint. The device
    /// and the planned number of passes may differ.
    ///
    /// # Errors
    /// A list of all differences.
    pub fn check_resumes(
        &self,
        file: &Path,
        expected: &Origin,
        bits: u32,
        first_pass: u32,
        end: u32,
    ) -> Result<(), CheckpointError> {
        let mut differences = expected.differences(&self.origin);
        let [asked, known] = [expected.aovs, self.origin.aovs];
        if asked.iter().any(|aov| !known.has(aov)) {
            differences.push(format!(
                "layers: expected {}, found {}",
                layer_names(asked),
                layer_names(known)
            ));
        }
        if first_pass != self.state.first_pass {
            let found = self.state.first_pass;
            differences.push(format!("first pass: expected {first_pass}, found {found}"));
        }
        if bits != self.state.bits && self.cuts.is_empty() {
            let found = self.state.bits;
            differences.push(format!("precision: expected {bits} bits, found {found}"));
        }
        if !differences.is_empty() {
            return Err(CheckpointError::Other {
                file: file.to_owned(),
                differences,
                mend: "\"expected\" is this render, \"found\" is the checkpoint: restore the \
                       setting, or drop --resume"
                    .to_owned(),
            });
        }
        let unfit = |what: String, mend: String| CheckpointError::Unfit {
            file: file.to_owned(),
            what,
            mend,
        };
        let (first, end_found) = (self.state.first_pass, self.end());
        if !self.cuts.is_empty() {
            return Err(unfit(
                "a merged checkpoint cannot be resumed, since its sums are rounded in a \
                 different order"
                    .to_owned(),
                format!("render the passes from {end_found} on separately, and merge both"),
            ));
        }
        if end_found > end {
            return Err(unfit(
                format!(
                    "contains passes {first}..{end_found}, but this render ends before pass {end}"
                ),
                format!("use --passes {end_found} or more"),
            ));
        }
        Ok(())
    }
}

impl Origin {
    /// Differences that change the rendered bits. Ignores the planned number of passes, the device
    /// and tone mapping.
    pub fn differences(&self, found: &Self) -> Vec<String> {
        let mut list = Vec::new();
        if self.version != found.version {
            list.push(format!(
                "caustica version: expected {}, found {}",
                self.version, found.version
            ));
        }
        let size = |origin: &Self| format!("{} x {}", origin.width, origin.height);
        if size(self) != size(found) {
            list.push(format!("image size: expected {}, found {}", size(self), size(found)));
        }
        let window = |origin: &Self| match origin.window {
            Some([x0, y0, x1, y1]) => format!("{x0},{y0},{x1},{y1}"),
            None => "the whole image".to_owned(),
        };
        if window(self) != window(found) {
            list.push(format!("crop: expected {}, found {}", window(self), window(found)));
        }
        if self.identity != found.identity {
            list.push(format!(
                "scene ({}): {}",
                self.identity.differences(&found.identity).join(", "),
                where_texts_differ(&self.scene_text, &found.scene_text)
            ));
        }
        if self.identity == found.identity && self.space != found.space {
            list.push(format!(
                "unit and position of the scene: expected {:?}, found {:?}",
                self.space, found.space
            ));
        }
        list.extend(setting_differences(&self.settings, &found.settings));
        list
    }
}

/// Names of layers for messages.
pub(super) fn layer_names(aovs: Aovs) -> String {
    if aovs.is_empty() { "none".to_owned() } else { aovs.to_string() }
}

/// Describes the first line in which two scene files differ.
fn where_texts_differ(expected: &str, found: &str) -> String {
    let lines = expected.lines().count().max(found.lines().count());
    let line = |text: &str, at: usize| {
        text.lines().nth(at).map_or("end of file".to_owned(), |line| format!("`{line}`"))
    };
    match (0..lines).find(|at| line(expected, *at) != line(found, *at)) {
        Some(at) => {
            let [expected, found] = [line(expected, at), line(found, at)];
            format!("in line {} of the scene file expected {expected}, found {found}", at + 1)
        }
        None => "the scene file is the same, but a mesh, image or profile that it uses differs"
            .to_owned(),
    }
}

/// Differences of all settings except the number of passes, in the spelling of scene files.
fn setting_differences(expected: &RenderSettings, found: &RenderSettings) -> Vec<String> {
    let [expected, found] = [expected, found].map(|settings| serde_json::json!(settings));
    let names = |settings: &Value| {
        settings.as_object().into_iter().flatten().map(|(name, _)| name.clone()).collect()
    };
    let names: BTreeSet<String> =
        BTreeSet::union(&names(&expected), &names(&found)).cloned().collect();
    let other = names.into_iter().filter(|name| name != "passes" && expected[name] != found[name]);
    other
        .map(|name| format!("`{name}`: expected {}, found {}", expected[&name], found[&name]))
        .collect()
}

/// Theory: a difference is reported for each field that affects the rendered bits, and for no
/// other.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::settings::{Method, Radius};

    #[test]
    fn each_setting_is_told_but_passes() {
        let settings = RenderSettings::default();
        let differences = |change: fn(&mut RenderSettings)| {
            let mut other = settings.clone();
            change(&mut other);
            setting_differences(&settings, &other)
        };
        assert_eq!(differences(|s| s.passes = 7), Vec::<String>::new());
        assert_eq!(differences(|s| s.seed = 7), ["`seed`: expected 0, found 7"]);
        assert_eq!(
            differences(|s| s.method = Method::Ppm),
            ["`method`: expected \"sppm\", found \"ppm\""]
        );
        assert_eq!(
            differences(|s| s.indirect_radius = Some(2.0)),
            ["`indirect_radius`: expected null, found 2.0"]
        );
        assert_eq!(
            differences(|s| (s.radius, s.alpha) = (Radius::Pixels(2.0), 0.5)),
            [
                "`alpha`: expected 0.6666666666666666, found 0.5",
                "`radius`: expected \"auto\", found {\"pixels\":2.0}"
            ]
        );
    }

    #[test]
    fn the_first_other_line_is_told() {
        assert_eq!(
            where_texts_differ("a\nb\nc", "a\nx\ny"),
            "in line 2 of the scene file expected `b`, found `x`"
        );
        assert_eq!(
            where_texts_differ("a\nb", "a"),
            "in line 2 of the scene file expected `b`, found end of file"
        );
        assert!(where_texts_differ("a", "a").contains("mesh"));
    }
}
