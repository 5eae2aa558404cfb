//! What a pass keeps on the device.

use super::super::features::Feature;
use super::super::kernels::aov_trace::AovPixel;
use super::super::kernels::records::{FilmPixel, Gathered, PhotonRecord, Statistics, VisiblePoint};
use super::super::kernels::resolve_parts::PartsPixel;
use super::Plan;
use super::kernel::SCAN_BLOCK;
use crate::scene::Aov;

impl Plan {
    /// Buffers of visible points that chunks take turns with. The counts of `gathered` are kept
    /// where a layer shows them.
    pub fn in_turn(&self) -> &'static [&'static str] {
        match (self.tiled, self.aovs.has(Aov::Photons)) {
            (false, _) => &[],
            (true, true) => &["visible_points"],
            (true, false) => &["visible_points", "gathered"],
        }
    }

    /// Name and bytes of every buffer beside the scene's; those of chunks for the largest chunk.
    pub fn buffers(&self) -> Vec<(&'static str, u64)> {
        let points = self.chunk(0).1 as u64;
        let pixels = points / self.eye_samples as u64;
        let records = self.capacity as u64;
        let mut list = vec![
            ("visible_points", points * size_of::<VisiblePoint>() as u64),
            ("film", pixels * size_of::<FilmPixel>() as u64),
            ("gathered", points * size_of::<Gathered>() as u64),
            ("counters", 32),
        ];
        if self.features.has(Feature::Local) {
            list.push(("statistics", points * size_of::<Statistics>() as u64));
        }
        if self.aovs.are_traced() {
            list.push(("aovs", pixels * size_of::<AovPixel>() as u64));
        }
        if self.parts_photons() {
            list.push(("parts", pixels * size_of::<PartsPixel>() as u64));
        }
        if self.features.has(Feature::Photons) {
            list.extend([
                ("records", records * size_of::<PhotonRecord>() as u64),
                ("sorted", records * size_of::<PhotonRecord>() as u64),
                ("order", records * 4),
                ("counts", self.buckets as u64 * 4),
                ("starts", (self.buckets as u64 + 1) * 4),
                ("block_sums", (self.buckets / SCAN_BLOCK + 1) as u64 * 4),
            ]);
        }
        list
    }
}
