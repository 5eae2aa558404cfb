//! The hash grid's kernels on the software driver against a naive loop.
//!
//! Theory: the grid is right if `starts` are the naive prefix sums and `sorted` holds, bucket by
//! bucket, the records in the order of their keys. Keys differ, so this determines every bit.
//! Output buffers are poisoned first, so that elements that no invocation wrote are detected.

use crate::support::software;
use bytemuck::{Zeroable, cast_slice, pod_collect_to_vec};
use caustica::low_level::gpu::Gpu;
use caustica::low_level::gpu::layout::SceneLayout;
use caustica::low_level::gpu::program::Program;
use caustica::low_level::gpu::recorder::Recorder;
use caustica::low_level::kernels::grid_build::{record_bucket, record_code};
use caustica::low_level::kernels::records::{Dispatch, PhotonRecord};
use caustica::low_level::plan::features::{Feature, Features};
use caustica::low_level::plan::{Buffer, Kernel, SCAN_BLOCK};
use glam::Vec3;
use std::collections::BTreeMap;

const POISON: u32 = 0xdead_beef;
const KERNELS: [Kernel; 7] = [
    Kernel::GridCount,
    Kernel::GridScanReduce,
    Kernel::GridScanSums,
    Kernel::GridScan,
    Kernel::GridScatter,
    Kernel::GridSort,
    Kernel::GridSortLong,
];

struct Grid {
    gpu: Gpu,
    recorder: Recorder,
    programs: Vec<Program>,
}

/// The output of the kernels.
struct Built {
    counts: Vec<u32>,
    starts: Vec<u32>,
    sorted: Vec<PhotonRecord>,
}

impl Grid {
    fn new() -> Self {
        let gpu = Gpu::open(&software()).unwrap();
        let recorder = Recorder::new(&gpu).unwrap();
        let features = Features::default().with(Feature::Photons);
        let programs = KERNELS
            .map(|kernel| Program::new(&gpu, kernel, &features, &SceneLayout::default()).unwrap())
            .into();
        Self { gpu, recorder, programs }
    }

    /// Runs the kernels, each in dispatches of at most `piece` items.
    fn build(&mut self, records: &[PhotonRecord], d: &Dispatch, piece: u32) -> Built {
        let gpu = &self.gpu;
        let capacity = d.capacity as usize;
        let buckets = d.mask as usize + 1;
        let poison = |words: usize| vec![POISON; words];
        let upload = |buffer: Buffer, words: &[u32]| {
            (buffer, gpu.upload(buffer.name(), cast_slice(words)).unwrap())
        };
        let mut all_records: Vec<u32> = cast_slice(records).to_vec();
        all_records.resize(capacity * 8, POISON);
        let buffers = BTreeMap::from([
            upload(Buffer::Records, &all_records),
            upload(Buffer::Counters, &[records.len() as u32, 0, 0, 0, 0, 0, 0, 0]),
            upload(Buffer::Counts, &vec![0; buckets]),
            upload(Buffer::Starts, &poison(buckets + 1)),
            upload(Buffer::BlockSums, &poison(buckets / SCAN_BLOCK as usize + 1)),
            upload(Buffer::Order, &poison(capacity)),
            upload(Buffer::Sorted, &poison(capacity * 8)),
        ]);
        for program in &self.programs {
            let end = match program.kernel {
                Kernel::GridCount | Kernel::GridScatter => d.capacity,
                Kernel::GridScanSums => buckets as u32 / SCAN_BLOCK,
                _ => buckets as u32,
            };
            let group = program
                .bind(gpu, &self.recorder.dispatches, |buffer| buffers.get(&buffer))
                .unwrap();
            let step = piece.next_multiple_of(program.kernel.info().workgroup_items).min(end);
            let mut first = 0;
            while first < end {
                let last = (first + step).min(end);
                self.recorder.dispatch(gpu, program, &group, &Dispatch { first, end: last, ..*d });
                if self.recorder.is_full() {
                    self.recorder.finish(gpu).unwrap();
                }
                first = last;
            }
        }
        self.recorder.finish(gpu).unwrap();
        let read =
            |buffer: Buffer, bytes: usize| gpu.read(&buffers[&buffer], bytes as u64).unwrap();
        Built {
            counts: pod_collect_to_vec(&read(Buffer::Counts, buckets * 4)),
            starts: pod_collect_to_vec(&read(Buffer::Starts, buckets * 4 + 4)),
            sorted: pod_collect_to_vec(&read(Buffer::Sorted, capacity * size_of::<PhotonRecord>())),
        }
    }
}

/// Lists the errors of a grid.
fn faults(records: &[PhotonRecord], d: &Dispatch, built: &Built) -> Vec<String> {
    let mut list = Vec::new();
    let mut by_bucket: BTreeMap<u32, Vec<&PhotonRecord>> = BTreeMap::new();
    for record in records {
        by_bucket.entry(record_bucket(d, record)).or_default().push(record);
    }
    let mut place = 0;
    for bucket in 0..=d.mask {
        if built.starts[bucket as usize] != place as u32 {
            list.push(format!(
                "bucket {bucket} starts at {}, not {place}",
                built.starts[bucket as usize]
            ));
            break;
        }
        let mut own = by_bucket.remove(&bucket).unwrap_or_default();
        own.sort_by_key(|record| record.key);
        for record in own {
            if built.sorted[place] != (PhotonRecord { key: record_code(d, record), ..*record }) {
                list.push(format!("place {place} of bucket {bucket} holds another record"));
            }
            place += 1;
        }
    }
    if built.starts[d.mask as usize + 1] != records.len() as u32 {
        list.push("the total is wrong".into());
    }
    if built.counts.iter().any(|count| *count != 0) {
        list.push("counts are left over".into());
    }
    if built.sorted[records.len()..].iter().any(|r| r.key != POISON || r.direction != POISON) {
        list.push("written beyond the records".into());
    }
    list
}

/// Makes `count` records in a cube of `size` cells, with distinct keys in random order.
fn scattered(count: u32, size: f32) -> Vec<PhotonRecord> {
    let mut state = 7u32;
    let mut random = || {
        state = state.wrapping_mul(747796405).wrapping_add(2891336453);
        (state >> 8) as f32 / 16777216.0 - 0.5
    };
    (0..count)
        .map(|i| PhotonRecord {
            position: Vec3::new(random(), random(), random()) * size,
            // an odd factor permutes all words
            key: i.wrapping_mul(2654435761),
            flux: Vec3::new(i as f32, random(), random()),
            direction: i,
        })
        .collect()
}

fn numbers(count: u32, buckets: u32) -> Dispatch {
    Dispatch {
        capacity: count.next_power_of_two().max(SCAN_BLOCK),
        mask: buckets - 1,
        inv_cell: 1.0,
        ..Dispatch::zeroed()
    }
}

#[test]
fn agrees_with_a_naive_loop() {
    let mut grid = Grid::new();
    for count in [0u32, 1, 63, 64, 65, 4095, 4096, 4097, 100_000] {
        let buckets = count.next_power_of_two().max(SCAN_BLOCK);
        let records = scattered(count, 40.0);
        let d = numbers(count, buckets);
        for piece in [u32::MAX / 2, 16384] {
            let built = grid.build(&records, &d, piece);
            let list = faults(&records, &d, &built);
            assert!(list.is_empty(), "{count} records in pieces of {piece}: {list:#?}");
        }
    }
}

/// Long buckets use the workgroup's sort: all records in one bucket, buckets near the length where
/// sorts change, and as many of them as a workgroup can have.
#[test]
fn long_buckets_are_sorted() {
    let mut grid = Grid::new();
    for (count, size) in [
        (20_000, 0.5),
        (31, 0.5),
        (32, 0.5),
        (33, 0.5),
        (64, 0.5),
        (65, 0.5),
        (30_000, 8.0),
        (300_000, 16.0),
    ] {
        let mut records = scattered(count, size);
        if size < 1.0 {
            records.iter_mut().for_each(|r| r.position += Vec3::splat(0.5));
        }
        let d = numbers(count, SCAN_BLOCK);
        let built = grid.build(&records, &d, u32::MAX / 2);
        let list = faults(&records, &d, &built);
        assert!(list.is_empty(), "{count} records in a cube of {size}: {list:#?}");
    }
}

/// The largest number of buckets of any plan: more blocks than a workgroup has invocations, and
/// more workgroups than fit a row.
#[test]
fn four_million_buckets() {
    let mut grid = Grid::new();
    let records = scattered(50_000, 1000.0);
    let d = Dispatch { capacity: 1 << 22, ..numbers(50_000, 1 << 22) };
    let built = grid.build(&records, &d, u32::MAX / 2);
    let list = faults(&records, &d, &built);
    assert!(list.is_empty(), "{list:#?}");
}

/// The comparison detects two swapped records of a bucket, a wrong start, and a lost record.
#[test]
fn planted_faults_are_found() {
    let mut grid = Grid::new();
    let records = scattered(1000, 2.0);
    let d = numbers(1000, SCAN_BLOCK);
    let found = |damage: fn(&mut Built), grid: &mut Grid| {
        let mut built = grid.build(&records, &d, u32::MAX / 2);
        damage(&mut built);
        !faults(&records, &d, &built).is_empty()
    };
    assert!(!found(|_| (), &mut grid));
    assert!(found(|b| b.sorted.swap(10, 11), &mut grid));
    assert!(found(|b| b.starts[2000] += 1, &mut grid));
    assert!(found(|b| b.sorted[500].flux.y += 1e-6, &mut grid));
    assert!(found(|b| b.counts[5] = 1, &mut grid));
    assert!(found(|b| b.sorted[1000].key = 0, &mut grid));
}
