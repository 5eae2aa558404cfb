//! Speed against accuracy: one scene rendered with a grid of settings and several seeds, measured
//! against a truth while it gets better, and told as curves, tables and a page.
//!
//! [`grid`] says which settings there are, [`truth`] what they are held against, [`render`] makes
//! one progressive render with snapshots, [`conduct`] goes through all of them and keeps what it
//! has in a [`folder`]. [`statistics`] and [`analysis`] make figures of that, [`axis`], [`chart`]
//! and [`panels`] pictures, [`tables`] and [`report`] the files. docs/study.md tells how to read
//! them.

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

/// Why a study cannot go on.
#[derive(Debug, Error)]
pub enum StudyError {
    /// A setting of the grid that does not exist or cannot have this value.
    #[error(transparent)]
    Grid(#[from] grid::GridError),
    /// A device that is not there, or that cannot render this.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// A render that failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// A picture that cannot be read or a file that cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A truth that the renders cannot be held against.
    #[error(transparent)]
    Metrics(#[from] MetricsError),
    /// A folder that holds something else.
    #[error("{}: {what}", folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What it holds.
        what: String,
    },
    /// Surfaces that the scene lacks, or that cannot be as the grid asks.
    #[error("{choice}: {what}")]
    Variant {
        /// As the grid has it, as in `lamp_area=point`.
        choice: String,
        /// Why not.
        what: String,
    },
}
