//! Watcher thread that loads the scene again when one of its files changes.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread;
use std::time::Duration;

use super::document::Watch;
use crate::scene::{Allowance, Loaded, SceneErrors, load_within};

/// Time between checks.
const EVERY: Duration = Duration::from_millis(250);

/// Result of loading a changed scene.
pub type Reloaded = Result<Loaded, SceneErrors>;

/// Adjusts a scene after each load, for example by applying command-line options.
pub type Adjust = Box<dyn Fn(&mut Loaded) + Send>;

/// Watches a scene's files; the thread ends when this is dropped.
pub struct Reloader {
    found: Receiver<Reloaded>,
    _alive: Sender<()>,
}

impl Reloader {
    /// Watches `file` and the `files` that it names; loads them within `allowance`.
    pub fn start(
        file: PathBuf,
        files: Vec<PathBuf>,
        allowance: Allowance,
        adjust: Adjust,
        wake: impl Fn() + Send + 'static,
    ) -> Self {
        let (sender, found) = mpsc::channel();
        let (alive, end) = mpsc::channel::<()>();
        thread::spawn(move || {
            let mut watch = Watch::new(with(&file, files.clone()));
            let mut known = files;
            while let Err(RecvTimeoutError::Timeout) = end.recv_timeout(EVERY) {
                if !watch.changed() {
                    continue;
                }
                let loaded = load_within(&file, &allowance).map(|mut loaded| {
                    adjust(&mut loaded);
                    loaded
                });
                // a file that a faulty scene does not name may be the one that repairs it, so keep
                // watching it
                match &loaded {
                    Ok(loaded) => known.clone_from(&loaded.files),
                    Err(errors) => known.extend_from_slice(&errors.files),
                }
                watch.follow(with(&file, known.clone()));
                if sender.send(loaded).is_err() {
                    break;
                }
                wake();
            }
        });
        Self { found, _alive: alive }
    }

    /// The scene as it was last loaded, if it was loaded since the last call.
    pub fn take(&self) -> Option<Reloaded> {
        self.found.try_iter().last()
    }
}

fn with(file: &Path, mut files: Vec<PathBuf>) -> Vec<PathBuf> {
    files.push(file.to_owned());
    files
}
