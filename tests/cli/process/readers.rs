//! Input files that are pipes, devices or forged.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

use caustica::low_level::film::Picture;

use super::{fifo, folder};
use crate::support::{command, ended, error, exr_bytes, spawn, words, write_exr};

#[track_caller]
fn refused(folder: &Path, line: &str, reported: &[&str]) {
    let output = ended(spawn(command(folder, &words(line))));
    let error = error(&output);
    assert_eq!(output.status.code(), Some(1), "{line}: {:?} {error}", output.status);
    reported
        .iter()
        .for_each(|word| assert!(error.contains(word), "{line} should say `{word}`: {error}"));
}

/// Theory: a pipe may have no writer and a device no end, so no command reads either, whatever name
/// refers to it. `ended` kills a process that waits.
#[test]
fn pipes_and_devices_are_refused() {
    let folder = folder("special");
    fs::create_dir(folder.join("folder.exr")).unwrap();
    for kind in ["exr", "pfm", "hdr", "png", "jpg", "checkpoint"] {
        fifo(&folder.join(format!("pipe.{kind}")));
        symlink("/dev/zero", folder.join(format!("zero.{kind}"))).unwrap();
    }
    let picture = Picture::from_fn(12, 8, |_, _| [0.5; 3]);
    write_exr(&folder.join("good.exr"), &picture);
    for name in ["pipe", "zero"] {
        for kind in ["exr", "pfm", "hdr", "png", "jpg"] {
            refused(
                &folder,
                &format!("diff {name}.{kind} good.exr"),
                &[name, "not a regular file"],
            );
        }
        let render = "render ball.toml --device cpu --quiet -o out.exr";
        for line in [
            format!("diff good.exr {name}.exr"),
            format!("merge {name}.checkpoint -o out.exr"),
            format!("{render} --resume {name}.checkpoint"),
            format!("render --like {name}.exr --device cpu --quiet -o out.exr"),
            format!("study ball.toml --truth {name}.exr -o studied"),
        ] {
            refused(&folder, &line, &[name, "not a regular file"]);
        }
    }
    refused(&folder, "diff folder.exr good.exr", &["folder.exr", "cannot be read"]);
    assert!(!folder.join("out.exr").exists());
}

/// Theory: the folder of a study may be untrusted too. A study waits for none of the files that it
/// resumes from.
#[test]
fn a_study_does_not_wait_for_its_files() {
    let folder = folder("study");
    let line = "study ball.toml --device cpu --vary alpha=0.5,0.7 --seeds 2 --budget 2s --quiet -o studied";
    let output = ended(spawn(command(&folder, &words(line))));
    assert_eq!(output.status.code(), Some(0), "{}", error(&output));
    for name in ["about.json", "runs.jsonl", "products.jsonl"] {
        let file = folder.join("studied").join(name);
        let content = fs::read(&file).unwrap();
        for device in [None, Some("/dev/zero")] {
            fs::remove_file(&file).unwrap();
            match device {
                None => fifo(&file),
                Some(device) => symlink(device, &file).unwrap(),
            }
            refused(&folder, line, &[name, "not a regular file"]);
        }
        fs::remove_file(&file).unwrap();
        fs::write(&file, content).unwrap();
    }
    // the report omits an image that is unreadable
    let crops = fs::read_dir(folder.join("studied/crops")).unwrap();
    let crop =
        crops.map(|entry| entry.unwrap().path()).find(|path| path.extension().is_some()).unwrap();
    fs::remove_file(&crop).unwrap();
    symlink("/dev/zero", &crop).unwrap();
    let output = ended(spawn(command(&folder, &words(line))));
    assert_eq!(output.status.code(), Some(0), "{}", error(&output));
}

/// Theory: a file of a hundred bytes may claim any number of pixels. The reader checks the
/// available memory before it allocates them; a failed allocation would end the program by signal
/// 6.
#[test]
fn sizes_are_not_believed() {
    let folder = folder("sizes");
    let picture = Picture::from_fn(12, 8, |_, _| [0.5; 3]);
    let mut exr = exr_bytes(&picture);
    fs::write(folder.join("good.exr"), &exr).unwrap();
    for window in ["dataWindow\0box2i\0", "displayWindow\0box2i\0"] {
        let at = exr.windows(window.len()).position(|bytes| bytes == window.as_bytes()).unwrap();
        let corner = at + window.len() + 4 + 8;
        exr[corner..corner + 8].copy_from_slice(&[0, 0, 16, 0].repeat(2));
    }
    fs::write(folder.join("huge.exr"), &exr).unwrap();
    let hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000 +X 2000000\n";
    fs::write(folder.join("huge.hdr"), hdr).unwrap();
    fs::write(folder.join("huge.pfm"), "PF\n2000000 2000000\n-1.0\n").unwrap();
    // a sparse file, longer than the memory
    let sparse = fs::File::create(folder.join("long.pfm")).unwrap();
    sparse.set_len(1 << 43).unwrap();
    for name in ["huge.exr", "huge.hdr", "huge.pfm", "long.pfm"] {
        refused(&folder, &format!("diff {name} good.exr"), &[name]);
    }
    refused(&folder, "diff huge.exr good.exr", &["1048577 x 1048577 pixels take"]);
    fs::remove_file(folder.join("long.pfm")).unwrap();
}
