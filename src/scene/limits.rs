//! What a scene may read, and how much of everything: for those who render scenes of strangers.

use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// What becomes of a scene that names an MTL or texture file that does not exist.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Missing {
    /// Refuse the scene.
    #[default]
    Error,
    /// Warn, and render what the file would have colored in mid-gray ([`Missing::STAND_IN`]).
    Warn,
}

impl Missing {
    /// Reflectance of surfaces whose material or texture is missing.
    pub const STAND_IN: f64 = 0.5;

    /// How to go on without a file, for errors about it.
    pub(super) const ADVICE: &str = "or render it in gray: --missing warn";
}

/// Where the files of a scene may lie, and limits that are checked before memory is taken.
/// docs/hostile-input.md tells what they promise.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Allowance {
    /// The folder that holds every file that may be read, the scene's own among them, links
    /// resolved; `None` is everywhere.
    pub root: Option<PathBuf>,
    /// What becomes of MTL and texture files that do not exist.
    pub missing: Missing,
    /// Bytes of a scene or profile file.
    pub scene_bytes: u64,
    /// `[[shapes]]` of a scene.
    pub shapes: u64,
    /// Bytes of all OBJ and MTL files; a file that several shapes name counts for each.
    pub mesh_bytes: u64,
    /// Triangles of one OBJ file.
    pub mesh_triangles: u64,
    /// Triangles of all meshes.
    pub triangles: u64,
    /// Pixels of one texture or environment picture.
    pub texture_pixels: u64,
    /// Bytes of the texels of all textures and environment pictures, and of each file that holds
    /// one.
    pub texture_bytes: u64,
    /// Pixels of the picture that the scene asks for.
    pub picture_pixels: u64,
    /// Errors, and warnings, that are listed; those beyond are counted.
    pub errors: u64,
}

/// Bytes that every process has for small scenes.
const LEAST: u64 = 16 << 20;
/// Bytes of memory for a byte of a scene file, at most (docs/hostile-input.md).
const SCENE_BYTE: u64 = 140;
/// The same for a triangle of a mesh, with its kd-tree.
const TRIANGLE: u64 = 600;
/// For a texel of 8 bits a channel while it is decoded.
const TEXEL: u64 = 8;
/// For a byte of texels.
const TEXEL_BYTE: u64 = 3;

impl Default for Allowance {
    fn default() -> Self {
        Self {
            root: None,
            missing: Missing::default(),
            scene_bytes: 64 << 20,
            shapes: 1_000_000,
            mesh_bytes: 2 << 30,
            mesh_triangles: 10_000_000,
            triangles: 20_000_000,
            texture_pixels: 1 << 28,
            texture_bytes: 4 << 30,
            picture_pixels: 1 << 28,
            errors: 100,
        }
    }
}

impl Allowance {
    /// Names of the limits.
    pub const LIMITS: [&'static str; 9] = [
        "scene-bytes",
        "shapes",
        "mesh-bytes",
        "mesh-triangles",
        "triangles",
        "texture-pixels",
        "texture-bytes",
        "picture-pixels",
        "errors",
    ];

    /// The same for a process that has `left` bytes of memory: no more of anything than that holds.
    /// Of other scenes a process without limits is not kept either; one with limits is ended by
    /// them without a word.
    pub fn within_memory(self, left: u64) -> Self {
        let left = left.max(LEAST);
        Self {
            scene_bytes: self.scene_bytes.min(left / SCENE_BYTE),
            mesh_bytes: self.mesh_bytes.min(left),
            mesh_triangles: self.mesh_triangles.min(left / TRIANGLE),
            triangles: self.triangles.min(left / TRIANGLE),
            texture_pixels: self.texture_pixels.min(left / TEXEL),
            texture_bytes: self.texture_bytes.min(left / TEXEL_BYTE),
            ..self
        }
    }

    /// The limit of a name; `None` where it is none of [`Self::LIMITS`].
    pub fn limit(&mut self, name: &str) -> Option<&mut u64> {
        Some(match name {
            "scene-bytes" => &mut self.scene_bytes,
            "shapes" => &mut self.shapes,
            "mesh-bytes" => &mut self.mesh_bytes,
            "mesh-triangles" => &mut self.mesh_triangles,
            "triangles" => &mut self.triangles,
            "texture-pixels" => &mut self.texture_pixels,
            "texture-bytes" => &mut self.texture_bytes,
            "picture-pixels" => &mut self.picture_pixels,
            "errors" => &mut self.errors,
            _ => return None,
        })
    }

    /// Opens a file that a scene names, of at most so many bytes; `most` tells the limit's name and
    /// what is left of it.
    pub(super) fn open(&self, path: &Path, most: (&'static str, u64)) -> Result<File, Refusal> {
        let place = self.place(path)?;
        // Opening a pipe would wait for its writer.
        let found = std::fs::metadata(&place).map_err(Refusal::Io)?;
        if !found.is_file() {
            return Err(Refusal::NoFile);
        }
        within(most.0, "bytes", found.len(), most.1)?;
        File::open(&place).map_err(Refusal::Io)
    }

    /// As [`Self::open`], and its bytes.
    pub(super) fn read(&self, path: &Path, most: (&'static str, u64)) -> Result<Vec<u8>, Refusal> {
        bytes(self.open(path, most)?, most)
    }

    /// Whether a path leads to a file that may be read.
    pub(super) fn has(&self, path: &Path) -> bool {
        self.place(path).is_ok_and(|place| place.is_file())
    }

    /// The file of a name in a folder. Names written on Windows separate folders by backslashes.
    pub(super) fn find(&self, folder: &Path, name: &str) -> PathBuf {
        let path = folder.join(name);
        if !name.contains('\\') || self.has(&path) {
            return path;
        }
        let slashed = folder.join(name.replace('\\', "/"));
        if self.has(&slashed) { slashed } else { path }
    }

    /// The bytes of a scene or profile file. Where nothing is confined it may be a pipe.
    pub(super) fn read_scene(&self, path: &Path) -> Result<Vec<u8>, Refusal> {
        let most = ("scene-bytes", self.scene_bytes);
        if self.root.is_some() {
            return self.read(path, most);
        }
        let file = File::open(path).map_err(Refusal::Io)?;
        let found = file.metadata().map_err(Refusal::Io)?;
        within(most.0, "bytes", found.len(), most.1)?;
        bytes(file, most)
    }

    /// The place of a file, links resolved where a root confines it. What is outside is refused
    /// whether it is there or not.
    fn place(&self, path: &Path) -> Result<PathBuf, Refusal> {
        let Some(root) = &self.root else { return Ok(path.to_owned()) };
        let inside = root
            .canonicalize()
            .ok()
            .zip(resolved(path))
            .filter(|(root, place)| place.starts_with(root));
        inside.map(|(_, place)| place).ok_or_else(|| Refusal::Outside { root: root.clone() })
    }
}

/// An absolute path without links; of a file that is not there, its nearest folder that is, and the
/// rest.
fn resolved(path: &Path) -> Option<PathBuf> {
    let mut known = std::path::absolute(path).ok()?;
    let mut rest = Vec::new();
    loop {
        if let Ok(real) = known.canonicalize() {
            return Some(rest.iter().rev().fold(real, |place, name| place.join(name)));
        }
        rest.push(known.file_name()?.to_owned());
        known.pop();
    }
}

fn bytes(file: File, (limit, most): (&'static str, u64)) -> Result<Vec<u8>, Refusal> {
    let mut bytes = Vec::new();
    file.take(most.saturating_add(1)).read_to_end(&mut bytes).map_err(Refusal::Io)?;
    within(limit, "bytes", bytes.len() as u64, most)?;
    Ok(bytes)
}

/// Whether so many of something are within what is left of a limit.
pub(super) fn within(
    limit: &'static str,
    what: &'static str,
    found: u64,
    most: u64,
) -> Result<(), Refusal> {
    if found <= most { Ok(()) } else { Err(Refusal::TooMuch { limit, what, found, most }) }
}

/// Why a file is not read.
#[derive(Debug)]
pub(super) enum Refusal {
    /// It lies outside of the root.
    Outside { root: PathBuf },
    /// It is a folder, a pipe or a device.
    NoFile,
    /// More than a limit leaves.
    TooMuch { limit: &'static str, what: &'static str, found: u64, most: u64 },
    /// The system's word.
    Io(io::Error),
}

impl Refusal {
    /// How to mend it.
    pub fn help(&self) -> Option<String> {
        match self {
            Self::Outside { .. } => {
                Some("put it into that folder, or allow another one (--root)".to_owned())
            }
            Self::TooMuch { limit, .. } => {
                Some(format!("make it smaller, or raise the limit: --limit {limit}=N"))
            }
            Self::NoFile | Self::Io(_) => None,
        }
    }

    /// Whether there is no such file.
    pub fn is_missing(&self) -> bool {
        matches!(self, Self::Io(error) if error.kind() == io::ErrorKind::NotFound)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Outside { root } => {
                write!(f, "it lies outside of {}, which holds all that may be read", root.display())
            }
            Self::NoFile => f.write_str("it is not a regular file"),
            Self::TooMuch { limit, what, found, most } => {
                write!(f, "{found} {what}, and the limit `{limit}` leaves {most}")
            }
            Self::Io(error) => error.fmt(f),
        }
    }
}
