//! The walk of an eye path, which eye tracing, layers and path tracing share. Twin:
//! `shaders/kernels/eye_path.wgsl`.

use super::direct::transmittance;
use super::geometry::intersect::intersect_scene;
use super::geometry::surface::{Surface, surface_at};
use super::lights::light::eval_environment;
use super::materials::enclosing::interior_at;
use super::materials::interior::{Interior, interior_before, medium_of, passes_hidden};
use super::materials::shading::Scatter;
use super::math::{FAR, max_component, offset_origin};
use super::real::{Real, Vec3};
use super::records::{Dispatch, HIDDEN_FACES};
use super::shapes::ray::{Hit, Ray};
use super::tables::*;

/// An eye path.
#[derive(Clone, Copy, Debug)]
pub struct EyePath {
    /// The next ray.
    pub ray: Ray,
    /// Product of the weights so far.
    pub throughput: Vec3,
    /// Interior list of the ray.
    pub interior: Interior,
    /// Hidden faces passed.
    pub hidden: u32,
    /// Scattering events.
    pub bounce: u32,
    /// Length so far, scene units.
    pub length: Real,
    /// Rays traced.
    pub rays: u32,
}

impl EyePath {
    /// A path that starts with a camera ray.
    #[inline(always)]
    pub fn new(scene: &Scene, ray: Ray) -> Self {
        let interior = interior_at(scene, scene.camera.medium, ray.origin);
        let throughput = Vec3::ONE;
        Self { ray, throughput, interior, hidden: 0, bounce: 0, length: 0.0, rays: 0 }
    }

    /// Returns whether the path is within its limits.
    #[inline(always)]
    pub fn continues(&self, dispatch: &Dispatch) -> bool {
        self.bounce <= dispatch.max_bounces && self.hidden <= HIDDEN_FACES
    }

    /// Traces the ray.
    #[inline(always)]
    pub fn trace(&mut self, scene: &Scene) -> Hit {
        self.rays += 1;
        intersect_scene(scene, &self.ray)
    }

    /// Environment in the ray's direction, times throughput.
    #[inline(always)]
    pub fn environment(&self, scene: &Scene) -> Vec3 {
        if scene.world.environment == NONE {
            return Vec3::ZERO;
        }
        let light = &scene.lights[scene.world.environment as usize];
        self.throughput * eval_environment(scene, light, self.ray.direction)
    }

    /// Moves to a hit: the medium on the way absorbs.
    #[inline(always)]
    pub fn arrive(&mut self, scene: &Scene, hit: &Hit) -> Surface {
        let s = surface_at(scene, &self.ray, hit);
        self.length += hit.t;
        self.interior = interior_before(scene, &s, -self.ray.direction, &self.interior);
        self.throughput *= transmittance(scene, medium_of(&self.interior), hit.t);
        s
    }

    /// Emission of the surface toward the path, times throughput.
    #[inline(always)]
    pub fn emission(&self, scene: &Scene, s: &Surface) -> Vec3 {
        if s.light == NONE || (-self.ray.direction).dot(s.normal) <= 0.0 {
            return Vec3::ZERO;
        }
        self.throughput * scene.lights[s.light as usize].color
    }

    /// Passes a hidden glass face, or returns false.
    #[inline(always)]
    pub fn passes(&mut self, scene: &Scene, s: &Surface) -> bool {
        let passed = passes_hidden(scene, s, &mut self.ray, &mut self.interior);
        self.hidden += u32::from(passed);
        passed
    }

    /// Continues with a scattered ray. Returns false if Russian roulette with the random number `u`
    /// ends the path, which it does only if little is left to lose: glass dims the throughput on
    /// the way in and undoes that on the way out.
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
