//! Fuzzer for all file readers: `cargo run --release --example fuzz -- --seconds 60 scene obj`.
//! docs/hostile-input.md describes the findings and the memory limits.
//!
//! Inputs are mutated seeds. An input with a new outcome (its error message without names and
//! numbers) is added to the seeds. A panic, or a run that exceeds the time limit, is a finding; its
//! input is saved in the folder `fuzz-findings`.

mod mutate;
mod seeds;
mod targets;

use std::collections::HashSet;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use clap::Parser;

use mutate::Mutator;
use targets::{MORE, Target};

/// Fuzz file readers with mutated files.
#[derive(Parser)]
struct Arguments {
    /// Targets: scene, plan, obj, mtl, ply, texture, profile, checkpoint [default: all]
    targets: Vec<Target>,
    /// Seconds per target
    #[arg(long, default_value_t = 60)]
    seconds: u64,
    /// Maximum number of runs per target
    #[arg(long, default_value_t = u64::MAX)]
    runs: u64,
    /// Time limit of a run in milliseconds
    #[arg(long, default_value_t = 2000)]
    most_ms: u64,
    /// Random seed
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Number of threads
    #[arg(long, default_value_t = 1)]
    threads: u64,
    /// Read each of these files once instead of mutated ones
    #[arg(long)]
    replay: Vec<PathBuf>,
}

/// Maximum length of an input in bytes.
const LONGEST: usize = 16 << 10;
/// Time after which a run is assumed to hang.
const HANG: Duration = Duration::from_secs(60);

/// State shared by all threads of a target.
struct Shared {
    target: Target,
    corpus: Mutex<Vec<Vec<u8>>>,
    outcomes: Mutex<HashSet<u64>>,
    reported: Mutex<HashSet<String>>,
    runs: AtomicU64,
    accepted: AtomicU64,
    findings: AtomicU64,
}

fn main() {
    let mut arguments = Arguments::parse();
    if arguments.targets.is_empty() {
        arguments.targets = Target::ALL.to_vec();
    }
    std::panic::set_hook(Box::new(|info| {
        *LAST_PANIC.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = info.to_string();
    }));
    let mut findings = 0;
    for &target in &arguments.targets {
        findings += fuzz(target, &arguments);
    }
    if findings > 0 {
        std::process::exit(1);
    }
}

static LAST_PANIC: Mutex<String> = Mutex::new(String::new());

fn fuzz(target: Target, arguments: &Arguments) -> u64 {
    let corpus = match arguments.replay.as_slice() {
        [] => seeds::of(target),
        files => files.iter().map(|file| fs::read(file).expect("a readable file")).collect(),
    };
    let shared = Shared {
        target,
        corpus: Mutex::new(corpus),
        outcomes: Mutex::default(),
        reported: Mutex::default(),
        runs: AtomicU64::new(0),
        accepted: AtomicU64::new(0),
        findings: AtomicU64::new(0),
    };
    let start = Instant::now();
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..arguments.threads)
            .map(|index| {
                let shared = &shared;
                let current: &Mutex<(Instant, Vec<u8>)> =
                    Box::leak(Box::new(Mutex::new((Instant::now(), Vec::new()))));
                let done: &AtomicBool = Box::leak(Box::new(AtomicBool::new(false)));
                scope.spawn(move || {
                    work(shared, index, arguments, start, current);
                    done.store(true, Ordering::Relaxed);
                });
                (current, done)
            })
            .collect();
        while workers.iter().any(|(_, done)| !done.load(Ordering::Relaxed)) {
            std::thread::sleep(Duration::from_millis(100));
            for (current, _) in workers.iter().filter(|(_, done)| !done.load(Ordering::Relaxed)) {
                let (since, input) = &*current.lock().unwrap();
                if since.elapsed() > HANG {
                    shared.keep("hang", input);
                    std::process::exit(1);
                }
            }
        }
    });
    let [runs, accepted, findings] = [&shared.runs, &shared.accepted, &shared.findings]
        .map(|count| count.load(Ordering::Relaxed));
    println!(
        "{target:?}: {runs} runs in {:.0} s, {accepted} accepted, {} outcomes, {findings} findings",
        start.elapsed().as_secs_f64(),
        shared.outcomes.lock().unwrap().len(),
    );
    findings
}

fn work(
    shared: &Shared,
    index: u64,
    arguments: &Arguments,
    start: Instant,
    current: &Mutex<(Instant, Vec<u8>)>,
) {
    let folder = seeds::folder(&format!("{:?}-{}-{index}", shared.target, std::process::id()));
    let mut mutator = Mutator::new(arguments.seed.wrapping_mul(1000) + index);
    let replayed = arguments.replay.len() as u64;
    let end = if replayed > 0 { replayed } else { arguments.runs };
    while start.elapsed().as_secs() < arguments.seconds {
        let run = shared.runs.fetch_add(1, Ordering::Relaxed);
        if run >= end {
            shared.runs.fetch_sub(1, Ordering::Relaxed);
            break;
        }
        let input = {
            let corpus = shared.corpus.lock().unwrap();
            // first each seed unchanged, then mutated ones
            match corpus.get(run as usize) {
                Some(seed) if run < corpus.len() as u64 => seed.clone(),
                _ => mutator.mutate(&corpus, LONGEST),
            }
        };
        let input = shared.target.finish(input, &mut mutator);
        *current.lock().unwrap() = (Instant::now(), input.clone());
        shared.one(&folder, &input, Duration::from_millis(arguments.most_ms));
    }
    let _ = fs::remove_dir_all(folder);
}

impl Shared {
    fn one(&self, folder: &Path, input: &[u8], most: Duration) {
        let run = || {
            let start = Instant::now();
            (catch_unwind(AssertUnwindSafe(|| self.target.run(folder, input))), start.elapsed())
        };
        let (outcome, mut took) = run();
        if took > most {
            // repeat, since the machine may have been busy
            took = took.min(run().1);
        }
        let Ok(outcome) = outcome else {
            let message =
                LAST_PANIC.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).clone();
            return self.keep(&message, input);
        };
        if took > most {
            self.keep(&format!("a run of {:.0} s", took.as_secs_f64()), input);
        }
        self.accepted.fetch_add(u64::from(outcome.is_empty()), Ordering::Relaxed);
        if outcome.contains(MORE) {
            return;
        }
        let mut hasher = DefaultHasher::new();
        outcome.hash(&mut hasher);
        if self.outcomes.lock().unwrap().insert(hasher.finish()) {
            self.corpus.lock().unwrap().push(input.to_vec());
        }
    }

    /// Saves the input of a finding, once for each message.
    fn keep(&self, message: &str, input: &[u8]) {
        self.findings.fetch_add(1, Ordering::Relaxed);
        let place: String = message.chars().filter(|c| !c.is_ascii_digit()).take(160).collect();
        let mut reported = self.reported.lock().unwrap();
        if !reported.insert(place) {
            return;
        }
        let file =
            PathBuf::from("fuzz-findings").join(format!("{:?}-{}", self.target, reported.len()));
        let kept = fs::create_dir_all("fuzz-findings").and_then(|()| fs::write(&file, input));
        println!("{}: {message} ({kept:?})", file.display());
    }
}
