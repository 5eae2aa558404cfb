//! Errors and warnings with their positions in the source. This module knows no scene format;
//! importers, checks and image readers report through it.
//!
//! A [`Report`] collects the findings of one load. A reader of a file that a scene names, such as
//! a mesh, collects [`Faults`] and passes them to the report, which adds where the scene names the
//! file.

mod faults;
mod finding;
mod findings;
mod report;
mod similar;
mod source;

pub(crate) use faults::Faults;
pub use finding::{Finding, SceneErrors};
pub(crate) use report::Report;
pub(crate) use similar::{did_you_mean, list, nearest, nearest_file};
pub(crate) use source::SourceFile;
