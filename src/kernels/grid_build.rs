//! The hash grid's construction: count, scan, scatter, sort. Twins: `shaders/kernels/grid_count.wgsl`,
//! `grid_scan_reduce.wgsl`, `grid_scan_sums.wgsl`, `grid_scan.wgsl`, `grid_scatter.wgsl`, `grid_sort.wgsl` and
//! `grid_sort_long.wgsl`.
//!
//! The result does not depend on the order in which threads arrive: within a bucket the records stand in the
//! order of their keys.

use super::grid::{grid_bucket, grid_cell, grid_code};
use super::math::oct_vector;
use super::real::{Real, Vec4};
use super::records::{Dispatch, PhotonRecord};
use glam::IVec3;
use rayon::prelude::*;

/// Records in the order of their buckets, each field by itself.
#[derive(Clone, Debug, Default)]
pub struct SortedRecords {
    /// Positions: x, y, z.
    pub positions: [Vec<Real>; 3],
    /// Directions to where photons came from, at any length: x, y, z.
    pub directions: [Vec<Real>; 3],
    /// Cells and families, as [`grid_code`] gives them.
    pub codes: Vec<u32>,
    /// See [`PhotonRecord::flux`]; the fourth is 0.
    pub fluxes: Vec<Vec4>,
}

/// Records that one task copies, at the least.
const SORT_TASK: usize = 4096;
/// Entries after the last record, for those who read some at once.
const TAIL: usize = 16;

/// A record's family: 1 for photons with a disc of their own (see [`Dispatch::indirect_radius`]).
fn record_family(dispatch: &Dispatch, record: &PhotonRecord) -> u32 {
    if dispatch.families == 2 { record.key & 1 } else { 0 }
}

/// Cell of a record in the grid of its family.
fn record_cell(dispatch: &Dispatch, record: &PhotonRecord) -> IVec3 {
    let indirect = record_family(dispatch, record) == 1;
    grid_cell(record.position, if indirect { dispatch.inv_cell_indirect } else { dispatch.inv_cell })
}

/// Bucket of a record.
pub fn record_bucket(dispatch: &Dispatch, record: &PhotonRecord) -> u32 {
    grid_bucket(record_cell(dispatch, record), dispatch.mask)
}

/// Cell and family of a record in one word: what stands for its key once it is sorted.
pub fn record_code(dispatch: &Dispatch, record: &PhotonRecord) -> u32 {
    grid_code(record_cell(dispatch, record), record_family(dispatch, record))
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

/// Copies the records to `sorted` in the order of `order`, in which buckets are sorted by key already.
pub fn grid_sort(dispatch: &Dispatch, records: &[PhotonRecord], order: &[u32], sorted: &mut SortedRecords) {
    let length = order.len() + TAIL;
    let SortedRecords { positions, directions, codes, fluxes } = sorted;
    positions.iter_mut().chain(directions.iter_mut()).for_each(|values| values.resize(length, 0.0));
    codes.resize(length, u32::MAX);
    codes[order.len()..].fill(u32::MAX);
    fluxes.resize(length, Vec4::ZERO);
    let ([xs, ys, zs], [us, vs, ws]) = (positions, directions);
    (order, xs, ys, zs, us, vs, ws, codes, fluxes).into_par_iter().with_min_len(SORT_TASK).for_each(
        |(i, x, y, z, u, v, w, code, flux)| {
            let record = &records[*i as usize];
            [*x, *y, *z] = record.position.to_array();
            [*u, *v, *w] = oct_vector(record.direction).to_array();
            *code = record_code(dispatch, record);
            *flux = record.flux.extend(0.0);
        },
    );
}
