//! What the kernels of a pass do, counted: the denominators of rates.

use serde::Serialize;

use crate::engine::PassReport;
use crate::kernels::records::{FilmPixel, Gathered, PhotonRecord, VisiblePoint};
use crate::plan::features::Feature;
use crate::plan::{Kernel, Plan};

/// What a pass did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Work {
    /// Eye paths.
    pub eye_paths: u64,
    /// Their rays, shadow rays among them.
    pub eye_rays: u64,
    /// Photon paths.
    pub photons: u64,
    /// Their rays.
    pub photon_rays: u64,
    /// Photon records.
    pub records: u64,
    /// Visible points that were gathered for, times batches.
    pub gathers: u64,
    /// Photons found in their discs.
    pub gathered: u64,
}

impl Work {
    /// Of a pass that reported this and gathered so many photons.
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

    /// What is counted of a kernel: the name of the rate, and how much. The CPU engine builds its
    /// grid in other steps than a GPU, whose bytes are not counted.
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

    /// Bytes that a GPU's kernel of the grid, or `resolve`, has to move in a pass, if every datum
    /// travels once each way.
    fn least_bytes(&self, plan: &Plan, kernel: &str) -> Option<f64> {
        let record = size_of::<PhotonRecord>() as f64;
        let records = self.records as f64;
        let points = f64::from(plan.pixels) * f64::from(plan.eye_samples);
        let batches = self.gathers as f64 / points;
        let buckets = f64::from(plan.buckets) * batches;
        let kernel = Kernel::ALL.into_iter().find(|k| k.stem() == kernel)?;
        Some(match kernel {
            // the record in; the count in and out
            Kernel::GridCount => records * (record + 8.0),
            Kernel::GridScanReduce => buckets * 4.0,
            // the count in, the start out
            Kernel::GridScan => buckets * 8.0,
            // the record and the start in; the count in and out; the number out
            Kernel::GridScatter => records * (record + 16.0),
            // the number and the record in, both out
            Kernel::GridSort => records * (2.0 * record + 8.0),
            // the point and what it gathered in; the pixel in and out
            Kernel::Resolve => {
                let point = (size_of::<VisiblePoint>() + size_of::<Gathered>()) as f64;
                points * point + f64::from(plan.pixels) * 2.0 * size_of::<FilmPixel>() as f64
            }
            _ => return None,
        })
    }
}
