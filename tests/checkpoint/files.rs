//! Damaged and forged checkpoint files.

use std::fs;
use std::path::{Path, PathBuf};

use caustica::low_level::checkpoint::{Checkpoint, CheckpointError, decode, merge, read, write};
use caustica::low_level::device::{Opened, Wanted};
use caustica::low_level::render::Stop;
use caustica::low_level::scene::settings::{RadiusRule, RenderSettings};
use caustica::low_level::scene::{Aovs, Film};
use xxhash_rust::xxh3::xxh3_128;

use super::{checkpoint_on, folder, open_on};
use crate::support::names;

/// Bytes before the header, and bytes of the checksum.
const PREFIX: usize = 24;
const SUM: usize = 16;
const NO_STOP: Stop = Stop { passes: u32::MAX, time: None, target_error: None };

/// Sets a window of 4 x 3 pixels with all layers.
fn window(film: &mut Film) {
    (film.width, film.height, film.window) = (6, 5, Some([1, 2, 5, 5]));
    film.aovs = Aovs::parse("all").unwrap();
}

fn opened() -> Opened {
    open_on(&Wanted::Cpu, window, |s| s.photons = 50)
}

fn made(name: &str) -> (PathBuf, Checkpoint) {
    let mut opened = opened();
    opened.engine.pass().unwrap();
    let state = opened.engine.save().unwrap();
    let checkpoint = checkpoint_on(&opened, window, state);
    let file = folder(name).join("a.checkpoint");
    write(&file, &checkpoint).unwrap();
    (file, checkpoint)
}

fn refusal(file: &Path, bytes: &[u8]) -> Option<CheckpointError> {
    decode(file, bytes).err()
}

/// Theory: a 128-bit checksum over everything before it, together with a length, detects every
/// truncation and every flipped bit.
#[test]
fn every_cut_and_every_flipped_byte_is_seen() {
    let (file, checkpoint) = made("damage");
    let bytes = fs::read(&file).unwrap();
    assert!(read(&file).unwrap() == checkpoint);
    for length in 0..bytes.len() {
        let error = refusal(&file, &bytes[..length]);
        let known = match length {
            0..PREFIX => matches!(error, Some(CheckpointError::NotOne { .. })),
            _ => matches!(&error, Some(CheckpointError::Length { expected, found, .. })
                if (*expected, *found) == (bytes.len() as u64, length as u64)),
        };
        assert!(known, "{length} bytes: {error:?}");
    }
    for at in 0..bytes.len() {
        let mut other = bytes.clone();
        other[at] ^= 1 << (at % 8);
        let error = refusal(&file, &other);
        let known = match at {
            0..8 => matches!(error, Some(CheckpointError::NotOne { .. })),
            8..12 => matches!(error, Some(CheckpointError::Format { expected: 2, .. })),
            16..24 => matches!(error, Some(CheckpointError::Length { .. })),
            _ => matches!(error, Some(CheckpointError::Damaged { .. })),
        };
        assert!(known, "byte {at}: {error:?}");
    }
    let longer = [&bytes[..], &[0]].concat();
    assert!(matches!(refusal(&file, &longer), Some(CheckpointError::Length { .. })));
    assert!(refusal(&file, &bytes).is_none(), "the bytes themselves are fine");
}

#[test]
fn what_is_no_checkpoint_is_told() {
    let folder = folder("others");
    let picture = folder.join("a.png");
    assert!(matches!(refusal(&picture, b"\x89PNG\r\n"), Some(CheckpointError::NotOne { .. })));
    assert!(matches!(refusal(&picture, b""), Some(CheckpointError::NotOne { .. })));
    for missing in
        [folder.join("none.checkpoint"), folder.clone(), "/dev/zero".into(), "/dev/null".into()]
    {
        let error = read(&missing).err().unwrap();
        assert!(matches!(error, CheckpointError::Io { verb: "read", .. }), "{error:?}");
        assert!(error.to_string().contains(missing.to_str().unwrap()), "{error}");
    }
}

/// Theory: a forged file may have a correct checksum and a wrong header. The reader must verify
/// every claim of the header.
#[test]
fn forged_headers_are_refused() {
    let (file, _) = made("forged");
    let bytes = fs::read(&file).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let header: serde_json::Value =
        serde_json::from_slice(&bytes[PREFIX..PREFIX + length]).unwrap();
    let sections = &bytes[PREFIX + length..bytes.len() - SUM];
    let forged = |header: &[u8], reported: u32| {
        let total = (PREFIX + header.len() + sections.len() + SUM) as u64;
        let start = [&bytes[..12], &reported.to_le_bytes(), &total.to_le_bytes()].concat();
        let content = [&start[..], header, sections].concat();
        let sum = xxh3_128(&content).to_le_bytes();
        refusal(&file, &[&content[..], &sum].concat())
    };
    let reported = |header: &serde_json::Value| {
        let header = header.to_string();
        forged(header.as_bytes(), header.len() as u32)
    };
    assert!(reported(&header).is_none(), "the forger's hand is right");
    let changes: [(&str, serde_json::Value); 24] = [
        ("/film", u64::MAX.into()),
        ("/film", 0.into()),
        ("/statistics", u64::MAX.into()),
        ("/statistics", 64.into()),
        ("/cuts", 1.into()),
        ("/aovs", 0.into()),
        ("/parts", 1.into()),
        ("/counts", 47.into()),
        ("/objects", 0.into()),
        ("/origin/aovs", "".into()),
        ("/origin/aovs", "albedoo".into()),
        ("/origin/window", serde_json::Value::Null),
        ("/origin/window/0", 5.into()),
        ("/origin/window/2", 7.into()),
        ("/origin/window/3", u32::MAX.into()),
        ("/passes", 0.into()),
        ("/passes", u32::MAX.into()),
        ("/first_pass", u32::MAX.into()),
        ("/bits", 16.into()),
        ("/bits", 64.into()),
        ("/origin/width", 4.into()),
        ("/origin/height", 0.into()),
        ("/origin/settings/photons", "many".into()),
        ("/totals/elapsed/secs", u64::MAX.into()),
    ];
    for (place, value) in changes {
        let mut lying = header.clone();
        *lying.pointer_mut(place).unwrap() = value.clone();
        // also make first_pass + passes overflow
        if place == "/passes" && value == u32::MAX {
            lying["first_pass"] = 1.into();
        }
        let error = reported(&lying);
        assert!(
            matches!(error, Some(CheckpointError::Damaged { .. })),
            "{place} {value}: {error:?}"
        );
    }
    for lie in [0, 1, length as u32 - 1, length as u32 + 1, u32::MAX] {
        let error = forged(header.to_string().as_bytes(), lie);
        assert!(matches!(error, Some(CheckpointError::Damaged { .. })), "{lie}: {error:?}");
    }
    // the parser refuses deep nesting; the stack does not overflow
    let deep = [vec![b'['; 100_000], vec![b']'; 100_000]].concat();
    assert!(matches!(forged(&deep, deep.len() as u32), Some(CheckpointError::Damaged { .. })));
}

/// Writes random bytes at random places, with a correct checksum. Each file is refused with a
/// reason, or it loads and can then be developed, merged and resumed. Nothing panics.
#[test]
fn forged_bytes_do_no_harm() {
    let (file, _) = made("chance");
    let bytes = fs::read(&file).unwrap();
    let mut state = 3u64;
    let mut below = |end: usize| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) as usize) % end
    };
    let digits = b"0123456789.-e,:{}[]\"tn";
    let (mut taken, mut refused, mut gone_on) = (0, 0, 0);
    let engine = &mut opened().engine;
    for round in 0..20_000 {
        let mut content = bytes[..bytes.len() - SUM].to_vec();
        for _ in 0..1 + below(4) {
            // half of the changes hit the numbers at the end of the header, where replacing a digit
            // by a digit still gives a valid header
            let header = PREFIX + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
            let at = if round % 2 == 0 { header - 1 - below(500) } else { below(content.len()) };
            let in_header = (PREFIX..header).contains(&at);
            content[at] = if in_header { digits[below(digits.len())] } else { below(256) as u8 };
        }
        let sum = xxh3_128(&content).to_le_bytes();
        match decode(&file, &[&content[..], &sum].concat()) {
            Ok(checkpoint) => {
                let (picture, errors, _) = checkpoint.develop();
                assert_eq!((picture.rgb.len(), errors.pixels.len()), (12, 12));
                let _ = (errors.relative(), errors.layers(), checkpoint.progress(NO_STOP).share());
                assert!(checkpoint.layers().iter().all(|layer| layer.plane.values.len() == 12));
                if engine.restore(&checkpoint.state).is_ok() && round % 4 == 0 {
                    engine.pass().unwrap();
                    gone_on += 1;
                }
                let mut next = checkpoint.clone();
                next.state.first_pass = checkpoint.end();
                next.state.passes = 1;
                let _ = merge(vec![(file.clone(), checkpoint), (file.clone(), next)])
                    .map(|all| (all.develop(), all.layers()));
                taken += 1;
            }
            Err(error) => {
                assert!(!error.to_string().is_empty());
                refused += 1;
            }
        }
    }
    assert!(taken > 1000 && refused > 1000 && gone_on > 100, "{taken} {refused} {gone_on}");
}

/// Theory: a failed write leaves the previous file intact.
#[test]
fn a_failed_write_keeps_the_one_before() {
    let (file, checkpoint) = made("unwritable");
    let mut other = checkpoint.clone();
    other.state.passes = 2;
    let writable = fs::metadata(&file).unwrap().permissions();
    let mut read_only = writable.clone();
    read_only.set_readonly(true);
    fs::set_permissions(&file, read_only).unwrap();
    let error = write(&file, &other).unwrap_err();
    assert!(matches!(error, CheckpointError::Io { verb: "written", .. }), "{error:?}");
    assert!(error.to_string().contains("read-only"), "{error}");
    assert!(read(&file).unwrap() == checkpoint);
    fs::set_permissions(&file, writable).unwrap();
    write(&file, &other).unwrap();
    assert!(read(&file).unwrap() == other);
    assert_eq!(names(file.parent().unwrap()).len(), 3, "nothing else is left in the folder");
}

/// Theory: radii under the local rule shrink from 1, means of finite light are finite, and no more
/// passes are rejected than were rendered. A file that violates this is refused whatever its
/// checksum. A file that satisfies it can be resumed without a panic.
#[test]
fn forged_numbers_are_refused() {
    let local = |s: &mut RenderSettings| (s.photons, s.radius_rule) = (50, RadiusRule::Local);
    let film = |film: &mut Film| (film.width, film.height) = (4, 3);
    let mut opened = open_on(&Wanted::Cpu, film, local);
    opened.engine.pass().unwrap();
    let state = opened.engine.save().unwrap();
    let sound = checkpoint_on(&opened, film, state);
    let file = folder("numbers").join("a.checkpoint");
    let mut refused = |change: &dyn Fn(&mut Checkpoint)| {
        let mut forged = sound.clone();
        change(&mut forged);
        write(&file, &forged).unwrap();
        match read(&file) {
            Ok(taken) => {
                opened.engine.restore(&taken.state).unwrap();
                opened.engine.pass().unwrap();
                false
            }
            Err(error) => {
                assert!(matches!(error, CheckpointError::Damaged { .. }), "{error:?}");
                true
            }
        }
    };
    let put = |bytes: &mut [u8], number: f32| bytes[..4].copy_from_slice(&number.to_le_bytes());
    let [scale, drop] = [0, 4].map(|at| {
        move |number: f32| move |c: &mut Checkpoint| put(&mut c.state.statistics[16 + at..], number)
    });
    for number in [0.0, 1e-30, 0.5, 1.0] {
        assert!(!refused(&|c| (scale(number)(c), drop(0.0)(c)).0), "a squared radius of {number}");
    }
    for number in [f32::INFINITY, f32::NAN, -1e-3, -f32::INFINITY, 1.0001, 4.0, 1e30] {
        assert!(refused(&scale(number)), "a squared radius of {number}");
    }
    for number in [f32::INFINITY, f32::NAN, -1e-3, 1.5] {
        assert!(refused(&drop(number)), "a decrease of {number}");
    }
    // the first four numbers of the film are mean and spread
    for number in [f32::INFINITY, -f32::INFINITY, f32::NAN] {
        for at in [0, 4, 8] {
            assert!(refused(&|c| put(&mut c.state.film[at..], number)), "radiance of {number}");
        }
    }
    for number in [f32::NAN, -1.0] {
        assert!(refused(&|c| put(&mut c.state.film[12..], number)), "a spread of {number}");
    }
    for unit in [0.0, -1.0] {
        assert!(refused(&|c| c.origin.space.unit = unit), "a unit of {unit}");
        assert!(refused(&|c| c.origin.space.radiance_unit = unit), "a radiance unit of {unit}");
    }
    assert!(refused(&|c| c.cuts = vec![[2, 0]; 12]), "a mean over two passes of one");
    for points in [1, 11, 13] {
        assert!(
            refused(&|c| c.state.statistics.resize(16 * points, 0)),
            "statistics of {points} points"
        );
    }
    assert!(!refused(&|_| ()), "the forger's hand is right");
}

/// Theory: the same holds for layers. Counts cover all visible points or none, and statistics exist
/// only under the local rule.
#[test]
fn forged_layers_are_refused() {
    let (_, sound) = made("layers");
    let file = folder("forged layers").join("a.checkpoint");
    let refused = |change: &dyn Fn(&mut Checkpoint)| {
        let mut forged = sound.clone();
        change(&mut forged);
        write(&file, &forged).unwrap();
        match read(&file) {
            Ok(taken) => {
                assert!(taken.layers().iter().all(|layer| layer.plane.values.len() == 12));
                false
            }
            Err(error) => {
                assert!(matches!(error, CheckpointError::Damaged { .. }), "{error:?}");
                true
            }
        }
    };
    assert_eq!((sound.state.layers.aovs.len(), sound.state.layers.parts.len()), (12 * 96, 12 * 32));
    assert_eq!((sound.state.layers.counts.len(), sound.state.statistics.len()), (12, 0));
    let put = |bytes: &mut [u8], at: usize, number: f32| {
        bytes[at..at + 4].copy_from_slice(&number.to_le_bytes())
    };
    for number in [f32::NAN, f32::INFINITY, -f32::INFINITY] {
        for at in (0..19).map(|k| 4 * k) {
            assert!(
                refused(&|c| put(&mut c.state.layers.aovs, 96 + at, number)),
                "{number} at {at}"
            );
        }
        for at in (0..7).map(|k| 4 * k) {
            assert!(
                refused(&|c| put(&mut c.state.layers.parts, 32 + at, number)),
                "parts: {number} at {at}"
            );
        }
    }
    // in this order: samples that hit, samples that end at a visible point, passes
    assert!(refused(&|c| put(&mut c.state.layers.aovs, 28, -1.0)));
    assert!(refused(&|c| put(&mut c.state.layers.aovs, 44, -1.0)));
    assert!(refused(&|c| put(&mut c.state.layers.parts, 12, -1.0)));
    assert!(refused(&|c| put(&mut c.state.layers.parts, 12, 2.0)), "two passes of one");
    for points in [1, 11, 13, 24] {
        assert!(refused(&|c| c.state.layers.counts.resize(points, 0)), "counts of {points} points");
        assert!(
            refused(&|c| c.state.statistics.resize(16 * points, 0)),
            "statistics of {points} points"
        );
    }
    assert!(
        refused(&|c| c.state.statistics.resize(16 * 12, 0)),
        "statistics without the local rule"
    );
    assert!(!refused(&|c| c.state.layers.counts.clear()) && !refused(&|_| ()));
}
