//! Tasks of a pass: what one core does at a time, for the processor's own vectors.

use super::super::features::Features;
use super::super::kernels::aov_trace::{AovPixel, aov_trace};
use super::super::kernels::eye_trace::eye_trace;
use super::super::kernels::gather::{gather, scale_sq};
use super::super::kernels::grid_build::{RecordList, SortedRecords};
use super::super::kernels::photon_trace::photon_trace;
use super::super::kernels::records::*;
use super::super::tables::{Facet, Scene};
use rayon::prelude::*;
use std::ops::Range;

/// Visible points that one task gathers for.
pub const GATHER_TASK: usize = 1024;
/// Visible points that one task finds.
pub const EYE_TASK: usize = 512;
/// Photons that one task traces, at the least and at the most, and tasks between.
const PHOTON_TASK: (u32, u32) = (1024, 8192);
const PHOTON_TASKS: u32 = 256;

/// Gathers of one task.
pub struct Gathers<'a> {
    pub facets: &'a [Facet],
    pub dispatch: &'a Dispatch,
    pub points: &'a [VisiblePoint],
    /// Under the local rule.
    pub statistics: Option<&'a [Statistics]>,
    pub starts: &'a [u32],
    pub sorted: &'a SortedRecords,
    pub gathered: &'a mut [Gathered],
}

impl pulp::WithSimd for Gathers<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for (i, (point, gathered)) in self.points.iter().zip(self.gathered).enumerate() {
            let scale = match self.statistics {
                Some(statistics) => scale_sq(self.dispatch, true, &statistics[i]),
                None => self.dispatch.scale_sq,
            };
            gather(self.facets, self.dispatch, point, scale, self.starts, self.sorted, gathered);
        }
    }
}

/// Eye paths of one task.
pub struct EyePaths<'a> {
    pub scene: &'a Scene,
    pub dispatch: &'a Dispatch,
    pub sampled: bool,
    pub first: u32,
    pub points: &'a mut [VisiblePoint],
}

impl pulp::WithSimd for EyePaths<'_> {
    /// Rays.
    type Output = u64;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> u64 {
        let mut all = 0;
        for (id, point) in (self.first..).zip(self.points) {
            let (traced, rays) = eye_trace(self.scene, self.dispatch, self.sampled, id);
            *point = traced;
            all += rays as u64;
        }
        all
    }
}

/// Photons of one task.
pub struct Photons<'a> {
    pub scene: &'a Scene,
    pub dispatch: &'a Dispatch,
    pub sampled: bool,
    pub ids: Range<u32>,
    pub list: &'a mut RecordList,
}

impl pulp::WithSimd for Photons<'_> {
    /// Rays, and photons by how they ended.
    type Output = (u64, [u64; 3]);

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Self::Output {
        let records = &mut self.list.records;
        records.clear();
        let mut rays = 0;
        let mut ends = [0; 3];
        for id in self.ids {
            let path =
                photon_trace(self.scene, self.dispatch, self.sampled, id, |record| records.push(record));
            rays += path.rays as u64;
            ends[path.end] += 1;
        }
        (rays, ends)
    }
}

/// One sample of each pixel of a chunk.
pub fn trace_aovs(scene: &Scene, d: &Dispatch, features: &Features, aovs: &mut [AovPixel]) {
    let sampled = features.has("sampled") && features.has("direct_layer");
    let first = (d.chunk_first / d.eye_samples) as usize;
    let pixels = aovs[first..first + d.end as usize].par_iter_mut();
    pixels.enumerate().for_each(|(id, pixel)| aov_trace(scene, d, sampled, id as u32, pixel));
}

/// Photons of one batch; the lists come in the order of their keys. The number of rays, and of photons by how they ended.
pub fn trace_photons(
    arch: pulp::Arch,
    scene: &Scene,
    d: &Dispatch,
    sampled: bool,
    records: &mut Vec<RecordList>,
) -> (u64, [u64; 3]) {
    let photons = d.end.div_ceil(PHOTON_TASKS).clamp(PHOTON_TASK.0, PHOTON_TASK.1);
    records.resize_with(d.end.div_ceil(photons) as usize, RecordList::default);
    let traced = records.par_iter_mut().enumerate().map(|(task, list)| {
        let first = task as u32 * photons;
        arch.dispatch(Photons {
            scene,
            dispatch: d,
            sampled,
            ids: first..first + photons.min(d.end - first),
            list,
        })
    });
    let sum = |(sum, all): (u64, [u64; 3]), (rays, ends): (u64, [u64; 3])| {
        (sum + rays, std::array::from_fn(|k| all[k] + ends[k]))
    };
    traced.reduce(|| (0, [0; 3]), sum)
}
