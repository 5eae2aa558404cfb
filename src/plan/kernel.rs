//! Declarations of the kernels, one per kernel, which shader composition, binding layouts, setup,
//! bench and ablation read.

use super::buffer::Buffer;
use super::features::{Feature, Features};

/// Number of buckets that one workgroup of the scan kernels covers, and the greatest number of
/// blocks.
pub const SCAN_BLOCK: u32 = 4096;
/// Number of buckets that one workgroup of [`Kernel::GridSortLong`] examines.
pub const SORT_BUCKETS: u32 = 256;
/// Number of items that one workgroup of most kernels covers.
const WORKGROUP: u32 = 64;

/// Kernel of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kernel {
    /// Traces eye paths to visible points.
    EyeTrace,
    /// Traces eye paths for the AOVs.
    AovTrace,
    /// Traces photon paths to records.
    PhotonTrace,
    /// Counts the records per bucket.
    GridCount,
    /// Sums the counts in blocks of buckets.
    GridScanReduce,
    /// Computes the exclusive prefix sums of the blocks' sums.
    GridScanSums,
    /// Computes the exclusive prefix sums of the buckets' counts.
    GridScan,
    /// Puts the record indices into bucket order.
    GridScatter,
    /// Sorts each short bucket by key.
    GridSort,
    /// Sorts each long bucket by key.
    GridSortLong,
    /// Computes the density estimates.
    Gather,
    /// Adds the photons' radiance to the layers, by photon class.
    ResolveParts,
    /// Adds the estimates to the film.
    Resolve,
}

/// Items that a kernel runs over: the range of its dispatch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Over {
    /// Visible points of a chunk.
    VisiblePoints,
    /// Pixels of a chunk.
    Pixels,
    /// Photons of a batch.
    Photons,
    /// Records of the capacity; the kernel stops at the count in `counters`.
    Records,
    /// Buckets of the grid.
    Buckets,
    /// Blocks of [`SCAN_BLOCK`] buckets.
    Blocks,
}

/// Access of a kernel to a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Reads elements.
    Read,
    /// Reads elements as vectors of four words.
    ReadVectors,
    /// Reads and writes elements.
    Write,
    /// Reads and writes words by atomic operations.
    Atomic,
}

/// Binding of a buffer to a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Use {
    /// Buffer that is bound.
    pub buffer: Buffer,
    /// Access to the buffer.
    pub access: Access,
    /// Feature that the binding requires, if any.
    pub feature: Option<Feature>,
}

impl Use {
    /// Returns true if the kernel only reads the buffer.
    pub const fn is_read_only(self) -> bool {
        matches!(self.access, Access::Read | Access::ReadVectors)
    }
}

/// Declaration of a kernel.
#[derive(Clone, Copy, Debug)]
pub struct KernelInfo {
    /// Stem of its shader file, which is also its entry point and label.
    pub stem: &'static str,
    /// Items that it runs over.
    pub over: Over,
    /// Number of items that one workgroup covers; dispatches start at multiples of it.
    pub workgroup_items: u32,
    /// True if it traces rays, and therefore binds the scene.
    pub traces: bool,
    /// Buffers that it binds after those of the scene.
    pub uses: &'static [Use],
}

const fn read(buffer: Buffer) -> Use {
    Use { buffer, access: Access::Read, feature: None }
}

const fn write(buffer: Buffer) -> Use {
    Use { buffer, access: Access::Write, feature: None }
}

const fn atomic(buffer: Buffer) -> Use {
    Use { buffer, access: Access::Atomic, feature: None }
}

const fn with(feature: Feature, used: Use) -> Use {
    Use { feature: Some(feature), ..used }
}

/// Buffers of the scene, for kernels that trace rays.
const SCENE: &[Use] = &[
    read(Buffer::Scene),
    with(Feature::KdTree, read(Buffer::Nodes)),
    with(Feature::KdTree, read(Buffer::Refs)),
    with(Feature::Triangle, read(Buffer::Triangles)),
    with(Feature::Attributes, read(Buffer::Attributes)),
    with(Feature::Texels, read(Buffer::Texels)),
];

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

    /// Declaration of the kernel.
    pub const fn info(self) -> KernelInfo {
        use Buffer::*;
        match self {
            Self::EyeTrace => KernelInfo {
                stem: "eye_trace",
                over: Over::VisiblePoints,
                workgroup_items: WORKGROUP,
                traces: true,
                uses: const { &[write(VisiblePoints), write(Counters)] },
            },
            Self::AovTrace => KernelInfo {
                stem: "aov_trace",
                over: Over::Pixels,
                workgroup_items: WORKGROUP,
                traces: true,
                uses: const { &[write(Aovs), write(Counters)] },
            },
            Self::PhotonTrace => KernelInfo {
                stem: "photon_trace",
                over: Over::Photons,
                workgroup_items: WORKGROUP,
                traces: true,
                uses: const { &[write(Records), write(Counters)] },
            },
            Self::GridCount => KernelInfo {
                stem: "grid_count",
                over: Over::Records,
                workgroup_items: WORKGROUP,
                traces: false,
                uses: const { &[read(Records), write(Counters), atomic(Counts)] },
            },
            Self::GridScanReduce => KernelInfo {
                stem: "grid_scan_reduce",
                over: Over::Buckets,
                workgroup_items: SCAN_BLOCK,
                traces: false,
                uses: const { &[write(Counts), write(BlockSums)] },
            },
            Self::GridScanSums => KernelInfo {
                stem: "grid_scan_sums",
                over: Over::Blocks,
                workgroup_items: SCAN_BLOCK,
                traces: false,
                uses: const { &[write(BlockSums)] },
            },
            Self::GridScan => KernelInfo {
                stem: "grid_scan",
                over: Over::Buckets,
                workgroup_items: SCAN_BLOCK,
                traces: false,
                uses: const { &[write(Counts), write(BlockSums), write(Starts)] },
            },
            Self::GridScatter => KernelInfo {
                stem: "grid_scatter",
                over: Over::Records,
                workgroup_items: WORKGROUP,
                traces: false,
                uses: const {
                    &[read(Records), write(Counters), atomic(Counts), read(Starts), write(Order)]
                },
            },
            Self::GridSort => KernelInfo {
                stem: "grid_sort",
                over: Over::Buckets,
                workgroup_items: WORKGROUP,
                traces: false,
                uses: const { &[read(Records), read(Starts), write(Order), write(Sorted)] },
            },
            Self::GridSortLong => KernelInfo {
                stem: "grid_sort_long",
                over: Over::Buckets,
                workgroup_items: SORT_BUCKETS,
                traces: false,
                uses: const {
                    &[read(Records), write(Counters), read(Starts), write(Order), write(Sorted)]
                },
            },
            Self::Gather => KernelInfo {
                stem: "gather",
                over: Over::VisiblePoints,
                workgroup_items: WORKGROUP,
                traces: false,
                uses: const {
                    &[
                        with(Feature::LobeParameters, read(Scene)),
                        with(Feature::Outlines, read(Outlines)),
                        read(VisiblePoints),
                        write(Counters),
                        read(Starts),
                        Use { buffer: Sorted, access: Access::ReadVectors, feature: None },
                        write(Gathered),
                        with(Feature::Local, read(Statistics)),
                    ]
                },
            },
            Self::ResolveParts => KernelInfo {
                stem: "resolve_parts",
                over: Over::Pixels,
                workgroup_items: WORKGROUP,
                traces: false,
                uses: const {
                    &[
                        read(VisiblePoints),
                        read(Gathered),
                        write(Parts),
                        with(Feature::Local, read(Statistics)),
                    ]
                },
            },
            Self::Resolve => KernelInfo {
                stem: "resolve",
                over: Over::Pixels,
                workgroup_items: WORKGROUP,
                traces: false,
                uses: const {
                    &[
                        read(VisiblePoints),
                        read(Gathered),
                        write(Film),
                        with(Feature::Local, write(Statistics)),
                    ]
                },
            },
        }
    }

    /// File stem and entry point.
    pub const fn stem(self) -> &'static str {
        self.info().stem
    }

    /// Buffers that the kernel binds with these features, in binding order.
    pub fn uses(self, features: Features) -> impl Iterator<Item = Use> {
        let info = self.info();
        let scene = if info.traces { SCENE } else { &[] };
        let needed = move |used: &Use| used.feature.is_none_or(|feature| features.has(feature));
        scene.iter().chain(info.uses).copied().filter(needed)
    }
}
