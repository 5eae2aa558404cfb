//! Steps of an eye path, shared by eye tracing, AOVs and path tracing. Twin:
//! `shaders/kernels/eye_path.wgsl`.

use super::direct::transmittance;
use super::geometry::intersect::intersect_scene;
use super::geometry::surface::{Surface, surface_at};
use super::lights::area::pdf_area;
use super::lights::environment::{eval_environment, pdf_environment};
use super::lights::select::{share_of, shares_at};
use super::lights::sun_disc::{eval_sun_discs, in_sun_disc, pdf_sun_disc};
use super::materials::enclosing::interior_at;
use super::materials::interior::{Interior, interior_before, medium_of, passes_hidden};
use super::materials::shading::{Lobe, RADIANCE, Scatter, ShadingPoint};
use super::materials::{pdf_rough, scatter_rough};
use super::math::sampling::balance;
use super::math::{FAR, max_component, offset_origin};
use super::real::{Real, Vec3, Vec4};
use super::records::{Dispatch, FOCUSED, HIDDEN_FACES};
use super::shapes::ray::{Hit, Ray};
use super::tables::*;

/// Number of scattering events that ends a path before its first ray.
const NO_RAY: u32 = u32::MAX;

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

/// The last rough surface of a path, by which the path weights emission that it finds.
#[derive(Clone, Copy, Debug)]
pub struct LastLobe {
    /// Density of the path's direction, sr^-1, or 0 unless a shadow ray could have found the same
    /// light.
    pub pdf: Real,
    /// Start of the light probabilities at the surface.
    pub shares: u32,
}

impl LastLobe {
    /// A path that no rough surface has scattered.
    pub const NONE: Self = Self { pdf: 0.0, shares: 0 };
}

/// What a path does at a narrow lobe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// It continues.
    Continues,
    /// It ends at a visible point that gathers only [`FOCUSED`] photons.
    GathersFocused,
    /// Russian roulette ends it.
    Ends,
}

/// Probability that a path continues at a narrow lobe whose [`FOCUSED`] photons are gathered
/// otherwise.
const CONTINUING: Real = 0.75;

impl EyePath {
    /// Starts a path with a camera ray; one with `t_max` 0 is not traced.
    #[inline(always)]
    pub fn new(scene: &SceneTables, ray: Ray) -> Self {
        let bounce = if ray.t_max == 0.0 { NO_RAY } else { 0 };
        let interior = interior_at(scene, scene.camera.medium, ray.origin);
        let throughput = Vec3::ONE;
        Self { ray, throughput, interior, hidden: 0, bounce, length: 0.0, rays: 0 }
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
        if s.light == NONE || (-self.ray.direction).dot(s.normal) <= 0.0 {
            return Vec3::ZERO;
        }
        self.throughput * scene.lights[s.light as usize].color
    }

    /// Radiance of the environment and of suns, times throughput, weighted against the shadow ray
    /// of `last`.
    #[inline(always)]
    pub fn found_environment(&self, scene: &SceneTables, last: &LastLobe) -> Vec3 {
        if last.pdf == 0.0 {
            return self.environment(scene);
        }
        let mut radiance = Vec3::ZERO;
        let direction = self.ray.direction;
        if scene.world.environment != NONE {
            let sky = scene.world.environment;
            let light = &scene.lights[sky as usize];
            let other =
                pdf_environment(scene, light, direction) * share_of(scene, last.shares, sky);
            let seen = self.throughput * eval_environment(scene, light, direction);
            radiance = seen * balance(last.pdf, other);
        }
        let mut sun = scene.world.sun_discs;
        while sun != NONE {
            let light = &scene.lights[sun as usize];
            if in_sun_disc(light, direction) {
                let other = pdf_sun_disc(light) * share_of(scene, last.shares, sun);
                radiance += self.throughput * light.color * balance(last.pdf, other);
            }
            sun = light.reference;
        }
        radiance
    }

    /// Emission of the surface at distance `t`, times throughput, weighted likewise. `ray` is the
    /// ray that hit it.
    #[inline(always)]
    pub fn found_emission(
        &self,
        scene: &SceneTables,
        last: &LastLobe,
        ray: &Ray,
        s: &Surface,
        t: Real,
    ) -> Vec3 {
        if last.pdf > 0.0 && s.light != NONE {
            let Ray { origin, direction, .. } = *ray;
            let other = pdf_area(scene, last.shares, s.light, origin, direction, t, s.normal, s.v);
            return self.emission(scene, s) * balance(last.pdf, other);
        }
        self.emission(scene, s)
    }

    /// Returns true if the path does not end at this lobe because it is narrow.
    #[inline(always)]
    pub fn turns_at(&self, dispatch: &Dispatch, lobe: &Lobe) -> bool {
        dispatch.continued != 0 && self.bounce < dispatch.max_bounces && lobe.is_narrow()
    }

    /// Continues at a narrow lobe, or ends there to gather the photons whose light no continued
    /// path can find, as the random numbers `u` decide. `sampled`: a shadow ray was sent.
    #[inline(always)]
    pub fn turn(
        &mut self,
        scene: &SceneTables,
        dispatch: &Dispatch,
        sampled: bool,
        p: &ShadingPoint,
        last: &mut LastLobe,
        u: Vec4,
    ) -> Turn {
        let gathers = dispatch.continued & FOCUSED != 0;
        if gathers && u.z >= CONTINUING {
            self.throughput *= 1.0 / (1.0 - CONTINUING);
            return Turn::GathersFocused;
        }
        let mut choice = u.z;
        if gathers {
            self.throughput *= 1.0 / CONTINUING;
            choice *= 1.0 / CONTINUING;
        }
        let v = Vec3::new(u.x, u.y, choice);
        let scattered = scatter_rough(scene, p, &self.interior, v, RADIANCE);
        if sampled {
            last.shares = shares_at(scene, p.s.position);
            last.pdf = pdf_rough(&p.lobe, p.n, p.wo, scattered.direction);
        }
        if self.scatter(&p.s, &scattered, u.w) { Turn::Continues } else { Turn::Ends }
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
