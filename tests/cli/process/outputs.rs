//! Output paths of images and checkpoints.

use std::fs;
use std::os::unix::fs::{FileTypeExt, MetadataExt, PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::Output;
use std::thread;

use caustica::low_level::checkpoint::read;
use caustica::low_level::storage::{self, Purpose};

use super::{fifo, folder, render};
use crate::support::{PROGRAM, ended, error, names, spawn, text, until};

const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

#[track_caller]
fn run(folder: &Path, line: &str, code: i32, words: &[&str]) -> Output {
    let output = ended(spawn(render(folder, &format!("--quiet {line}"))));
    let error = error(&output);
    assert_eq!(output.status.code(), Some(code), "{line}: {error}");
    words
        .iter()
        .for_each(|word| assert!(error.contains(word), "{line} should say `{word}`: {error}"));
    output
}

fn mode(path: &Path) -> u32 {
    fs::metadata(path).unwrap().permissions().mode() & 0o7777
}

/// Temporary files and locks of the program in a folder.
fn leftovers(folder: &Path) -> Vec<PathBuf> {
    let names = names(folder).into_iter();
    names.filter(|name| name.starts_with(".caustica-")).map(|name| folder.join(name)).collect()
}

/// Theory: a link stands for its target, which may not exist yet, through any number of folders.
/// The link itself is not replaced.
#[test]
fn links_are_followed() {
    let folder = folder("links");
    fs::create_dir_all(folder.join("far/away")).unwrap();
    for (link, to) in [
        ("one.png", "real.png"),
        ("two.png", "far/three.png"),
        ("far/three.png", "away/four.png"),
        ("new.png", "far/away/made.png"),
        ("kept.checkpoint", "far/kept"),
    ] {
        symlink(to, folder.join(link)).unwrap();
    }
    fs::write(folder.join("real.png"), "before").unwrap();
    fs::write(folder.join("far/away/four.png"), "before").unwrap();
    run(&folder, "-o one.png -o two.png -o new.png --checkpoint kept.checkpoint", 0, &[]);
    for link in ["one.png", "two.png", "far/three.png", "new.png", "kept.checkpoint"] {
        assert!(fs::symlink_metadata(folder.join(link)).unwrap().is_symlink(), "{link}");
    }
    for file in ["real.png", "far/away/four.png", "far/away/made.png"] {
        assert!(fs::read(folder.join(file)).unwrap().starts_with(PNG), "{file}");
    }
    assert_eq!(read(&folder.join("far/kept")).unwrap().state.passes, 2);
    // two names of one file count as one output
    run(&folder, "-o one.png -o real.png", 2, &["real.png"]);
    symlink("round.png", folder.join("round.png")).unwrap();
    run(&folder, "-o round.png", 1, &["round.png", "cannot be written"]);
    for part in ["", "far", "far/away"] {
        assert_eq!(leftovers(&folder.join(part)), [""; 0].map(PathBuf::from), "{part}");
    }
}

/// Theory: an overwritten file keeps its mode and owner, and its new content is at no time readable
/// to more users. A read-only file is refused before the render starts, even for root.
#[test]
fn modes_and_owners_stay() {
    let folder = folder("modes");
    let file = |name: &str, mode: u32| {
        let path = folder.join(name);
        fs::write(&path, "before").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
        path
    };
    let modes = [("private.png", 0o600), ("shared.exr", 0o664), ("odd.pfm", 0o751)];
    let files = modes.map(|(name, mode)| file(name, mode));
    let owner = |path: &Path| fs::metadata(path).map(|m| (m.uid(), m.gid())).unwrap();
    let other = (12_345, 54_321);
    let is_root = std::os::unix::fs::chown(&files[0], Some(other.0), Some(other.1)).is_ok();
    run(&folder, "-o private.png -o shared.exr -o odd.pfm", 0, &[]);
    for (path, (name, expected)) in files.iter().zip(modes) {
        assert_eq!(format!("{:o}", mode(path)), format!("{expected:o}"), "{name}");
        assert_ne!(fs::read(path).unwrap(), b"before", "{name}");
    }
    assert_eq!(owner(&files[0]) == other, is_root);
    // this also holds while the file is written
    storage::write(&files[0], Purpose::Result, |out| {
        let unfinished = leftovers(&folder);
        assert_eq!(unfinished.iter().map(|path| mode(path)).collect::<Vec<_>>(), [0o600]);
        out.write_all(b"after")
    })
    .unwrap();
    let read_only = file("locked.png", 0o444);
    let refused = run(&folder, "-o new.png -o locked.png", 1, &["locked.png", "read-only"]);
    assert_eq!(text(&refused.stdout), "");
    assert!(!folder.join("new.png").exists(), "it is refused before the work");
    assert_eq!((fs::read(&read_only).unwrap(), mode(&read_only)), (b"before".to_vec(), 0o444));
    let kept = file("locked.checkpoint", 0o400);
    run(
        &folder,
        "-o new.png --checkpoint locked.checkpoint",
        1,
        &["locked.checkpoint", "read-only"],
    );
    assert_eq!(mode(&kept), 0o400);
}

/// Theory: a name may have 255 bytes, and the program reserves none of them. Names of temporary
/// files that are taken are skipped.
#[test]
fn names_may_be_long_and_taken() {
    let folder = folder("names");
    let long = |length: usize, end: &str| format!("{}{end}", "x".repeat(length - end.len()));
    for length in [245, 250, 254, 255] {
        let (picture, kept) = (long(length, ".png"), long(length, ".checkpoint"));
        run(&folder, &format!("-o {picture} --checkpoint {kept}"), 0, &[]);
        assert!(folder.join(&picture).exists() && read(&folder.join(&kept)).is_ok(), "{length}");
    }
    let kept = long(255, ".checkpoint");
    run(&folder, &format!("-o a.png --checkpoint {kept} --resume {kept}"), 0, &[]);
    run(&folder, &format!("-o {}", long(256, ".png")), 1, &["cannot be written", "too long"]);
    // files that a killed process with this number may have left
    let file = folder.join("taken.png");
    storage::write(&file, Purpose::Result, |_| {
        let mine = leftovers(&folder).remove(0);
        let (start, count) = mine.to_str().unwrap().rsplit_once('-').unwrap();
        let count = u64::from_str_radix(count, 16).unwrap();
        (count + 1..count + 50)
            .for_each(|n| fs::write(format!("{start}-{n:x}"), "another's").unwrap());
        Ok(())
    })
    .unwrap();
    storage::write(&file, Purpose::Result, |out| out.write_all(b"whole")).unwrap();
    assert_eq!(fs::read(&file).unwrap(), b"whole");
}

/// Theory: a pipe or device receives the image and is not replaced. A checkpoint, which must be
/// read again, is refused there before the render starts.
#[test]
fn pipes_get_pictures() {
    let folder = folder("pipes");
    for pipe in ["direct.pfm", "end"] {
        fifo(&folder.join(pipe));
    }
    symlink("end", folder.join("link.pfm")).unwrap();
    run(&folder, "-o file.pfm", 0, &[]);
    let expected = fs::read(folder.join("file.pfm")).unwrap();
    for (name, pipe) in [("direct.pfm", "direct.pfm"), ("link.pfm", "end")] {
        let path = folder.join(pipe);
        let reader = thread::spawn({
            let path = path.clone();
            move || fs::read(path).unwrap()
        });
        run(&folder, &format!("-o {name}"), 0, &[]);
        assert!(reader.join().unwrap() == expected, "{name}");
        assert!(fs::symlink_metadata(&path).unwrap().file_type().is_fifo(), "{name}");
    }
    assert!(fs::symlink_metadata(folder.join("link.pfm")).unwrap().is_symlink());
    symlink("/dev/stdout", folder.join("out.png")).unwrap();
    let output = run(&folder, "-o out.png", 0, &[]);
    assert!(output.stdout.starts_with(PNG) && output.stdout.ends_with(b"out.png\n"));
    // a file that a shell has opened for several programs keeps what they write before and after
    let line = "{ echo before; \"$0\" render ball.toml --device cpu --quiet -o out.png; echo after; } >all.bin";
    let mut shell = std::process::Command::new("sh");
    shell.args(["-c", line, PROGRAM]).current_dir(&folder);
    assert_eq!(ended(spawn(shell)).status.code(), Some(0));
    let all = fs::read(folder.join("all.bin")).unwrap();
    let inner =
        all.strip_prefix(b"before\n").and_then(|rest| rest.strip_suffix(b"out.png\nafter\n"));
    assert!(inner == output.stdout.strip_suffix(b"out.png\n"), "{} bytes", all.len());
    // the name of standard output does not determine the format; the message says which names do
    for name in ["/dev/stdout", "-", "/dev/fd/1", "/proc/self/fd/1", "/dev/stderr"] {
        let output =
            run(&folder, &format!("--output={name}"), 2, &[name, "does not determine", "ln -s"]);
        assert!(output.stdout.is_empty());
    }
    run(&folder, "--checkpoint end -o never.png", 1, &["end", "not a regular file"]);
    assert!(fs::metadata(folder.join("end")).unwrap().file_type().is_fifo());
    assert!(!folder.join("never.png").exists());
}

/// Theory: a failed output does not affect the others. All failures are reported, the exit code is
/// 1, and the result is saved in another place, which the message names.
#[test]
fn one_failed_output_keeps_no_other() {
    let folder = folder("gone");
    for part in ["gone", "lost"] {
        fs::create_dir(folder.join(part)).unwrap();
    }
    let line = "-o gone/y.png -o ok.png -o lost/z.exr --passes 40 --time 60s --target-error 0.0001% \
                --checkpoint lost/kept.checkpoint --checkpoint-every 0.001ms";
    let child = spawn(render(&folder, line));
    // the render is under way
    until("a checkpoint", || folder.join("lost/kept.checkpoint").exists());
    for part in ["gone", "lost"] {
        // the program may be writing there at this moment
        until("an empty folder", || fs::remove_dir_all(folder.join(part)).is_ok());
    }
    let output = ended(child);
    let error = error(&output);
    assert_eq!(output.status.code(), Some(1), "{error}");
    for word in
        ["gone/y.png: cannot be written", "lost/z.exr: cannot be written", "lost/kept.checkpoint"]
    {
        assert!(error.contains(word), "{word}: {error}");
    }
    assert!(fs::read(folder.join("ok.png")).unwrap().starts_with(PNG), "{error}");
    let said = |start: &str| {
        let rest = error.rsplit_once(start).unwrap_or_else(|| panic!("{start}: {error}")).1;
        folder.join(rest.split_whitespace().next().unwrap())
    };
    let picture = caustica::low_level::film::read(&said("image saved in ")).unwrap();
    assert_eq!((picture.width, picture.height), (12, 8));
    let kept = said("checkpoint saved in ");
    assert_eq!(read(&kept).unwrap().state.passes, 40, "{error}");
    let kept = kept.file_name().unwrap().to_str().unwrap().to_owned();
    run(&folder, &format!("-o again.png --passes 40 --resume {kept}"), 0, &[]);
}
