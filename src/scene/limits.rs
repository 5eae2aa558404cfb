//! File access and resource limits, for untrusted scenes.

use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// Treatment of material and texture files that do not exist.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Missing {
    /// Reject the scene.
    #[default]
    Error,
    /// Warn, and render the affected surfaces in mid-gray ([`Missing::STAND_IN`]).
    Warn,
}

impl Missing {
    /// Reflectance of surfaces whose material or texture is missing.
    pub const STAND_IN: f64 = 0.5;

    /// Advice on missing files, for error messages.
    pub(super) const ADVICE: &str = "or render it in gray: --missing warn";
}

/// Folder and resource limits of a scene's files, checked before memory is allocated. See
/// docs/hostile-input.md.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Allowance {
    /// Folder that must contain every file that is read, including the scene file, after links are
    /// resolved; `None` allows all files.
    pub root: Option<PathBuf>,
    /// Treatment of material and texture files that do not exist.
    pub missing: Missing,
    /// Most bytes of a scene or profile file.
    pub scene_bytes: u64,
    /// Most shapes in a scene file.
    pub shapes: u64,
    /// Most bytes of all mesh files and their material files; a file that several shapes name
    /// counts for each.
    pub mesh_bytes: u64,
    /// Most triangles of one mesh file.
    pub mesh_triangles: u64,
    /// Most triangles of all meshes.
    pub triangles: u64,
    /// Most pixels of one texture or environment image.
    pub texture_pixels: u64,
    /// Most bytes of texels of all textures and environment images, and of each file that contains
    /// one.
    pub texture_bytes: u64,
    /// Most pixels of the image size that the scene requests.
    pub picture_pixels: u64,
    /// Most errors, and most warnings, that are listed; the others are counted.
    pub errors: u64,
}

/// Least memory that [`Allowance::within_memory`] assumes, in bytes, so that small scenes load.
const LEAST: u64 = 16 << 20;
/// Most memory per byte of a scene file, in bytes (docs/hostile-input.md).
const SCENE_BYTE: u64 = 140;
/// Most memory per byte of a mesh file, without its triangles: the file and its text.
const MESH_BYTE: u64 = 2;
/// Most memory per shape that an instance makes, with its share of the kd-tree, in bytes.
const SHAPE: u64 = 1000;
/// Most memory per triangle of a mesh, with its kd-tree and a reserve, in bytes.
const TRIANGLE: u64 = 660;
/// Most memory per texel of 8 bits per channel during decoding, in bytes.
const TEXEL: u64 = 8;
/// Most memory per byte of texels, in bytes.
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
    /// Names of the limits on the command line.
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

    /// Lowers the limits to fit into `left` bytes of memory. Larger scenes would fail anyway:
    /// without an OS limit they exhaust the memory, and with one the system ends the process
    /// without a message.
    pub fn within_memory(self, left: u64) -> Self {
        let left = left.max(LEAST);
        Self {
            scene_bytes: self.scene_bytes.min(left / SCENE_BYTE),
            shapes: self.shapes.min(left / SHAPE),
            mesh_bytes: self.mesh_bytes.min(left / MESH_BYTE),
            mesh_triangles: self.mesh_triangles.min(left / TRIANGLE),
            triangles: self.triangles.min(left / TRIANGLE),
            texture_pixels: self.texture_pixels.min(left / TEXEL),
            texture_bytes: self.texture_bytes.min(left / TEXEL_BYTE),
            ..self
        }
    }

    /// The limit with this name; `None` if it is not in [`Self::LIMITS`].
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

    /// Opens a file that a scene names. `most` is the name of the limit and the number of bytes
    /// that it leaves.
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

    /// Like [`Self::open`], but returns the bytes.
    pub(super) fn read(&self, path: &Path, most: (&'static str, u64)) -> Result<Vec<u8>, Refusal> {
        bytes(self.open(path, most)?, most)
    }

    /// Returns whether `path` leads to an existing file that may be read.
    pub(super) fn has(&self, path: &Path) -> bool {
        self.place(path).is_ok_and(|place| place.is_file())
    }

    /// Path of a file in a folder. Tries slashes for backslashes, which separate folders on
    /// Windows.
    pub(super) fn find(&self, folder: &Path, name: &str) -> PathBuf {
        let path = folder.join(name);
        if !name.contains('\\') || self.has(&path) {
            return path;
        }
        let slashed = folder.join(name.replace('\\', "/"));
        if self.has(&slashed) { slashed } else { path }
    }

    /// Reads a scene or profile file. Without a root it may be a pipe.
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

    /// Path of a file; with a root, links are resolved. Rejects a path outside the root whether or
    /// not the file exists.
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

/// Absolute path without links; for a file that does not exist, the nearest existing folder and the
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

/// Checks a quantity against the amount that a limit leaves.
pub(super) fn within(
    limit: &'static str,
    what: &'static str,
    found: u64,
    most: u64,
) -> Result<(), Refusal> {
    if found <= most { Ok(()) } else { Err(Refusal::TooMuch { limit, what, found, most }) }
}

/// Reason why a file is not read.
#[derive(Debug)]
pub(crate) enum Refusal {
    /// The file lies outside the root.
    Outside { root: PathBuf },
    /// The path is a folder, a pipe or a device.
    NoFile,
    /// A quantity exceeds the amount that a limit leaves.
    TooMuch { limit: &'static str, what: &'static str, found: u64, most: u64 },
    /// Error from the operating system.
    Io(io::Error),
}

impl Refusal {
    /// Remedy, if there is one.
    pub fn help(&self) -> Option<String> {
        match self {
            Self::Outside { .. } => {
                Some("move it into that folder, or allow another one: --root DIR".to_owned())
            }
            Self::TooMuch { limit, .. } => {
                Some(format!("make it smaller, or raise the limit: --limit {limit}=N"))
            }
            Self::NoFile | Self::Io(_) => None,
        }
    }

    /// Returns whether the file does not exist.
    pub fn is_missing(&self) -> bool {
        matches!(self, Self::Io(error) if error.kind() == io::ErrorKind::NotFound)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Outside { root } => {
                write!(f, "it lies outside of {}, the only folder that may be read", root.display())
            }
            Self::NoFile => f.write_str("it is not a regular file"),
            Self::TooMuch { limit, what, found, most } => {
                write!(f, "{found} {what}, but the limit `{limit}` leaves {most}")
            }
            Self::Io(error) => error.fmt(f),
        }
    }
}
