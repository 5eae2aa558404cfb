//! Looks through the text of a Wavefront OBJ file before tobj reads it: tobj names no lines in its errors, takes an
//! index of 0 and numbers that are not finite, reads polylines as faces, and mixes up faces with and without normals.

use std::collections::{BTreeMap, HashSet};
use std::ops::Range;

use super::numbers::LARGEST;
use super::report::Faults;

/// A word of a file with the bytes that hold it.
pub(super) type Word<'t> = (&'t str, Range<usize>);

/// What a first look at an OBJ file finds.
#[derive(Debug, Default)]
pub(super) struct Scan<'t> {
    /// Statements for tobj to read.
    pub cleaned: String,
    pub faults: Faults,
    /// Triangles that the faces will be cut into.
    pub triangles: u64,
    /// Names of the material files, each once.
    pub libraries: Vec<Word<'t>>,
    known_libraries: HashSet<&'t str>,
    /// Names of materials where they are called.
    pub uses: Vec<Word<'t>>,
    /// The first face before any `usemtl`.
    pub bare_face: Option<Range<usize>>,
    /// Keywords of statements that are not used, with their number.
    pub unread: BTreeMap<&'t str, usize>,
    counts: [i64; 3],
    group: Option<[bool; 2]>,
    /// Largest index of each kind that was above what stood before it.
    ahead: [i64; 3],
}

/// Joins lines that end in a backslash, keeping every byte in its place.
pub(super) fn join_lines(text: &str) -> String {
    text.replace("\\\r\n", "   ").replace("\\\n", "  ")
}

/// Looks through an OBJ file; `own_materials` keeps its `usemtl` and `mtllib`.
pub(super) fn scan(text: &str, own_materials: bool) -> Scan<'_> {
    let mut scan = Scan::default();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        scan.line(line, start, own_materials);
        start += line.len();
    }
    if (0..3).any(|kind| scan.ahead[kind] > scan.counts[kind]) {
        scan.missing(text);
    }
    scan
}

impl<'t> Scan<'t> {
    fn fault(&mut self, span: Range<usize>, message: impl Into<String>, expected: impl Into<String>) {
        self.faults.push(span, message, expected);
    }

    /// Finds the indices that point behind the end.
    fn missing(&mut self, text: &str) {
        let mut start = 0;
        for line in text.split_inclusive('\n') {
            let statement = line.split('#').next().unwrap_or("");
            let mut words = words(statement, start);
            start += line.len();
            if words.next().is_none_or(|(keyword, _)| keyword != "f") {
                continue;
            }
            for (corner, at) in words {
                for (kind, part) in corner.split('/').enumerate().take(3) {
                    let (name, count) =
                        (["vertices", "texture coordinates", "normals"][kind], self.counts[kind]);
                    let Some(index) = part.parse::<i64>().ok().filter(|&index| index > count) else {
                        continue;
                    };
                    let message = format!("index {index} is out of bounds: the file has {count} {name}");
                    let expected =
                        if count == 0 { "expected none".into() } else { format!("expected 1 to {count}") };
                    self.fault(at.clone(), message, expected);
                }
            }
        }
    }

    fn line(&mut self, line: &'t str, start: usize, own_materials: bool) {
        let statement = line.split('#').next().unwrap_or("");
        let mut words = words(statement, start);
        let Some((keyword, span)) = words.next() else { return };
        let rest: Vec<_> = words.collect();
        let argument = argument(statement, start, keyword, &span);
        let keep = match keyword {
            "v" => self.vertex(0, 3, &[3, 4, 6], &rest, &span),
            "vt" => self.vertex(1, 2, &[1, 2, 3], &rest, &span),
            "vn" => self.vertex(2, 3, &[3], &rest, &span),
            "f" => self.face(&rest, &span),
            "o" | "g" => {
                self.group = None;
                true
            }
            "usemtl" if own_materials => {
                if self.uses.last().is_none_or(|last| last.0 != argument.0) {
                    self.group = None;
                }
                if argument.0.is_empty() {
                    self.fault(span, "`usemtl` names no material", "expected a name");
                }
                self.uses.push(argument);
                true
            }
            "mtllib" if own_materials => {
                let new = self.known_libraries.insert(argument.0);
                if new {
                    self.libraries.push(argument);
                }
                new
            }
            "usemtl" | "mtllib" | "s" => false,
            _ => {
                *self.unread.entry(keyword).or_default() += 1;
                false
            }
        };
        if keep {
            self.cleaned.push_str(statement.trim());
            self.cleaned.push('\n');
        }
    }

    fn vertex(
        &mut self,
        kind: usize,
        kept: usize,
        lengths: &[usize],
        rest: &[Word],
        span: &Range<usize>,
    ) -> bool {
        self.counts[kind] += 1;
        if !lengths.contains(&rest.len()) {
            let expected = format!("expected {kept} numbers");
            self.fault(span.clone(), format!("{} numbers", rest.len()), expected);
            return false;
        }
        for (word, at) in rest {
            let number = word.parse().unwrap_or(f64::NAN);
            if !number.is_finite() {
                self.fault(at.clone(), format!("`{word}` is not a finite number"), "expected a number");
            } else if number.abs() > LARGEST {
                let expected = format!("expected at most {LARGEST:e} in magnitude");
                self.fault(at.clone(), format!("`{word}` is too large for single precision"), expected);
            }
        }
        if kind == 0 && rest.len() == 4 && rest[3].0.parse() == Ok(0.0) {
            self.fault(rest[3].1.clone(), "a vertex with w = 0 is infinitely far", "expected another number");
        }
        if kind == 0 && rest.len() == 6 {
            *self.unread.entry("vertex color").or_default() += 1;
        }
        // tobj wants two numbers in a `vt`, and takes no colors without a full set of them.
        let kept = if kind == 0 && rest.len() == 4 { 4 } else { kept };
        let padded = rest.iter().map(|word| word.0).chain(["0"]).take(kept);
        self.cleaned.push_str(["v", "vt", "vn"][kind]);
        for word in padded {
            self.cleaned.push(' ');
            self.cleaned.push_str(word);
        }
        self.cleaned.push('\n');
        false
    }

    fn face(&mut self, corners: &[Word], span: &Range<usize>) -> bool {
        if corners.len() < 3 {
            let message = format!("a face of {} corners", corners.len());
            self.fault(span.clone(), message, "expected at least 3 corners");
            return false;
        }
        if self.uses.is_empty() && self.bare_face.is_none() {
            self.bare_face = Some(span.clone());
        }
        self.triangles += corners.len() as u64 - 2;
        for (corner, at) in corners {
            let parts: Vec<_> = corner.split('/').collect();
            let has = [1, 2].map(|kind| parts.get(kind).is_some_and(|part| !part.is_empty()));
            if parts.len() > 3 || parts[0].is_empty() {
                self.fault(
                    at.clone(),
                    format!("`{corner}` is no corner"),
                    "expected v, v/vt, v//vn or v/vt/vn",
                );
                return false;
            }
            match self.group {
                Some(group) if group != has => {
                    let message = "faces of one group differ in having texture coordinates or normals";
                    let expected =
                        ["v", "v//vn", "v/vt", "v/vt/vn"][usize::from(group[0]) * 2 + usize::from(group[1])];
                    self.fault(at.clone(), message, format!("expected {expected}, as before in this group"));
                    return false;
                }
                _ => self.group = Some(has),
            }
            for (kind, part) in parts.iter().enumerate().filter(|(_, part)| !part.is_empty()) {
                self.index(kind, part, at);
            }
        }
        true
    }

    fn index(&mut self, kind: usize, part: &str, at: &Range<usize>) {
        match part.parse::<i64>() {
            Err(_) => self.fault(at.clone(), format!("`{part}` is not an index"), "expected a whole number"),
            Ok(0) => self.fault(
                at.clone(),
                "an index of 0",
                "expected indices from 1, or negative ones from the end",
            ),
            Ok(index) if index < -self.counts[kind] => {
                let message = format!("index {index} is out of bounds");
                let expected = format!("expected at least -{}: so many stand above", self.counts[kind]);
                self.fault(at.clone(), message, expected);
            }
            // An index may point to what follows; whether it is there shows at the end.
            Ok(index) => self.ahead[kind] = self.ahead[kind].max(index),
        }
    }
}

/// The words of a line that starts at byte `start` of its file.
pub(super) fn words(line: &str, start: usize) -> impl Iterator<Item = Word<'_>> {
    line.split_whitespace().map(move |word| {
        let at = start + (word.as_ptr() as usize - line.as_ptr() as usize);
        (word, at..at + word.len())
    })
}

/// Everything behind a keyword, trimmed: names may hold spaces.
pub(super) fn argument<'t>(line: &'t str, start: usize, keyword: &str, at: &Range<usize>) -> Word<'t> {
    let behind = at.start - start + keyword.len();
    let text = line[behind..].trim();
    let begin = start + (text.as_ptr() as usize - line.as_ptr() as usize);
    (text, begin..begin + text.len())
}
