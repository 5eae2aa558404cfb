//! Samples of pixel filters: offsets from a pixel's centre, in pixels, whose density is the filter
//! or, for a filter with negative lobes, proportional to its absolute value (Ernst, Stamminger &
//! Greiner 2006, "Filter Importance Sampling"). Twin: `shaders/math/pixel_filter.wgsl`.

use super::TAU;
use super::real::{Real, Vec2};
use super::trig::{logarithm, sin_cos};

/// Number of halvings of [0, 2] in the inversion of the cubic filter's distribution.
const HALVINGS: u32 = 22;

/// Kind of a pixel filter, stored as a number in `Camera::filter_kind`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum FilterKind {
    /// The pixel itself.
    Pixel,
    /// A square of any width.
    Box,
    /// Product of two tents.
    Tent,
    /// Gaussian within a circle.
    Gaussian,
    /// Product of two cubic filters.
    Mitchell,
}

impl FilterKind {
    /// Kind with the number `kind`.
    #[inline(always)]
    pub const fn of(kind: u32) -> Self {
        match kind {
            0 => Self::Pixel,
            1 => Self::Box,
            2 => Self::Tent,
            3 => Self::Gaussian,
            _ => Self::Mitchell,
        }
    }
}

/// Offset with a constant density between `-radius` and `radius`.
pub fn sample_box(u: Real, radius: Real) -> Real {
    radius * (2.0 * u - 1.0)
}

/// Offset with the density of a tent that ends at `radius`.
pub fn sample_tent(u: Real, radius: Real) -> Real {
    let v = 2.0 * u - 1.0;
    let x = 1.0 - (1.0 - v.abs()).sqrt();
    radius * if v < 0.0 { -x } else { x }
}

/// Offset with the density of a Gaussian within a circle; `inside` is the fraction of the whole
/// Gaussian that the circle contains, `1 - exp(-radius^2 / (2 sigma^2))`.
pub fn sample_gaussian(u: Vec2, sigma: Real, inside: Real) -> Vec2 {
    let r = sigma * (-2.0 * logarithm(1.0 - u.x * inside)).max(0.0).sqrt();
    let (s, c) = sin_cos(TAU * u.y);
    Vec2::new(r * c, r * s)
}

/// Integral of the absolute value of six times the cubic filter from `2 - s` to 2, for `s` up to
/// one. The filter is `s^2 ((b + 6 c) s - 6 c) / 6` there: negative where `(b + 6 c) s < 6 c`, with
/// the integral `-(half - 3) / 12`.
fn cubic_tail(s: Real, b: Real, c: Real, half: Real) -> Real {
    let slope = b + 6.0 * c;
    let found = s * s * s * (2.0 * c - 0.25 * slope * s);
    if slope * s > 6.0 * c {
        return (half - 3.0) - found;
    }
    found
}

/// Integral of the absolute value of six times the cubic filter from 0 to `x`, for `x` in [0, 2];
/// `half` is the integral up to 2.
fn cubic_integral(x: Real, b: Real, c: Real, half: Real) -> Real {
    if x >= 1.0 {
        return half - cubic_tail(2.0 - x, b, c, half);
    }
    let square = 2.0 * (2.0 * b + c) - 6.0;
    let cube = 3.0 - 0.75 * (3.0 * b + 2.0 * c);
    x * ((6.0 - 2.0 * b) + x * x * (square + cube * x))
}

/// Offset with a density proportional to the absolute value of the cubic filter with the parameters
/// `b` and `c`; `half` is the integral of six times that value from 0 to 2.
pub fn sample_cubic(u: Real, b: Real, c: Real, half: Real) -> Real {
    let v = 2.0 * u - 1.0;
    let wanted = v.abs() * half;
    // bisection: exact, with the same bits everywhere
    let mut x = 0.0;
    let mut width = 1.0;
    for _ in 0..HALVINGS {
        if cubic_integral(x + width, b, c, half) <= wanted {
            x += width;
        }
        width *= 0.5;
    }
    if v < 0.0 { -x } else { x }
}

/// Returns true if [`sample_cubic`] gives an offset where the filter is negative.
pub fn in_lobe(u: Real, half: Real) -> bool {
    (2.0 * u - 1.0).abs() * half > half - 0.5 * (half - 3.0)
}
