//! Construction of the hash grid: count, scan, scatter, sort. Twins:
//! `shaders/kernels/grid_count.wgsl`, `grid_scan_reduce.wgsl`, `grid_scan_sums.wgsl`,
//! `grid_scan.wgsl`, `grid_scatter.wgsl`, `grid_sort.wgsl` and `grid_sort_long.wgsl`.
//!
//! The result does not depend on the order in which threads arrive: within a bucket the records are
//! sorted by key. On the CPU each photon task partitions its records by the leading bits of their
//! buckets; each part of the buckets is then sorted separately, within the cache.

use super::grid::{grid_bucket, grid_cell, grid_code};
use super::math::oct_vector;
use super::real::{Real, Vec4};
use super::records::{Dispatch, FOCUSED, PhotonRecord};
use bytemuck::Zeroable;
use glam::IVec3;
use rayon::prelude::*;
use std::mem::{swap, take};

/// Greatest number of parts of the buckets: few enough write streams for the TLB, and with four
/// million records a part fits in the L2 cache.
const PARTS: u32 = 256;

/// Records of one photon task, in key order until [`grid_scatter`] partitions them.
#[derive(Clone, Debug, Default)]
pub struct RecordList {
    /// The records.
    pub records: Vec<PhotonRecord>,
    /// Bucket of each record.
    buckets: Vec<u32>,
    /// Number of records in each part of the buckets; after [`grid_scatter`] the end of each part.
    parts: Vec<u32>,
}

impl RecordList {
    /// List of records in key order.
    pub fn new(records: Vec<PhotonRecord>) -> Self {
        Self { records, ..Self::default() }
    }
}

/// Records in bucket order, as a structure of arrays.
#[derive(Clone, Debug, Default)]
pub struct SortedRecords {
    /// Positions: x, y, z.
    pub positions: [Vec<Real>; 3],
    /// Directions that the photons came from, not normalized: x, y, z.
    pub directions: [Vec<Real>; 3],
    /// Row of cells and class of each record, see [`grid_code`].
    pub codes: Vec<u32>,
    /// See [`PhotonRecord::flux`]; the fourth component is the [`FOCUSED`] bit of the key.
    pub fluxes: Vec<Vec4>,
}

/// Padding entries after the last record, for readers that load several at once.
const TAIL: usize = 16;

/// Class of a record: 1 for photons with a separate disc (see [`Dispatch::indirect_radius`]).
fn record_family(dispatch: &Dispatch, record: &PhotonRecord) -> u32 {
    if dispatch.classes == 2 { record.key & 1 } else { 0 }
}

/// Cell of a record in the grid of its class.
fn record_cell(dispatch: &Dispatch, record: &PhotonRecord) -> IVec3 {
    let indirect = record_family(dispatch, record) == 1;
    grid_cell(
        record.position,
        if indirect { dispatch.inv_cell_indirect } else { dispatch.inv_cell },
    )
}

/// Bucket of a record.
pub fn record_bucket(dispatch: &Dispatch, record: &PhotonRecord) -> u32 {
    grid_bucket(record_cell(dispatch, record), dispatch.mask)
}

/// Row and class of a record in one word, which replaces its key once it is sorted.
pub fn record_code(dispatch: &Dispatch, record: &PhotonRecord) -> u32 {
    grid_code(record_cell(dispatch, record), record_family(dispatch, record))
}

/// Flux of a record; the fourth component is its [`FOCUSED`] bit.
fn with_focus(dispatch: &Dispatch, record: &PhotonRecord) -> Vec4 {
    record.flux.extend((record.key & dispatch.continued & FOCUSED) as Real)
}

/// Number of bits to shift a bucket index right to get the index of its part.
fn part_shift(dispatch: &Dispatch) -> u32 {
    dispatch.mask.count_ones().saturating_sub(PARTS.ilog2())
}

/// Counts the records in each part of the buckets.
pub fn grid_count(dispatch: &Dispatch, lists: &mut [RecordList]) {
    let shift = part_shift(dispatch);
    lists.par_iter_mut().for_each(|RecordList { records, buckets, parts }| {
        buckets.clear();
        buckets.extend(records.iter().map(|record| record_bucket(dispatch, record)));
        parts.clear();
        parts.resize((dispatch.mask >> shift) as usize + 1, 0);
        for bucket in buckets {
            parts[(*bucket >> shift) as usize] += 1;
        }
    });
}

/// Exclusive prefix sum of the parts' record counts over all lists; the last entry is the total.
pub fn grid_scan(lists: &[RecordList]) -> Vec<u32> {
    let parts = lists.iter().map(|list| list.parts.len()).max().unwrap_or(0);
    let mut starts = vec![0; parts + 1];
    for list in lists {
        starts.iter_mut().skip(1).zip(&list.parts).for_each(|(sum, count)| *sum += count);
    }
    let mut sum = 0;
    for start in &mut starts {
        sum += *start;
        *start = sum;
    }
    starts
}

/// Partitions the records of each list by part; the order of keys is kept within a part.
pub fn grid_scatter(dispatch: &Dispatch, lists: &mut [RecordList]) {
    let shift = part_shift(dispatch);
    lists.par_iter_mut().for_each_init(RecordList::default, |other, list| {
        other.records.resize(list.records.len(), PhotonRecord::zeroed());
        other.buckets.resize(list.records.len(), 0);
        let mut end = 0;
        let mut places = [0; PARTS as usize];
        for (place, part) in places.iter_mut().zip(&mut list.parts) {
            *place = end as usize;
            end += *part;
            *part = end;
        }
        for (record, bucket) in list.records.iter().zip(&list.buckets) {
            let place = &mut places[(*bucket >> shift) as usize];
            other.records[*place] = *record;
            other.buckets[*place] = *bucket;
            *place += 1;
        }
        swap(&mut list.records, &mut other.records);
        swap(&mut list.buckets, &mut other.buckets);
    });
}

/// Copies the records to `sorted` in bucket order; `starts[b]` becomes the number of records in the
/// buckets before `b`, and the last entry the total. `part_starts` is the result of [`grid_scan`].
pub fn grid_sort(
    dispatch: &Dispatch,
    lists: &[RecordList],
    part_starts: &[u32],
    starts: &mut [u32],
    sorted: &mut SortedRecords,
) {
    let shift = part_shift(dispatch);
    let total = part_starts.last().map_or(0, |total| *total as usize);
    sorted.resize(total);
    let (starts, all) = starts.split_at_mut(dispatch.mask as usize + 1);
    all[0] = total as u32;
    let mut rest = sorted.places();
    let parts: Vec<_> = starts
        .chunks_mut(1 << shift)
        .zip(part_starts.windows(2))
        .map(|(starts, range)| (starts, range[0], rest.take((range[1] - range[0]) as usize)))
        .collect();
    parts.into_par_iter().enumerate().for_each(|(part, (starts, first, mut places))| {
        let runs = || {
            lists.iter().map(move |list| {
                let begin = if part == 0 { 0 } else { list.parts[part - 1] };
                let run = begin as usize..list.parts[part] as usize;
                list.records[run.clone()].iter().zip(&list.buckets[run])
            })
        };
        let within = (1 << shift) - 1;
        starts.fill(0);
        // count the records per bucket, then sum
        runs().flatten().for_each(|(_, bucket)| starts[(*bucket & within) as usize] += 1);
        let mut end = first;
        for start in &mut *starts {
            end += *start;
            *start = end;
        }
        // fill from the last to the first: each entry of `starts` begins as an end and becomes a
        // start
        for (record, bucket) in runs().rev().flat_map(|run| run.rev()) {
            let start = &mut starts[(*bucket & within) as usize];
            *start -= 1;
            places.put((*start - first) as usize, dispatch, record);
        }
    });
}

/// Runs the whole construction on records in key order; returns `starts` and the sorted records.
pub fn build_grid(dispatch: &Dispatch, records: Vec<PhotonRecord>) -> (Vec<u32>, SortedRecords) {
    let mut lists = [RecordList::new(records)];
    let mut starts = vec![0; dispatch.mask as usize + 2];
    let mut sorted = SortedRecords::default();
    grid_count(dispatch, &mut lists);
    let part_starts = grid_scan(&lists);
    grid_scatter(dispatch, &mut lists);
    grid_sort(dispatch, &lists, &part_starts, &mut starts, &mut sorted);
    (starts, sorted)
}

/// Slices of [`SortedRecords`] that one task fills.
struct Places<'a> {
    positions: [&'a mut [Real]; 3],
    directions: [&'a mut [Real]; 3],
    codes: &'a mut [u32],
    fluxes: &'a mut [Vec4],
}

impl SortedRecords {
    /// Resizes to `records` entries plus the padding, which belongs to no cell.
    fn resize(&mut self, records: usize) {
        let length = records + TAIL;
        self.positions
            .iter_mut()
            .chain(&mut self.directions)
            .for_each(|values| values.resize(length, 0.0));
        self.codes.resize(length, u32::MAX);
        self.codes[records..].fill(u32::MAX);
        self.fluxes.resize(length, Vec4::ZERO);
    }

    fn places(&mut self) -> Places<'_> {
        Places {
            positions: self.positions.each_mut().map(|values| &mut values[..]),
            directions: self.directions.each_mut().map(|values| &mut values[..]),
            codes: &mut self.codes,
            fluxes: &mut self.fluxes,
        }
    }
}

impl Places<'_> {
    /// Splits off the next `count` entries.
    fn take(&mut self, count: usize) -> Self {
        Places {
            positions: self.positions.each_mut().map(|values| cut(values, count)),
            directions: self.directions.each_mut().map(|values| cut(values, count)),
            codes: cut(&mut self.codes, count),
            fluxes: cut(&mut self.fluxes, count),
        }
    }

    #[inline]
    fn put(&mut self, i: usize, dispatch: &Dispatch, record: &PhotonRecord) {
        let (position, direction) =
            (record.position.to_array(), oct_vector(record.direction).to_array());
        for axis in 0..3 {
            self.positions[axis][i] = position[axis];
            self.directions[axis][i] = direction[axis];
        }
        self.codes[i] = record_code(dispatch, record);
        self.fluxes[i] = with_focus(dispatch, record);
    }
}

/// Splits off the first `count` entries of `values`.
fn cut<'a, T>(values: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let (first, rest) = take(values).split_at_mut(count);
    *values = rest;
    first
}

#[cfg(test)]
mod tests {
    use super::super::math::oct_encode;
    use super::super::real::Vec3;
    use super::*;

    /// Random records in a cube of `side` cells, one in five of them at the origin.
    fn random_records(count: u32, side: Real) -> Vec<PhotonRecord> {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
            (state >> 8) as Real / 16_777_216.0
        };
        let record = |key| {
            let at =
                Vec3::new(random(), random(), random()) * if key % 5 == 0 { 0.0 } else { side };
            PhotonRecord {
                position: at,
                key,
                flux: at,
                direction: oct_encode(Vec3::new(0.6, 0.0, -0.8)),
            }
        };
        (0..count).map(record).collect()
    }

    /// Returns true if the grid matches its definition: the records stably sorted by bucket, and
    /// `starts` the number of records in the buckets before each.
    fn is_grid(
        d: &Dispatch,
        mut records: Vec<PhotonRecord>,
        starts: &[u32],
        sorted: &SortedRecords,
    ) -> bool {
        records.sort_by_key(|record| record_bucket(d, record));
        let before = |b: u32| records.partition_point(|record| record_bucket(d, record) < b) as u32;
        let same = |(i, record): (usize, &PhotonRecord)| {
            let place = |values: &[Vec<Real>; 3]| values.each_ref().map(|v| v[i]);
            place(&sorted.positions) == record.position.to_array()
                && place(&sorted.directions) == oct_vector(record.direction).to_array()
                && sorted.codes[i] == record_code(d, record)
                && sorted.fluxes[i] == with_focus(d, record)
        };
        starts.iter().zip(0..).all(|(start, b)| *start == before(b))
            && records.iter().enumerate().all(same)
            && sorted.codes[records.len()..] == [u32::MAX; TAIL]
    }

    // Theory: the grid depends only on its records, not on how they are split into lists and the
    // buckets into parts. Leftovers of a larger grid must not show.
    #[test]
    fn grid_is_its_definition() {
        let mut sorted = SortedRecords::default();
        for (count, buckets, list) in
            [(70_000, 1 << 16, 1000), (5000, 1 << 12, 5000), (900, 64, 7), (3, 1, 1)]
        {
            let d = Dispatch { mask: buckets - 1, inv_cell: 1.0, classes: 2, ..Dispatch::zeroed() };
            let d = Dispatch { inv_cell_indirect: 0.3, ..d };
            let records = random_records(count, (count as Real).sqrt());
            let mut lists: Vec<_> =
                records.chunks(list).map(|r| RecordList::new(r.to_vec())).collect();
            lists.push(RecordList::default());
            let mut starts = vec![7; buckets as usize + 1];
            grid_count(&d, &mut lists);
            let part_starts = grid_scan(&lists);
            grid_scatter(&d, &mut lists);
            grid_sort(&d, &lists, &part_starts, &mut starts, &mut sorted);
            assert!(
                is_grid(&d, records.clone(), &starts, &sorted),
                "{count} records, {buckets} buckets"
            );
            // the check detects two swapped records, and a bucket that starts late
            let last = count as usize - 1;
            let mut planted = sorted.clone();
            planted.fluxes.swap(0, last);
            assert!(!is_grid(&d, records.clone(), &starts, &planted));
            starts[buckets as usize] += 1;
            assert!(!is_grid(&d, records, &starts, &sorted));
        }
    }
}
