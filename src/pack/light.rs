//! Lights: strengths in scene units, and sampling distributions.

use super::lights::LightKind;
use super::real::{Real, ToDouble, ToReal, Vec2, Vec3};
use super::shape::Emitter;
use super::shapes::revolution::ring_point;
use super::tables::*;
use crate::prepare::distribution::cumulative;
use crate::prepare::learned::LightSource;
use crate::prepare::normalize::Normalization;
use crate::scene::{self, Environment};
use bytemuck::Zeroable;
use glam::DVec3;
use std::f64::consts::PI;

/// Number of steps of the midpoint rule for a patch's area.
const AREA_STEPS: u32 = 32;

/// Properties of the lights that the tables do not contain.
pub struct PackedLights {
    /// World radiance of one unit of scene radiance.
    pub radiance_unit: f64,
    /// Luminance of the brightest extended light, in world units.
    pub brightest: f64,
    /// Power of each light; for light from infinity, per area that faces it.
    pub power: Vec<f64>,
    /// Scene element that each light comes from.
    pub sources: Vec<LightSource>,
}

/// Fills `lights` and `distributions`.
pub fn pack_lights(
    scene: &scene::Scene,
    n: &Normalization,
    emitters: &[Emitter],
    out: &mut SceneTables,
) -> PackedLights {
    // Strengths are in world radiance at first. Areas and distances are already in scene units, so
    // irradiance is radiance times solid angle in both.
    let mut lights: Vec<(Light, DVec3, f64)> = Vec::new();
    let mut sources: Vec<LightSource> =
        emitters.iter().map(|e| LightSource::Shape(e.shape)).collect();
    sources.extend((0..scene.lights.len()).map(LightSource::Light));
    let mut distributions = Vec::new();
    let mut luminance_max = emitters.iter().map(|e| luminance(e.radiance)).fold(0.0, f64::max);
    for e in emitters {
        let mut light =
            Light { kind: LightKind::Area as u32, reference: e.reference, ..Light::zeroed() };
        let mut area = e.area;
        if kind_of(e.reference) == KIND_REVOLUTION {
            area = revolution_distribution(out, &mut light, &mut distributions);
        }
        light.area = area as Real;
        lights.push((light, e.radiance, PI * area));
    }
    for l in &scene.lights {
        let unit_sq = n.unit * n.unit;
        lights.push(match l {
            scene::Light::Point { position, intensity } => {
                let light = Light {
                    kind: LightKind::Point as u32,
                    position: n.point(*position).to_real(),
                    ..Light::zeroed()
                };
                (light, DVec3::from(*intensity) / unit_sq, 4.0 * PI)
            }
            scene::Light::Spot { position, target, intensity, angle_degrees, blend } => {
                // 1 - cos
                let versine = |degrees: f64| 2.0 * (0.5 * degrees).to_radians().sin().powi(2);
                let outer = versine(*angle_degrees);
                let inner = versine(angle_degrees * (1.0 - blend)).min(outer);
                let light = Light {
                    kind: LightKind::Spot as u32,
                    position: n.point(*position).to_real(),
                    direction: (*target - *position).normalize().to_real(),
                    outer: outer as Real,
                    inner: inner as Real,
                    ..Light::zeroed()
                };
                (light, DVec3::from(*intensity) / unit_sq, PI * (inner + outer))
            }
            scene::Light::Sun { direction, irradiance, angle_degrees } if *angle_degrees > 0.0 => {
                let half = (0.5 * angle_degrees).to_radians();
                let versine = 2.0 * (0.5 * half).sin().powi(2);
                let light = Light {
                    kind: LightKind::SunDisc as u32,
                    direction: direction.normalize().to_real(),
                    outer: versine as Real,
                    reference: out.world.sun_discs,
                    ..Light::zeroed()
                };
                out.world.sun_discs = lights.len() as u32;
                // a surface that faces the disc receives pi sin^2 of its radiance
                let radiance = DVec3::from(*irradiance) / (PI * half.sin().powi(2));
                luminance_max = luminance_max.max(luminance(radiance));
                (light, radiance, 2.0 * PI * versine)
            }
            scene::Light::Sun { direction, irradiance, .. } => {
                let light = Light {
                    kind: LightKind::Sun as u32,
                    direction: direction.normalize().to_real(),
                    ..Light::zeroed()
                };
                (light, DVec3::from(*irradiance), 1.0)
            }
        });
    }
    match &scene.environment {
        Some(Environment::Constant { radiance }) if DVec3::from(*radiance).max_element() > 0.0 => {
            out.world.environment = lights.len() as u32;
            lights.push((
                Light { kind: LightKind::Constant as u32, ..Light::zeroed() },
                DVec3::from(*radiance),
                4.0 * PI,
            ));
        }
        Some(Environment::Image { rotate_degrees, tilt, scale, .. }) => {
            let (sin, cos) = rotate_degrees.to_radians().sin_cos();
            let mut light = Light {
                kind: LightKind::Image as u32,
                reference: out.textures.len() as u32 - 1,
                outer: cos as Real,
                inner: sin as Real,
                ..Light::zeroed()
            };
            if let Some(tilt) = tilt {
                light.position = tilt.x_axis.to_real();
                light.direction = tilt.y_axis.to_real();
                light.patch_count = 1;
            }
            let scale = DVec3::from(*scale);
            if let Some([mean, brightest]) =
                image_distribution(out, &mut light, scale, &mut distributions)
            {
                luminance_max = luminance_max.max(brightest);
                out.world.environment = lights.len() as u32;
                lights.push((light, scale, 4.0 * PI * mean));
            }
        }
        _ => {}
    }
    if lights.len() > sources.len() {
        sources.push(LightSource::Environment);
    }
    let power: Vec<f64> =
        lights.iter().map(|(_, c, factor)| (c.x + c.y + c.z) / 3.0 * factor).collect();
    let total: f64 = power.iter().sum();
    let brightest = lights.iter().map(|(_, c, _)| c.max_element()).fold(0.0, f64::max);
    let radiance_unit = if brightest > 0.0 { brightest.log2().round().exp2() } else { 1.0 };
    let count = lights.len();
    let mut sum = 0.0;
    for ((mut light, color, _), power) in lights.into_iter().zip(&power) {
        light.color = (color / radiance_unit).to_real();
        light.selection = (power / total) as Real;
        light.first += count as u32;
        sum += power;
        out.distributions.push((sum / total) as Real);
        out.lights.push(light);
    }
    out.distributions.extend(distributions);
    out.world.light_count = count as u32;
    PackedLights { radiance_unit, brightest: luminance_max, power, sources }
}

/// Appends the start of each patch in v and the cumulative fractions of area; returns the area.
/// Patches overlap their neighbours, so the part of a patch ends where the next one starts.
fn revolution_distribution(
    out: &SceneTables,
    light: &mut Light,
    distributions: &mut Vec<Real>,
) -> f64 {
    let index = index_of(light.reference);
    let patches: Vec<&Patch> = out.patches.iter().filter(|p| p.revolution == index).collect();
    let revolution = &out.revolutions[index as usize];
    light.patch_first = out.patches.iter().position(|p| p.revolution == index).unwrap_or(0) as u32;
    light.patch_count = patches.len() as u32;
    light.first = distributions.len() as u32;
    let v_of = |p: &Patch, t: Real| (p.segment as Real + t) / revolution.segments as Real;
    let starts: Vec<Real> = patches.iter().map(|p| v_of(p, p.t0)).collect();
    let mut areas = Vec::new();
    for (k, patch) in patches.iter().enumerate() {
        let end = starts.get(k + 1).copied().unwrap_or(1.0);
        let end_t = (end * revolution.segments as Real - patch.segment as Real).min(patch.t1);
        let end_tau = ((end_t - patch.t0) / (patch.t1 - patch.t0)) as f64;
        let mut area = 0.0;
        for i in 0..AREA_STEPS {
            let tau = (i as f64 + 0.5) / AREA_STEPS as f64 * end_tau;
            let ring = ring_point(&out.profile_points, patch, 0.0, tau as Real);
            area += ring.d_theta.cross(ring.d_tau).length() as f64;
        }
        let scale = revolution.scale as f64;
        areas.push(area * end_tau / AREA_STEPS as f64 * 2.0 * PI * scale * scale);
    }
    distributions.extend(&starts);
    push_cumulative(&areas, distributions);
    areas.iter().sum()
}

/// Luminance of linear Rec. 709 light.
fn luminance(color: DVec3) -> f64 {
    color.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

/// Appends the cumulative fractions of rows, and of columns within each row, by channel mean times
/// solid angle. Returns the average channel mean, and the greatest luminance times `scale`, or
/// `None` for a black image. A texel has the weight of the root mean square of the filtered image
/// inside it, which minimizes the variance. Filtering blends in its neighbours, so the weight is
/// zero only if they are black as well.
fn image_distribution(
    out: &SceneTables,
    light: &mut Light,
    scale: DVec3,
    distributions: &mut Vec<Real>,
) -> Option<[f64; 2]> {
    let texture = &out.textures[light.reference as usize];
    let (w, h) = (texture.width, texture.height);
    light.first = distributions.len() as u32;
    let mut brightest = 0.0_f64;
    let mut value = |x: Real, y: Real| {
        let uv = Vec2::new(x / w as Real, 1.0 - y / h as Real);
        let c: Vec3 = super::materials::texture::eval_texture(out, light.reference, uv);
        brightest = brightest.max(luminance(c.to_double() * scale));
        ((c.x + c.y + c.z) / 3.0).max(0.0) as f64
    };
    // (mean, root mean square) at the centers of the texel's quarters
    let mut texel = |i: u32, j: u32| {
        let quarters = [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)];
        let values = quarters.map(|(x, y)| value(i as Real + x, j as Real + y));
        let mean_of = |f: fn(f64) -> f64| values.iter().map(|v| f(*v)).sum::<f64>() / 4.0;
        (mean_of(|v| v), mean_of(|v| v * v).sqrt())
    };
    let mut rows = Vec::new();
    let mut columns = Vec::new();
    let mut mean = 0.0;
    for j in 0..h {
        let theta = |j: u32| PI * j as f64 / h as f64;
        let solid = theta(j).cos() - theta(j + 1).cos();
        let (means, row): (Vec<f64>, Vec<f64>) = (0..w).map(|i| texel(i, j)).unzip();
        rows.push(row.iter().sum::<f64>() * solid);
        mean += means.iter().sum::<f64>() * solid / (2.0 * w as f64);
        push_cumulative(&row, &mut columns);
    }
    if mean <= 0.0 {
        return None;
    }
    push_cumulative(&rows, distributions);
    distributions.extend(columns);
    Some([mean, brightest])
}

/// Appends cumulative fractions in steps of the random numbers. Each value above zero gets at least
/// one step, however bright the others are; if all are zero, the fractions are even.
fn push_cumulative(values: &[f64], target: &mut Vec<Real>) {
    let even = vec![1.0; values.len()];
    let dark = values.iter().sum::<f64>() <= 0.0;
    target.extend(cumulative(if dark { &even } else { values }).map(|share| share as Real));
}

/// Theory: the brightest texel of a sky is the one with the greatest luminance, whatever its color:
/// of equal channels, green has 0.7152 of white, blue 0.0722.
#[cfg(test)]
mod tests {
    use super::super::pack;
    use super::*;
    use crate::scene::{Camera, ImageData, Scene, Texels};

    #[test]
    fn skies_have_the_luminance_of_their_colors() {
        for (color, scale, expected) in [
            ([0.0, 1.0, 0.0], [1.0; 3], 0.7152),
            ([0.0, 0.0, 1.0], [1.0; 3], 0.0722),
            ([1.0, 1.0, 1.0], [0.0, 2.0, 0.0], 1.4304),
        ] {
            let mut scene = Scene::new(Camera::look_at(DVec3::Z, DVec3::ZERO, 40.0));
            let texels = Texels::Float(vec![color; 8]);
            let path = "sky.exr".to_owned();
            scene.images.push(ImageData { path, width: 4, height: 2, texels });
            let environment =
                Environment::Image { image: 0, rotate_degrees: 0.0, tilt: None, scale };
            scene.environment = Some(environment);
            let packed = pack(&scene, Normalization::of(&scene), 4, 4).unwrap();
            assert!((packed.brightest - expected).abs() < 1e-6, "{color:?}: {}", packed.brightest);
        }
    }
}
