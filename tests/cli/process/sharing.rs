//! Two processes and one checkpoint.

use std::fs;
use std::os::unix::fs::symlink;

use caustica::low_level::checkpoint::read;

use super::{ended, folder, render, signal, spawn, until};
use crate::support::{error, fails, good, words};

/// Theory: of two renders that would write to one file, by whatever names, the second ends at its
/// start and says who has it, whether there is a checkpoint yet or not; whoever is killed holds
/// nothing.
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
            let names = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name());
            let lock = names.into_iter().find(|name| name.to_str().unwrap().ends_with(".lock"));
            let holder_is = |text: String| text == holder.id().to_string();
            lock.is_some_and(|name| fs::read_to_string(folder.join(name)).is_ok_and(holder_is))
        };
        until("locked", locked);
        let held = format!("process {}", holder.id());
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
        // what is there is whole at any moment, for those who only read
        for _ in 0..20 {
            assert!(read(&file).is_ok());
        }
        let merging = ["merge", "a.checkpoint", "-o", "link.checkpoint"];
        fails(&folder, &merging, 2, &["link.checkpoint", "one of those that are merged"]);
        signal(&holder, kill);
        ended(holder);
    }
    // nobody holds it now, and nothing unfinished is left
    let passes = read(&file).unwrap().state.passes + 1;
    let line = format!(
        "--quiet -o c.exr --checkpoint a.checkpoint --resume a.checkpoint --passes {passes}"
    );
    assert_eq!(ended(spawn(render(&folder, &line))).status.code(), Some(0));
    let mut left: Vec<_> =
        fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["a.checkpoint", "a.exr", "ball.toml", "c.exr", "link.checkpoint"]);
}

/// Theory: a lock is the same for a user who may only read its file: who holds it is said.
#[test]
fn the_lock_of_another_user_counts() {
    use std::os::unix::fs::PermissionsExt;
    let folder = std::env::temp_dir().join(format!("caustica-lock-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    fs::set_permissions(&folder, fs::Permissions::from_mode(0o777)).unwrap();
    let program = folder.join("caustica");
    fs::copy(env!("CARGO_BIN_EXE_caustica"), &program).unwrap();
    fs::write(folder.join("ball.toml"), super::SCENE.as_str()).unwrap();
    let line = "--quiet --passes 1000000 --time 60s --checkpoint a.checkpoint -o a.exr";
    let holder = spawn(render(&folder, line));
    let lock = || {
        let names = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
        let own = |path: &std::path::PathBuf| {
            fs::read_to_string(path).is_ok_and(|text| text == holder.id().to_string())
        };
        names.into_iter().find(|path| path.extension().is_some_and(|e| e == "lock") && own(path))
    };
    until("locked", || lock().is_some());
    fs::set_permissions(lock().unwrap(), fs::Permissions::from_mode(0o444)).unwrap();
    // root may write to any file, so that the second render is another user's then
    let id = std::process::Command::new("id").arg("-u").output().unwrap();
    let mut second = std::process::Command::new("setpriv");
    if crate::support::text(&id.stdout).trim() == "0" {
        second.args(["--reuid=65534", "--clear-groups"]).arg(&program);
    } else {
        second = std::process::Command::new(&program);
    }
    second
        .args(words("render ball.toml --device cpu"))
        .args(words(&line.replace("a.exr", "b.exr")));
    let output = ended(spawn({
        second.current_dir(&folder);
        second
    }));
    let error = error(&output);
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(error.contains(&format!("process {}", holder.id())), "{error}");
    signal(&holder, "TERM");
    ended(holder);
    fs::remove_dir_all(&folder).unwrap();
}

/// Theory: what a command reads it does not write over, whatever the names.
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
        fails(&folder, &words(&line), 2, &[target, "one of those that are merged", "another"]);
    }
    good(&folder, &words("merge a.checkpoint b.checkpoint -o c.checkpoint"));
    assert!(a == fs::read(folder.join("a.checkpoint")).unwrap());
    assert!(b == fs::read(folder.join("b.checkpoint")).unwrap());
}
