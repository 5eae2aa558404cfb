//! Scan of a Wavefront OBJ file before tobj reads it. tobj reports no lines in its errors, accepts
//! an index of 0 and numbers that are not finite, reads polylines as faces, and confuses faces with
//! and without normals.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;

use super::lines::{Statement, Word, finite, statements};
use super::smoothing::SmoothingGroups;
use crate::scene::diagnostics::Faults;
use crate::scene::numbers::LARGEST;

/// Result of the scan of an OBJ file.
#[derive(Debug)]
pub(super) struct Scan<'t> {
    /// Statements for tobj, in which materials are named by their index in `uses`.
    pub cleaned: String,
    pub faults: Faults,
    pub warnings: Faults,
    /// Number of triangles after triangulation.
    pub triangles: u64,
    pub faces: u64,
    pub smoothing: SmoothingGroups,
    /// Arguments of each `mtllib`, without duplicates.
    pub libraries: Vec<Word<'t>>,
    known_libraries: HashSet<&'t str>,
    /// Names of materials, each with its first position and whether a face uses it.
    pub uses: Vec<(&'t str, Range<usize>, bool)>,
    known_uses: HashMap<&'t str, usize>,
    /// Material of the next face, and the last one that was written to `cleaned`.
    current: Option<usize>,
    written: Option<usize>,
    /// The first face before any `usemtl`.
    pub bare_face: Option<Range<usize>>,
    /// Keywords of ignored statements, with their number.
    pub unread: BTreeMap<&'t str, usize>,
    counts: [i64; 3],
    group: Option<[bool; 2]>,
    /// Largest index of each kind.
    ahead: [i64; 3],
    /// Unusable vertices, texture coordinates and normals by their index, each with the position of
    /// an unusable number.
    bad: [HashMap<i64, Range<usize>>; 3],
}

/// Names of the kinds of indices.
const KINDS: [&str; 3] = ["vertices", "texture coordinates", "normals"];

/// Scans an OBJ file; `own_materials` keeps its `usemtl` and `mtllib`.
pub(super) fn scan(text: &str, own_materials: bool) -> Scan<'_> {
    let mut scan = Scan {
        cleaned: if own_materials { format!("mtllib {LIBRARY}\n") } else { String::new() },
        faults: Faults::default(),
        warnings: Faults::warnings(),
        triangles: 0,
        faces: 0,
        smoothing: SmoothingGroups::default(),
        libraries: Vec::new(),
        known_libraries: HashSet::new(),
        uses: Vec::new(),
        known_uses: HashMap::new(),
        current: None,
        written: None,
        bare_face: None,
        unread: BTreeMap::new(),
        counts: [0; 3],
        group: None,
        ahead: [0; 3],
        bad: Default::default(),
    };
    for statement in statements(text, 0..text.len()) {
        scan.statement(&statement, own_materials);
    }
    let is_bad = scan.bad.iter().any(|bad| !bad.is_empty());
    if is_bad || (0..3).any(|kind| scan.ahead[kind] > scan.counts[kind]) {
        scan.indices(text);
    }
    scan
}

/// Name of the only material file that tobj reads.
const LIBRARY: &str = "own";

impl<'t> Scan<'t> {
    fn fault(
        &mut self,
        span: Range<usize>,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) {
        self.faults.push(span, message, expected);
    }

    /// Reports indices beyond the end, and indices of unusable elements. Unusable elements that no
    /// face uses cause a warning.
    fn indices(&mut self, text: &str) {
        let mut counts = [0; 3];
        for statement in statements(text, 0..text.len()) {
            match statement.keyword {
                "v" => counts[0] += 1,
                "vt" => counts[1] += 1,
                "vn" => counts[2] += 1,
                "f" => {
                    for (corner, at) in statement.words() {
                        self.corner(corner, &at, &counts, text);
                    }
                }
                _ => {}
            }
        }
        for (kind, name) in KINDS.into_iter().enumerate() {
            let bad = std::mem::take(&mut self.bad[kind]);
            if let Some(first) = bad.values().min_by_key(|at| at.start) {
                let message = format!("{} {name} have a number that cannot be used", bad.len());
                self.warnings.push(first.clone(), message, "no face uses them");
            }
        }
    }

    fn corner(&mut self, corner: &str, at: &Range<usize>, counts: &[i64; 3], text: &str) {
        for (kind, part) in corner.split('/').enumerate().take(3) {
            let Ok(index) = part.parse::<i64>() else { continue };
            let count = self.counts[kind];
            if index > count {
                let name = KINDS[kind];
                let message =
                    format!("index {index} is out of bounds: the file has {count} {name}");
                let expected = if count == 0 {
                    "expected none".into()
                } else {
                    format!("expected 1 to {count}")
                };
                self.fault(at.clone(), message, expected);
            }
            let index = if index < 0 { index.saturating_add(counts[kind] + 1) } else { index };
            if let Some(place) = self.bad[kind].remove(&index) {
                let (message, expected) = unusable(&text[place.clone()]);
                self.fault(place, message, expected);
            }
        }
    }

    fn statement(&mut self, statement: &Statement<'t>, own_materials: bool) {
        match statement.keyword {
            "v" => self.vertex(0, 3, statement),
            "vt" => self.vertex(1, 1, statement),
            "vn" => self.vertex(2, 3, statement),
            "f" => self.face(statement, own_materials),
            "o" | "g" => {
                self.group = None;
                self.cleaned.push_str("g\n");
            }
            "usemtl" if own_materials => {
                let (name, at) = statement.name();
                if name.is_empty() {
                    self.fault(
                        statement.at.clone(),
                        "`usemtl` names no material",
                        "expected a name",
                    );
                }
                let count = self.uses.len();
                let index = *self.known_uses.entry(name).or_insert(count);
                if index == count {
                    self.uses.push((name, at, false));
                }
                if self.current != Some(index) {
                    self.group = None;
                }
                self.current = Some(index);
            }
            "mtllib" if own_materials => {
                let argument = statement.name();
                if self.known_libraries.insert(argument.0) {
                    self.libraries.push(argument);
                }
            }
            "s" => {
                if let Err((span, message)) = self.smoothing.begin(statement, self.faces) {
                    self.warnings.push(span, message, "expected `off` or a number; not used");
                }
            }
            "usemtl" | "mtllib" => {}
            keyword => *self.unread.entry(keyword).or_default() += 1,
        }
    }

    /// Reads the numbers of a `v`, `vt` or `vn`, which needs `least` of them.
    fn vertex(&mut self, kind: usize, least: usize, statement: &Statement<'t>) {
        self.counts[kind] += 1;
        let words: Vec<_> = statement.words().collect();
        if words.len() < least {
            let message =
                format!("{} number{}", words.len(), if words.len() == 1 { "" } else { "s" });
            let expected =
                format!("expected {}", if kind == 1 { "2 numbers" } else { "3 numbers" });
            return self.fault(statement.at.clone(), message, expected);
        }
        // A fourth number of a vertex is its weight w, which divides the others; with 6 or 7
        // numbers the last ones are colors.
        let used = if kind == 1 {
            2
        } else if kind == 0 && words.len() == 4 {
            4
        } else {
            3
        };
        match (kind, words.len()) {
            (0, 6 | 7) => *self.unread.entry("vertex color").or_default() += 1,
            (0, 5..) | (1 | 2, 4..) => *self.unread.entry("further number").or_default() += 1,
            _ => {}
        }
        let is_bad = |(at, (word, _)): &(usize, &Word)| {
            let number = finite(word).ok().filter(|number| number.abs() <= LARGEST);
            number.is_none() || (*at == 3 && number == Some(0.0))
        };
        let bad = words.iter().take(used).enumerate().find(is_bad).map(|(_, (_, at))| at.clone());
        self.cleaned.push_str(["v", "vt", "vn"][kind]);
        // tobj requires two numbers in a `vt`.
        for (word, _) in
            words.iter().map(|(word, at)| (*word, at)).chain([("0", &(0..0))]).take(used)
        {
            self.cleaned.push(' ');
            self.cleaned.push_str(if bad.is_some() { "1" } else { word });
        }
        self.cleaned.push('\n');
        if let Some(at) = bad {
            self.bad[kind].insert(self.counts[kind], at);
        }
    }

    fn face(&mut self, statement: &Statement<'t>, own_materials: bool) {
        let corners: Vec<_> = statement.words().collect();
        if corners.len() < 3 {
            let message = format!("a face of {} corners", corners.len());
            return self.fault(statement.at.clone(), message, "expected at least 3 corners");
        }
        match self.current {
            Some(index) => self.uses[index].2 = true,
            None if own_materials => {
                self.bare_face = self.bare_face.take().or(Some(statement.at.clone()))
            }
            None => {}
        }
        self.triangles += corners.len() as u64 - 2;
        for (corner, at) in &corners {
            let parts: Vec<_> = corner.split('/').collect();
            let has = [1, 2].map(|kind| parts.get(kind).is_some_and(|part| !part.is_empty()));
            if parts.len() > 3 || parts[0].is_empty() {
                self.fault(
                    at.clone(),
                    format!("`{corner}` is no corner"),
                    "expected v, v/vt, v//vn or v/vt/vn",
                );
                return;
            }
            match self.group {
                Some(group) if group != has => {
                    let message =
                        "faces of one group differ in having texture coordinates or normals";
                    let expected = ["v", "v//vn", "v/vt", "v/vt/vn"]
                        [usize::from(group[0]) * 2 + usize::from(group[1])];
                    self.fault(
                        at.clone(),
                        message,
                        format!("expected {expected}, as before in this group"),
                    );
                    return;
                }
                _ => self.group = Some(has),
            }
            for (kind, part) in parts.iter().enumerate().filter(|(_, part)| !part.is_empty()) {
                self.index(kind, part, at);
            }
        }
        if let Some(index) = self.current.filter(|_| self.current != self.written) {
            self.cleaned.push_str(&format!("usemtl {index}\n"));
            self.written = self.current;
        }
        self.faces += 1;
        self.cleaned.push('f');
        for (corner, _) in corners {
            self.cleaned.push(' ');
            self.cleaned.push_str(corner);
        }
        self.cleaned.push('\n');
    }

    fn index(&mut self, kind: usize, part: &str, at: &Range<usize>) {
        match part.parse::<i64>() {
            Err(_) => self.fault(
                at.clone(),
                format!("`{part}` is not an index"),
                "expected a whole number",
            ),
            Ok(0) => self.fault(
                at.clone(),
                "an index of 0",
                "expected indices from 1, or negative ones from the end",
            ),
            Ok(index) if index < -self.counts[kind] => {
                let message = format!("index {index} is out of bounds");
                let expected =
                    format!("expected at least -{}: so many stand above", self.counts[kind]);
                self.fault(at.clone(), message, expected);
            }
            // An index may point ahead in the file; `scan` checks at the end whether the element
            // exists.
            Ok(index) => self.ahead[kind] = self.ahead[kind].max(index),
        }
    }
}

/// Message and label for an unusable number that a face refers to.
fn unusable(word: &str) -> (String, String) {
    match finite(word) {
        Err(message) => (message, "expected a number".to_owned()),
        Ok(0.0) => (
            "a vertex with w = 0 is infinitely far".to_owned(),
            "expected another number".to_owned(),
        ),
        Ok(_) => {
            let expected = format!("expected at most {LARGEST:e} in magnitude");
            (format!("`{word}` is too large for single precision"), expected)
        }
    }
}
