//! A thread that reads the scene anew whenever one of its files changes.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread;
use std::time::Duration;

use super::document::Watch;
use crate::scene::{Allowance, Loaded, SceneErrors, load_within};

/// Time between looks.
const EVERY: Duration = Duration::from_millis(250);

/// What a file that changed has become.
pub type Reloaded = Result<Loaded, SceneErrors>;

/// What is done to a scene when it has been read, such as to put the command line's options in
/// force.
pub type Adjust = Box<dyn Fn(&mut Loaded) + Send>;

/// Looks at a scene's files; ends when dropped.
pub struct Reloader {
    found: Receiver<Reloaded>,
    _alive: Sender<()>,
}

impl Reloader {
    /// Looks at `file` and at the `files` that it names; reads no more than is allowed.
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
                // a file that a faulty scene does not name any more may be the one that mends it
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

    /// The scene as it was read last, if it was since this was last asked for.
    pub fn take(&self) -> Option<Reloaded> {
        self.found.try_iter().last()
    }
}

fn with(file: &Path, mut files: Vec<PathBuf>) -> Vec<PathBuf> {
    files.push(file.to_owned());
    files
}
