//! The start radius where nobody names one.
//!
//! Mean squared error is variance, which falls as the photons in the disc grow, and squared bias,
//! which grows as r^4: the radius with the least sum goes as the sixth root of one over the
//! photons' density (Silverman 1986, section 4.3, for densities in the plane). What stands before
//! the root is measured: docs/speed-accuracy.md, made by `scenes/studies/run`, shows it beside
//! other radii.

use std::fmt;

/// Start radius in pixels, for one photon a pass on each pixel, of photons that a diffuse surface
/// has scattered: their light is smooth.
const INDIRECT: f64 = 5.5;
/// The same of the others where they bring caustics, for one photon a pass emitted for each pixel:
/// a wide disc blurs their edges, and maps send photons enough.
const CAUSTIC: f64 = 2.0;
/// Radius of the first over that of the others where there are no caustics.
const SMOOTH: f64 = 3.0;
/// Least share of caustics in the photons' light that counts.
const LEAST_SHARE: f64 = 0.01;
/// Pixels that are chosen; steps of about a square root of two, so that the choice hangs on no
/// rounding and can be said.
const STEPS: [f64; 9] = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0];

/// A choice and its reasons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Automatic {
    /// Start radius in widths of a pixel's footprint.
    pub pixels: f64,
    /// That of photons that a diffuse surface has scattered, over it.
    pub indirect: f64,
    /// Photons of a pass that fall on a pixel's footprint, median over the picture.
    pub density: f64,
    /// Share of caustics in the light that photons bring.
    pub caustics: f64,
}

/// Chooses for `density` photons of a pass on a pixel and `emitted` that are emitted for each
/// pixel.
pub fn automatic(density: f64, emitted: f64, caustics: f64) -> Automatic {
    // No photon at all asks for the widest disc.
    let best = |one: f64, photons: f64| one * photons.max(1e-9).powf(-1.0 / 6.0);
    let wide = step(best(INDIRECT, density));
    let sharp = if caustics < LEAST_SHARE { wide / SMOOTH } else { best(CAUSTIC, emitted) };
    let pixels = step(sharp.min(wide));
    Automatic { pixels, indirect: (wide / pixels).max(1.0), density, caustics }
}

/// The nearest of [`STEPS`], by ratio.
fn step(radius: f64) -> f64 {
    let far = |step: &f64| (step / radius).ln().abs();
    STEPS.into_iter().min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(radius)
}

impl fmt::Display for Automatic {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { pixels, indirect, density, caustics } = self;
        let wide = pixels * indirect;
        let density = match density {
            d if *d < 1e-4 => "hardly any".to_owned(),
            d if *d < 0.095 => format!("{d:.1e}"),
            d if *d < 0.95 => format!("{d:.1}"),
            d => format!("{d:.0}"),
        };
        let share = 100.0 * caustics;
        write!(
            f,
            "{pixels} px, {wide} px for light that a diffuse surface has scattered, for {density} photons of a pass on each pixel, of whose light {share:.0} % is caustics"
        )
    }
}

/// Theory: 64 times the photons halve the radius, and a choice is one of the steps.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn denser_photons_make_narrower_discs() {
        let px = |photons: f64| automatic(photons, photons, 0.5).pixels;
        let wide = |photons: f64| automatic(photons, photons, 0.5).indirect * px(photons);
        assert_eq!((px(1.0 / 64.0), px(64.0)), (2.0 * px(1.0), 0.5 * px(1.0)));
        assert_eq!((wide(1.0 / 64.0), wide(64.0)), (2.0 * wide(1.0), 0.5 * wide(1.0)));
        let all: Vec<f64> = (-60..60).map(|k| px(10f64.powf(0.1 * f64::from(k)))).collect();
        assert!(all.windows(2).all(|pair| pair[0] >= pair[1]), "{all:?}");
        assert!(all.iter().all(|pixels| STEPS.contains(pixels)));
        assert_eq!((px(0.0), px(f64::INFINITY)), (16.0, 1.0), "nothing seen, and everything");
        let smooth = automatic(1.0, 1.0, 0.0);
        assert_eq!((smooth.pixels, smooth.indirect), (2.0, 3.0), "one disc of six pixels");
    }

    #[test]
    fn a_choice_says_why() {
        let said = automatic(0.314, 1.0, 0.42).to_string();
        assert!(
            said.ends_with(
                "scattered, for 0.3 photons of a pass on each pixel, of whose light 42 % is caustics"
            ),
            "{said}"
        );
        assert!(automatic(0.0, 1.0, 0.0).to_string().contains("for hardly any photons"));
    }
}
