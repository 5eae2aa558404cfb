//! The kernels of a pass, and one dispatch of one.

use super::super::features::{Feature, Features};
use super::super::kernels::records::Dispatch;

/// A kernel: the stem of its shader file, of its Rust twin and its entry point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kernel {
    /// Eye paths to visible points.
    EyeTrace,
    /// Eye paths to what a picture shows beside radiance.
    AovTrace,
    /// Photon paths to records.
    PhotonTrace,
    /// Records per bucket.
    GridCount,
    /// Sums of blocks of buckets.
    GridScanReduce,
    /// Exclusive prefix sums of the blocks' sums.
    GridScanSums,
    /// Exclusive prefix sums of the buckets.
    GridScan,
    /// Records into bucket order.
    GridScatter,
    /// Each short bucket into the order of its keys.
    GridSort,
    /// Each long one.
    GridSortLong,
    /// Density estimates.
    Gather,
    /// What photons bring, by the way they came.
    ResolveParts,
    /// Estimates into the film.
    Resolve,
}

/// Buckets that one workgroup of the scan kernels covers; the same number of blocks is the most
/// there may be.
pub const SCAN_BLOCK: u32 = 4096;
/// Buckets that one workgroup of [`Kernel::GridSortLong`] looks through.
pub const SORT_BUCKETS: u32 = 256;

impl Kernel {
    /// All kernels, in the order of a pass.
    pub const ALL: [Self; 13] = [
        Self::EyeTrace,
        Self::AovTrace,
        Self::PhotonTrace,
        Self::GridCount,
        Self::GridScanReduce,
        Self::GridScanSums,
        Self::GridScan,
        Self::GridScatter,
        Self::GridSort,
        Self::GridSortLong,
        Self::Gather,
        Self::ResolveParts,
        Self::Resolve,
    ];

    /// File stem and entry point.
    pub fn stem(self) -> &'static str {
        match self {
            Self::EyeTrace => "eye_trace",
            Self::AovTrace => "aov_trace",
            Self::PhotonTrace => "photon_trace",
            Self::GridCount => "grid_count",
            Self::GridScanReduce => "grid_scan_reduce",
            Self::GridScanSums => "grid_scan_sums",
            Self::GridScan => "grid_scan",
            Self::GridScatter => "grid_scatter",
            Self::GridSort => "grid_sort",
            Self::GridSortLong => "grid_sort_long",
            Self::Gather => "gather",
            Self::ResolveParts => "resolve_parts",
            Self::Resolve => "resolve",
        }
    }

    /// The buffers it binds beside the scene's (see [`Plan::buffers`](super::Plan::buffers)) and
    /// whether it writes them.
    pub fn buffers(self, features: &Features) -> Vec<(&'static str, bool)> {
        let mut list = match self {
            Self::EyeTrace => vec![("visible_points", true), ("counters", true)],
            Self::AovTrace => vec![("aovs", true), ("counters", true)],
            Self::PhotonTrace => vec![("records", true), ("counters", true)],
            Self::GridCount => vec![("records", false), ("counters", true), ("counts", true)],
            Self::GridScanReduce => vec![("counts", true), ("block_sums", true)],
            Self::GridScanSums => vec![("block_sums", true)],
            Self::GridScan => vec![("counts", true), ("block_sums", true), ("starts", true)],
            Self::GridScatter => {
                vec![
                    ("records", false),
                    ("counters", true),
                    ("counts", true),
                    ("starts", false),
                    ("order", true),
                ]
            }
            Self::GridSort => {
                vec![("records", false), ("starts", false), ("order", true), ("sorted", true)]
            }
            Self::GridSortLong => vec![
                ("records", false),
                ("counters", true),
                ("starts", false),
                ("order", true),
                ("sorted", true),
            ],
            Self::Gather => {
                vec![
                    ("visible_points", false),
                    ("counters", true),
                    ("starts", false),
                    ("sorted", false),
                    ("gathered", true),
                ]
            }
            Self::ResolveParts => {
                vec![("visible_points", false), ("gathered", false), ("parts", true)]
            }
            Self::Resolve => vec![("visible_points", false), ("gathered", false), ("film", true)],
        };
        if features.has(Feature::Local)
            && matches!(self, Self::Gather | Self::ResolveParts | Self::Resolve)
        {
            list.push(("statistics", self == Self::Resolve));
        }
        list
    }

    /// Whether it reads the flattened scene.
    pub fn reads_scene(self) -> bool {
        matches!(self, Self::EyeTrace | Self::AovTrace | Self::PhotonTrace)
    }
}

/// One dispatch of a kernel over `dispatch.first..dispatch.end`.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// What runs.
    pub kernel: Kernel,
    /// Which chunk's `visible_points`, `gathered`, `statistics` and `film` it binds.
    pub chunk: u32,
    /// Its numbers. Kernels over records run over the whole capacity and stop at the count in
    /// `counters`.
    pub dispatch: Dispatch,
}
