//! All hits of a ray with a surface of revolution in f64, by an independent method.
//!
//! The ray parameter at height y(t) is u(t) = (y(t) - o_y) / d_y, so a hit is a root of the
//! polynomial g(t) = (o_x + u d_x)^2 + (o_z + u d_z)^2 - r^2, of twice the profile's degree.
//! Subdivision in Bernstein form isolates its roots (the polynomial lies in the hull of its
//! coefficients, and has at most as many roots as they have sign changes). A horizontal ray instead
//! meets the circles where y(t) = o_y.

use caustica::low_level::shapes::revolution::Revolution;
use glam::{DVec2, DVec3, Vec3};

/// A hit: distance in the units of the ray's direction, segment, curve parameter.
#[derive(Clone, Copy, Debug)]
pub struct OracleHit {
    pub t: f64,
    pub segment: usize,
    pub parameter: f64,
}

/// The f32 ray in the local frame that the f32 revolution describes; distances stay the scene's.
pub fn local_ray(revolution: &Revolution, origin: Vec3, direction: Vec3) -> (DVec3, DVec3) {
    let axes = [revolution.x_axis, revolution.y_axis, revolution.z_axis].map(|a| a.as_dvec3());
    let into = |v: DVec3| {
        DVec3::new(axes[0].dot(v), axes[1].dot(v), axes[2].dot(v)) / f64::from(revolution.scale)
    };
    (into(origin.as_dvec3() - revolution.center.as_dvec3()), into(direction.as_dvec3()))
}

/// Hits at distances above zero, nearest first.
pub fn all_hits(segments: &[Vec<DVec2>], o: DVec3, d: DVec3) -> Vec<OracleHit> {
    // Distances between which the ray is inside a ball around the surface; relative to a point near
    // it, coordinates are small.
    let radius = segments.iter().flatten().fold(0.0_f64, |a, p| a.max(p.length())) * 1.001;
    let (dd, od) = (d.length_squared(), o.dot(d));
    let near = -od / dd;
    let o = o + d * near;
    let reach_sq = (radius * radius - o.length_squared()) / dd;
    if reach_sq <= 0.0 {
        return Vec::new();
    }
    let reach = reach_sq.sqrt();
    let mut hits = Vec::new();
    for (segment, points) in segments.iter().enumerate() {
        let mut found = |t: f64, l: f64| {
            if l + near > 0.0 {
                hits.push(OracleHit { t: l + near, segment, parameter: t });
            }
        };
        if d.y == 0.0 {
            horizontal(points, o, d, &mut found);
        } else {
            slanted(points, o, d, reach, &mut found);
        }
    }
    hits.sort_by(|a, b| a.t.total_cmp(&b.t));
    hits
}

fn horizontal(points: &[DVec2], o: DVec3, d: DVec3, found: &mut impl FnMut(f64, f64)) {
    let r: Vec<f64> = points.iter().map(|p| p.x).collect();
    let height: Vec<f64> = points.iter().map(|p| p.y - o.y).collect();
    let a = d.x * d.x + d.z * d.z;
    let middle = -(o.x * d.x + o.z * d.z) / a;
    let across = (o.x * d.z - o.z * d.x).powi(2) / a;
    for t in roots(&height) {
        let h = value(&r, t).powi(2) - across;
        if h >= 0.0 {
            let half = (h / a).sqrt();
            found(t, middle - half);
            found(t, middle + half);
        }
    }
}

fn slanted(points: &[DVec2], o: DVec3, d: DVec3, reach: f64, found: &mut impl FnMut(f64, f64)) {
    let r: Vec<f64> = points.iter().map(|p| p.x).collect();
    let u: Vec<f64> = points.iter().map(|p| (p.y - o.y) / d.y).collect();
    // Only the parts of the curve at heights that the ray passes; there u has the size of the ball.
    let mut cuts = vec![0.0, 1.0];
    for bound in [-reach, reach] {
        cuts.extend(roots(&u.iter().map(|x| x - bound).collect::<Vec<_>>()));
    }
    cuts.sort_by(f64::total_cmp);
    for w in cuts.windows(2).filter(|w| w[1] > w[0]) {
        let middle = value(&u, 0.5 * (w[0] + w[1]));
        if middle.abs() > reach {
            continue;
        }
        let (r, u) = (restrict(&r, w[0], w[1]), restrict(&u, w[0], w[1]));
        let line = |a: f64, b: f64| u.iter().map(|u| a + u * b).collect::<Vec<f64>>();
        let (x, z) = (line(o.x, d.x), line(o.z, d.z));
        let g: Vec<f64> = square(&x)
            .iter()
            .zip(square(&z))
            .zip(square(&r))
            .map(|((x, z), r)| x + z - r)
            .collect();
        if o.x == 0.0 && o.z == 0.0 && d.x == 0.0 && d.z == 0.0 {
            // Along the axis g = -r^2: its roots are those of r, without a change of sign.
            for s in roots(&r) {
                found(w[0] + s * (w[1] - w[0]), value(&u, s));
            }
            continue;
        }
        for s in roots(&g) {
            found(w[0] + s * (w[1] - w[0]), value(&u, s));
        }
    }
}

/// Bernstein coefficients of the square, of twice the degree.
fn square(a: &[f64]) -> Vec<f64> {
    let n = a.len() - 1;
    (0..=2 * n)
        .map(|k| {
            let terms = k.saturating_sub(n)..=k.min(n);
            terms
                .map(|i| binomial(n, i) * binomial(n, k - i) / binomial(2 * n, k) * a[i] * a[k - i])
                .sum()
        })
        .collect()
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product()
}

fn split(c: &[f64], t: f64) -> (Vec<f64>, Vec<f64>) {
    let mut b = c.to_vec();
    let mut lower = Vec::with_capacity(b.len());
    for k in 1..=c.len() {
        lower.push(b[0]);
        for i in 0..c.len() - k {
            b[i] = b[i] * (1.0 - t) + b[i + 1] * t;
        }
    }
    (lower, b)
}

fn restrict(c: &[f64], a: f64, b: f64) -> Vec<f64> {
    let upper = split(c, a).1;
    if b >= 1.0 { upper } else { split(&upper, (b - a) / (1.0 - a)).0 }
}

fn value(c: &[f64], t: f64) -> f64 {
    split(c, t).1[0]
}

/// Roots in [0, 1] where the polynomial changes sign, and those at an end.
pub fn roots(c: &[f64]) -> Vec<f64> {
    let mut out = Vec::new();
    let size = c.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    if size > 0.0 {
        isolate(c, 0.0, 1.0, size * 1e-16, &mut out);
    }
    out
}

fn isolate(c: &[f64], a: f64, b: f64, noise: f64, out: &mut Vec<f64>) {
    let changes = c.windows(2).filter(|w| (w[0] < 0.0) != (w[1] < 0.0)).count();
    let last = c[c.len() - 1];
    if changes == 0 {
        // A root at the very end of the curve has no change of sign.
        if c[0] == 0.0 && a == 0.0 {
            out.push(a);
        }
        if last == 0.0 && b == 1.0 {
            out.push(b);
        }
        return;
    }
    if changes == 1 && (c[0] < 0.0) != (last < 0.0) {
        out.push(bisect(c, a, b));
        return;
    }
    // A cluster of roots closer than rounding: the ends decide.
    if b - a < 1e-15 || c.iter().all(|x| x.abs() < noise) {
        if (c[0] < 0.0) != (last < 0.0) {
            out.push(0.5 * (a + b));
        }
        return;
    }
    let middle = 0.5 * (a + b);
    let (lower, upper) = split(c, 0.5);
    isolate(&lower, a, middle, noise, out);
    isolate(&upper, middle, b, noise, out);
}

/// The one root of `c` on [a, b]: regula falsi (Illinois) and bisection in turn, on the
/// coefficients of that interval.
fn bisect(c: &[f64], a: f64, b: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    let (mut f_low, mut f_high) = (c[0], c[c.len() - 1]);
    let rising = f_low < 0.0;
    for i in 0..120 {
        let secant = low - f_low * (high - low) / (f_high - f_low);
        let t = if i % 3 == 2 || !(secant > low && secant < high) {
            0.5 * (low + high)
        } else {
            secant
        };
        if t <= low || t >= high || high - low < 1e-16 {
            break;
        }
        let f = value(c, t);
        if f == 0.0 {
            return a + t * (b - a);
        }
        if (f > 0.0) == rising {
            high = t;
            f_high = f;
            f_low *= 0.5;
        } else {
            low = t;
            f_low = f;
            f_high *= 0.5;
        }
    }
    a + 0.5 * (low + high) * (b - a)
}
