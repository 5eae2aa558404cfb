//! Elementary functions in f64, from the standard library: no GPU has to match their bits. The f32
//! version is `src/math/trig.rs`.

/// Returns `x`. The f32 version hides it from shader compilers.
pub fn kept(x: f64) -> f64 {
    x
}

/// `(sin x, cos x)` for x in radians.
pub fn sin_cos(x: f64) -> (f64, f64) {
    x.sin_cos()
}

/// Angle of (x, y) in (-pi, pi], radians. Zero for the origin.
pub fn arctan2(y: f64, x: f64) -> f64 {
    y.atan2(x)
}

/// Natural logarithm; arguments below the smallest normal number count as that number.
pub fn logarithm(x: f64) -> f64 {
    x.max(f64::MIN_POSITIVE).ln()
}

/// e^x.
pub fn exponential(x: f64) -> f64 {
    x.exp()
}
