//! Targets of the fuzzer: the file readers.

use std::fs;
use std::path::Path;

use caustica::low_level::accel::tessellate::{Fineness, tessellate};
use caustica::low_level::checkpoint::Checkpoint;
use caustica::low_level::prepare::limits;
use caustica::low_level::scene::{self, Allowance, Loaded, SceneErrors};
use caustica::low_level::{checkpoint, pilots, plan};
use xxhash_rust::xxh3::xxh3_128;

use crate::mutate::Mutator;
use crate::seeds::{self, READER};

/// A file reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Target {
    /// Scene files.
    Scene,
    /// Scene files, including packing and planning.
    Plan,
    /// OBJ files.
    Obj,
    /// MTL files.
    Mtl,
    /// PLY files.
    Ply,
    /// PNG, JPEG, HDR and EXR files.
    Texture,
    /// Profile files, including tessellation.
    Profile,
    /// Checkpoints, including development and resuming for one pass.
    Checkpoint,
}

/// Bytes of a checkpoint before its header.
const PREFIX: usize = 24;
/// Bytes of a checkpoint's checksum.
const SUM: usize = 16;

impl Target {
    /// All targets.
    pub const ALL: [Self; 8] = [
        Self::Scene,
        Self::Plan,
        Self::Obj,
        Self::Mtl,
        Self::Ply,
        Self::Texture,
        Self::Profile,
        Self::Checkpoint,
    ];

    /// Reads an input. Returns an empty string if it is accepted, otherwise the generalized error.
    pub fn run(self, folder: &Path, input: &[u8]) -> String {
        let allowance = Allowance {
            root: Some(folder.to_owned()),
            mesh_triangles: 100_000,
            texture_pixels: 1 << 22,
            texture_bytes: 1 << 26,
            errors: 20,
            ..Allowance::default()
        };
        let scene = |text: &[u8]| scene::parse_within(&folder.join("scene.toml"), text, &allowance);
        match self {
            Self::Scene => summary(scene(input).map(warnings)),
            Self::Plan => summary(scene(input).map(|loaded| plan(&loaded))),
            Self::Obj => {
                write(folder, "mesh.obj", input);
                summary(
                    scene(reader("mesh.obj", "smooth = true\nmaterial = \"m\"").as_bytes())
                        .map(warnings),
                ) + &summary(scene(reader("mesh.obj", "").as_bytes()).map(warnings))
            }
            Self::Mtl => {
                write(folder, "mesh.mtl", input);
                summary(scene(reader("mesh.obj", "").as_bytes()).map(warnings))
            }
            Self::Ply => {
                write(folder, "mesh.ply", input);
                summary(scene(reader("mesh.ply", "material = \"m\"").as_bytes()).map(warnings))
            }
            Self::Texture => {
                // the content determines the format
                let name = if input.starts_with(&[0x76, 0x2f, 0x31, 0x01]) {
                    "sky.exr"
                } else {
                    "sky.png"
                };
                write(folder, name, input);
                let text = format!(
                    "{READER}[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n[[shapes]]\n\
                     type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\nmaterial = \"m\"\n\
                     [environment]\nfile = \"{name}\"\n"
                );
                summary(scene(text.as_bytes()).map(warnings))
            }
            Self::Profile => {
                write(folder, "profile.toml", input);
                let loaded = scene::load_profile_within(&folder.join("profile.toml"), &allowance);
                summary(loaded.map(|profile| {
                    let mesh =
                        tessellate(&profile.segments, &Fineness { sectors: 3, flatness: 1e-2 });
                    mesh.map(|mesh| drop(mesh.to_obj("")))
                        .map_or_else(|error| general(&error.to_string()), |()| String::new())
                }))
            }
            Self::Checkpoint => match checkpoint::decode("c.checkpoint".as_ref(), input) {
                Ok(checkpoint) => {
                    let _ = (checkpoint.develop(), checkpoint.layers());
                    let _ = (checkpoint.end(), checkpoint.provenance(), checkpoint.development());
                    resume(&checkpoint)
                }
                Err(error) => general(&error.to_string()),
            },
        }
    }

    /// Corrects the checksums and lengths of some inputs, which would otherwise be rejected early.
    pub fn finish(self, mut input: Vec<u8>, mutator: &mut Mutator) -> Vec<u8> {
        match self {
            Self::Checkpoint if mutator.below(8) > 0 && input.len() > PREFIX + SUM => {
                let (total, end) = (input.len() as u64, input.len() - SUM);
                input[16..24].copy_from_slice(&total.to_le_bytes());
                if let Some(length) = header(&input[PREFIX..end]).filter(|_| mutator.below(2) == 0)
                {
                    input[12..16].copy_from_slice(&length.to_le_bytes());
                }
                let sum = xxh3_128(&input[..end]).to_le_bytes();
                input[end..].copy_from_slice(&sum);
            }
            Self::Texture if mutator.below(4) > 0 && input.starts_with(b"\x89PNG\r\n\x1a\n") => {
                mend_png(&mut input)
            }
            _ => {}
        }
        input
    }
}

/// Resumes a checkpoint for one pass, if the engine accepts it.
fn resume(checkpoint: &Checkpoint) -> String {
    let (_, mut opened) = seeds::opened(checkpoint.origin.settings.radius_rule);
    let engine = &mut opened.engine;
    match engine
        .restore(&checkpoint.state)
        .and_then(|()| engine.pass())
        .and_then(|_| engine.results())
    {
        Ok(_) => String::new(),
        Err(error) => general(&error.to_string()),
    }
}

/// Length of the JSON object at the start of `bytes`.
fn header(bytes: &[u8]) -> Option<u32> {
    let mut stream = serde_json::Deserializer::from_slice(bytes).into_iter::<serde_json::Value>();
    stream.next()?.ok()?;
    u32::try_from(stream.byte_offset()).ok()
}

/// Corrects the checksums of the chunks of a PNG file (ISO 3309; PNG specification, annex D).
fn mend_png(input: &mut [u8]) {
    let mut at = 8;
    while let Some(word) = input.get(at..at + 4) {
        let length = u32::from_be_bytes([word[0], word[1], word[2], word[3]]) as usize;
        let end = at + 8 + length;
        let Some(content) = input.get(at + 4..end) else { return };
        let crc = !content.iter().fold(u32::MAX, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |crc, _| {
                if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 }
            })
        });
        let Some(place) = input.get_mut(end..end + 4) else { return };
        place.copy_from_slice(&crc.to_be_bytes());
        at = end + 4;
    }
}

fn reader(mesh: &str, more: &str) -> String {
    format!(
        "{READER}[materials.m]\ntype = \"diffuse\"\nreflectance = 0.5\n[[shapes]]\n\
         type = \"mesh\"\nfile = \"{mesh}\"\n{more}\n"
    )
}

fn write(folder: &Path, name: &str, input: &[u8]) {
    fs::write(folder.join(name), input).expect("a file in a temporary folder");
}

fn warnings(loaded: Loaded) -> String {
    let limits = limits::warnings(&loaded.scene, &loaded.settings, &loaded.places);
    for warning in &limits {
        let _ = format!("{:?}", miette::Report::new(warning.clone()));
    }
    String::new()
}

fn plan(loaded: &Loaded) -> String {
    let film = loaded.scene.film;
    match pilots::prepare(&loaded.scene, film.width, film.height) {
        Ok(packed) if u64::from(film.width) * u64::from(film.height) < 1 << 24 => {
            let plan = plan::Plan::probed(&packed, &loaded.settings);
            let _ = (plan.buffers(), plan.automatic_radius());
            String::new()
        }
        Ok(_) => String::new(),
        Err(error) => general(&error.to_string()),
    }
}

/// Suffix of the outcome of inputs with several errors, which are not added to the seeds.
pub const MORE: &str = "..";

/// Outcome of a scene: its first error without names and numbers.
fn summary(outcome: Result<String, SceneErrors>) -> String {
    match outcome {
        Ok(text) => text,
        Err(errors) => {
            let first =
                errors.errors.first().map_or(String::new(), |error| general(error.message()));
            let others = if errors.errors.len() > 1 { MORE } else { "" };
            if first.len() % 4 == 0 {
                let _ = format!("{:?}", miette::Report::new(errors));
            }
            format!("{first}.{others}")
        }
    }
}

/// Message without numbers and quoted text.
fn general(message: &str) -> String {
    let unquoted = message.split(['`', '"']).step_by(2).collect::<String>();
    let words = unquoted.split(' ').filter(|word| !word.contains(['/', '.', '[', '{']));
    words.flat_map(str::chars).filter(char::is_ascii_alphabetic).take(60).collect()
}
