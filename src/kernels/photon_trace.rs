//! Path of one photon: emission, then a record at every non-specular hit and on to the next until roulette
//! ends it. Run by one invocation per photon; reads the scene, appends to `records`. Twin:
//! `shaders/kernels/photon_trace.wgsl`.

use super::direct::{medium_before, transmittance};
use super::lights::aim::aimed_scatter;
use super::lights::emission::emit_photon;
use super::materials::scatter::{IMPORTANCE, is_specular, reflectance_at, scatter_rough, scatter_specular};
use super::math::rng::{STREAM_PHOTON, rng_new, rng_next};
use super::math::{FAR, max_component, oct_encode, offset_origin};
use super::real::Vec2;
use super::records::{Dispatch, PhotonRecord};
use super::shapes::intersect::intersect_scene;
use super::shapes::ray::Ray;
use super::shapes::surface::surface_at;
use super::tables::*;

/// How a photon's path ended: in [`PhotonPath::end`], and the place of its count.
pub const ESCAPED: usize = 0;
/// Roulette ended it, or nothing was left of its flux.
pub const ABSORBED: usize = 1;
/// It had been scattered as often as allowed.
pub const CUT: usize = 2;

/// What became of one photon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhotonPath {
    /// Rays traced.
    pub rays: u32,
    /// [`ESCAPED`], [`ABSORBED`] or [`CUT`].
    pub end: usize,
}

/// Traces photon `id` of the batch and hands each record to `store`. `sampled`:
/// photons straight from a light are not stored, since shadow rays bring that light.
#[inline(always)]
pub fn photon_trace(
    scene: &Scene,
    dispatch: &Dispatch,
    sampled: bool,
    id: u32,
    mut store: impl FnMut(PhotonRecord),
) -> PhotonPath {
    let mut rng = rng_new(dispatch.batch_first + id, dispatch.pass_number, STREAM_PHOTON, dispatch.seed);
    let emission = emit_photon(scene, &mut rng);
    let mut ray = emission.ray;
    let mut flux = emission.flux;
    let mut excess = emission.excess;
    let mut medium = emission.medium;
    let far = scene.world.disc_levels > 1;
    let tracked = far || scene.world.guided != 0;
    let mut family = 0;
    let mut rays = 0;
    let mut end = CUT;
    for bounce in 0..dispatch.max_bounces + 1 {
        if max_component(flux) <= 0.0 {
            end = ABSORBED;
            break;
        }
        rays += 1;
        let hit = intersect_scene(scene, &ray);
        if hit.reference == NONE {
            end = ESCAPED;
            break;
        }
        let s = surface_at(scene, &ray, &hit);
        let wo = -ray.direction;
        // the first ray of light from infinity starts behind its origin, outside of every medium
        flux *= transmittance(scene, medium_before(scene, &s, wo, medium), hit.t.max(0.0));
        let kind = scene.materials[s.material as usize].kind;
        let u = rng_next(&mut rng);
        let mut scattered;
        if is_specular(kind) {
            scattered = scatter_specular(scene, &s, wo, medium, u.x, IMPORTANCE);
        } else {
            let stored = bounce > 0 || !sampled;
            if stored && max_component(reflectance_at(scene, s.material, s.uv)) > 0.0 {
                let key = id << dispatch.key_bits | bounce << 1 | family;
                store(PhotonRecord { position: s.position, key, flux, direction: oct_encode(wo) });
            }
            scattered = scatter_rough(scene, &s, wo, medium, Vec2::new(u.x, u.y), IMPORTANCE);
            if far {
                scattered = aimed_scatter(scene, &s, wo, u, scattered);
            }
            if dispatch.families == 2 && kind == MATERIAL_DIFFUSE {
                family = 1;
            }
        }
        let weight = max_component(scattered.weight);
        // a faint photon, one of many that a map sends at glass and mirrors, is to get through them
        let mut survival = weight.min(1.0);
        if tracked {
            let kept = if is_specular(kind) { excess.max(1.0) } else { excess };
            survival = (weight * kept).min(1.0);
            excess *= weight / survival;
        }
        if u.w >= survival {
            end = ABSORBED;
            break;
        }
        scattered.weight *= 1.0 / survival;
        flux *= scattered.weight;
        medium = scattered.medium;
        let origin = offset_origin(s.position, s.error, s.normal, scattered.direction);
        ray = Ray { origin, t_min: 0.0, direction: scattered.direction, t_max: FAR };
    }
    PhotonPath { rays, end }
}
