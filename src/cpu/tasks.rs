//! Tasks of a pass, the work that one core does at a time, compiled for the processor's vector
//! instructions.

use super::super::kernels::aov_trace::{AovPixel, aov_trace};
use super::super::kernels::eye_trace::eye_trace;
use super::super::kernels::gather::{gather, scale_sq};
use super::super::kernels::grid_build::SortedRecords;
use super::super::kernels::records::*;
use super::super::plan::features::{Feature, Features};
use super::super::tables::{Material, Outline, SceneTables};
use rayon::prelude::*;

/// Number of visible points that one task gathers for.
pub const GATHER_TASK: usize = 1024;
/// Number of visible points that one task traces.
pub const EYE_TASK: usize = 512;

/// Gathers photons for the visible points of one task.
pub struct Gathers<'a> {
    pub materials: &'a [Material],
    pub outlines: &'a [Outline],
    pub dispatch: &'a Dispatch,
    pub points: &'a [VisiblePoint],
    /// Statistics of the points, under the local rule only.
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
            gather(
                self.materials,
                self.outlines,
                self.dispatch,
                point,
                scale,
                self.starts,
                self.sorted,
                gathered,
            );
        }
    }
}

/// Traces the eye paths of one task.
pub struct EyePaths<'a> {
    pub scene: &'a SceneTables,
    pub dispatch: &'a Dispatch,
    pub sampled: bool,
    pub first: u32,
    pub points: &'a mut [VisiblePoint],
}

impl pulp::WithSimd for EyePaths<'_> {
    /// Number of rays.
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

/// Traces one sample of each pixel of a chunk for the AOVs.
pub fn trace_aovs(scene: &SceneTables, d: &Dispatch, features: &Features, aovs: &mut [AovPixel]) {
    let sampled = features.has(Feature::Sampled);
    let lit = features.has(Feature::DirectLayer);
    let first = (d.chunk_first / d.eye_samples) as usize;
    let pixels = aovs[first..first + d.end as usize].par_iter_mut();
    pixels.enumerate().for_each(|(id, pixel)| aov_trace(scene, d, sampled, lit, id as u32, pixel));
}
