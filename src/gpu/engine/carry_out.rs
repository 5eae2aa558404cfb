//! The steps of a pass, dispatched; what a software driver stopped is found again.

use super::super::mend::{mend_aovs, mend_photons, mend_points};
use super::super::program::workgroup_items;
use super::{COUNTERS_BYTES, ENDS, GpuEngine, READINGS_BYTES, STOPPED_COUNT};
use crate::engine::{EngineError, PassReport, PhotonEnds};
use crate::features::Feature;
use crate::kernels::records::Dispatch;
use crate::plan::{Kernel, Step};

/// Records of each batch, rays and photons' ends of a pass, and invocations that the driver
/// stopped.
struct Counted {
    records: Vec<u32>,
    rays: u64,
    eye_rays: u64,
    ends: PhotonEnds,
    stopped: u32,
}

impl GpuEngine {
    /// Submits what was recorded.
    fn flush(&mut self) -> Result<(), EngineError> {
        let seconds = self.recorder.finish(&self.gpu)?;
        if self.stamped {
            for (kernel, seconds) in self.recorder.stamped(&self.gpu)? {
                self.clock.add(kernel.stem(), seconds);
            }
        }
        if seconds > 0.0 {
            self.submissions.count += 1;
        }
        if seconds > self.submissions.longest_seconds {
            self.submissions.longest_seconds = seconds;
            self.submissions.longest = self.pace.kernels().collect();
        }
        self.pace.learn(seconds);
        Ok(())
    }

    /// Runs a step, by itself if its time is asked for and the device has no clock.
    fn run(&mut self, step: &Step) -> Result<(), EngineError> {
        if self.stamped || !self.clock.is_wound() {
            return self.record(step);
        }
        self.flush()?;
        self.clock.begin(step.kernel.stem());
        self.record(step)?;
        self.flush()?;
        self.clock.end();
        Ok(())
    }

    /// Records a step in as many dispatches as the pace asks for.
    fn record(&mut self, step: &Step) -> Result<(), EngineError> {
        let Dispatch { mut first, end, .. } = step.dispatch;
        let whole = step.kernel == Kernel::GridScanSums;
        let granule = workgroup_items(step.kernel);
        while first < end {
            let fit = self.pace.fit(step.kernel, end - first);
            if fit == 0 || self.recorder.is_full() {
                self.flush()?;
                // once a part is resolved, the whole pass is to be in the film
                if !self.torn {
                    self.plan.cancel.check()?;
                }
                continue;
            }
            let items = if whole { end } else { fit.next_multiple_of(granule).min(end - first) };
            let dispatch = Dispatch { first, end: first + items, ..step.dispatch };
            let group = &self.groups[&(step.kernel, step.chunk)];
            self.recorder.dispatch(&self.gpu, &self.programs[&step.kernel], group, &dispatch);
            self.pace.record(step.kernel, items, end - step.dispatch.first);
            first += items;
        }
        Ok(())
    }

    /// A pass with so many photons a batch; nothing where that has to be thrown away, since records
    /// did not fit or the driver stopped long loops.
    pub(super) fn phases(&mut self, batch: u32) -> Result<Option<PassReport>, EngineError> {
        self.plan.cancel.check()?;
        let pass = self.passes_done;
        let mut report = PassReport {
            photons: self.plan.settings.photons as u64,
            radius: self.plan.radius(pass),
            ..PassReport::default()
        };
        for (number, steps) in self.plan.phases(pass, batch).into_iter().enumerate() {
            let (resolve, trace): (Vec<_>, Vec<_>) =
                steps.into_iter().partition(|s| adds_up(s.kernel));
            let counted = self.trace(&trace, number == 0)?;
            let photons =
                trace.iter().filter(|s| s.kernel == Kernel::PhotonTrace).map(|s| s.dispatch.end);
            let overflow =
                |(photons, records): (u32, &u32)| *records > self.plan.capacity && photons > 1;
            let overflows = photons.zip(&counted.records).any(overflow);
            // tiles before this one have been added to the film
            if counted.stopped > 0 && (batch == 1 || self.scene.is_none() || self.torn) {
                return Err(self.unfinished());
            }
            if overflows || counted.stopped > 0 {
                return Ok(None);
            }
            self.torn = true;
            for step in &resolve {
                self.run(step)?;
                self.mend_aovs(step)?;
            }
            self.flush()?;
            let eyes = trace
                .iter()
                .filter(|s| s.kernel == Kernel::EyeTrace)
                .map(|s| s.dispatch.end as u64);
            report.eye_paths += eyes.sum::<u64>();
            report.rays += counted.rays;
            report.eye_rays += counted.eye_rays;
            // photons that are traced again for another tile are the same
            if number == 0 {
                report.records = counted.records.iter().map(|r| *r as u64).sum();
                report.ends = counted.ends;
            }
        }
        self.torn = false;
        Ok(Some(report))
    }

    /// The steps of a phase up to `Resolve`, which do not touch what passes before have found.
    fn trace(&mut self, steps: &[Step], first_phase: bool) -> Result<Counted, EngineError> {
        let batches = steps.iter().filter(|s| s.kernel == Kernel::PhotonTrace).count() as u64;
        let bytes = READINGS_BYTES + 4 * batches;
        if self.readings.size() < bytes {
            self.readings = self.gpu.storage("readings", bytes)?;
        }
        let shared = self.shared.get("gathered");
        let own =
            self.chunks.iter().filter_map(|chunk| chunk.get("gathered").filter(|_| first_phase));
        for gathered in own.chain(shared) {
            self.recorder.clear(&self.gpu, gathered, None);
        }
        self.recorder.clear(&self.gpu, &self.shared["counters"], None);
        let mut offset = READINGS_BYTES;
        let (mut mended, mut mended_eyes) = (0, 0);
        for step in steps {
            if step.kernel == Kernel::PhotonTrace {
                self.recorder.clear(&self.gpu, &self.shared["counters"], Some(4));
            }
            self.run(step)?;
            mended += self.mend(step)?;
            if step.kernel == Kernel::EyeTrace {
                mended_eyes = mended;
                self.recorder.copy(
                    &self.gpu,
                    (&self.shared["counters"], 4),
                    (&self.readings, COUNTERS_BYTES),
                    8,
                );
            }
            if step.kernel == Kernel::PhotonTrace {
                self.recorder.copy(
                    &self.gpu,
                    (&self.shared["counters"], 0),
                    (&self.readings, offset),
                    4,
                );
                offset += 4;
            }
        }
        let counters = &self.shared["counters"];
        self.recorder.copy(&self.gpu, (counters, 0), (&self.readings, 0), COUNTERS_BYTES);
        self.flush()?;
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&self.gpu.read(&self.readings, bytes)?);
        let wide = |at: usize| words[at] as u64 | (words[at + 1] as u64) << 32;
        let rays = wide(1) + mended;
        // a pass that traces no eye path leaves what stood here
        let eyes = steps.iter().any(|step| step.kernel == Kernel::EyeTrace);
        let eye_rays = if eyes { wide(COUNTERS_BYTES as usize / 4) + mended_eyes } else { 0 };
        let ends = PhotonEnds::of([words[ENDS], words[ENDS + 1], words[ENDS + 2]].map(u64::from));
        let records = words[READINGS_BYTES as usize / 4..].to_vec();
        Ok(Counted { records, rays, eye_rays, ends, stopped: words[3] })
    }

    /// Traces again, on the CPU, the paths of a step that a software driver stopped; the number of
    /// their rays.
    fn mend(&mut self, step: &Step) -> Result<u64, EngineError> {
        if self.scene.is_none() || !matches!(step.kernel, Kernel::EyeTrace | Kernel::PhotonTrace) {
            return Ok(0);
        }
        self.flush()?;
        let counters = &self.shared["counters"];
        let mut words: Vec<u32> =
            bytemuck::pod_collect_to_vec(&self.gpu.read(counters, COUNTERS_BYTES)?);
        let Some(scene) = self.scene.as_ref().filter(|_| words[3] > 0) else {
            return Ok(0);
        };
        let sampled = self.plan.features.has(Feature::Sampled);
        let (mended, rays) = if step.kernel == Kernel::EyeTrace {
            let own = self.chunks[step.chunk as usize].get("visible_points");
            let buffer = own.unwrap_or_else(|| &self.shared["visible_points"]);
            mend_points(&self.gpu, scene, &step.dispatch, sampled, buffer)?
        } else {
            let mended = mend_photons(
                &self.gpu,
                scene,
                &step.dispatch,
                sampled,
                &self.shared["records"],
                words[0],
            )?;
            words[0] = mended.records;
            for (word, count) in words[ENDS..].iter_mut().zip(mended.ends) {
                *word += count;
            }
            (mended.photons, mended.rays)
        };
        // what is left are loops of the batches before, for which the pass is run again
        words[3] -= mended.min(words[3]);
        self.gpu.write(counters, bytemuck::cast_slice(&words));
        Ok(rays)
    }

    /// Traces again, on the CPU, the samples of a step that a software driver stopped; fails where
    /// there is another driver.
    fn mend_aovs(&mut self, step: &Step) -> Result<(), EngineError> {
        if step.kernel != Kernel::AovTrace {
            return Ok(());
        }
        self.flush()?;
        let counters = &self.shared["counters"];
        let mut words: Vec<u32> =
            bytemuck::pod_collect_to_vec(&self.gpu.read(counters, COUNTERS_BYTES)?);
        if words[STOPPED_COUNT] == 0 {
            return Ok(());
        }
        let Some(scene) = &self.scene else {
            return Err(self.unfinished());
        };
        let sampled = self.plan.features.has(Feature::Sampled)
            && self.plan.features.has(Feature::DirectLayer);
        mend_aovs(
            &self.gpu,
            scene,
            &step.dispatch,
            sampled,
            &self.chunks[step.chunk as usize]["aovs"],
        )?;
        words[STOPPED_COUNT] = 0;
        self.gpu.write(counters, bytemuck::cast_slice(&words));
        Ok(())
    }

    fn unfinished(&self) -> EngineError {
        EngineError::Unsupported(format!(
            "{} leaves long loops unfinished; take --device cpu",
            self.device
        ))
    }
}

/// Whether a kernel adds to what passes before have found, so that it must not run in a pass that
/// is thrown away.
fn adds_up(kernel: Kernel) -> bool {
    matches!(kernel, Kernel::ResolveParts | Kernel::Resolve | Kernel::AovTrace)
}
