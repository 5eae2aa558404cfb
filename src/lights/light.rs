//! Choice of a light and sampling of its direction from a surface point, with densities per solid
//! angle. Twin: `shaders/lights/light.wgsl`.

use super::materials::texture::eval_texture;
use super::math::sampling::{PDF_SPHERE, sample_sphere};
use super::math::trig::{arctan2, sin_cos};
use super::math::{EPS, FAR, PI, TAU};
use super::real::{Real, Vec2, Vec3, Vec4};
use super::select::{choose_light, share_of};
use super::shape::{pdf_bin, pdf_shape, pdf_sphere_cone, sample_shape, sample_sphere_cone};
use super::tables::*;

/// Unoccluded light that reaches a point from a sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction to the light.
    pub direction: Vec3,
    /// Distance up to which the shadow ray must be free, scene units.
    pub distance: Real,
    /// Radiance, or irradiance at normal incidence for lights without extent.
    pub radiance: Vec3,
    /// Density per solid angle times the probability of choosing the light; for lights without
    /// extent that probability alone.
    pub pdf: Real,
    /// True if a scattered ray could hit the same light.
    pub extended: bool,
}

/// Returns the first k in `0..count` for which the cumulative value `distributions[first + k]`
/// exceeds `u`, or the last k.
#[inline(always)]
pub fn find_interval(scene: &Scene, first: u32, count: u32, u: Real) -> u32 {
    // binary search without branches on the compared values, which are unpredictable
    let mut low = 0;
    let mut length = count;
    while length > 1 {
        let half = length / 2;
        low += if scene.distributions[(first + low + half - 1) as usize] > u { 0 } else { half };
        length -= half;
    }
    low
}

/// Samples light at `position`: `u.x` chooses the light by the probabilities at `shares`, the other
/// three numbers sample it.
#[inline(always)]
pub fn sample_light(scene: &Scene, shares: u32, position: Vec3, u: Vec4) -> LightSample {
    let index = choose_light(scene, shares, u.x);
    let share = share_of(scene, shares, index);
    sample_one_light(scene, &scene.lights[index as usize], share, position, u)
}

/// Samples light at `position` from `light`, which is chosen with probability `share`.
#[inline(always)]
pub fn sample_one_light(
    scene: &Scene,
    light: &Light,
    share: Real,
    position: Vec3,
    u: Vec4,
) -> LightSample {
    let none = LightSample {
        direction: Vec3::Z,
        distance: 0.0,
        radiance: Vec3::ZERO,
        pdf: 1.0,
        extended: true,
    };
    if light.kind == LIGHT_AREA {
        if kind_of(light.reference) == KIND_SPHERE {
            let sphere = &scene.spheres[index_of(light.reference) as usize];
            if pdf_sphere_cone(sphere, position) > 0.0 {
                let p = sample_sphere_cone(sphere, position, Vec2::new(u.y, u.z));
                let to = p.position + p.normal * p.error - position;
                let dist_sq = to.dot(to);
                // on the lamp itself
                if dist_sq == 0.0 {
                    return none;
                }
                let distance = dist_sq.sqrt();
                return LightSample {
                    direction: to * (1.0 / distance),
                    distance: distance * (1.0 - 16.0 * EPS),
                    radiance: light.color,
                    pdf: p.pdf * share,
                    extended: true,
                };
            }
        }
        let p = sample_shape(scene, light, Vec2::new(u.y, u.z), u.w);
        let to = p.position + p.normal * p.error - position;
        let dist_sq = to.dot(to);
        if dist_sq == 0.0 {
            return none;
        }
        let distance = dist_sq.sqrt();
        let direction = to * (1.0 / distance);
        let cos = -direction.dot(p.normal);
        if cos <= 0.0 {
            return none;
        }
        return LightSample {
            direction,
            distance: distance * (1.0 - 16.0 * EPS),
            radiance: light.color,
            pdf: p.pdf * dist_sq / cos * share,
            extended: true,
        };
    }
    if light.kind == LIGHT_POINT || light.kind == LIGHT_SPOT {
        let to = light.position - position;
        let dist_sq = to.dot(to);
        if dist_sq == 0.0 {
            return none;
        }
        let distance = dist_sq.sqrt();
        let direction = to * (1.0 / distance);
        let mut radiance = light.color * (1.0 / dist_sq);
        if light.kind == LIGHT_SPOT {
            // half the squared chord: near the axis 1 - cos loses all digits
            let chord = direction + light.direction;
            radiance *= spot_falloff(light, 0.5 * chord.dot(chord));
        }
        return LightSample {
            direction,
            distance: distance * (1.0 - 16.0 * EPS),
            radiance,
            pdf: share,
            extended: false,
        };
    }
    if light.kind == LIGHT_SUN {
        return LightSample {
            direction: -light.direction,
            distance: FAR,
            radiance: light.color,
            pdf: share,
            extended: false,
        };
    }
    let direction = sample_environment(scene, light, u);
    LightSample {
        direction,
        distance: FAR,
        radiance: eval_environment(scene, light, direction),
        pdf: pdf_environment(scene, light, direction) * share,
        extended: true,
    }
}

/// Spot falloff at `versine`, which is 1 - cos of the angle to the axis: 1 inside the inner cone, 0
/// outside the outer cone, a smoothstep of the cosine in between.
pub fn spot_falloff(light: &Light, versine: Real) -> Real {
    if versine <= light.inner {
        return 1.0;
    }
    if versine >= light.outer {
        return 0.0;
    }
    let x = (light.outer - versine) / (light.outer - light.inner);
    x * x * (3.0 - 2.0 * x)
}

/// Density per solid angle with which [`sample_light`] at `from` samples `direction` on area light
/// `index`, hit at distance `t` at a point with unit normal `normal` and profile parameter `v`.
pub fn pdf_light(
    scene: &Scene,
    shares: u32,
    index: u32,
    from: Vec3,
    direction: Vec3,
    t: Real,
    normal: Vec3,
    v: Real,
) -> Real {
    let light = &scene.lights[index as usize];
    let share = share_of(scene, shares, index);
    if kind_of(light.reference) == KIND_SPHERE {
        let sphere = &scene.spheres[index_of(light.reference) as usize];
        let pdf = pdf_sphere_cone(sphere, from);
        if pdf > 0.0 {
            return pdf * share;
        }
    }
    let cos = direction.dot(normal).abs();
    pdf_shape(scene, light, v) * t * t / cos.max(1e-12) * share
}

/// Texture coordinates of a direction in an equirectangular image rotated about y; v is 1 at the
/// zenith.
pub fn environment_uv(light: &Light, direction: Vec3) -> Vec2 {
    let x = light.outer * direction.x - light.inner * direction.z;
    let z = light.inner * direction.x + light.outer * direction.z;
    let r = (x * x + z * z).sqrt();
    Vec2::new(0.5 - arctan2(z, x) * (1.0 / TAU), 1.0 - arctan2(r, direction.y) * (1.0 / PI))
}

/// Radiance of the environment from `direction`.
pub fn eval_environment(scene: &Scene, light: &Light, direction: Vec3) -> Vec3 {
    if light.kind == LIGHT_CONSTANT {
        return light.color;
    }
    light.color * eval_texture(scene, light.reference, environment_uv(light, direction))
}

/// Samples a direction towards the environment.
pub fn sample_environment(scene: &Scene, light: &Light, u: Vec4) -> Vec3 {
    if light.kind == LIGHT_CONSTANT {
        return sample_sphere(Vec2::new(u.y, u.z));
    }
    let texture = &scene.textures[light.reference as usize];
    let row = find_interval(scene, light.first, texture.height, u.y);
    let column = find_interval(
        scene,
        light.first + texture.height + row * texture.width,
        texture.width,
        u.z,
    );
    // offset in the row from the lower bits of u.w: what is left of u.y gives few distinct offsets
    // in rows of low probability
    let fine = u.w * 4096.0;
    let across = (column as Real + u.w) / texture.width as Real;
    let down = (row as Real + (fine - fine.floor())) / texture.height as Real;
    let (sin_phi, cos_phi) = sin_cos((0.5 - across) * TAU);
    let (sin, cos) = sin_cos(down * PI);
    let x = sin * cos_phi;
    let z = sin * sin_phi;
    Vec3::new(light.outer * x + light.inner * z, cos, light.outer * z - light.inner * x)
}

/// Density per solid angle of [`sample_environment`].
pub fn pdf_environment(scene: &Scene, light: &Light, direction: Vec3) -> Real {
    if light.kind == LIGHT_CONSTANT {
        return PDF_SPHERE;
    }
    let texture = &scene.textures[light.reference as usize];
    let uv = environment_uv(light, direction);
    let row = (((1.0 - uv.y) * texture.height as Real).floor() as u32).min(texture.height - 1);
    let column = ((uv.x * texture.width as Real).floor() as u32).min(texture.width - 1);
    let p = pdf_bin(scene, light.first, row, texture.height)
        * pdf_bin(scene, light.first + texture.height + row * texture.width, column, texture.width);
    // from x and z: near a pole 1 - y^2 loses all digits
    let sin = (direction.x * direction.x + direction.z * direction.z).max(1e-12).sqrt();
    p / (2.0 * PI * PI * sin)
}
