//! The hash grid's construction: count, scan, scatter, sort. Twins: `shaders/kernels/grid_count.wgsl`,
//! `grid_scan_reduce.wgsl`, `grid_scan_sums.wgsl`, `grid_scan.wgsl`, `grid_scatter.wgsl`, `grid_sort.wgsl` and
//! `grid_sort_long.wgsl`.
//!
//! The result does not depend on the order in which threads arrive: within a bucket the records stand in the
//! order of their keys.

use super::grid::{grid_bucket, grid_cell};
use super::records::{Dispatch, PhotonRecord};

/// Bucket of a record.
pub fn record_bucket(dispatch: &Dispatch, record: &PhotonRecord) -> u32 {
    grid_bucket(grid_cell(record.position, dispatch.inv_cell), dispatch.mask)
}

/// Counts the records of each bucket.
pub fn grid_count(dispatch: &Dispatch, records: &[PhotonRecord], counts: &mut [u32]) {
    for record in records {
        counts[record_bucket(dispatch, record) as usize] += 1;
    }
}

/// `starts[b]` becomes the number of records in the buckets before `b`; one more entry holds their total.
pub fn grid_scan(counts: &[u32], starts: &mut [u32]) {
    let mut sum = 0;
    for (start, count) in starts.iter_mut().zip(counts) {
        *start = sum;
        sum += count;
    }
    starts[counts.len()] = sum;
}

/// Puts the numbers of the records into bucket order, using up `counts`. Records come in the order of their
/// keys here and are taken from the last to the first, so that each bucket ends up sorted; the GPU, where threads
/// arrive in any order, sorts afterwards.
pub fn grid_scatter(
    dispatch: &Dispatch,
    records: &[PhotonRecord],
    starts: &[u32],
    counts: &mut [u32],
    order: &mut [u32],
) {
    for (i, record) in records.iter().enumerate().rev() {
        let bucket = record_bucket(dispatch, record) as usize;
        counts[bucket] -= 1;
        order[(starts[bucket] + counts[bucket]) as usize] = i as u32;
    }
}

/// Sorts one bucket's slice of `order` by key and copies its records to `sorted`.
pub fn grid_sort(records: &[PhotonRecord], order: &mut [u32], sorted: &mut [PhotonRecord]) {
    order.sort_unstable_by_key(|&i| records[i as usize].key);
    for (target, &i) in sorted.iter_mut().zip(order.iter()) {
        *target = records[i as usize];
    }
}
