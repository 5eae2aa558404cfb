//! Renders that are killed at random moments and resumed.
//!
//! Theory: the checkpoint's name always refers to a complete file or to none. After any kill the
//! file is readable and never holds fewer passes than before, and the render that finally finishes
//! writes the bytes of an uninterrupted one.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use caustica::low_level::checkpoint::{read, write};
use caustica::low_level::film::file::read_exr;

use super::{folder, good};
use crate::support::{Running, interruptible, names, words};

/// Random numbers in [0, 1) from a linear congruential generator.
struct Chance(u64);

impl Chance {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / (1u64 << 24) as f64
    }
}

/// Options for a crop with all layers.
const WINDOW: &str = "--crop 5,3,20,14 --aov all";

/// How the processes ended.
#[derive(Debug, Default)]
struct Tally {
    /// Killed by signal 9.
    killed: u32,
    /// Ended by signal 15, after the current pass.
    terminated: u32,
    /// Ended after at least one pass and before the last.
    midway: u32,
}

/// Runs `line` until it finishes, in as many processes as needed. Each runs on the next of
/// `devices` and is ended after a random time.
fn through_kills(
    folder: &Path,
    line: &str,
    devices: &[&str],
    chance: &mut Chance,
    tally: &mut Tally,
) {
    let file = folder.join("a.checkpoint");
    let _ = fs::remove_file(&file);
    let (mut passes, mut wait) = (0, 0.2);
    for life in 0.. {
        let resume = if file.exists() { "--resume a.checkpoint" } else { "" };
        let device = devices[life % devices.len()];
        let keep = "--checkpoint a.checkpoint --checkpoint-every 1ms --quiet";
        let line = format!("{line} --device {device} {keep} {resume} -o a.exr");
        let mut child = Running::start(
            interruptible(folder, &words(&line)).stdout(Stdio::null()).stderr(Stdio::null()),
        );
        std::thread::sleep(Duration::from_secs_f64(wait * chance.next()));
        let signal = if chance.next() < 0.7 { "-9" } else { "-15" };
        let sent = Command::new("kill").args([signal, &child.id().to_string()]).status();
        let code = child.wait().unwrap().code();
        let before = passes;
        if file.exists() {
            let checkpoint = read(&file).unwrap_or_else(|error| panic!("{error}"));
            passes = checkpoint.state.passes;
            assert!(passes >= before, "{passes} {before}");
        }
        if code == Some(0) {
            return;
        }
        assert!(sent.unwrap().success() && matches!(code, None | Some(130)), "{code:?}");
        let count = if signal == "-9" { &mut tally.killed } else { &mut tally.terminated };
        *count += 1;
        tally.midway += u32::from(passes > before);
        // adapt to the machine's speed: most processes finish a few passes
        wait *= if passes == before { 1.3 } else { 0.8 };
    }
}

fn channels(folder: &Path, file: &str) -> std::collections::BTreeMap<String, Vec<f32>> {
    read_exr(&folder.join(file)).unwrap().channels
}

#[test]
fn ends_in_the_same_bytes() {
    let folder = folder("kills");
    let mut chance = Chance(1);
    let mut tally = Tally::default();
    let lines = ["--radius-rule local", "--method ppm", "--target-error 2.5%", WINDOW];
    for (number, options) in lines.iter().enumerate() {
        let line = format!("render ball.toml {options}");
        good(&folder, &format!("{line} --device cpu --quiet -o whole.exr"));
        let want = 14 * (number as u32 + 1);
        while tally.killed + tally.terminated < want {
            through_kills(&folder, &line, &["cpu"], &mut chance, &mut tally);
            assert!(
                fs::read(folder.join("a.exr")).unwrap()
                    == fs::read(folder.join("whole.exr")).unwrap(),
                "{options}: {tally:?}"
            );
            assert!(channels(&folder, "a.exr").contains_key("Variance.Y"));
        }
    }
    println!("{tally:?}");
    assert!(tally.killed > 10 && tally.terminated > 3 && tally.midway > 10, "{tally:?}");
    let mut left = names(&folder);
    // the next render removes temporary files of a killed checkpoint writer; those of an image may
    // stay
    left.retain(|name| {
        assert!(!name.ends_with(".lock"), "{name}");
        !name.starts_with(".caustica-")
    });
    assert_eq!(left, ["a.checkpoint", "a.exr", "ball.toml", "wall.obj", "whole.exr"]);
}

/// Each process runs on another device: lavapipe resumes what the CPU started, and the reverse.
#[test]
fn ends_in_the_same_bits_on_changing_devices() {
    let folder = folder("kills on devices");
    let mut chance = Chance(7);
    for options in ["--radius-rule local", WINDOW] {
        let line = format!("render ball.toml --passes 40 {options}");
        good(&folder, &format!("{line} --device software --quiet -o whole.exr"));
        for devices in [&["software"][..], &["cpu", "software"]] {
            let mut tally = Tally::default();
            while tally.midway < 3 {
                through_kills(&folder, &line, devices, &mut chance, &mut tally);
                assert!(
                    channels(&folder, "a.exr") == channels(&folder, "whole.exr"),
                    "{options} {devices:?}: {tally:?}"
                );
            }
            println!("{options} {devices:?}: {tally:?}");
        }
    }
}

/// The comparison detects a checkpoint that counts one pass more than it holds.
#[test]
fn a_pass_left_out_is_seen() {
    let folder = folder("a pass left out");
    let file = folder.join("a.checkpoint");
    let line = "render ball.toml --device cpu --quiet";
    good(&folder, &format!("{line} -o whole.exr"));
    good(&folder, &format!("{line} --passes 10 --checkpoint a.checkpoint -o early.exr"));
    let mut checkpoint = read(&file).unwrap();
    good(&folder, &format!("{line} --resume a.checkpoint -o a.exr"));
    assert!(channels(&folder, "a.exr") == channels(&folder, "whole.exr"));
    checkpoint.state.passes += 1;
    write(&file, &checkpoint).unwrap();
    good(&folder, &format!("{line} --resume a.checkpoint -o a.exr"));
    assert!(channels(&folder, "a.exr") != channels(&folder, "whole.exr"));
}
