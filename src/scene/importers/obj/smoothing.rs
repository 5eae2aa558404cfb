//! Smoothing groups of an OBJ file: `s N` begins group N, `s off` and `s 0` flat faces (Wavefront,
//! "Object Files", appendix B1).

use std::ops::Range;

use super::lines::Statement;

/// The group of the faces before any `s`, and of all faces of a file without one.
const UNNAMED: u32 = 0;

/// Smoothing groups by face.
#[derive(Debug, Default)]
pub(super) struct SmoothingGroups {
    /// First face of each run of faces after an `s`, and the group of the run.
    runs: Vec<(u64, Option<u32>)>,
}

impl SmoothingGroups {
    /// Reads an `s`, which applies to the faces after the first `faces`.
    ///
    /// # Errors
    /// Position and text of a message, if the group is neither a number nor `off`.
    pub fn begin(
        &mut self,
        statement: &Statement,
        faces: u64,
    ) -> Result<(), (Range<usize>, String)> {
        let Some((word, at)) = statement.words().next() else {
            return Err((statement.at.clone(), "`s` names no smoothing group".to_owned()));
        };
        let group = match (word, word.parse()) {
            ("off", _) | (_, Ok(0)) => None,
            (_, Ok(group)) => Some(group),
            (_, Err(_)) => return Err((at, format!("`{word}` is no smoothing group"))),
        };
        self.runs.push((faces, group));
        Ok(())
    }

    /// The group of each face, in the order of the file; `None` for flat faces. Has no end.
    pub fn of_faces(&self) -> impl Iterator<Item = Option<u32>> + '_ {
        let mut runs = self.runs.iter().peekable();
        let mut group = Some(UNNAMED);
        (0..).map(move |face: u64| {
            while let Some((_, next)) = runs.next_if(|(first, _)| *first <= face) {
                group = *next;
            }
            group
        })
    }
}
