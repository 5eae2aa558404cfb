//! The command `render` on devices that fail, at every step in turn.
//!
//! Theory: a person who named a device gets the picture of the passes that are left, a checkpoint
//! of them, and exit code 5; one who left the choice to the program gets the picture. Both end in
//! the bits of a render that never failed.

use std::fs;
use std::path::{Path, PathBuf};

use caustica::low_level::device::Candidates;
use caustica::low_level::film::read;
use clap::{Args, Command, FromArgMatches};

use super::engine::{FAULTS, Fault, Shared, Step, candidate, script, successor};
use super::{Arguments, Done, Failure, run_on};

/// An empty folder.
fn folder(name: &str) -> PathBuf {
    let folder =
        std::env::temp_dir().join(format!("caustica-faults-{}-{name}", std::process::id()));
    if folder.exists() {
        fs::remove_dir_all(&folder).unwrap();
    }
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// What the command is asked: the scene, small, into `a.exr` in a folder, with an error to aim at,
/// so that no step depends on a clock.
fn arguments(folder: &Path, more: &[&str]) -> Arguments {
    let output = folder.join("a.exr");
    let common = [
        "render",
        "scenes/cornell.toml",
        "--size",
        "12x8",
        "--photons",
        "400",
        "--radius",
        "2px",
        "--passes",
        "5",
    ];
    let rest = ["--target-error", "0.000001%", "--quiet", "-o", output.to_str().unwrap()];
    let all = common.iter().chain(&rest).chain(more);
    let matches =
        Arguments::augment_args(Command::new("render")).try_get_matches_from(all).unwrap();
    Arguments::from_arg_matches(&matches).unwrap()
}

/// Renders on devices of which each fails by its script, and perhaps one more that does not.
fn render(
    folder: &Path,
    more: &[&str],
    scripts: &[&Shared],
    and_cpu: bool,
) -> Result<Done, Failure> {
    let list = || {
        let faulty = scripts.iter().map(|script| candidate(script));
        Candidates::from_list(faulty.chain(and_cpu.then(successor)))
    };
    run_on(arguments(folder, more), &|_, _| Ok(list()))
}

fn pixels(folder: &Path) -> Vec<u32> {
    read(&folder.join("a.exr")).unwrap().rgb.iter().flatten().map(|x| x.to_bits()).collect()
}

/// The picture without failures, for one test, and what the device is asked for on the way with
/// these options.
fn whole(test: &str, more: &[&str]) -> (Vec<u32>, Vec<Step>) {
    let (folder, script) = (folder(&format!("{test}-whole")), script(None));
    assert!(matches!(render(&folder, more, &[&script], false), Ok(Done::Fully)));
    let (picture, asked) = (pixels(&folder), script.borrow().asked.clone());
    fs::remove_dir_all(&folder).unwrap();
    (picture, asked)
}

const ALWAYS: [&str; 2] = ["--checkpoint-every", "0.001ms"];

#[test]
fn the_program_ends_in_the_same_bits() {
    assert_eq!(Done::DeviceLost as u8, 5);
    let folder = folder("named");
    let file = folder.join("b.checkpoint");
    let file = file.to_str().unwrap();
    let kept = [&ALWAYS[..], &["--checkpoint", file]].concat();
    let (picture, steps) = whole("named", &[]);
    for number in 0..steps.len() {
        // a device that the user named
        let _ = fs::remove_file(file);
        let _ = fs::remove_file(folder.join("a.exr"));
        let faulty = script(Some((number, Fault::Lost)));
        let done = render(&folder, &kept, &[&faulty], false);
        let made = faulty.borrow().asked.iter().filter(|step| **step == Step::Pass).count();
        match done {
            Ok(Done::DeviceLost) => {
                assert!(folder.join("a.exr").exists(), "step {number}: no picture");
                let resumed = [&["--resume", file], &kept[..]].concat();
                assert!(
                    matches!(render(&folder, &resumed, &[], true), Ok(Done::Fully)),
                    "step {number}"
                );
            }
            Ok(Done::Fully) => {
                assert!(faulty.borrow().asked.len() <= number, "step {number} went unnoticed")
            }
            Ok(other) => panic!("step {number}: {other:?}"),
            Err(failure) => {
                assert!(made <= 2, "step {number}: {made} passes are lost");
                assert_eq!(failure.code(), 5, "step {number}");
                assert!(matches!(render(&folder, &kept, &[], true), Ok(Done::Fully)));
            }
        }
        assert!(pixels(&folder) == picture, "step {number}: other bits");
        // a device that the program chose
        let _ = fs::remove_file(folder.join("a.exr"));
        let faulty = script(Some((number, FAULTS[number % FAULTS.len()])));
        assert!(matches!(render(&folder, &[], &[&faulty], true), Ok(Done::Fully)), "step {number}");
        assert!(pixels(&folder) == picture, "step {number}: other bits");
    }
    fs::remove_dir_all(&folder).unwrap();
}

/// Without --checkpoint it is next to the picture; a file that is there already stays.
#[test]
fn work_is_kept_unasked() {
    let folder = folder("unasked");
    let (picture, steps) = whole("unasked", &[]);
    let fourth = (0..steps.len()).filter(|i| steps[*i] == Step::Pass).nth(3).unwrap();
    let fail = || render(&folder, &[], &[&script(Some((fourth, Fault::OutOfMemory)))], false);
    assert!(matches!(fail(), Ok(Done::DeviceLost)));
    let beside = folder.join("a.checkpoint");
    let kept = fs::read(&beside).unwrap();
    let resumed = ["--resume", beside.to_str().unwrap()];
    assert!(matches!(render(&folder, &resumed, &[], true), Ok(Done::Fully)));
    assert!(pixels(&folder) == picture);
    fs::write(&beside, b"another's").unwrap();
    assert!(matches!(fail(), Ok(Done::DeviceLost)));
    assert_eq!(fs::read(&beside).unwrap(), b"another's");
    assert_ne!(kept, b"another's");
    fs::remove_dir_all(&folder).unwrap();
}

/// A render goes on with the batches that it was begun with.
#[test]
fn batches_stay() {
    let folder = folder("batches");
    let (batched, steps) = whole("batches", &["--batch", "150"]);
    assert!(batched != whole("batches", &[]).0, "sums are rounded batch by batch");
    let third = (0..steps.len()).filter(|i| steps[*i] == Step::Pass).nth(2).unwrap();
    let faulty = script(Some((third, Fault::OutOfMemory)));
    assert!(matches!(
        render(&folder, &["--batch", "150"], &[&faulty], false),
        Ok(Done::DeviceLost)
    ));
    let kept = folder.join("a.checkpoint");
    let resumed = ["--resume", kept.to_str().unwrap(), "--memory-budget", "100MB"];
    assert!(matches!(render(&folder, &resumed, &[], true), Ok(Done::Fully)));
    assert!(pixels(&folder) == batched);
    let other = [&resumed[..], &["--batch", "200"]].concat();
    assert_eq!(render(&folder, &other, &[], true).unwrap_err().code(), 1);
    fs::remove_dir_all(&folder).unwrap();
}
