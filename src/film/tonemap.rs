//! Tone mapping from radiance to display values: exposure, AgX or clipping, sRGB curve.

use std::sync::LazyLock;

use glam::{DMat3, DVec3};

use crate::math::srgb::srgb_from_linear;
use crate::scene::{Film, ToneMap};

/// Conversion of radiance to display values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Development {
    /// Exposure in stops (powers of two).
    pub exposure: f64,
    /// Tone curve.
    pub tonemap: ToneMap,
    /// Bit depth of each channel in a file.
    pub bits: Bits,
}

impl Development {
    /// Development with the exposure and tone map of a film, at 8 bits per channel.
    pub fn of(film: &Film) -> Self {
        Self { exposure: film.exposure, tonemap: film.tonemap, bits: Bits::Eight }
    }
}

/// Bit depth per channel of display values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Bits {
    /// 8 bits, for viewing.
    #[default]
    Eight,
    /// 16 bits, for editing.
    Sixteen,
}

impl Development {
    /// Display values in [0, 1] with the sRGB curve applied. NaN becomes black.
    pub fn display(&self, radiance: [f32; 3]) -> [f64; 3] {
        let exposed = DVec3::from(radiance.map(f64::from)) * self.exposure.exp2();
        let linear = match self.tonemap {
            ToneMap::Agx => agx(exposed),
            ToneMap::Srgb => exposed,
        };
        linear
            .to_array()
            .map(|value| if value > 0.0 { srgb_from_linear(value.min(1.0)) } else { 0.0 })
    }

    /// Display values as 8-bit numbers.
    pub fn bytes(&self, radiance: [f32; 3]) -> [u8; 3] {
        self.display(radiance).map(|value| (255.0 * value).round() as u8)
    }

    /// Display values as 16-bit numbers.
    pub fn words(&self, radiance: [f32; 3]) -> [u16; 3] {
        self.display(radiance).map(|value| (65535.0 * value).round() as u16)
    }
}

/// Range of the AgX curve, in stops relative to a radiance of one.
const AGX_STOPS: (f64, f64) = (-12.473_93, 4.026_069);

/// AgX inset matrix: desaturates colors before the curve, so that bright lights turn white. Each
/// row is normalized to sum to one, so that grays are preserved exactly.
static AGX_INSET: LazyLock<DMat3> = LazyLock::new(|| {
    let rows = [
        DVec3::new(0.842_479_062_253_094, 0.078_433_599_999_999_2, 0.079_223_745_147_764_3),
        DVec3::new(0.042_328_242_261_012_3, 0.878_468_636_469_772, 0.079_166_127_460_543_4),
        DVec3::new(0.042_375_654_905_705_1, 0.078_433_6, 0.879_142_973_793_104),
    ];
    let [r, g, b] = rows.map(|row| row / row.element_sum());
    DMat3::from_cols(r, g, b).transpose()
});

static AGX_OUTSET: LazyLock<DMat3> = LazyLock::new(|| AGX_INSET.inverse());

/// AgX tone mapping by Troy Sobotka (2022), with the matrices and the sixth-order polynomial fit of
/// the curve by Benjamin Wrensch ("Minimal AgX Implementation", mean squared error 3.7e-6). Input
/// and output are linear.
fn agx(exposed: DVec3) -> DVec3 {
    let (low, high) = AGX_STOPS;
    let inset = *AGX_INSET * exposed.max(DVec3::ZERO);
    let encoded = DVec3::from(inset.to_array().map(|value| {
        let stops = value.log2().clamp(low, high);
        agx_curve((stops - low) / (high - low)).clamp(0.0, 1.0)
    }));
    let display = *AGX_OUTSET * encoded;
    // the curve's output is encoded for a display with gamma 2.2
    display.max(DVec3::ZERO).powf(2.2)
}

/// AgX base contrast curve: increasing, from [0, 1] to approximately [0, 1].
fn agx_curve(x: f64) -> f64 {
    const COEFFICIENTS: [f64; 7] = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.002_32];
    COEFFICIENTS.iter().fold(0.0, |sum, coefficient| sum * x + coefficient)
}
