//! Shrinking of the gather radius from pass to pass.

use super::Plan;
use crate::scene::settings::RadiusRule;

impl Plan {
    /// Squared radius in pass `pass` of this render over the squared start radius. For the local
    /// rule it is an estimate, which only sets the cell size.
    pub fn scale_sq(&self, pass: u32) -> f64 {
        match self.settings.radius_rule {
            RadiusRule::Fixed => 1.0,
            _ => global_scale_sq(self.first_pass as u64 + pass as u64 + 1, self.settings.alpha),
        }
    }

    /// Typical gather radius of pass `pass` in world units; of the first class, if there are two.
    pub fn radius(&self, pass: u32) -> f64 {
        self.widening * self.probe.radius * self.scale_sq(pass).sqrt() * self.unit
    }
}

/// `r_i^2 / r_1^2 = prod_{k=1}^{i-1} (k + alpha) / (k + 1)` (Knaus & Zwicker 2011, eq. 20), in
/// closed form through the gamma function for large `i`.
pub fn global_scale_sq(i: u64, alpha: f64) -> f64 {
    const DIRECT: u64 = 256;
    let head: f64 = (1..i.min(DIRECT)).map(|k| (k as f64 + alpha) / (k as f64 + 1.0)).product();
    if i <= DIRECT {
        return head;
    }
    // Gamma(i + a) / Gamma(i + 1) relative to its value at i = DIRECT
    let ratio = |x: f64| ln_gamma(x + alpha) - ln_gamma(x + 1.0);
    head * (ratio(i as f64) - ratio(DIRECT as f64)).exp()
}

/// ln Gamma(x) by Stirling's series; relative error about 1e-15 for x >= 100.
fn ln_gamma(x: f64) -> f64 {
    let r = 1.0 / x;
    (x - 0.5) * x.ln() - x + 0.918_938_533_204_672_7 + r / 12.0 - r * r * r / 360.0
        + r.powi(5) / 1260.0
}
