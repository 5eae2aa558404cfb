// Elementary functions as fixed polynomials, so that every device rounds them alike. Twin:
// src/math/trig.rs, which states errors and sources.

// Returns `x` in a way that compilers cannot see through, so that they do not rewrite a sum.
fn kept(x: f32) -> f32 {
    return min(x, 1e30);
}

// Returns (sin x, cos x).
fn sin_cos(x: f32) -> vec2f {
    let k = floor(x * 0.63661975 + 0.5);
    let r = ((x - kept(k * 1.5703125)) - kept(k * 4.837513e-4)) - kept(k * 7.54979e-8);
    let z = r * r;
    let s = kept(((-1.9515296e-4 * z + 8.332161e-3) * z - 1.6666655e-1) * z * r) + r;
    let c = (((2.4433157e-5 * z - 1.3887316e-3) * z + 4.1666646e-2) * z - 0.5) * z + 1.0;
    let quadrant = i32(k) & 3;
    let odd = (quadrant & 1) == 1;
    let sin = select(s, c, odd);
    let cos = select(c, s, odd);
    return vec2f(
        select(sin, -sin, quadrant >= 2), select(cos, -cos, quadrant == 1 || quadrant == 2)
    );
}

fn arctan2(y: f32, x: f32) -> f32 {
    let ax = abs(x);
    let ay = abs(y);
    let big = max(ax, ay);
    if big == 0.0 {
        return 0.0;
    }
    let ratio = min(ax, ay) / big;
    let shifted = ratio > 0.41421357;
    let w = select(ratio, (ratio - 1.0) / (ratio + 1.0), shifted);
    let z = w * w;
    let p =
        kept((((8.0537445e-2 * z - 1.3877686e-1) * z + 1.9977711e-1) * z - 3.333295e-1) * z * w) + w;
    let octant = select(p, kept(p) + 0.7853982, shifted);
    let quadrant = select(octant, 1.5707964 - octant, ay > ax);
    let half = select(quadrant, 3.1415927 - quadrant, x < 0.0);
    return select(half, -half, y < 0.0);
}

fn exponential(x: f32) -> f32 {
    if x < -87.0 {
        return 0.0;
    }
    let y = min(x, 88.0);
    let k = floor(y * 1.442695 + 0.5);
    let r = (y - kept(k * 0.6933594)) + kept(k * 2.1219444e-4);
    let z = r * r;
    let p = ((((1.9875691e-4 * r + 1.3982e-3) * r + 8.333452e-3) * r + 4.1665796e-2) * r
        + 1.6666666e-1)
        * r
        + 0.5;
    let power_of_two = bitcast<f32>(u32(i32(k) + 127) << 23u);
    return (kept(kept(p * z) + r) + 1.0) * power_of_two;
}

fn logarithm(x: f32) -> f32 {
    let bits = bitcast<u32>(max(x, 1.1754944e-38));
    var exponent = i32(bits >> 23u) - 126;
    var m = bitcast<f32>((bits & 0x007fffffu) | 0x3f000000u);
    if m < 0.70710677 {
        exponent -= 1;
        m += m;
    }
    let r = m - 1.0;
    let z = r * r;
    let low = (((7.0376836e-2 * r - 1.151461e-1) * r + 1.1676999e-1) * r - 1.2420141e-1) * r;
    let high = (((low + 1.4249323e-1) * r - 1.6668057e-1) * r + 2.0000715e-1) * r;
    let p = ((high - 2.4999994e-1) * r + 3.333333e-1) * r;
    let e = f32(exponent);
    let tail = (kept(p * z) - kept(e * 2.1219444e-4)) - kept(0.5 * z);
    return (r + tail) + kept(e * 0.6933594);
}

fn power(x: f32, y: f32) -> f32 {
    if x <= 0.0 {
        return select(0.0, 1.0, y == 0.0);
    }
    return exponential(y * logarithm(x));
}
