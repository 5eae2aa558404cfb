//! Construction of the hash grid on the CPU, step by step. `cargo bench --bench grid`.
//!
//! Sizes: 2^16 records and their tables fit the L2 cache of most processors; 2^22 records, the
//! maximum of a batch, exceed all caches. There are as many buckets as records, as in a plan, and
//! lists are as long as those of a photon task.

use bytemuck::Zeroable;
use caustica::low_level::kernels::grid_build::{
    RecordList, SortedRecords, grid_count, grid_scan, grid_scatter, grid_sort,
};
use caustica::low_level::kernels::records::{Dispatch, PhotonRecord};
use divan::{Bencher, counter::ItemsCount};
use glam::Vec3;

const RECORDS: [u32; 4] = [1 << 16, 1 << 18, 1 << 20, 1 << 22];

fn main() {
    divan::main();
}

/// Number of records per list.
const LIST: usize = 1 << 13;

/// Records on the walls of a cube, with about four per grid cell, as around visible points.
fn lists(count: u32) -> (Dispatch, Vec<RecordList>) {
    let side = (count as f32 / 24.0).sqrt();
    let mut state = 1u32;
    let mut random = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / 16_777_216.0
    };
    let record = |key| {
        let mut position = Vec3::new(random(), random(), random());
        position[key as usize % 3] = (key / 3 % 2) as f32;
        PhotonRecord { position: position * side, key, ..PhotonRecord::zeroed() }
    };
    let records: Vec<_> = (0..count).map(record).collect();
    let list = |records: &[PhotonRecord]| RecordList::new(records.to_vec());
    let d = Dispatch {
        capacity: count,
        mask: count - 1,
        inv_cell: 1.0,
        classes: 1,
        ..Dispatch::zeroed()
    };
    (d, records.chunks(LIST).map(list).collect())
}

#[divan::bench(args = RECORDS)]
fn count(bencher: Bencher, n: u32) {
    let (d, mut lists) = lists(n);
    bencher.counter(ItemsCount::new(n)).bench_local(|| grid_count(&d, &mut lists));
}

#[divan::bench(args = RECORDS)]
fn scan(bencher: Bencher, n: u32) {
    let (d, mut lists) = lists(n);
    grid_count(&d, &mut lists);
    bencher.counter(ItemsCount::new(n)).bench_local(|| grid_scan(&lists));
}

#[divan::bench(args = RECORDS)]
fn scatter(bencher: Bencher, n: u32) {
    let (d, mut lists) = lists(n);
    grid_count(&d, &mut lists);
    bencher
        .counter(ItemsCount::new(n))
        .with_inputs(|| lists.clone())
        .bench_local_refs(|lists| grid_scatter(&d, lists));
}

#[divan::bench(args = RECORDS)]
fn sort(bencher: Bencher, n: u32) {
    let (d, mut lists) = lists(n);
    grid_count(&d, &mut lists);
    let part_starts = grid_scan(&lists);
    grid_scatter(&d, &mut lists);
    let mut starts = vec![0; n as usize + 1];
    let mut sorted = SortedRecords::default();
    bencher
        .counter(ItemsCount::new(n))
        .bench_local(|| grid_sort(&d, &lists, &part_starts, &mut starts, &mut sorted));
}
