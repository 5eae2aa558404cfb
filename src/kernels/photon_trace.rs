//! Path of one photon: emission, then a record at every non-specular hit, until roulette ends the
//! path. Run by one invocation per photon; reads the scene, appends to `records`. Twin:
//! `shaders/kernels/photon_trace.wgsl`.

use super::direct::transmittance;
use super::geometry::intersect::intersect_scene;
use super::geometry::surface::{Surface, surface_at};
use super::lights::aim::aimed_scatter;
use super::lights::emission::{Emission, emit_photon};
use super::materials::interior::{Interior, interior_before, medium_of, passes_hidden};
use super::materials::shading::{IMPORTANCE, shading_point};
use super::materials::{choose_layer, scatter_rough, scatter_specular};
use super::math::rng::{Rng, STREAM_PHOTON, rng_new, rng_next};
use super::math::{FAR, max_component, oct_encode, offset_origin};
use super::real::{Real, Vec3};
use super::records::{Dispatch, FOCUSED, HIDDEN_FACES, PhotonRecord};
use super::shapes::ray::{Hit, Ray};
use super::tables::*;

/// Value of [`PhotonPath::end`] and index of its counter: the path left the scene.
pub const ESCAPED: usize = 0;
/// The path was ended by roulette, or its flux became zero.
pub const ABSORBED: usize = 1;
/// The path reached the limit on scattering events or on hidden faces.
pub const CUT: usize = 2;

/// State of one photon path.
#[derive(Clone, Copy, Debug)]
pub struct PhotonPath {
    /// Next ray.
    pub ray: Ray,
    /// Number of rays traced.
    pub rays: u32,
    /// [`ESCAPED`], [`ABSORBED`] or [`CUT`]; valid once the path has ended.
    pub end: usize,
    id: u32,
    rng: Rng,
    flux: Vec3,
    relative_flux: Real,
    interior: Interior,
    photon_class: u32,
    /// [`FOCUSED`] or 0.
    focus: u32,
    bounce: u32,
    hidden: u32,
}

impl PhotonPath {
    /// Emits photon `id` of the batch.
    #[inline(always)]
    pub fn new(scene: &SceneTables, dispatch: &Dispatch, id: u32) -> PhotonPath {
        let mut rng =
            rng_new(dispatch.batch_first + id, dispatch.pass_number, STREAM_PHOTON, dispatch.seed);
        let emission = emit_photon(scene, &mut rng);
        let mut path = Self::emitted(emission, rng, id);
        if !emission.extended {
            path.focus = dispatch.continued & FOCUSED;
        }
        path
    }

    /// Starts the path of photon `id` of the batch from an emission.
    #[inline(always)]
    pub fn emitted(emission: Emission, rng: Rng, id: u32) -> PhotonPath {
        PhotonPath {
            ray: emission.ray,
            rays: 0,
            end: CUT,
            id,
            rng,
            flux: emission.flux,
            relative_flux: emission.relative_flux,
            interior: emission.interior,
            photon_class: 0,
            focus: 0,
            bounce: 0,
            hidden: 0,
        }
    }

    /// Returns true if the path continues with `ray`, and counts that ray.
    #[inline(always)]
    pub fn goes_on(&mut self, dispatch: &Dispatch) -> bool {
        if self.bounce > dispatch.max_bounces || self.hidden > HIDDEN_FACES {
            return false;
        }
        if max_component(self.flux) <= 0.0 {
            self.end = ABSORBED;
            return false;
        }
        self.rays += 1;
        true
    }

    /// Record of the photon at `s`, which it reached from the direction `wo`.
    #[inline(always)]
    fn record(&self, dispatch: &Dispatch, s: &Surface, wo: Vec3) -> PhotonRecord {
        let kind = self.focus | self.photon_class;
        let key = self.id << dispatch.key_bits | self.bounce << dispatch.bounce_shift | kind;
        PhotonRecord { position: s.position, key, flux: self.flux, direction: oct_encode(wo) }
    }

    /// Processes the hit of `ray` and samples the next ray; returns false if the path ends. Passes
    /// a record to `store` if the photon leaves one. With `sampled`, photons directly from a light
    /// are not stored, because shadow rays account for that light.
    #[inline(always)]
    pub fn meet(
        &mut self,
        scene: &SceneTables,
        dispatch: &Dispatch,
        sampled: bool,
        hit: &Hit,
        store: &mut impl FnMut(PhotonRecord),
    ) -> bool {
        if hit.reference == NONE {
            self.end = ESCAPED;
            return false;
        }
        let far = scene.world.far != 0;
        let tracked = far || scene.world.guided != 0;
        let s = surface_at(scene, &self.ray, hit);
        let wo = -self.ray.direction;
        // rays from infinity start behind their origin, where there is no medium
        self.interior = interior_before(scene, &s, wo, &self.interior);
        self.flux *= transmittance(scene, medium_of(&self.interior), hit.t.max(0.0));
        if passes_hidden(scene, &s, &mut self.ray, &mut self.interior) {
            self.hidden += 1;
            return true;
        }
        let mut p = shading_point(scene, hit, &s, wo, &self.interior);
        // store a record at non-specular hits, unless shadow rays account for the light; shadow
        // rays end at faces, hidden ones included
        let mut stores = self.bounce > 0 || self.hidden > 0 || !sampled;
        let mut layer = 1.0;
        if p.lobe.bsdf.is_layered() {
            if stores && p.lobe.m.stores != 0 {
                store(self.record(dispatch, &s, wo));
            }
            stores = false;
            let u = rng_next(&mut self.rng);
            layer = choose_layer(scene, hit, &mut p, u.x);
        }
        // scatter
        let specular = p.lobe.bsdf.is_specular();
        let u = rng_next(&mut self.rng);
        let mut scattered;
        if specular {
            scattered = scatter_specular(scene, &p, &self.interior, u.x, IMPORTANCE);
        } else {
            if stores && max_component(p.lobe.reflectance) > 0.0 {
                store(self.record(dispatch, &s, wo));
            }
            scattered = scatter_rough(scene, &p, &self.interior, u.truncate(), IMPORTANCE);
            if far {
                scattered = aimed_scatter(scene, &p, u, scattered);
            }
            self.focus = 0;
            if dispatch.classes == 2 && p.lobe.bsdf.is_wide() {
                self.photon_class = 1;
            }
        }
        scattered.weight *= layer;
        // Russian roulette
        let weight = max_component(scattered.weight);
        // guiding maps send many faint photons at glass and mirrors: roulette must not end them
        // there
        let mut survival = weight.min(1.0);
        if tracked {
            let kept = if specular { self.relative_flux.max(1.0) } else { self.relative_flux };
            survival = (weight * kept).min(1.0);
            self.relative_flux *= weight / survival;
        }
        if u.w >= survival {
            self.end = ABSORBED;
            return false;
        }
        scattered.weight *= 1.0 / survival;
        self.flux *= scattered.weight;
        self.interior = scattered.interior;
        let origin = offset_origin(s.position, s.error, s.normal, scattered.direction);
        self.ray = Ray { origin, t_min: 0.0, direction: scattered.direction, t_max: FAR };
        self.bounce += 1;
        true
    }
}

/// Traces photon `id` of the batch and passes each record to `store`.
#[inline(always)]
pub fn photon_trace(
    scene: &SceneTables,
    dispatch: &Dispatch,
    sampled: bool,
    id: u32,
    mut store: impl FnMut(PhotonRecord),
) -> PhotonPath {
    let mut path = PhotonPath::new(scene, dispatch, id);
    while path.goes_on(dispatch) {
        let hit = intersect_scene(scene, &path.ray);
        if !path.meet(scene, dispatch, sampled, &hit, &mut store) {
            break;
        }
    }
    path
}
