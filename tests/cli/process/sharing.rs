//! Two processes that share a checkpoint.

use std::fs;
use std::os::unix::fs::symlink;

use caustica::low_level::checkpoint::read;

use super::{folder, render};
use crate::support::{
    PROGRAM, ended, error, fails, good, names, only_unprivileged, signal, spawn, unprivileged,
    until, words,
};

/// Theory: if two renders write to one file, by whatever names, the second ends at its start and
/// names the process that holds it, whether or not the checkpoint exists yet. A killed process
/// holds no lock.
#[test]
fn a_checkpoint_has_one_writer() {
    let folder = folder("writers");
    symlink("a.checkpoint", folder.join("link.checkpoint")).unwrap();
    let file = folder.join("a.checkpoint");
    let endless = "--quiet --passes 1000000 --checkpoint a.checkpoint";
    for (round, kill) in ["KILL", "TERM"].into_iter().enumerate() {
        let resume = if round > 0 { "--resume a.checkpoint" } else { "" };
        let holder =
            spawn(render(&folder, &format!("{endless} {resume} --checkpoint-every 1ms -o a.exr")));
        let locked = || {
            let lock = names(&folder).into_iter().find(|name| name.ends_with(".lock"));
            let holder_is = |text: String| text == holder.id().to_string();
            lock.is_some_and(|name| fs::read_to_string(folder.join(name)).is_ok_and(holder_is))
        };
        until("locked", locked);
        let held = format!("process ({})", holder.id());
        let second = |line: &str| {
            let output = ended(spawn(render(&folder, &format!("--quiet -o b.exr {line}"))));
            let error = error(&output);
            assert_eq!(output.status.code(), Some(1), "{line}: {error}");
            assert!(error.contains(&held) && error.contains("checkpoint"), "{line}: {error}");
            assert!(!folder.join("b.exr").exists());
        };
        second("--checkpoint a.checkpoint");
        second("--checkpoint link.checkpoint");
        until("a checkpoint", || file.exists());
        second("--checkpoint a.checkpoint");
        second("--checkpoint a.checkpoint --resume a.checkpoint");
        second("--checkpoint link.checkpoint --resume a.checkpoint");
        // readers always find a complete file
        for _ in 0..20 {
            assert!(read(&file).is_ok());
        }
        let merging = ["merge", "a.checkpoint", "-o", "link.checkpoint"];
        fails(&folder, &merging, 2, &["link.checkpoint", "one of the merged checkpoints"]);
        signal(&holder, kill);
        ended(holder);
    }
    // the lock is free, and no temporary file is left
    let passes = read(&file).unwrap().state.passes + 1;
    let line = format!(
        "--quiet -o c.exr --checkpoint a.checkpoint --resume a.checkpoint --passes {passes}"
    );
    assert_eq!(ended(spawn(render(&folder, &line))).status.code(), Some(0));
    assert_eq!(names(&folder), ["a.checkpoint", "a.exr", "ball.toml", "c.exr", "link.checkpoint"]);
}

/// Theory: a lock also works for a user who may only read its file.
#[test]
fn the_lock_of_another_user_counts() {
    use std::os::unix::fs::PermissionsExt;
    let _only = only_unprivileged();
    let folder = std::env::temp_dir().join(format!("caustica-lock-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    fs::set_permissions(&folder, fs::Permissions::from_mode(0o777)).unwrap();
    let program = folder.join("caustica");
    fs::copy(PROGRAM, &program).unwrap();
    fs::write(folder.join("ball.toml"), super::SCENE.as_str()).unwrap();
    let line = "--quiet --passes 1000000 --time 60s --checkpoint a.checkpoint -o a.exr";
    let holder = spawn(render(&folder, line));
    let lock = || {
        let paths = names(&folder).into_iter().map(|name| folder.join(name));
        let own = |path: &std::path::PathBuf| {
            fs::read_to_string(path).is_ok_and(|text| text == holder.id().to_string())
        };
        paths.into_iter().find(|path| path.extension().is_some_and(|e| e == "lock") && own(path))
    };
    until("locked", || lock().is_some());
    fs::set_permissions(lock().unwrap(), fs::Permissions::from_mode(0o444)).unwrap();
    // root may write to any file, so root runs the second render as another user
    let mut second = unprivileged(&program);
    second
        .args(words("render ball.toml --device cpu"))
        .args(words(&line.replace("a.exr", "b.exr")));
    let output = ended(spawn({
        second.current_dir(&folder);
        second
    }));
    let error = error(&output);
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(error.contains(&format!("process ({})", holder.id())), "{error}");
    signal(&holder, "TERM");
    ended(holder);
    fs::remove_dir_all(&folder).unwrap();
}

/// Theory: a command does not overwrite its inputs, whatever their names.
#[test]
fn what_is_merged_is_not_written_over() {
    let folder = folder("merge");
    for (range, name) in [("0..2", "a.checkpoint"), ("2..4", "b.checkpoint")] {
        let line = format!("--quiet --passes {range} --checkpoint {name} -o {name}.exr");
        assert_eq!(ended(spawn(render(&folder, &line))).status.code(), Some(0));
    }
    symlink("a.checkpoint", folder.join("l.checkpoint")).unwrap();
    let [a, b] = ["a.checkpoint", "b.checkpoint"].map(|name| fs::read(folder.join(name)).unwrap());
    for target in
        ["a.checkpoint", "b.checkpoint", "./a.checkpoint", "../merge/b.checkpoint", "l.checkpoint"]
    {
        let line = format!("merge a.checkpoint b.checkpoint -o {target}");
        fails(&folder, &words(&line), 2, &[target, "one of the merged checkpoints", "another"]);
    }
    good(&folder, &words("merge a.checkpoint b.checkpoint -o c.checkpoint"));
    assert!(a == fs::read(folder.join("a.checkpoint")).unwrap());
    assert!(b == fs::read(folder.join("b.checkpoint")).unwrap());
}
