//! MTL files of an OBJ file, and the lookup of its material names.

use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::library::Library;
use super::lines::{Text, Word, before_comment, parts, readings};
use super::mtl;
use super::scan::Scan;
use crate::scene::builder::SceneBuilder;
use crate::scene::diagnostics::{did_you_mean, nearest_file};
use crate::scene::limits::{Missing, Refusal};
use crate::scene::meshes::OwnMaterial;
use crate::scene::{Material, MaterialKind, Reflectance};

/// Identifies a material by the index of its file and its index in that file.
type Id = (usize, usize);

/// MTL files of an OBJ file, in order.
#[derive(Debug, Default)]
pub(super) struct Libraries {
    files: Vec<Library>,
    /// Materials by the bytes of their names; the first of each name counts.
    by_bytes: HashMap<Vec<u8>, Id>,
    /// Materials by the characters of their names, for files that differ in encoding.
    by_text: HashMap<String, Id>,
    /// Materials by their names without a trailing comment; `None` if that is ambiguous.
    before_comment: HashMap<Vec<u8>, Option<Id>>,
    /// True if a file could not be read, so that it may define an unknown name.
    incomplete: bool,
}

/// Most MTL files of one OBJ file.
const MOST_FILES: usize = 1000;
/// Most words that are tried as one file name with blanks.
const LONGEST_NAME: usize = 16;

impl Libraries {
    /// Reads the MTL files that the OBJ file at `path` names.
    pub fn read(builder: &mut SceneBuilder, path: &Path, text: &Text, scan: &mut Scan) -> Self {
        let mut libraries = Self::default();
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut known = HashSet::new();
        for (name, at) in std::mem::take(&mut scan.libraries) {
            if name.is_empty() {
                scan.faults.push(at, "`mtllib` names no file", "expected an MTL file");
                continue;
            }
            for (at, file) in files_of((name, at), text, builder, folder) {
                if known.len() == MOST_FILES {
                    let message = format!("more than {MOST_FILES} material files");
                    scan.faults.push(at, message, "expected fewer");
                    return libraries;
                }
                if known.insert(file.clone()) {
                    libraries.add(builder, scan, at, file);
                }
            }
        }
        libraries
    }

    fn add(
        &mut self,
        builder: &mut SceneBuilder,
        scan: &mut Scan,
        at: Range<usize>,
        file: PathBuf,
    ) {
        builder.report.files.push(file.clone());
        let bytes = match builder.mesh_bytes(&file) {
            Ok(bytes) => bytes,
            Err(error) => {
                self.incomplete = true;
                return unread(builder, scan, &file, at, &error);
            }
        };
        let text = match Text::decode(&file, &bytes) {
            Ok(text) => text,
            Err(foreign) => {
                self.incomplete = true;
                let message = format!("{}: {foreign}", file.display());
                return scan.faults.push(at, message, foreign.help());
            }
        };
        let mut library = Library::new(file, text);
        let mut own = HashSet::new();
        for index in 0..library.entries.len() {
            let name = library.name(index);
            if name.is_empty() {
                continue;
            }
            let (id, bytes, shown) =
                ((self.files.len(), index), library.text.bytes(name), name.to_owned());
            let shorter = before_comment(name).map(|name| library.text.bytes(name));
            if !own.insert(bytes.clone()) {
                let message = format!("material `{}` is defined again", library.text.shown(name));
                let at = library.entries[index].name.clone();
                library.warnings.push(at, message, "the first definition counts");
                continue;
            }
            self.by_bytes.entry(bytes).or_insert(id);
            self.by_text.entry(shown).or_insert(id);
            if let Some(shorter) = shorter {
                self.before_comment
                    .entry(shorter)
                    .and_modify(|known| *known = None)
                    .or_insert(Some(id));
            }
        }
        self.files.push(library);
    }

    /// The material with this name, and the part of the name that matched.
    fn find<'n>(&self, text: &Text, name: &'n str) -> Option<(Id, &'n str)> {
        let in_bytes = |name: &'n str| self.by_bytes.get(&text.bytes(name)).map(|&id| (id, name));
        let in_text = |name: &'n str| self.by_text.get(name).map(|&id| (id, name));
        let commented = |name: &'n str| {
            self.before_comment.get(&text.bytes(name)).and_then(|id| Some(((*id)?, name)))
        };
        readings(name)
            .find_map(in_bytes)
            .or_else(|| readings(name).find_map(in_text))
            .or_else(|| readings(name).find_map(commented))
    }

    /// Materials of the faces of an OBJ file, in the order of [`Scan::uses`]; `None` for a name
    /// that is unused or undefined. Reports undefined names.
    pub fn materials(
        &mut self,
        builder: &mut SceneBuilder,
        (file, text): (&str, &Text),
        scan: &mut Scan,
        emits: bool,
    ) -> Vec<Option<OwnMaterial>> {
        let mut made = Vec::new();
        let uses = std::mem::take(&mut scan.uses);
        let mut known = HashMap::<Id, OwnMaterial>::new();
        for (name, at, used) in uses {
            if !used || name.is_empty() {
                made.push(None);
                continue;
            }
            let Some((id, called)) = self.find(text, name) else {
                made.push(self.undefined(builder, (file, text), scan, (name, at)));
                continue;
            };
            if called != name && before_comment(name).is_none() {
                let message = format!("material `{}` is not defined", text.shown(name));
                let label = format!("read as `{}` with a comment", text.shown(called));
                scan.warnings.push(at, message, label);
            }
            let own = known.get(&id).cloned().unwrap_or_else(|| {
                let library = &mut self.files[id.0];
                let key = (file.to_owned(), library.path.clone(), id.1, emits);
                builder.meshes.own_materials.get(&key).cloned().unwrap_or_else(|| {
                    let name = format!("{file}:{}", library.text.shown(library.name(id.1)));
                    let (material, emission) = mtl::material(library, id.1, name, emits, builder);
                    let material = builder.add_own_material(material);
                    let own = OwnMaterial { material, emission };
                    builder.meshes.own_materials.insert(key, own.clone());
                    own
                })
            });
            known.insert(id, own.clone());
            made.push(Some(own));
        }
        made
    }

    /// Reports the findings in the MTL files.
    pub fn report(&mut self, builder: &mut SceneBuilder, named_at: &Range<usize>) {
        for library in &mut self.files {
            let (faults, warnings) = library.take_findings();
            builder.report.asset_errors(named_at.clone(), &library.text.source, faults);
            builder.report.asset_warnings(named_at.clone(), &library.text.source, warnings);
        }
    }

    fn undefined(
        &self,
        builder: &mut SceneBuilder,
        (file, text): (&str, &Text),
        scan: &mut Scan,
        (name, at): Word,
    ) -> Option<OwnMaterial> {
        let shown = text.shown(name);
        let message = format!("material `{shown}` is not defined");
        if builder.allowance.missing == Missing::Warn {
            scan.warnings.push(at, message, "rendered in gray");
            let reflectance = Reflectance::Color([Missing::STAND_IN; 3]);
            let kind = MaterialKind::Diffuse { reflectance, roughness: 0.0 };
            let name = format!("{file}:{shown}");
            let material = Material { name, ..Material::new(kind) };
            let material = builder.add_own_material(material);
            return Some(OwnMaterial { material, emission: [0.0; 3] });
        }
        // An unreadable file has been reported already, and may define the name.
        if !self.incomplete {
            let other = format!("expected a material of the file's MTL, {}", Missing::ADVICE);
            let all =
                self.files.iter().flat_map(|file| (0..file.entries.len()).map(|at| file.name(at)));
            let expected =
                if scan.faults.is_full() { other } else { did_you_mean(&shown, all, &other) };
            scan.faults.push(at, message, expected);
        }
        None
    }
}

/// Reports an MTL file that cannot be read.
fn unread(builder: &SceneBuilder, scan: &mut Scan, file: &Path, at: Range<usize>, error: &Refusal) {
    let message = format!("cannot read {}: {error}", file.display());
    if !error.is_missing() {
        let mend = error.help().unwrap_or_else(|| "expected an MTL file".to_owned());
        return scan.faults.push(at, message, mend);
    }
    if builder.allowance.missing == Missing::Warn {
        return scan.warnings.push(at, message, "its materials are rendered in gray");
    }
    let near = nearest_file(file).filter(|_| !scan.faults.is_full());
    let mend =
        near.map_or("expected an MTL file".to_owned(), |near| format!("did you mean {near}?"));
    scan.faults.push(at, message, format!("{mend}, {}", Missing::ADVICE));
}

/// The files that the argument of one `mtllib` names. Names may contain blanks, blanks separate
/// names, and a comment may follow; the files that exist decide.
fn files_of(
    (name, at): Word,
    text: &Text,
    builder: &SceneBuilder,
    folder: &Path,
) -> Vec<(Range<usize>, PathBuf)> {
    let span = |part: &str| {
        let start = at.start + (part.as_ptr() as usize - name.as_ptr() as usize);
        start..start + part.len()
    };
    let find = |part: &str| text.find(builder.allowance, folder, part);
    let mut found = Vec::new();
    let mut rest = name;
    while !rest.is_empty() && (found.is_empty() || !rest.starts_with('#')) {
        let ends =
            parts(rest).map(|word| word.as_ptr() as usize - rest.as_ptr() as usize + word.len());
        let ends: Vec<_> = ends.take(LONGEST_NAME).chain([rest.len()]).collect();
        let is_there = |&&end: &&usize| builder.allowance.has(&find(&rest[..end]));
        let is_named = |&&end: &&usize| rest[..end].to_ascii_lowercase().ends_with(".mtl");
        let there = ends.iter().rev().find(is_there);
        let end = there.or_else(|| ends.iter().find(is_named)).copied().unwrap_or(rest.len());
        found.push((span(&rest[..end]), find(&rest[..end])));
        rest = rest[end..].trim_start_matches([' ', '\t', '\r', '\x0b', '\x0c']);
        if found.len() > MOST_FILES {
            break;
        }
    }
    found
}
