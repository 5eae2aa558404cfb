//! Retraces paths that a software driver stopped, with the Rust twins of the kernels.
//!
//! Mesa's software driver silently leaves all loops of an invocation once they have run 65535
//! rounds together (`LP_MAX_TGSI_LOOP_ITERATIONS`); long paths through surfaces of revolution need
//! more. The kernels detect this and mark their output. The twins compute the same bits that the
//! driver would have.

use super::context::Gpu;
use super::executor::execute::Repair;
use super::executor::{ENDS, Executor, STOPPED_COUNT};
use crate::engine::EngineError;
use crate::kernels::aov_trace::{AovPixel, aov_trace};
use crate::kernels::eye_trace::eye_trace;
use crate::kernels::photon_trace::{PhotonPath, photon_trace};
use crate::kernels::records::{Dispatch, PhotonRecord, STOPPED, VisiblePoint};
use crate::plan::features::Feature;
use crate::plan::{Buffer, Stage, Step};
use crate::tables::SceneTables;
use bytemuck::{cast_slice, pod_collect_to_vec};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Retraces the paths that a software driver stopped.
pub struct Retracer {
    /// Tables of the scene.
    pub scene: SceneTables,
}

impl Repair for Retracer {
    fn after_step(&self, executor: &mut Executor, step: &Step) -> Result<u64, EngineError> {
        match step.stage {
            Stage::EyeTrace | Stage::PhotonTrace | Stage::AovTrace => {}
            Stage::BuildGrid | Stage::Gather | Stage::ResolveParts | Stage::Resolve => {
                return Ok(0);
            }
        }
        let mut words = executor.counters()?;
        if words[STOPPED_COUNT] == 0 {
            return Ok(0);
        }
        let (scene, gpu, dispatch) = (&self.scene, &executor.gpu, &step.dispatch);
        let own = |which| executor.buffer(which, step.chunk);
        let sampled = executor.plan.features.has(Feature::Sampled);
        let rays = match step.stage {
            Stage::EyeTrace => {
                let points = own(Buffer::VisiblePoints);
                let (paths, rays) = retrace_points(gpu, scene, dispatch, sampled, points)?;
                words[STOPPED_COUNT] -= paths.min(words[STOPPED_COUNT]);
                rays
            }
            Stage::PhotonTrace => {
                let records = own(Buffer::Records);
                let found = retrace_photons(gpu, scene, dispatch, sampled, records, words[0])?;
                words[0] = found.records;
                words[ENDS..].iter_mut().zip(found.ends).for_each(|(word, count)| *word += count);
                // the rest are loops of earlier batches, for which the pass is run again
                words[STOPPED_COUNT] -= found.photons.min(words[STOPPED_COUNT]);
                found.rays
            }
            Stage::AovTrace => {
                let lit = executor.plan.features.has(Feature::DirectLayer);
                retrace_aovs(gpu, scene, dispatch, sampled, lit, own(Buffer::Aovs))?;
                words[STOPPED_COUNT] = 0;
                0
            }
            Stage::BuildGrid | Stage::Gather | Stage::ResolveParts | Stage::Resolve => 0,
        };
        executor.set_counters(&words);
        Ok(rays)
    }

    fn allows_retry(&self) -> bool {
        true
    }
}

/// Repairs nothing: for drivers that finish loops.
pub struct Unrepaired;

impl Repair for Unrepaired {
    fn after_step(&self, executor: &mut Executor, step: &Step) -> Result<u64, EngineError> {
        // layers are traced after the last reading of the counters in a pass
        if step.stage == Stage::AovTrace && executor.counters()?[STOPPED_COUNT] > 0 {
            return Err(executor.unfinished());
        }
        Ok(0)
    }

    fn allows_retry(&self) -> bool {
        false
    }
}

/// Retraces the marked points of a chunk; returns the numbers of points and of rays.
fn retrace_points(
    gpu: &Gpu,
    scene: &SceneTables,
    dispatch: &Dispatch,
    sampled: bool,
    buffer: &wgpu::Buffer,
) -> Result<(u32, u64), EngineError> {
    let bytes = dispatch.end as u64 * size_of::<VisiblePoint>() as u64;
    let mut points: Vec<VisiblePoint> = pod_collect_to_vec(&gpu.read(buffer, bytes)?);
    let marked = points.par_iter_mut().enumerate().filter(|(_, point)| point.state & STOPPED != 0);
    let rays = marked.map(|(id, point)| {
        let (traced, rays) = eye_trace(scene, dispatch, sampled, id as u32);
        *point = traced;
        (1, rays as u64)
    });
    let retraced = rays.reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    gpu.write(buffer, cast_slice(&points));
    Ok(retraced)
}

/// Retraces the samples of the marked pixels of a chunk.
fn retrace_aovs(
    gpu: &Gpu,
    scene: &SceneTables,
    dispatch: &Dispatch,
    sampled: bool,
    lit: bool,
    buffer: &wgpu::Buffer,
) -> Result<(), EngineError> {
    let bytes = dispatch.end as u64 * size_of::<AovPixel>() as u64;
    let mut aovs: Vec<AovPixel> = pod_collect_to_vec(&gpu.read(buffer, bytes)?);
    let marked = aovs.par_iter_mut().enumerate().filter(|(_, aov)| aov.state & STOPPED != 0);
    marked.for_each(|(id, aov)| {
        aov.state &= !STOPPED;
        aov_trace(scene, dispatch, sampled, lit, id as u32, aov);
    });
    gpu.write(buffer, cast_slice(&aovs));
    Ok(())
}

/// Result of [`retrace_photons`].
struct RetracedPhotons {
    /// Number of records of the batch after retracing.
    pub records: u32,
    /// Number of photons that were retraced.
    pub photons: u32,
    /// Number of their rays.
    pub rays: u64,
    /// Numbers of photons by how their paths ended.
    pub ends: [u32; 3],
}

/// Replaces the records of the marked photons among the `count` records of a batch.
fn retrace_photons(
    gpu: &Gpu,
    scene: &SceneTables,
    dispatch: &Dispatch,
    sampled: bool,
    buffer: &wgpu::Buffer,
    count: u32,
) -> Result<RetracedPhotons, EngineError> {
    if count > dispatch.capacity {
        // the batch has overflowed and will be traced again
        return Ok(RetracedPhotons { records: count, photons: 0, rays: 0, ends: [0; 3] });
    }
    let bytes = count as u64 * size_of::<PhotonRecord>() as u64;
    let mut records: Vec<PhotonRecord> = pod_collect_to_vec(&gpu.read(buffer, bytes)?);
    // no encoded direction is 0
    let is_mark = |record: &PhotonRecord| record.direction == 0;
    let marked: BTreeSet<u32> =
        records.iter().filter(|r| is_mark(r)).map(|mark| mark.key).collect();
    records.retain(|r| !is_mark(r) && !marked.contains(&(r.key >> dispatch.key_bits)));
    let photons = marked.len() as u32;
    let traced: Vec<(Vec<PhotonRecord>, PhotonPath)> = marked
        .into_par_iter()
        .map(|id| {
            let mut found = Vec::new();
            let path = photon_trace(scene, dispatch, sampled, id, |record| found.push(record));
            (found, path)
        })
        .collect();
    let rays = traced.iter().map(|(_, path)| path.rays as u64).sum();
    let mut ends = [0; 3];
    traced.iter().for_each(|(_, path)| ends[path.end] += 1);
    records.extend(traced.into_iter().flat_map(|(found, _)| found));
    let count = records.len() as u32;
    records.truncate(dispatch.capacity as usize);
    gpu.write(buffer, cast_slice(&records));
    Ok(RetracedPhotons { records: count, photons, rays, ends })
}
