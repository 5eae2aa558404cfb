//! Fraction of light that microfacets scatter once, as a polynomial in the cosine.

use super::real::{Real, Vec4};
use super::tables::Material;
use crate::double::materials::brushed::{brushed_lambda, brushed_normal};
use crate::double::materials::fresnel::{fresnel, refracted};
use crate::double::materials::microfacet::{ggx_lambda, ggx_visible_normal};
use crate::double::tables::Material as Brushed;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Number of coefficients.
const TERMS: usize = 8;
/// Number of cosines that the polynomial is fitted to.
const NODES: usize = 24;
/// Number of sampled facets along each dimension.
const FACETS: usize = 48;

/// The same for brushed metal, and the number of azimuths.
const FEW: usize = 24;
const AZIMUTHS: usize = 6;

/// Directional albedo of GGX microfacets.
#[derive(Clone, Copy, Debug)]
pub struct Albedo {
    /// Coefficients of the powers of the cosine, lowest first.
    pub terms: [f64; TERMS],
    /// Least value at the cosines that it was fitted to.
    pub least: f64,
}

impl Albedo {
    /// Albedo for a width `alpha`, if a facet reflects `fresnel` of the light at its own cosine:
    /// the mean of `F G_2 / G_1` over the visible normals, fitted by least squares.
    pub fn of(alpha: f64, fresnel: impl Fn(f64) -> f64) -> Self {
        Self::fitted_to(|cos| single_scattering(alpha, cos, &fresnel))
    }

    /// Albedo, both sides together, of a rough dielectric seen from the medium with `eta` times the
    /// index of the other one.
    pub fn of_dielectric(alpha: f64, eta: f64) -> Self {
        Self::fitted_to(|cos| {
            mean_over_facets(alpha, cos, |wo, h| {
                let interface = fresnel(wo.dot(h), eta);
                let up = h * (2.0 * wo.dot(h)) - wo;
                let down = refracted(wo, h, wo.dot(h), interface.cos_t, eta);
                let reflected = interface.reflectance * masking(alpha, cos, up.z);
                reflected + (1.0 - interface.reflectance) * masking(alpha, cos, -down.z)
            })
        })
    }

    /// Albedo of brushed metal with the widths `along_u` and `along_v` and a Fresnel term of one,
    /// the mean over the azimuth.
    pub fn of_brushed([along_u, along_v]: [f64; 2]) -> Self {
        let m = Brushed { alpha: along_u, ior: along_v, ..Brushed::EMPTY };
        Self::fitted_to(|cos| {
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            let toward = |k: usize| {
                // one quadrant: the distribution is symmetric
                let (y, x) = ((k as f64 + 0.5) / AZIMUTHS as f64 * (0.5 * PI)).sin_cos();
                let wo = DVec3::new(sin * x, sin * y, cos);
                let lambda = brushed_lambda(wo, &m);
                let part = |k: usize| {
                    let u = DVec2::new((k % FEW) as f64 + 0.5, (k / FEW) as f64 + 0.5) / FEW as f64;
                    let h = brushed_normal(wo, &m, u);
                    let wi = h * (2.0 * wo.dot(h)) - wo;
                    if wi.z <= 0.0 {
                        return 0.0;
                    }
                    (1.0 + lambda) / (1.0 + lambda + brushed_lambda(wi, &m))
                };
                (0..FEW * FEW).map(part).sum::<f64>() / (FEW * FEW) as f64
            };
            (0..AZIMUTHS).map(toward).sum::<f64>() / AZIMUTHS as f64
        })
    }

    fn fitted_to(albedo: impl Fn(f64) -> f64) -> Self {
        let nodes: [(f64, f64); NODES] = std::array::from_fn(|i| {
            // dense towards both ends
            let cos = 0.5 - 0.5 * ((i as f64 + 0.5) / NODES as f64 * PI).cos();
            (cos, albedo(cos))
        });
        let least = nodes.iter().map(|node| node.1).fold(1.0, f64::min);
        Self { terms: fitted(&nodes), least }
    }

    /// Mean over the hemisphere, weighted by the cosine.
    pub fn mean(&self) -> f64 {
        self.terms.iter().enumerate().map(|(k, term)| 2.0 * term / (k + 2) as f64).sum()
    }

    /// Stores the polynomial and its mean.
    pub fn store(&self, out: &mut Material) {
        let [a, b, c, d, e, f, g, h] = self.terms.map(|term| term as Real);
        out.albedo_low = Vec4::new(a, b, c, d);
        out.albedo_high = Vec4::new(e, f, g, h);
        out.mean_albedo = self.mean() as Real;
    }
}

/// Mean over the hemisphere, weighted by the cosine, of a function of the cosine.
pub fn mean_over_hemisphere(f: impl Fn(f64) -> DVec3) -> DVec3 {
    const STEPS: usize = 2048;
    let step = |i: usize| {
        let cos = (i as f64 + 0.5) / STEPS as f64;
        f(cos) * (2.0 * cos)
    };
    (0..STEPS).map(step).sum::<DVec3>() / STEPS as f64
}

fn single_scattering(alpha: f64, cos: f64, fresnel: &impl Fn(f64) -> f64) -> f64 {
    mean_over_facets(alpha, cos, |wo, h| {
        let wi = h * (2.0 * wo.dot(h)) - wo;
        fresnel(wo.dot(h)) * masking(alpha, cos, wi.z)
    })
}

/// `G_2 / G_1` for directions with these cosines; 0 if the second one is on the wrong side.
fn masking(alpha: f64, cos_o: f64, cos_i: f64) -> f64 {
    if cos_i <= 0.0 {
        return 0.0;
    }
    let lambda = ggx_lambda(cos_o, alpha);
    (1.0 + lambda) / (1.0 + lambda + ggx_lambda(cos_i, alpha))
}

/// Mean of `f(wo, h)` over the normals `h` that are visible from `wo`, which has the cosine `cos`.
fn mean_over_facets(alpha: f64, cos: f64, f: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    let wo = DVec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
    let part = |k: usize| {
        let u = DVec2::new((k % FACETS) as f64 + 0.5, (k / FACETS) as f64 + 0.5) / FACETS as f64;
        f(wo, ggx_visible_normal(wo, alpha, u))
    };
    (0..FACETS * FACETS).map(part).sum::<f64>() / (FACETS * FACETS) as f64
}

/// Least-squares polynomial through `nodes`, by the normal equations and Gaussian elimination.
fn fitted(nodes: &[(f64, f64)]) -> [f64; TERMS] {
    let mut rows = [[0.0; TERMS + 1]; TERMS];
    for (x, y) in nodes {
        let powers: [f64; TERMS] = std::array::from_fn(|k| x.powi(k as i32));
        for (row, a) in rows.iter_mut().zip(powers) {
            for (cell, b) in row.iter_mut().zip(powers.iter().chain([y])) {
                *cell += a * b;
            }
        }
    }
    for pivot in 0..TERMS {
        let best =
            (pivot..TERMS).max_by(|a, b| rows[*a][pivot].abs().total_cmp(&rows[*b][pivot].abs()));
        rows.swap(pivot, best.unwrap_or(pivot));
        let lead = rows[pivot];
        for row in &mut rows[pivot + 1..] {
            let factor = row[pivot] / lead[pivot];
            row.iter_mut().zip(lead).for_each(|(cell, value)| *cell -= factor * value);
        }
    }
    let mut terms = [0.0; TERMS];
    for k in (0..TERMS).rev() {
        let known: f64 = (k + 1..TERMS).map(|j| rows[k][j] * terms[j]).sum();
        terms[k] = (rows[k][TERMS] - known) / rows[k][k];
    }
    terms
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Theory: the polynomial gives the albedo within 0.005 at all cosines, and the mean follows
    /// from its terms. Values at a width of 1 are those of the tables of Kulla & Conty (2017): 0.45
    /// to 0.65 of the light is lost at most.
    #[test]
    fn polynomials_follow_the_albedo() {
        for alpha in [0.1, 0.3, 0.5, 0.8, 1.0] {
            for fresnel in [|_: f64| 1.0, |cos: f64| 0.04 + 0.96 * (1.0 - cos).powi(5)] {
                let albedo = Albedo::of(alpha, fresnel);
                let at = |cos: f64| {
                    albedo.terms.iter().enumerate().map(|(k, t)| t * cos.powi(k as i32)).sum()
                };
                let mut worst = 0f64;
                for i in 0..60 {
                    let cos = (f64::from(i) + 0.5) / 60.0;
                    let found: f64 = at(cos);
                    worst = worst.max((found - single_scattering(alpha, cos, &fresnel)).abs());
                }
                assert!(worst < 5e-3, "alpha {alpha}: {worst}");
                let mean = mean_over_hemisphere(|cos| DVec3::splat(at(cos))).x;
                assert!((mean - albedo.mean()).abs() < 1e-5, "{mean} {}", albedo.mean());
            }
        }
        let rough = Albedo::of(1.0, |_| 1.0);
        assert!((0.3..0.5).contains(&rough.least), "{}", rough.least);
    }
}
