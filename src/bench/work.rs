//! What the kernels of a pass do, counted: the denominators of rates.

use std::collections::BTreeMap;

use bytemuck::Zeroable;
use rayon::prelude::*;
use serde::Serialize;

use crate::engine::PassReport;
use crate::grid::{grid_bucket, grid_cell};
use crate::kernels::eye_trace::eye_trace;
use crate::kernels::gather::gather;
use crate::kernels::grid_build::{grid_count, grid_scan, grid_scatter};
use crate::kernels::photon_trace::photon_trace;
use crate::kernels::records::*;
use crate::pack::Packed;
use crate::plan::{Kernel, Plan};
use glam::{IVec3, Vec3};

/// Most visible points that are looked at for the gather's counts.
const SAMPLE: u32 = 1 << 16;

/// Photons around the visible points of a pass, counted on the CPU at every so many-th point for the pass's first batch, and
/// scaled to the pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct GatherCounts {
    /// Visible points that have a disc, times batches.
    pub points: f64,
    /// Photons in the cells around them.
    pub tested: f64,
    /// Photons in their discs.
    pub accepted: f64,
}

/// Counts for pass `pass`. The local rule's own radii are not known here: the plan's guess stands for them.
pub fn gather_counts(packed: &Packed, plan: &Plan, pass: u32) -> GatherCounts {
    let scene = &packed.scene;
    let sampled = plan.features.has("sampled");
    let steps = plan.steps(pass, plan.batch_photons);
    let Some(trace) = steps.iter().find(|step| step.kernel == Kernel::PhotonTrace) else {
        return GatherCounts::default();
    };
    let d = &trace.dispatch;
    let records: Vec<PhotonRecord> = (0..d.end)
        .into_par_iter()
        .flat_map_iter(|id| {
            let mut found = Vec::new();
            let _ = photon_trace(scene, d, sampled, id, |record| found.push(record));
            found
        })
        .collect();
    let mut counts = vec![0; plan.buckets as usize];
    let mut starts = vec![0; plan.buckets as usize + 1];
    let mut order = vec![0; records.len()];
    grid_count(d, &records, &mut counts);
    grid_scan(&counts, &mut starts);
    grid_scatter(d, &records, &starts, &mut counts, &mut order);
    let sorted: Vec<PhotonRecord> = order.iter().map(|&i| records[i as usize]).collect();

    let eyes = plan.steps(0, plan.batch_photons);
    let all = u64::from(plan.pixels) * u64::from(plan.eye_samples);
    let stride = all.div_ceil(u64::from(SAMPLE)).max(1);
    let found = (0..all.div_ceil(stride)).into_par_iter().map(|i| {
        let id = (i * stride) as u32;
        let chunk = &eyes[(id / plan.chunk_points) as usize].dispatch;
        let pass_number = if plan.settings.method == crate::settings::Method::Ppm { 0 } else { pass };
        let d_eye = Dispatch { pass_number, ..*chunk };
        let (point, _) = eye_trace(scene, &d_eye, sampled, id % plan.chunk_points);
        if point.radius <= 0.0 {
            return [0, 0, 0];
        }
        let mut gathered = Gathered::zeroed();
        gather(d, &point, d.scale_sq, &starts, &sorted, &mut gathered);
        [1, tested(d, &point, &starts), u64::from(gathered.count)]
    });
    let sums = found.reduce(|| [0; 3], |a, b| std::array::from_fn(|k| a[k] + b[k]));
    let looked_at = all.div_ceil(stride) as f64;
    let scale = all as f64 / looked_at * f64::from(plan.settings.photons) / f64::from(d.end);
    let [points, tested, accepted] = sums.map(|sum| sum as f64 * scale);
    GatherCounts { points, tested, accepted }
}

/// Photons in the buckets of the cells that a visible point's disc reaches into.
fn tested(d: &Dispatch, point: &VisiblePoint, starts: &[u32]) -> u64 {
    let radius = Vec3::splat(point.radius * d.scale_sq.sqrt());
    let low = grid_cell(point.position - radius, d.inv_cell);
    let high = grid_cell(point.position + radius, d.inv_cell);
    let cells = (low.z..=high.z)
        .flat_map(|z| (low.y..=high.y).flat_map(move |y| (low.x..=high.x).map(move |x| IVec3::new(x, y, z))));
    cells
        .map(|cell| grid_bucket(cell, d.mask) as usize)
        .map(|bucket| u64::from(starts[bucket + 1] - starts[bucket]))
        .sum()
}

/// Bytes that each kernel of a pass has to move at least, if every datum that it needs travels once each way.
pub fn least_bytes(plan: &Plan, report: &PassReport) -> BTreeMap<&'static str, f64> {
    let record = size_of::<PhotonRecord>() as f64;
    let (point, pixel) = (size_of::<VisiblePoint>() as f64, size_of::<FilmPixel>() as f64);
    let gathered = size_of::<Gathered>() as f64;
    let records = report.records as f64;
    let batches = f64::from(plan.settings.photons.div_ceil(plan.batch_photons.max(1)));
    let buckets = f64::from(plan.buckets) * batches;
    let points = f64::from(plan.pixels) * f64::from(plan.eye_samples);
    BTreeMap::from([
        // the record in; the count in and out
        (Kernel::GridCount.stem(), records * (record + 8.0)),
        (Kernel::GridScanReduce.stem(), buckets * 4.0),
        // the count in, the start out
        (Kernel::GridScan.stem(), buckets * 8.0),
        // the record and the start in; the count in and out; the number out
        (Kernel::GridScatter.stem(), records * (record + 16.0)),
        // the number and the record in, both out
        (Kernel::GridSort.stem(), records * (2.0 * record + 8.0)),
        // the point and what it gathered in; the pixel in and out
        (Kernel::Resolve.stem(), points * (point + gathered) + f64::from(plan.pixels) * 2.0 * pixel),
    ])
}

/// Theory: what a disc accepts is among what its cells hold, and both can be found by going through all records.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::pack::pack;
    use crate::scene;

    #[test]
    fn counts_are_those_of_a_search_through_everything() {
        let mut loaded = scene::load("scenes/cornell.toml".as_ref()).unwrap();
        (loaded.scene.film.width, loaded.scene.film.height) = (16, 16);
        loaded.settings.photons = 3000;
        let packed = pack(&loaded.scene, 16, 16).unwrap();
        let plan = Plan::new(&packed, &loaded.settings);
        let counts = gather_counts(&packed, &plan, 1);
        let d = plan.dispatch(1);
        let mut records = Vec::new();
        for id in 0..3000 {
            let _ = photon_trace(&packed.scene, &d, true, id, |record| records.push(record));
        }
        let (mut points, mut accepted) = (0, 0);
        for id in 0..256 {
            let (point, _) = eye_trace(&packed.scene, &d, true, id);
            let radius = point.radius * d.scale_sq.sqrt();
            let near = |r: &&PhotonRecord| (r.position - point.position).length() <= radius;
            points += usize::from(point.radius > 0.0);
            accepted += records.iter().filter(near).count();
        }
        assert_eq!(counts.points, points as f64);
        // the search knows no wrong side and no flat disc: it may find a few more
        assert!(counts.accepted <= accepted as f64 && counts.accepted > 0.9 * accepted as f64, "{counts:?}");
        assert!(counts.tested >= counts.accepted && counts.tested <= 256.0 * records.len() as f64);
    }
}
