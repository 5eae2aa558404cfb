//! Steps of an eye path, shared by eye tracing, AOVs and path tracing. Twin:
//! `shaders/kernels/eye_path.wgsl`.

use super::direct::transmittance;
use super::geometry::intersect::intersect_scene;
use super::geometry::surface::{Surface, surface_at};
use super::lights::area::eval_area;
use super::lights::environment::eval_environment;
use super::lights::sun_disc::eval_sun_discs;
use super::materials::enclosing::interior_at;
use super::materials::interior::{Interior, interior_before, medium_of, passes_hidden};
use super::materials::shading::Scatter;
use super::math::{FAR, max_component, offset_origin};
use super::real::{Real, Vec3};
use super::records::{Dispatch, HIDDEN_FACES};
use super::shapes::ray::{Hit, Ray};
use super::tables::*;

/// State of an eye path.
#[derive(Clone, Copy, Debug)]
pub struct EyePath {
    /// Next ray.
    pub ray: Ray,
    /// Product of the scattering weights, roulette factors and transmittances so far.
    pub throughput: Vec3,
    /// Media that the ray's origin lies in.
    pub interior: Interior,
    /// Number of hidden faces passed.
    pub hidden: u32,
    /// Number of scattering events.
    pub bounce: u32,
    /// Path length so far, scene units.
    pub length: Real,
    /// Number of rays traced.
    pub rays: u32,
}

impl EyePath {
    /// Starts a path with a camera ray.
    #[inline(always)]
    pub fn new(scene: &SceneTables, ray: Ray) -> Self {
        let interior = interior_at(scene, scene.camera.medium, ray.origin);
        let throughput = Vec3::ONE;
        Self { ray, throughput, interior, hidden: 0, bounce: 0, length: 0.0, rays: 0 }
    }

    /// Returns true while the path is within its limits on scattering events and hidden faces.
    #[inline(always)]
    pub fn continues(&self, dispatch: &Dispatch) -> bool {
        self.bounce <= dispatch.max_bounces && self.hidden <= HIDDEN_FACES
    }

    /// Traces the path's ray and counts it.
    #[inline(always)]
    pub fn trace(&mut self, scene: &SceneTables) -> Hit {
        self.rays += 1;
        intersect_scene(scene, &self.ray)
    }

    /// Radiance of the environment and of suns in the ray's direction, times throughput.
    #[inline(always)]
    pub fn environment(&self, scene: &SceneTables) -> Vec3 {
        let mut radiance = Vec3::ZERO;
        if scene.world.environment != NONE {
            let light = &scene.lights[scene.world.environment as usize];
            radiance = self.throughput * eval_environment(scene, light, self.ray.direction);
        }
        if scene.world.sun_discs != NONE {
            radiance += self.throughput * eval_sun_discs(scene, self.ray.direction);
        }
        radiance
    }

    /// Moves to a hit and applies the absorption of the medium on the way.
    #[inline(always)]
    pub fn arrive(&mut self, scene: &SceneTables, hit: &Hit) -> Surface {
        let s = surface_at(scene, &self.ray, hit);
        self.length += hit.t;
        self.interior = interior_before(scene, &s, -self.ray.direction, &self.interior);
        self.throughput *= transmittance(scene, medium_of(&self.interior), hit.t);
        s
    }

    /// Emission of the surface towards the path, times throughput.
    #[inline(always)]
    pub fn emission(&self, scene: &SceneTables, s: &Surface) -> Vec3 {
        if s.light == NONE {
            return Vec3::ZERO;
        }
        self.throughput * eval_area(scene, s, self.ray.direction)
    }

    /// Passes through a lamp that the camera does not see, if the path has come straight from the
    /// camera; returns false otherwise. Called before [`Self::arrive`].
    #[inline(always)]
    pub fn passes_unseen(&mut self, scene: &SceneTables, hit: &Hit) -> bool {
        if scene.world.unseen == 0 || self.bounce > 0 {
            return false;
        }
        let s = surface_at(scene, &self.ray, hit);
        if s.light == NONE || scene.lights[s.light as usize].flags & LIGHT_UNSEEN == 0 {
            return false;
        }
        // the ray goes on from the same origin, so that lengths count from there
        self.ray.t_min = hit.t;
        self.hidden += 1;
        true
    }

    /// Passes through the face if it is a hidden one; returns false otherwise.
    #[inline(always)]
    pub fn passes(&mut self, scene: &SceneTables, s: &Surface) -> bool {
        let passed = passes_hidden(scene, s, &mut self.ray, &mut self.interior);
        self.hidden += u32::from(passed);
        passed
    }

    /// Continues with a scattered ray. Returns false if Russian roulette with the random number `u`
    /// ends the path. Its survival probability is min(1, 4 throughput), because glass lowers the
    /// throughput on entry and restores it on exit.
    #[inline(always)]
    pub fn scatter(&mut self, s: &Surface, scattered: &Scatter, u: Real) -> bool {
        self.throughput *= scattered.weight;
        self.interior = scattered.interior;
        let survival = (4.0 * max_component(self.throughput)).min(1.0);
        if u >= survival {
            return false;
        }
        self.throughput *= 1.0 / survival;
        let origin = offset_origin(s.position, s.error, s.normal, scattered.direction);
        self.ray = Ray { origin, t_min: 0.0, direction: scattered.direction, t_max: FAR };
        self.bounce += 1;
        true
    }
}
