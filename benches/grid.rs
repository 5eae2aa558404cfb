//! The hash grid's construction on the CPU, step by step. `cargo bench --bench grid`.
//!
//! Sizes: 2^16 records fit the second-level cache of most processors with everything that goes with them, 2^19 the last level
//! of some, and 2^22, as many as a batch may have, none. There are as many buckets as records, as in a plan.

use bytemuck::Zeroable;
use caustica::kernels::grid_build::{SortedRecords, grid_count, grid_scan, grid_scatter, grid_sort};
use caustica::kernels::records::{Dispatch, PhotonRecord};
use divan::{Bencher, counter::ItemsCount};
use glam::Vec3;

const RECORDS: [u32; 4] = [1 << 16, 1 << 18, 1 << 20, 1 << 22];

fn main() {
    divan::main();
}

/// Records on the walls of a cube of such a size that a cell of the wall holds about four, as around visible points.
fn records(count: u32) -> (Dispatch, Vec<PhotonRecord>) {
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
    let d = Dispatch { capacity: count, mask: count - 1, inv_cell: 1.0, families: 1, ..Dispatch::zeroed() };
    (d, (0..count).map(record).collect())
}

#[divan::bench(args = RECORDS)]
fn count(bencher: Bencher, n: u32) {
    let (d, records) = records(n);
    bencher
        .counter(ItemsCount::new(n))
        .with_inputs(|| vec![0; n as usize])
        .bench_local_refs(|counts| grid_count(&d, &records, counts));
}

#[divan::bench(args = RECORDS)]
fn scan(bencher: Bencher, n: u32) {
    let (d, records) = records(n);
    let mut counts = vec![0; n as usize];
    grid_count(&d, &records, &mut counts);
    let mut starts = vec![0; n as usize + 1];
    bencher.counter(ItemsCount::new(n)).bench_local(|| grid_scan(&counts, &mut starts));
}

#[divan::bench(args = RECORDS)]
fn scatter(bencher: Bencher, n: u32) {
    let (d, records) = records(n);
    let mut counts = vec![0; n as usize];
    grid_count(&d, &records, &mut counts);
    let mut starts = vec![0; n as usize + 1];
    grid_scan(&counts, &mut starts);
    let mut order = vec![0; n as usize];
    bencher
        .counter(ItemsCount::new(n))
        .with_inputs(|| counts.clone())
        .bench_local_refs(|counts| grid_scatter(&d, &records, &starts, counts, &mut order));
}

/// Buckets are sorted by the scatter already: what is left is the copy.
#[divan::bench(args = RECORDS)]
fn sort(bencher: Bencher, n: u32) {
    let (d, records) = records(n);
    let mut counts = vec![0; n as usize];
    grid_count(&d, &records, &mut counts);
    let mut starts = vec![0; n as usize + 1];
    grid_scan(&counts, &mut starts);
    let mut order = vec![0; n as usize];
    grid_scatter(&d, &records, &starts, &mut counts, &mut order);
    let mut sorted = SortedRecords::default();
    bencher.counter(ItemsCount::new(n)).bench_local(|| grid_sort(&d, &records, &order, &mut sorted));
}
