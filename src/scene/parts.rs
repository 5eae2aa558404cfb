//! Positions of a scene's parts in its source, as checks and the builder ask for them.

use std::ops::Range;

/// A camera, a material, a shape or another part of a scene file. An importer implements this trait
/// for the nodes of its format, so that findings about the part point to the right place.
pub(crate) trait Part {
    /// Name of the part in messages: `camera`, `shapes[3]`, `materials.glass`.
    fn place(&self) -> &str;

    /// Byte range of the part.
    fn span(&self) -> Range<usize>;

    /// Byte range of the value that became a field of the description, such as `radius`; the part's
    /// own range if the file has no such value.
    fn span_of(&self, key: &str) -> Range<usize>;

    /// Calls `visit` with each key of the part and the byte range of its value.
    fn each_key(&self, visit: &mut dyn FnMut(&str, Range<usize>));
}

/// A part that the file leaves out, by its name; findings point to the start of the file.
pub(crate) struct Absent(pub &'static str);

impl Part for Absent {
    fn place(&self) -> &str {
        self.0
    }

    fn span(&self) -> Range<usize> {
        0..0
    }

    fn span_of(&self, _key: &str) -> Range<usize> {
        0..0
    }

    fn each_key(&self, _visit: &mut dyn FnMut(&str, Range<usize>)) {}
}
