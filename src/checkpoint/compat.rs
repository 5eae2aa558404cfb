//! Whether a checkpoint is of the render at hand, or of the same as another one; if not, what
//! differs.

use std::collections::BTreeSet;
use std::path::Path;

use serde_json::Value;

use super::{Checkpoint, CheckpointError, Origin};
use crate::scene::Aovs;
use crate::scene::settings::RenderSettings;

impl Checkpoint {
    /// Fails unless a render of `expected`, whose numbers have `bits` bits and whose passes are
    /// numbered from `first_pass` and end before `end`, ends in the same bits from here as from its
    /// start. The device does not count, nor does where it was to end.
    ///
    /// # Errors
    /// Everything that differs.
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
                "the layers: expected {}, found {}",
                told(asked),
                told(known)
            ));
        }
        if first_pass != self.state.first_pass {
            let found = self.state.first_pass;
            differences
                .push(format!("the first pass: expected pass {first_pass}, found pass {found}"));
        }
        if bits != self.state.bits && self.cuts.is_empty() {
            let found = self.state.bits;
            differences.push(format!("the device's numbers: expected {bits} bits, found {found}"));
        }
        if !differences.is_empty() {
            return Err(CheckpointError::Other {
                file: file.to_owned(),
                differences,
                mend: "expected is what this render asks for, found what the checkpoint is of: change the one back, or leave out \
                       --resume"
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
                "it is merged, and no render rounds its sums in the same order".to_owned(),
                format!("render passes from {end_found} on by themselves, and merge both"),
            ));
        }
        if end_found > end {
            return Err(unfit(
                format!("it holds passes {first}..{end_found}, this render ends before pass {end}"),
                format!("ask for --passes {end_found} or more"),
            ));
        }
        Ok(())
    }
}

impl Origin {
    /// What makes other bits than `self` would make. Where a render was to end, its device and how
    /// it is tone-mapped do not.
    pub fn differences(&self, found: &Self) -> Vec<String> {
        let mut list = Vec::new();
        if self.version != found.version {
            list.push(format!(
                "caustica's version: expected {}, found {}",
                self.version, found.version
            ));
        }
        let size = |origin: &Self| format!("{} x {}", origin.width, origin.height);
        if size(self) != size(found) {
            list.push(format!(
                "the picture's size: expected {}, found {}",
                size(self),
                size(found)
            ));
        }
        let window = |origin: &Self| match origin.window {
            Some([x0, y0, x1, y1]) => format!("{x0},{y0},{x1},{y1}"),
            None => "the whole picture".to_owned(),
        };
        if window(self) != window(found) {
            list.push(format!("the crop: expected {}, found {}", window(self), window(found)));
        }
        if self.identity != found.identity {
            list.push(format!(
                "the scene ({}): {}",
                self.identity.differences(&found.identity).join(", "),
                where_texts_differ(&self.scene_text, &found.scene_text)
            ));
        }
        if self.identity == found.identity && self.space != found.space {
            list.push(format!(
                "its unit and place: expected {:?}, found {:?}",
                self.space, found.space
            ));
        }
        list.extend(setting_differences(&self.settings, &found.settings));
        list
    }
}

/// The names of layers.
pub(super) fn told(aovs: Aovs) -> String {
    if aovs.is_empty() { "none".to_owned() } else { aovs.to_string() }
}

/// The first line in which two scene files differ.
fn where_texts_differ(expected: &str, found: &str) -> String {
    let lines = expected.lines().count().max(found.lines().count());
    let line = |text: &str, at: usize| {
        text.lines().nth(at).map_or("its end".to_owned(), |line| format!("`{line}`"))
    };
    match (0..lines).find(|at| line(expected, *at) != line(found, *at)) {
        Some(at) => {
            let [expected, found] = [line(expected, at), line(found, at)];
            format!("in line {} of its file expected {expected}, found {found}", at + 1)
        }
        None => "its file is the same, but not a mesh, picture or profile that it names".to_owned(),
    }
}

/// All settings but the number of passes, as scene files spell them.
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

/// Theory: every field that decides bits is told, and no other.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::settings::{Method, Radius};

    #[test]
    fn each_setting_is_told_but_passes() {
        let settings = RenderSettings::default();
        let told = |change: fn(&mut RenderSettings)| {
            let mut other = settings.clone();
            change(&mut other);
            setting_differences(&settings, &other)
        };
        assert_eq!(told(|s| s.passes = 7), Vec::<String>::new());
        assert_eq!(told(|s| s.seed = 7), ["`seed`: expected 0, found 7"]);
        assert_eq!(
            told(|s| s.method = Method::Ppm),
            ["`method`: expected \"sppm\", found \"ppm\""]
        );
        assert_eq!(
            told(|s| s.indirect_radius = Some(2.0)),
            ["`indirect_radius`: expected null, found 2.0"]
        );
        assert_eq!(
            told(|s| (s.radius, s.alpha) = (Radius::Pixels(2.0), 0.5)),
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
            "in line 2 of its file expected `b`, found `x`"
        );
        assert_eq!(
            where_texts_differ("a\nb", "a"),
            "in line 2 of its file expected `b`, found its end"
        );
        assert!(where_texts_differ("a", "a").contains("mesh"));
    }
}
