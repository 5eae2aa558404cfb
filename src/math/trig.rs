//! Elementary functions as fixed polynomials, so that every device rounds them alike; WGSL leaves
//! the accuracy of its built-in `sin`, `exp`, ... open. Coefficients: Moshier, Cephes (single
//! precision). Twin: `shaders/math/trig.wgsl`.

use std::f32::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, LOG2_E, PI};

/// Returns `x` (a number below 1e30) in a way that compilers cannot see through. Mesa rewrites
/// `a * b + a * c` to `a * (b + c)`, and `(a + b) + constant` to `(a + constant) + b`, which would
/// destroy the parts of an argument reduction or the order of a sum.
pub fn kept(x: f32) -> f32 {
    x.min(1e30)
}

/// `(sin x, cos x)` for x in radians; absolute error below 1e-7 for |x| <= 1e4.
///
/// Cody-Waite reduction: pi/2 in three parts, the first two short enough for exact products.
pub fn sin_cos(x: f32) -> (f32, f32) {
    let k = (x * FRAC_2_PI + 0.5).floor();
    let r = ((x - kept(k * 1.5703125)) - kept(k * 4.837_513e-4)) - kept(k * 7.549_79e-8);
    let z = r * r;
    let s = kept(((-1.951_529_6e-4 * z + 8.332_161e-3) * z - 1.666_665_5e-1) * z * r) + r;
    let c = (((2.443_315_7e-5 * z - 1.388_731_6e-3) * z + 4.166_664_6e-2) * z - 0.5) * z + 1.0;
    let quadrant = (k as i32) & 3;
    let odd = (quadrant & 1) == 1;
    let sin = if odd { c } else { s };
    let cos = if odd { s } else { c };
    (
        if quadrant >= 2 { -sin } else { sin },
        if quadrant == 1 || quadrant == 2 { -cos } else { cos },
    )
}

/// Angle of (x, y) in (-pi, pi], radians; absolute error below 4e-7. Zero for the origin.
pub fn arctan2(y: f32, x: f32) -> f32 {
    let ax = x.abs();
    let ay = y.abs();
    let big = ax.max(ay);
    if big == 0.0 {
        return 0.0;
    }
    let ratio = ax.min(ay) / big;
    // tan(pi/8) separates the two expansions
    let shifted = ratio > 0.414_213_57;
    let w = if shifted { (ratio - 1.0) / (ratio + 1.0) } else { ratio };
    let z = w * w;
    let p = kept(
        (((8.053_744_5e-2 * z - 1.387_768_6e-1) * z + 1.997_771_1e-1) * z - 3.333_295e-1) * z * w,
    ) + w;
    let octant = if shifted { kept(p) + FRAC_PI_4 } else { p };
    let quadrant = if ay > ax { FRAC_PI_2 - octant } else { octant };
    let half = if x < 0.0 { PI - quadrant } else { quadrant };
    if y < 0.0 { -half } else { half }
}

/// e^x; relative error below 2e-7. Zero below -87, where f32 approaches its smallest normal number,
/// and clamped to e^88 above 88.
pub fn exponential(x: f32) -> f32 {
    if x < -87.0 {
        return 0.0;
    }
    let y = x.min(88.0);
    let k = (y * LOG2_E + 0.5).floor();
    let r = (y - kept(k * 0.693_359_4)) + kept(k * 2.121_944_4e-4);
    let z = r * r;
    let p = ((((1.987_569_1e-4 * r + 1.398_2e-3) * r + 8.333_452e-3) * r + 4.166_579_6e-2) * r
        + 1.666_666_6e-1)
        * r
        + 0.5;
    let power_of_two = f32::from_bits(((k as i32 + 127) as u32) << 23);
    (kept(kept(p * z) + r) + 1.0) * power_of_two
}

/// Natural logarithm; absolute error below 1e-7 times max(1, |ln x|). Arguments below 2^-126,
/// including zero and negative numbers, count as 2^-126.
pub fn logarithm(x: f32) -> f32 {
    let bits = x.max(1.175_494_4e-38).to_bits();
    let mut exponent = (bits >> 23) as i32 - 126;
    let mut m = f32::from_bits((bits & 0x007f_ffff) | 0x3f00_0000);
    // scale m to [sqrt(1/2), sqrt(2))
    if m < std::f32::consts::FRAC_1_SQRT_2 {
        exponent -= 1;
        m += m;
    }
    let r = m - 1.0;
    let z = r * r;
    let low = (((7.037_683_6e-2 * r - 1.151_461e-1) * r + 1.167_699_9e-1) * r - 1.242_014_1e-1) * r;
    let high = (((low + 1.424_932_3e-1) * r - 1.666_805_7e-1) * r + 2.000_071_5e-1) * r;
    let p = ((high - 2.499_999_4e-1) * r + 3.333_333e-1) * r;
    let e = exponent as f32;
    let tail = (kept(p * z) - kept(e * 2.121_944_4e-4)) - kept(0.5 * z);
    (r + tail) + kept(e * 0.693_359_4)
}

/// x^y for x >= 0 as exp(y ln x); relative error about 1e-7 (2 + |y ln x|). 0^y is 0 for y > 0, 1
/// for y = 0.
pub fn power(x: f32, y: f32) -> f32 {
    if x <= 0.0 {
        return if y == 0.0 { 1.0 } else { 0.0 };
    }
    exponential(y * logarithm(x))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest value of `error` over `count` points of [a, b].
    fn worst(a: f64, b: f64, count: u32, error: impl Fn(f32) -> f64) -> f64 {
        (0..=count)
            .map(|i| error((a + (b - a) * f64::from(i) / f64::from(count)) as f32))
            .fold(0.0, f64::max)
    }

    // Theory: the f32 argument is exact, so the f64 function of std gives the true value to 1e-15.
    #[test]
    fn sin_cos_agrees_with_f64() {
        for range in [1.0, 10.0, 1e3, 1e4] {
            let error = |x: f32| {
                let (s, c) = sin_cos(x);
                let (ts, tc) = f64::from(x).sin_cos();
                (f64::from(s) - ts).abs().max((f64::from(c) - tc).abs())
            };
            let e = worst(-range, range, 2_000_000, error);
            println!("sin_cos |x| <= {range}: {e:.2e}");
            assert!(e < 1e-7, "{e}");
        }
        // the check detects an argument that is off by one part in a million
        assert!(
            worst(-10.0, 10.0, 1000, |x| (f64::from(sin_cos(x * 1.000_001).0)
                - f64::from(x).sin())
            .abs())
                > 1e-6
        );
    }

    #[test]
    fn arctan2_agrees_with_f64() {
        let e = worst(-std::f64::consts::PI, std::f64::consts::PI, 2_000_000, |a| {
            let (s, c) = f64::from(a).sin_cos();
            let (y, x) = ((s * 3.7) as f32, (c * 3.7) as f32);
            let d = (f64::from(arctan2(y, x)) - f64::from(y).atan2(f64::from(x))).abs();
            d.min(std::f64::consts::TAU - d)
        });
        println!("arctan2: {e:.2e}");
        assert!(e < 4e-7, "{e}");
        assert_eq!(arctan2(0.0, 0.0), 0.0);
        assert_eq!(arctan2(0.0, -1.0), PI);
        assert_eq!(arctan2(-1.0, 0.0), -FRAC_PI_2);
    }

    #[test]
    fn exponential_agrees_with_f64() {
        let e = worst(-87.0, 88.0, 2_000_000, |x| {
            (f64::from(exponential(x)) / f64::from(x).exp() - 1.0).abs()
        });
        println!("exponential: {e:.2e}");
        assert!(e < 2e-7, "{e}");
        assert_eq!(exponential(0.0), 1.0);
        assert_eq!(exponential(-200.0), 0.0);
        assert!(exponential(1e30).is_finite());
    }

    #[test]
    fn logarithm_agrees_with_f64() {
        let e = worst(-87.0, 88.0, 2_000_000, |x| {
            let v = f64::from(x).exp() as f32;
            let t = f64::from(v).ln();
            (f64::from(logarithm(v)) - t).abs() / t.abs().max(1.0)
        });
        println!("logarithm: {e:.2e}");
        assert!(e < 1e-7, "{e}");
        assert_eq!(logarithm(1.0), 0.0);
        assert!(logarithm(0.0).is_finite() && logarithm(-1.0).is_finite());
    }

    #[test]
    fn power_agrees_with_f64() {
        for y in [0.5, 1.0 / 2.4, 2.2, -3.0] {
            let e = worst(1e-3, 10.0, 200_000, |x| {
                let t = f64::from(x).powf(f64::from(y));
                (f64::from(power(x, y)) / t - 1.0).abs()
                    / (2.0 + (f64::from(y) * f64::from(x).ln()).abs())
            });
            println!("power y = {y}: {e:.2e}");
            assert!(e < 1e-7, "{e}");
        }
        assert_eq!((power(0.0, 2.0), power(0.0, 0.0)), (0.0, 1.0));
    }
}
