//! Pilot paths, and the stages that prepare a scene for rendering.
//!
//! [`prepare`] calls the stages in order: it packs the scene, traces pilot eye paths, packs again
//! if these show that scene space should be centered elsewhere, and learns from pilot photons how
//! to sample the lights. [`probe()`] then measures what a plan needs to know. Pilots run on
//! the CPU for every engine, so that all engines render the same image.

mod cells;
mod discs;
mod emission;
mod eye_pilots;
pub mod probe;
mod transfer;
mod visibility;

pub use probe::{Probe, probe};
pub use transfer::learned;

use super::lights::LightKind;
use super::pack::{PackError, PackedScene, pack};
use super::real::{Real, ToDouble, Vec3};
use super::{geometry, kernels, lights, materials, math, real, shapes, tables};
use crate::prepare::learned::Learned;
use crate::prepare::normalize::{Normalization, reach};
use crate::scene::Scene;
use crate::telemetry::stage::stage;
use eye_pilots::{EyePilots, Region, trace_eye_pilots};
use std::f64::consts::PI;
use visibility::Visibility;

/// Packs `scene` for an image of `width` by `height` pixels, and learns from pilot paths how to
/// sample its lights.
///
/// # Errors
/// Those of [`pack`].
pub fn prepare(scene: &Scene, width: u32, height: u32) -> Result<PackedScene, PackError> {
    let mut packed = pack(scene, Normalization::of(scene), width, height)?;
    let mut eyes = trace_eye_pilots(&packed.tables);
    if let Some(better) = better_normalization(&packed, &eyes) {
        packed = pack(scene, better, width, height)?;
        eyes = trace_eye_pilots(&packed.tables);
    }
    learn(&mut packed, scene, &eyes);
    Ok(packed)
}

/// Like [`prepare`], with the results that another precision has learned.
///
/// # Errors
/// Those of [`pack`].
pub fn prepare_like(
    scene: &Scene,
    width: u32,
    height: u32,
    learned: &Learned,
) -> Result<PackedScene, PackError> {
    let mut packed = pack(scene, learned.normalization, width, height)?;
    transfer::apply(&mut packed, learned);
    Ok(packed)
}

/// Learns again for the current camera, so that the tables equal those of [`prepare`]. Returns
/// false, without learning, if `prepare` might choose a different normalization.
pub fn relearn(packed: &mut PackedScene, scene: &Scene) -> bool {
    if packed.normalization != Normalization::of(scene) {
        return false;
    }
    let eyes = trace_eye_pilots(&packed.tables);
    if better_normalization(packed, &eyes).is_some() {
        return false;
    }
    learn(packed, scene, &eyes);
    true
}

/// A normalization that suits the region seen by the camera, if the current one does not.
fn better_normalization(packed: &PackedScene, eyes: &EyePilots) -> Option<Normalization> {
    let region = eyes.region()?;
    let center = packed.normalization.world(region.center.to_double());
    let radius = f64::from(region.radius) * packed.unit;
    (!packed.normalization.suits(center, radius)).then(|| Normalization::about(center, radius))
}

/// Learns emission discs, probabilities of lights, and guide maps.
fn learn(packed: &mut PackedScene, scene: &Scene, eyes: &EyePilots) {
    let _stage = stage("pilots");
    let n = &packed.normalization;
    let out = &mut packed.tables;
    out.distributions.truncate(packed.learned_from);
    // if nothing is seen, use the whole scene
    let all = Region { center: Vec3::ZERO, radius: (n.radius / n.unit) as Real };
    let region = eyes.region().unwrap_or(all);
    let (center, radius) = (n.world(region.center.to_double()), f64::from(region.radius) * n.unit);
    discs::learn_discs(out, eyes, region, reach(scene, center, radius) / n.unit);
    let area = PI * f64::from(region.radius) * f64::from(region.radius);
    let lights = out.lights.iter().zip(&packed.power);
    let power: Vec<f64> = lights
        .map(
            |(light, power)| {
                if LightKind::of(light.kind).is_infinite() { area * power } else { *power }
            },
        )
        .collect();
    packed.contributions = emission::learn_emission(out, &Visibility::new(eyes, region), &power);
    cells::learn_cells(out, eyes, &power);
}
