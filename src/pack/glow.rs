//! Flags, texture and emission map of area lights.

use super::light::{luminance, push_cumulative};
use super::lights::glow::MAP_SIDE;
use super::materials::texture::eval_texture;
use super::real::{Real, ToDouble, Vec2};
use super::tables::*;
use crate::scene::Glow;
use glam::DVec3;
use std::collections::HashMap;

/// Number of samples along each side of a texture, or of a cell of an emission map.
const SAMPLES: [u32; 2] = [64, 4];
/// Part of a map's density, and of a triangle's power, that does not depend on its texels, so that
/// every point that emits is sampled.
const EVEN: f64 = 0.05;

/// Factors that a texture and the number of sides contribute.
pub struct Factor {
    /// Factor on the power.
    pub power: f64,
    /// Factor on the luminance of the brightest point.
    pub brightest: f64,
}

/// Mean and maximum of the textures that emit, so that the triangles of a mesh share them.
#[derive(Default)]
pub struct Glows {
    textures: HashMap<usize, [f64; 2]>,
}

impl Glows {
    /// Sets the texture and the emission map of a projector; returns the mean of the texture.
    pub fn project(
        &mut self,
        out: &SceneTables,
        light: &mut Light,
        texture: usize,
        distributions: &mut Vec<Real>,
    ) -> f64 {
        light.flags |= LIGHT_TEXTURED;
        light.texture = texture as u32;
        emission_map(out, light, distributions).max(1e-9)
    }

    /// Sets the flags, the texture and the emission map of `light`.
    pub fn set(
        &mut self,
        out: &mut SceneTables,
        light: &mut Light,
        glow: &Glow,
        distributions: &mut Vec<Real>,
    ) -> Factor {
        let mut factor = Factor { power: 1.0, brightest: 1.0 };
        if glow.two_sided {
            light.flags |= LIGHT_TWO_SIDED;
            factor.power = 2.0;
        }
        if glow.hidden_from_camera {
            light.flags |= LIGHT_UNSEEN;
            out.world.unseen = 1;
        }
        let Some(texture) = glow.texture else { return factor };
        light.flags |= LIGHT_TEXTURED;
        light.texture = texture as u32;
        let [mean, brightest] =
            *self.textures.entry(texture).or_insert_with(|| statistics(out, light.texture));
        factor.brightest = brightest;
        let own = match kind_of(light.reference) {
            KIND_RECTANGLE if natural(out, light) => emission_map(out, light, distributions),
            KIND_TRIANGLE => triangle_mean(out, light),
            _ => mean,
        };
        // a texture without light still gets a probability
        factor.power *= (own + EVEN * mean).max(1e-9);
        factor
    }
}

/// Returns true if a rectangle has its own texture coordinates.
fn natural(out: &SceneTables, light: &Light) -> bool {
    out.rectangles[index_of(light.reference) as usize].uv == UV_NATURAL
}

/// Channel mean of a texture at (u, v).
fn value(out: &SceneTables, texture: u32, u: f64, v: f64) -> f64 {
    let c: DVec3 = eval_texture(out, texture, Vec2::new(u as Real, v as Real)).to_double();
    ((c.x + c.y + c.z) / 3.0).max(0.0)
}

/// Mean of the texture over the unit square, and the luminance of its brightest texel.
fn statistics(out: &SceneTables, index: u32) -> [f64; 2] {
    let n = SAMPLES[0];
    let at = |k: u32| (f64::from(k) + 0.5) / f64::from(n);
    let sum: f64 = (0..n * n).map(|k| value(out, index, at(k % n), at(k / n))).sum();
    let texture = &out.textures[index as usize];
    let brightest = if texture.kind == TEXTURE_CHECKER {
        luminance(texture.color0.to_double()).max(luminance(texture.color1.to_double()))
    } else {
        // texel centers, where the filter returns the texel
        let (w, h) = (texture.width, texture.height);
        let scale = texture.scale.to_double();
        let texel = |k: u32| {
            let u = (f64::from(k % w) + 0.5) / f64::from(w) / scale.x;
            let v = (f64::from(k / w) + 0.5) / f64::from(h) / scale.y;
            let uv = Vec2::new(u as Real, v as Real);
            luminance(eval_texture(out, index, uv).to_double())
        };
        (0..w * h).map(texel).fold(0.0, f64::max)
    };
    [sum / f64::from(n * n), brightest]
}

/// Mean of the texture over a triangle.
fn triangle_mean(out: &SceneTables, light: &Light) -> f64 {
    let triangle = &out.triangles[index_of(light.reference) as usize];
    if triangle.attributes == NONE {
        return value(out, light.texture, 0.0, 0.0);
    }
    let a = &out.attributes[triangle.attributes as usize];
    let n = SAMPLES[1];
    let third = 1.0 / 3.0;
    let mut sum = 0.0;
    let mut count = 0.0;
    // centers of the n^2 triangles that the sides are cut into
    for i in 0..n {
        for j in 0..n - i {
            let mut add = |b: f64, c: f64| {
                let w = 1.0 - b - c;
                let at = |p: Real, q: Real, r: Real| {
                    f64::from(p) * w + f64::from(q) * b + f64::from(r) * c
                };
                sum += value(out, light.texture, at(a.u0, a.u1, a.u2), at(a.v0, a.v1, a.v2));
                count += 1.0;
            };
            let (x, y) = (f64::from(i), f64::from(j));
            add((x + third) / f64::from(n), (y + third) / f64::from(n));
            if i + j + 1 < n {
                add((x + 2.0 * third) / f64::from(n), (y + 2.0 * third) / f64::from(n));
            }
        }
    }
    sum / count
}

/// Appends the emission map of a rectangle to `distributions`: cumulative rows of (s, t), then the
/// cumulative columns of each row, by the root mean square of the texture in each cell, which
/// minimizes the variance. Returns the mean of the texture.
fn emission_map(out: &SceneTables, light: &mut Light, distributions: &mut Vec<Real>) -> f64 {
    light.flags |= LIGHT_MAPPED;
    light.map = distributions.len() as u32;
    let n = MAP_SIDE;
    let fine = SAMPLES[1];
    let mut mean = 0.0;
    let cells: Vec<f64> = (0..n * n)
        .map(|cell| {
            let mut sum_sq = 0.0;
            for k in 0..fine * fine {
                let at = |cell: u32, k: u32| {
                    (f64::from(cell) + (f64::from(k) + 0.5) / f64::from(fine)) / f64::from(n)
                };
                let found =
                    value(out, light.texture, at(cell % n, k % fine), at(cell / n, k / fine));
                mean += found / f64::from(fine * fine * n * n);
                sum_sq += found * found;
            }
            (sum_sq / f64::from(fine * fine)).sqrt()
        })
        .collect();
    let even = EVEN * cells.iter().sum::<f64>() / f64::from(n * n);
    let rows: Vec<Vec<f64>> =
        cells.chunks(n as usize).map(|row| row.iter().map(|c| c + even).collect()).collect();
    push_cumulative(&rows.iter().map(|row| row.iter().sum()).collect::<Vec<f64>>(), distributions);
    rows.iter().for_each(|row| push_cumulative(row, distributions));
    mean
}
