// Profile of a surface of revolution, cut into patches, and rays in the profile's half-plane. Twin:
// src/shapes/revolution_profile.rs, which documents the fields. Reads `scene.profile_points`.

const MAX_DEGREE: u32 = 15u;

struct Patch {
    revolution: u32,
    segment: u32,
    first_point: u32,
    degree: u32,
    origin: vec2f,
    axis: vec2f,
    r_min: f32,
    r_max: f32,
    y_min: f32,
    y_max: f32,
    phi_min: f32,
    phi_max: f32,
    slope: f32,
    length: f32,
    t0: f32,
    t1: f32,
    wobble: f32,
    step_tolerance: f32,
}

struct LocalRay {
    origin: vec3f,
    start: f32,
    direction: vec3f,
    side: f32,
}

struct RayPoint {
    l: f32,
    s: f32,
    h: f32,
    ds: f32,
    dh: f32,
}

struct RingPoint {
    point: vec3f,
    d_theta: vec3f,
    d_tau: vec3f,
}

// First four control points of the current patch, cached because some devices read buffers slowly
// and a patch is evaluated often.
struct ControlPoints {
    b0: vec2f,
    b1: vec2f,
    b2: vec2f,
    b3: vec2f,
}

var<private> control_points: ControlPoints;

// Loads the cache; must be called before the functions below are called with another patch.
fn load_control_points(piece: Patch) {
    let first = piece.first_point;
    let last = first + piece.degree;
    control_points = ControlPoints(
        scene.profile_points[first],
        scene.profile_points[first + 1u],
        scene.profile_points[min(first + 2u, last)],
        scene.profile_points[min(first + 3u, last)],
    );
}

// Returns (s, h, ds/dtau, dh/dtau), by de Casteljau. The common degrees 1 to 3 avoid the array and
// the loop, which are expensive.
fn profile_point(piece: Patch, tau: f32) -> vec4f {
    let n = piece.degree;
    if n > 3u {
        return profile_point_high(piece, tau);
    }
    var b0 = control_points.b0;
    var b1 = control_points.b1;
    if n > 1u {
        var b2 = control_points.b2;
        if n > 2u {
            b0 += (b1 - b0) * tau;
            b1 += (b2 - b1) * tau;
            b2 += (control_points.b3 - b2) * tau;
        }
        b0 += (b1 - b0) * tau;
        b1 += (b2 - b1) * tau;
    }
    return profile_end(b0, b1, n, tau);
}

fn profile_point_high(piece: Patch, tau: f32) -> vec4f {
    let n = piece.degree;
    var b: array<vec2f, MAX_DEGREE + 1u>;
    for (var i = 0u; i <= n; i++) {
        b[i] = scene.profile_points[piece.first_point + i];
    }
    for (var k = 1u; k < n; k++) {
        for (var i = 0u; i <= n - k; i++) {
            b[i] += (b[i + 1u] - b[i]) * tau;
        }
    }
    return profile_end(b[0], b[1], n, tau);
}

// Last de Casteljau step, between the last two points.
fn profile_end(b0: vec2f, b1: vec2f, n: u32, tau: f32) -> vec4f {
    let leg = b1 - b0;
    let point = b0 + leg * tau;
    let tangent = leg * f32(n);
    return vec4f(point.x, point.y, tangent.x, tangent.y);
}

fn ray_point(piece: Patch, ray: LocalRay, l: f32) -> RayPoint {
    let o = ray.origin;
    let d = ray.direction;
    let x = o.x + d.x * l;
    let z = o.z + d.z * l;
    let radius = sqrt(x * x + z * z);
    // the radius has a kink on the axis: use the one-sided slope there
    var outward = ray.side * sqrt(d.x * d.x + d.z * d.z);
    if radius > 0.0 {
        outward = (x * d.x + z * d.z) / radius;
    }
    let d_radius = select(0.0, outward, outward * ray.side > 0.0);
    let r = radius - piece.origin.x;
    let y = (o.y + d.y * l) - piece.origin.y;
    return RayPoint(
        l,
        kept(piece.axis.x * r + piece.axis.y * y),
        kept(piece.axis.y * r - piece.axis.x * y),
        kept(piece.axis.x * d_radius + piece.axis.y * d.y),
        kept(piece.axis.y * d_radius - piece.axis.x * d.y),
    );
}

fn tau_at(piece: Patch, s: f32) -> f32 {
    var low = 0.0;
    var high = 1.0;
    var tau = clamp(s / piece.length, 0.0, 1.0);
    for (var i = 0u; i < 20u; i++) {
        let p = profile_point(piece, tau);
        let error = p.x - s;
        if error > 0.0 {
            high = tau;
        } else {
            low = tau;
        }
        var advance = 2.0;
        if p.z > 0.0 {
            advance = error / p.z;
        }
        var next = tau - advance;
        if next < low || next > high {
            next = 0.5 * (low + high);
        }
        let moved = abs(next - tau);
        tau = next;
        if moved <= 1e-7 {
            break;
        }
    }
    return tau;
}

// Returns (F, phi'(s), tau).
fn profile_offset(piece: Patch, at: RayPoint, exact: bool) -> vec3f {
    let past = max(max(-at.s, at.s - piece.length), 0.0) * piece.slope;
    if !exact && at.h > piece.phi_max + past {
        return vec3f(1.0, 0.0, 0.0);
    }
    if !exact && at.h < piece.phi_min - past {
        return vec3f(-1.0, 0.0, 0.0);
    }
    let s = clamp(at.s, 0.0, piece.length);
    let tau = tau_at(piece, s);
    let p = profile_point(piece, tau);
    var slope = 0.0;
    if p.z > 0.0 {
        slope = p.w / p.z;
    }
    let d_phi = clamp(slope, -piece.slope, piece.slope);
    return vec3f(at.h - (p.y + d_phi * (at.s - s)), d_phi, tau);
}

fn ring_point(piece: Patch, theta: f32, tau: f32) -> RingPoint {
    let p = profile_point(piece, tau);
    let sc = sin_cos(theta);
    let sin = sc.x;
    let cos = sc.y;
    // one addition at a time: Mesa rewrites e + (a b + c d)
    let r = (piece.origin.x + piece.axis.x * p.x) + piece.axis.y * p.y;
    let y = (piece.origin.y + piece.axis.y * p.x) - piece.axis.x * p.y;
    let dr = piece.axis.x * p.z + piece.axis.y * p.w;
    let dy = piece.axis.y * p.z - piece.axis.x * p.w;
    return RingPoint(
        vec3f(r * cos, y, r * sin),
        vec3f(-r * sin, 0.0, r * cos),
        vec3f(dr * cos, dy, dr * sin),
    );
}
