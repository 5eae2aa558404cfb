//! Scenes that need more memory than the process may have.

use std::fmt::Write;
use std::fs;
use std::process::Command;

use super::{SCENE, folder};
use crate::support::{PROGRAM, ended, error, spawn, words};

/// Whether `error` reports a lack of memory and helps: it names the exceeded scene limit and its
/// option, or the limit of the process and what to make smaller. Which of the two comes first
/// depends on how much address space the allocator has reserved.
fn helps(error: &str, option: &str) -> bool {
    let scene = error.contains(option);
    let process = error.contains("(ulimit -v)");
    scene
        || process
            && ["take coarser meshes", "--size", "--limit", "raise the limit"]
                .iter()
                .any(|help| error.contains(help))
}

/// Theory: the reader checks the available memory before it reads a mesh or an image. So under any
/// limit the program writes an image or a message, with exit code 0 or 1; a failed allocation would
/// end it by signal 6. An explicit limit applies however much memory is free.
#[test]
fn large_scenes_in_little_memory() {
    let folder = folder("large");
    let rows = 300;
    let mut mesh = String::new();
    for at in 0..rows * rows {
        writeln!(mesh, "v {} {} {}", at % rows, at * 7 % 11, at / rows).unwrap();
    }
    for at in (0..rows * (rows - 1)).filter(|at| at % rows + 1 < rows) {
        writeln!(mesh, "f {} {} {} {}", at + 1, at + 2, at + 2 + rows, at + 1 + rows).unwrap();
    }
    fs::write(folder.join("m.obj"), mesh).unwrap();
    image::GrayImage::new(6000, 5000).save(folder.join("t.png")).unwrap();
    let shape = "[[shapes]]\ntype = \"mesh\"\nfile = \"m.obj\"\nmaterial = \"white\"\n";
    fs::write(folder.join("mesh.toml"), format!("{}\n{shape}", *SCENE)).unwrap();
    let texture = "[textures.t]\ntype = \"image\"\nfile = \"t.png\"\n[materials.white]";
    let textured = SCENE
        .replace("[materials.white]", texture)
        .replace("reflectance = 0.5", "reflectance = \"t\"");
    fs::write(folder.join("texture.toml"), textured).unwrap();
    let run = |scene: &str, megabytes: u64, more: &str| {
        let line =
            format!("render {scene} --device cpu --quiet --passes 1 --photons 100 -o a.png {more}");
        let mut command = Command::new("prlimit");
        command.arg(format!("--as={}", megabytes * 1_000_000)).arg(PROGRAM);
        command.args(words(&line)).current_dir(&folder).env("RAYON_NUM_THREADS", "1");
        ended(spawn(command))
    };
    for (scene, limit) in
        [("mesh.toml", "--limit mesh-triangles"), ("texture.toml", "--limit texture-")]
    {
        let (mut rendered, mut refused) = (0, 0);
        // the allocator takes address space in steps of 64 MiB, so the least left over is found by
        // small steps only
        for megabytes in (40..200).step_by(4).chain([260, 340, 450, 700, 1200]) {
            let output = run(scene, megabytes, "");
            let error = error(&output);
            match output.status.code() {
                Some(0) => rendered += 1,
                Some(1) if helps(&error, limit) => refused += 1,
                _ => panic!("{scene} in {megabytes} MB: {:?} {error}", output.status),
            }
        }
        assert!(rendered > 0 && refused > 0, "{scene}: {rendered} {refused}");
    }
    let named = run("mesh.toml", 1200, "--limit mesh-triangles=1e5");
    assert_eq!(named.status.code(), Some(1), "{}", error(&named));
}
