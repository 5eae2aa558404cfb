//! Studies of speed against accuracy: renders a scene with a grid of settings and several seeds,
//! measures the error against a reference (the *truth*) as the renders progress, and reports the
//! results as curves, tables and an HTML page.
//!
//! [`grid`] defines the settings and [`truth`] the reference. [`render`] performs a progressive
//! render with snapshots, [`conduct`] runs all renders and stores the results in a [`folder`].
//! [`statistics`] and [`analysis`] evaluate them, [`axis`], [`chart`] and [`panels`] draw charts,
//! [`tables`] and [`report`] write files. docs/study.md explains how to read them.

pub mod analysis;
pub mod axis;
pub mod chart;
pub mod conduct;
pub mod crop;
pub mod folder;
pub mod grid;
pub mod lamps;
pub mod palette;
pub mod panels;
pub mod render;
pub mod report;
pub mod revolutions;
pub mod statistics;
pub mod tables;
pub mod truth;
pub mod variant;
pub mod words;

use std::path::PathBuf;

use thiserror::Error;

use crate::device::DeviceError;
use crate::engine::EngineError;
use crate::film::FileError;
use crate::film::metrics::MetricsError;

/// Error that ends a study.
#[derive(Debug, Error)]
pub enum StudyError {
    /// Invalid setting or value in the grid.
    #[error(transparent)]
    Grid(#[from] grid::GridError),
    /// The device does not exist or cannot render the scene.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// A render failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The reference cannot be compared with the renders.
    #[error(transparent)]
    Metrics(#[from] MetricsError),
    /// The folder contains other files or a different study.
    #[error("{}: {what}", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Description of the problem.
        what: String,
    },
    /// The scene does not support a variant of the grid.
    #[error("{choice}: {what}")]
    Variant {
        /// Choice in the notation of the grid, such as `lamp_area=point`.
        choice: String,
        /// Reason.
        what: String,
    },
}
