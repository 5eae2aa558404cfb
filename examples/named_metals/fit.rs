//! Choice of one complex index per RGB channel: see `docs/metals.md`.

use super::observer::{COUNT, channel_weights, wavelengths};
use super::spectra::Spectrum;

/// Number of angles at which the reflectance is fitted.
const ANGLES: usize = 32;

/// Steps of the search for `eta` before it is refined.
const SCAN: usize = 512;

/// Steps of the golden-section search.
const REFINEMENTS: usize = 60;

/// Index of a metal per channel of linear Rec. 709, and how well it fits.
pub struct Fit {
    /// Reflectance at normal incidence, computed from the spectrum; may exceed 1 or be negative if
    /// the color lies outside of the gamut.
    pub color: [f64; 3],
    /// `color`, limited to what a metal can reflect: see [`fit`].
    pub reflectance: [f64; 3],
    /// Index of refraction.
    pub eta: [f64; 3],
    /// Extinction coefficient.
    pub k: [f64; 3],
    /// Root mean square of the reflectance's error over the angles.
    pub rms: [f64; 3],
    /// Greatest error of the reflectance at an angle.
    pub max: [f64; 3],
}

/// Reflectance of a conductor for unpolarized light in vacuum: the exact Fresnel equations for a
/// complex index (Born and Wolf, Principles of Optics, 7th edition, section 14.4.2). `cos` is the
/// cosine of the angle of incidence.
pub fn conductor(cos: f64, eta: f64, k: f64) -> f64 {
    let (cos_sq, sin_sq) = (cos * cos, 1.0 - cos * cos);
    // u + iv = eta cos(theta_t) = sqrt((eta + ik)^2 - sin^2)
    let real = eta * eta - k * k - sin_sq;
    let modulus = real.hypot(2.0 * eta * k);
    let u = (0.5 * (modulus + real)).max(0.0).sqrt();
    let s = (cos_sq + modulus - 2.0 * u * cos) / (cos_sq + modulus + 2.0 * u * cos);
    let (even, odd) = (modulus * cos_sq + sin_sq * sin_sq, 2.0 * u * cos * sin_sq);
    let p = s * (even - odd) / (even + odd);
    0.5 * (s + p)
}

/// Extinction coefficient with which a conductor of index `eta` reflects `r` at normal incidence.
fn extinction(eta: f64, r: f64) -> f64 {
    let (plus, minus) = (eta + 1.0, eta - 1.0);
    ((r * plus * plus - minus * minus) / (1.0 - r)).max(0.0).sqrt()
}

/// Cosines of the angles of the fit: the middles of equal intervals.
fn cosines() -> [f64; ANGLES] {
    std::array::from_fn(|i| (i as f64 + 0.5) / ANGLES as f64)
}

/// Reflectance of a channel: the weighted mean over the wavelengths, and the same limited to values
/// from 0 to the greatest reflectance at a wavelength.
fn channel(weights: &[f64; COUNT], reflectances: &[f64; COUNT]) -> (f64, f64) {
    let mean: f64 = weights.iter().zip(reflectances).map(|(weight, r)| weight * r).sum();
    let greatest = reflectances.iter().fold(0.0, |greatest: f64, &r| greatest.max(r));
    (mean, mean.clamp(0.0, greatest))
}

/// The index per channel that reproduces a channel's reflectance at normal incidence exactly, and
/// at the other angles with the least mean square error.
///
/// A channel's reflectance at an angle is the mean of the Fresnel reflectance over the wavelengths
/// with [`channel_weights`]. It is at most the greatest reflectance at any wavelength and at least
/// 0: the weights have negative parts, with which a saturated metal leaves [0, 1].
///
/// All indices with the same reflectance `r` at normal incidence have `eta` between
/// `(1 - sqrt r) / (1 + sqrt r)` and the inverse, and one `k` for each `eta` (Gulbrandsen, Artist
/// Friendly Metallic Fresnel, JCGT 3(4), 2014). So the fit is a search for one number, `eta`: a
/// scan in equal ratios, then a golden-section search.
pub fn fit(spectrum: &Spectrum) -> Fit {
    let indices = wavelengths().map(|nm| spectrum.at(nm));
    let at = |cos: f64| indices.map(|(n, k)| conductor(cos, n, k));
    let (normal, oblique) = (at(1.0), cosines().map(at));
    let mut fit = Fit {
        color: [0.0; 3],
        reflectance: [0.0; 3],
        eta: [0.0; 3],
        k: [0.0; 3],
        rms: [0.0; 3],
        max: [0.0; 3],
    };
    for (c, weights) in channel_weights().iter().enumerate() {
        (fit.color[c], fit.reflectance[c]) = channel(weights, &normal);
        let r = fit.reflectance[c];
        let targets = oblique.map(|reflectances| channel(weights, &reflectances).1);
        let errors = |eta: f64| {
            let k = extinction(eta, r);
            let mut errors = [0.0; ANGLES];
            for ((error, cos), target) in errors.iter_mut().zip(cosines()).zip(targets) {
                *error = (conductor(cos, eta, k) - target).abs();
            }
            errors
        };
        let square = |eta: f64| errors(eta).iter().map(|error| error * error).sum::<f64>();
        fit.eta[c] = least(square, (1.0 + r.sqrt()) / (1.0 - r.sqrt()));
        fit.k[c] = extinction(fit.eta[c], r);
        fit.rms[c] = (square(fit.eta[c]) / ANGLES as f64).sqrt();
        fit.max[c] = errors(fit.eta[c]).into_iter().fold(0.0, f64::max);
    }
    fit
}

/// Where `f` is least in [1 / limit, limit].
fn least(f: impl Fn(f64) -> f64, limit: f64) -> f64 {
    let ratio = limit.powf(2.0 / SCAN as f64);
    let samples = (0..=SCAN).map(|i| ratio.powi(i as i32) / limit);
    let start = samples.min_by(|&a, &b| f(a).total_cmp(&f(b))).unwrap_or(1.0);
    let golden = 0.5 * (5_f64.sqrt() - 1.0);
    let (mut low, mut high) = ((start / ratio).max(1.0 / limit), (start * ratio).min(limit));
    for _ in 0..REFINEMENTS {
        let (left, right) = (high - golden * (high - low), low + golden * (high - low));
        if f(left) < f(right) {
            high = right;
        } else {
            low = left;
        }
    }
    0.5 * (low + high)
}
