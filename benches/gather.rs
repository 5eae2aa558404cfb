//! Density estimation at visible points on the CPU. `cargo bench --bench gather`.
//!
//! Sizes: a disc contains about one photon in dark areas or after the radius has shrunk, ten to a
//! hundred for a well-chosen radius, and a thousand in a caustic or at the start of a render.

use bytemuck::Zeroable;
use caustica::low_level::kernels::gather::gather;
use caustica::low_level::kernels::grid_build::build_grid;
use caustica::low_level::kernels::records::{Dispatch, Gathered, PhotonRecord, VisiblePoint};
use caustica::low_level::math::oct_encode;
use caustica::low_level::tables::NONE;
use divan::{Bencher, counter::ItemsCount};
use glam::Vec3;

/// Number of records on a square wall; too many for the L1 cache.
const RECORDS: u32 = 1 << 18;
/// Number of visible points per measurement.
const POINTS: u32 = 1 << 10;

fn main() {
    divan::main();
}

#[divan::bench(args = [1, 10, 100, 1000])]
fn photons_in_a_disc(bencher: Bencher, photons: u32) {
    let mut state = 1u32;
    let mut random = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / 16_777_216.0
    };
    let up = oct_encode(Vec3::Y);
    // wall of area one, cells as wide as a disc
    let radius = (photons as f32 / RECORDS as f32 / std::f32::consts::PI).sqrt();
    let mask = RECORDS - 1;
    let d = Dispatch {
        capacity: RECORDS,
        mask,
        inv_cell: 0.5 / radius,
        scale_sq: 1.0,
        classes: 1,
        ..Dispatch::zeroed()
    };
    let mut on_the_wall = || Vec3::new(random(), 0.0, random());
    let records: Vec<_> = (0..RECORDS)
        .map(|key| PhotonRecord { position: on_the_wall(), key, flux: Vec3::ONE, direction: up })
        .collect();
    let (starts, sorted) = build_grid(&d, records);
    let points: Vec<_> = (0..POINTS)
        .map(|_| VisiblePoint {
            position: on_the_wall(),
            radius,
            weight: Vec3::ONE,
            outline: NONE,
            normal: up,
            shading: up,
            ..VisiblePoint::zeroed()
        })
        .collect();
    bencher.counter(ItemsCount::new(POINTS)).bench_local(|| {
        let mut found = 0;
        for point in &points {
            let mut gathered = Gathered::zeroed();
            gather(&[], &[], &d, point, 1.0, &starts, &sorted, &mut gathered);
            found += gathered.count;
        }
        found
    });
}
