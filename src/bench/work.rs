//! Operation counts of the kernels of a pass, for rates.

use serde::Serialize;

use crate::engine::PassReport;
use crate::kernels::records::{FilmPixel, Gathered, PhotonRecord, VisiblePoint};
use crate::plan::features::Feature;
use crate::plan::{Kernel, Plan};

/// Operation counts of a pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Work {
    /// Eye paths.
    pub eye_paths: u64,
    /// Rays of eye paths, including shadow rays.
    pub eye_rays: u64,
    /// Photon paths.
    pub photons: u64,
    /// Rays of photon paths.
    pub photon_rays: u64,
    /// Photon records.
    pub records: u64,
    /// Number of visible points times number of photon batches.
    pub gathers: u64,
    /// Photons found in the gather discs.
    pub gathered: u64,
}

impl Work {
    /// Counts of a pass with this report and number of gathered photons.
    pub fn of(plan: &Plan, report: &PassReport, gathered: u64) -> Self {
        let batches = match plan.features.has(Feature::Photons) {
            true => u64::from(plan.settings.photons.div_ceil(plan.batch_photons.max(1))),
            false => 0,
        };
        Self {
            eye_paths: report.eye_paths,
            eye_rays: report.eye_rays,
            photons: report.photons,
            photon_rays: report.rays.saturating_sub(report.eye_rays),
            records: report.records,
            gathers: u64::from(plan.pixels) * u64::from(plan.eye_samples) * batches,
            gathered,
        }
    }

    /// Names of the rates of a kernel and their counts. Empty for the grid kernels of the CPU
    /// engine, which builds its grid in other steps than a GPU.
    pub fn counts(&self, plan: &Plan, kernel: &str, gpu: bool) -> Vec<(&'static str, f64)> {
        let counts = match kernel {
            "eye_trace" | "path_trace" => {
                vec![("paths_per_second", self.eye_paths), ("rays_per_second", self.eye_rays)]
            }
            "photon_trace" => {
                vec![("photons_per_second", self.photons), ("rays_per_second", self.photon_rays)]
            }
            "gather" => {
                vec![("gathers_per_second", self.gathers), ("photons_per_second", self.gathered)]
            }
            _ if !gpu && kernel.starts_with("grid_") => vec![],
            _ => {
                return self
                    .least_bytes(plan, kernel)
                    .map(|b| ("bytes_per_second", b))
                    .into_iter()
                    .collect();
            }
        };
        counts.into_iter().map(|(name, count)| (name, count as f64)).collect()
    }

    /// Minimum number of bytes that a grid kernel on a GPU, or `resolve`, transfers in a pass, if
    /// each value is read and written once.
    fn least_bytes(&self, plan: &Plan, kernel: &str) -> Option<f64> {
        let record = size_of::<PhotonRecord>() as f64;
        let records = self.records as f64;
        let points = f64::from(plan.pixels) * f64::from(plan.eye_samples);
        let batches = self.gathers as f64 / points;
        let buckets = f64::from(plan.buckets) * batches;
        let kernel = Kernel::ALL.into_iter().find(|k| k.stem() == kernel)?;
        Some(match kernel {
            // read the record; read and write the count
            Kernel::GridCount => records * (record + 8.0),
            Kernel::GridScanReduce => buckets * 4.0,
            // read the count, write the start
            Kernel::GridScan => buckets * 8.0,
            // read the record and the start; read and write the count; write the index
            Kernel::GridScatter => records * (record + 16.0),
            // read and write the index and the record
            Kernel::GridSort => records * (2.0 * record + 8.0),
            // read the visible point and its gathered sums; read and write the pixel
            Kernel::Resolve => {
                let point = (size_of::<VisiblePoint>() + size_of::<Gathered>()) as f64;
                points * point + f64::from(plan.pixels) * 2.0 * size_of::<FilmPixel>() as f64
            }
            _ => return None,
        })
    }
}
