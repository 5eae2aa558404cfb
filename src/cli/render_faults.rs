//! The command `render` on devices that fail at each step in turn.
//!
//! Theory: with an explicit device, the command writes the image of the recovered passes and a
//! checkpoint, and exits with code 5. With an automatic device, it completes the image. Both lead
//! to the bits of a render without failures.

use std::fs;
use std::path::{Path, PathBuf};

use caustica::low_level::device::Candidates;
use caustica::low_level::film::read;
use clap::{Args, Command, FromArgMatches};

use super::engine::{FAULTS, Fault, Shared, Step, candidate, script, successor};
use super::{Arguments, Done, Failure, run_on};

/// Creates an empty folder.
fn folder(name: &str) -> PathBuf {
    let folder =
        std::env::temp_dir().join(format!("caustica-faults-{}-{name}", std::process::id()));
    if folder.exists() {
        fs::remove_dir_all(&folder).unwrap();
    }
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Arguments for a small render to `a.exr` in `folder`. A target error makes the steps independent
/// of time.
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

/// Renders on devices that fail as scripted, and optionally on another one that does not.
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

/// Image of a render without failures, and the steps of its device.
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
        // explicit device
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
                assert!(made <= 2, "step {number}: {made} passes lost");
                assert_eq!(failure.code(), 5, "step {number}");
                assert!(matches!(render(&folder, &kept, &[], true), Ok(Done::Fully)));
            }
        }
        assert!(pixels(&folder) == picture, "step {number}: other bits");
        // automatic device
        let _ = fs::remove_file(folder.join("a.exr"));
        let faulty = script(Some((number, FAULTS[number % FAULTS.len()])));
        assert!(matches!(render(&folder, &[], &[&faulty], true), Ok(Done::Fully)), "step {number}");
        assert!(pixels(&folder) == picture, "step {number}: other bits");
    }
    fs::remove_dir_all(&folder).unwrap();
}

/// Without --checkpoint, the checkpoint is written next to the image; an existing file is kept.
#[test]
fn work_is_kept_unasked() {
    let folder = folder("unasked");
    let (picture, steps) = whole("unasked", &[]);
    let fourth = (0..steps.len()).filter(|i| steps[*i] == Step::Pass).nth(3).unwrap();
    let fail = || render(&folder, &[], &[&script(Some((fourth, Fault::OutOfMemory)))], false);
    assert!(matches!(fail(), Ok(Done::DeviceLost)));
    let neighbor = folder.join("a.checkpoint");
    let kept = fs::read(&neighbor).unwrap();
    let resumed = ["--resume", neighbor.to_str().unwrap()];
    assert!(matches!(render(&folder, &resumed, &[], true), Ok(Done::Fully)));
    assert!(pixels(&folder) == picture);
    fs::write(&neighbor, b"another's").unwrap();
    assert!(matches!(fail(), Ok(Done::DeviceLost)));
    assert_eq!(fs::read(&neighbor).unwrap(), b"another's");
    assert_ne!(kept, b"another's");
    fs::remove_dir_all(&folder).unwrap();
}

/// A resumed render keeps its photon batches.
#[test]
fn batches_stay() {
    let folder = folder("batches");
    let (batched, steps) = whole("batches", &["--batch", "150"]);
    assert!(batched != whole("batches", &[]).0, "batches change rounding");
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
