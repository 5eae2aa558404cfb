//! Declarations of the kernels' buffers, the single table that plan, engines, memory accounting and
//! checkpoints read.

use super::super::kernels::aov_trace::AovPixel;
use super::super::kernels::records::{FilmPixel, Gathered, PhotonRecord, Statistics, VisiblePoint};
use super::super::kernels::resolve_parts::PartsPixel;
use super::super::tables::{Attributes, Node, Outline, Triangle};
use super::Plan;
use super::features::Feature;
use super::kernel::SCAN_BLOCK;
use crate::scene::Aov;

/// Buffer that kernels bind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Buffer {
    /// Short tables of the scene in one struct.
    Scene,
    /// Nodes of the kd-tree.
    Nodes,
    /// Shape references of the kd-tree's leaves.
    Refs,
    /// Triangles of meshes.
    Triangles,
    /// Normals, texture coordinates and outlines of triangles.
    Attributes,
    /// Outlines of flat shapes.
    Outlines,
    /// Texels of images.
    Texels,
    /// Visible points: the ends of the eye paths.
    VisiblePoints,
    /// Sums over the photons gathered at visible points in a pass.
    Gathered,
    /// Statistics of visible points under the local rule.
    Statistics,
    /// Running estimates of the pixels.
    Film,
    /// AOVs of the pixels.
    Aovs,
    /// Caustic and indirect radiance of the pixels.
    Parts,
    /// Counters of records, rays and photons of a pass; see `kernels/records.wgsl`.
    Counters,
    /// Photon records in the order in which they were written.
    Records,
    /// Photon records in bucket order.
    Sorted,
    /// Record indices in bucket order.
    Order,
    /// Number of records in each bucket.
    Counts,
    /// Index of the first record of each bucket; the last entry is the total.
    Starts,
    /// Number of records in each block of buckets.
    BlockSums,
}

/// Quantity that determines the number of a buffer's elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// Size of the scene's table.
    Scene,
    /// One element per visible point; chunks may have separate buffers.
    VisiblePoints,
    /// One element per pixel; chunks may have separate buffers.
    Pixels,
    /// One element per record of the capacity.
    Records,
    /// One element per bucket of the grid.
    Buckets,
    /// One element per bucket, plus one.
    BucketEnds,
    /// One element per block of [`SCAN_BLOCK`] buckets, plus one.
    Blocks,
    /// One element.
    One,
}

/// Time at which a buffer is filled with zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cleared {
    /// On allocation.
    Once,
    /// At the start of each tile of each pass.
    EachTile,
}

/// Declaration of a buffer.
#[derive(Clone, Copy, Debug)]
pub struct BufferInfo {
    /// Name in shaders, messages and reports.
    pub name: &'static str,
    /// WGSL type of an element.
    pub element: &'static str,
    /// Size of an element in bytes.
    pub element_bytes: usize,
    /// Quantity that determines the number of elements.
    pub extent: Extent,
    /// True if the host reads it.
    pub read_back: bool,
    /// True if a checkpoint contains it.
    pub checkpoint: bool,
    /// Time at which it is cleared.
    pub cleared: Cleared,
}

impl Buffer {
    /// All buffers, those of the scene first.
    pub const ALL: [Self; 20] = [
        Self::Scene,
        Self::Nodes,
        Self::Refs,
        Self::Triangles,
        Self::Attributes,
        Self::Outlines,
        Self::Texels,
        Self::VisiblePoints,
        Self::Film,
        Self::Gathered,
        Self::Counters,
        Self::Statistics,
        Self::Aovs,
        Self::Parts,
        Self::Records,
        Self::Sorted,
        Self::Order,
        Self::Counts,
        Self::Starts,
        Self::BlockSums,
    ];

    /// Declaration of the buffer.
    pub fn info(self) -> BufferInfo {
        use Extent::{Blocks, BucketEnds, Buckets, One, Pixels, Records, VisiblePoints};
        match self {
            Self::Scene => BufferInfo::new::<[u8; 1]>("scene", "SceneTables", Extent::Scene),
            Self::Nodes => BufferInfo::new::<Node>("nodes", "vec2u", Extent::Scene),
            Self::Refs => BufferInfo::new::<u32>("refs", "u32", Extent::Scene),
            Self::Triangles => BufferInfo::new::<Triangle>("triangles", "Triangle", Extent::Scene),
            Self::Attributes => {
                BufferInfo::new::<Attributes>("attributes", "Attributes", Extent::Scene)
            }
            Self::Outlines => BufferInfo::new::<Outline>("outlines", "Outline", Extent::Scene),
            Self::Texels => BufferInfo::new::<u32>("texels", "u32", Extent::Scene),
            Self::VisiblePoints => {
                BufferInfo::new::<VisiblePoint>("visible_points", "VisiblePoint", VisiblePoints)
            }
            // checkpoints store the counts, for the layer that shows them
            Self::Gathered => BufferInfo {
                read_back: true,
                checkpoint: true,
                cleared: Cleared::EachTile,
                ..BufferInfo::new::<Gathered>("gathered", "Gathered", VisiblePoints)
            },
            Self::Statistics => BufferInfo {
                read_back: true,
                checkpoint: true,
                ..BufferInfo::new::<Statistics>("statistics", "Statistics", VisiblePoints)
            },
            Self::Film => BufferInfo {
                read_back: true,
                checkpoint: true,
                ..BufferInfo::new::<FilmPixel>("film", "FilmPixel", Pixels)
            },
            Self::Aovs => BufferInfo {
                read_back: true,
                checkpoint: true,
                ..BufferInfo::new::<AovPixel>("aovs", "AovPixel", Pixels)
            },
            Self::Parts => BufferInfo {
                read_back: true,
                checkpoint: true,
                ..BufferInfo::new::<PartsPixel>("parts", "PartsPixel", Pixels)
            },
            Self::Counters => BufferInfo {
                read_back: true,
                cleared: Cleared::EachTile,
                ..BufferInfo::new::<[u32; 8]>("counters", "Counters", One)
            },
            Self::Records => BufferInfo::new::<PhotonRecord>("records", "PhotonRecord", Records),
            Self::Sorted => BufferInfo::new::<PhotonRecord>("sorted", "PhotonRecord", Records),
            Self::Order => BufferInfo::new::<u32>("order", "u32", Records),
            Self::Counts => BufferInfo::new::<u32>("counts", "u32", Buckets),
            Self::Starts => BufferInfo::new::<u32>("starts", "u32", BucketEnds),
            Self::BlockSums => BufferInfo::new::<u32>("block_sums", "u32", Blocks),
        }
    }

    /// Name in shaders, messages and reports.
    pub fn name(self) -> &'static str {
        self.info().name
    }

    /// Size of an element in bytes.
    pub fn element_bytes(self) -> usize {
        self.info().element_bytes
    }
}

impl BufferInfo {
    fn new<T>(name: &'static str, element: &'static str, extent: Extent) -> Self {
        Self {
            name,
            element,
            element_bytes: size_of::<T>(),
            extent,
            read_back: false,
            checkpoint: false,
            cleared: Cleared::Once,
        }
    }

    /// WGSL type of the buffer.
    pub fn wgsl_type(&self) -> String {
        match (self.extent, self.element) {
            (Extent::One, element) | (Extent::Scene, element @ "SceneTables") => element.to_owned(),
            (_, element) => format!("array<{element}>"),
        }
    }
}

impl Plan {
    /// Returns true if the plan needs `buffer`.
    pub fn needs(&self, buffer: Buffer) -> bool {
        let has = |feature| self.features.has(feature);
        match buffer {
            Buffer::Scene
            | Buffer::VisiblePoints
            | Buffer::Film
            | Buffer::Gathered
            | Buffer::Counters => true,
            Buffer::Nodes | Buffer::Refs => has(Feature::KdTree),
            Buffer::Triangles => has(Feature::Triangle),
            Buffer::Attributes => has(Feature::Attributes),
            Buffer::Outlines => has(Feature::Outlines),
            Buffer::Texels => has(Feature::Texels),
            Buffer::Statistics => has(Feature::Local),
            Buffer::Aovs => self.aovs.are_traced(),
            Buffer::Parts => self.parts_photons(),
            Buffer::Records
            | Buffer::Sorted
            | Buffer::Order
            | Buffer::Counts
            | Buffer::Starts
            | Buffer::BlockSums => has(Feature::Photons),
        }
    }

    /// Returns true if tiles share one buffer in turn. The counts in `gathered` are kept if a layer
    /// shows them.
    pub fn is_reused(&self, buffer: Buffer) -> bool {
        self.tiled
            && match buffer {
                Buffer::VisiblePoints => true,
                Buffer::Gathered => !self.aovs.has(Aov::Photons),
                _ => false,
            }
    }

    /// Returns true if each chunk has a separate buffer.
    pub fn is_per_chunk(&self, buffer: Buffer) -> bool {
        let extent = buffer.info().extent;
        matches!(extent, Extent::VisiblePoints | Extent::Pixels) && !self.is_reused(buffer)
    }

    /// Number of elements in a buffer other than the scene's; that of the largest chunk if chunks
    /// have separate buffers.
    pub fn elements(&self, buffer: Buffer) -> u64 {
        let points = u64::from(self.chunk(0).1);
        match buffer.info().extent {
            Extent::Scene => 0,
            Extent::VisiblePoints => points,
            Extent::Pixels => points / u64::from(self.eye_samples),
            Extent::Records => u64::from(self.capacity),
            Extent::Buckets => u64::from(self.buckets),
            Extent::BucketEnds => u64::from(self.buckets) + 1,
            Extent::Blocks => u64::from(self.buckets / SCAN_BLOCK) + 1,
            Extent::One => 1,
        }
    }

    /// Buffers other than the scene's and their sizes in bytes; for per-chunk buffers the size of
    /// the largest chunk.
    pub fn buffers(&self) -> Vec<(Buffer, u64)> {
        let own = |buffer: &Buffer| buffer.info().extent != Extent::Scene && self.needs(*buffer);
        let bytes = |buffer: Buffer| self.elements(buffer) * buffer.element_bytes() as u64;
        Buffer::ALL.into_iter().filter(own).map(|buffer| (buffer, bytes(buffer))).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::plan::features::Feature;
    use crate::plan::{Buffer, Cleared, Command, Kernel, Plan};
    use std::collections::BTreeSet;

    /// Theory: the tables are complete if every buffer is listed once, has a unique name, is bound
    /// by a kernel, and is cleared by a command if the table requires it.
    #[test]
    fn declarations_are_complete() {
        let names: BTreeSet<_> = Buffer::ALL.iter().map(|buffer| buffer.name()).collect();
        assert_eq!(names.len(), Buffer::ALL.len());
        let all = Feature::all().collect();
        let bound: BTreeSet<Buffer> = Kernel::ALL
            .iter()
            .flat_map(|kernel| kernel.uses(all))
            .map(|used| used.buffer)
            .collect();
        assert_eq!(bound, Buffer::ALL.into_iter().collect());
        let mut loaded = crate::scene::load("scenes/cornell.toml".as_ref()).unwrap();
        (loaded.scene.film.width, loaded.scene.film.height) = (8, 8);
        loaded.settings.photons = 100;
        let packed = crate::pilots::prepare(&loaded.scene, 8, 8).unwrap();
        let plan = Plan::probed(&packed, &loaded.settings);
        for commands in plan.commands(0, plan.batch_photons) {
            let cleared = commands.iter().filter_map(|command| match command {
                Command::ClearGathered { .. } => Some(Buffer::Gathered),
                Command::ClearCounters => Some(Buffer::Counters),
                _ => None,
            });
            let cleared: BTreeSet<_> = cleared.collect();
            let declared =
                Buffer::ALL.into_iter().filter(|buffer| buffer.info().cleared == Cleared::EachTile);
            assert_eq!(cleared, declared.collect());
        }
    }
}
