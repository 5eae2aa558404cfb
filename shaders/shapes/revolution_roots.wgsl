// Intersection of a ray with one patch of a surface of revolution. Twin:
// src/shapes/revolution_roots.rs, which explains the method.

const NEWTON_STEPS: u32 = 15u;
const NEWTON_HALVINGS: u32 = 10u;
const BRACKETED: u32 = 256u;
const MARCH_LIMIT: u32 = 256u;
const MARCH_LEAST: f32 = 1.0 / 8192.0;
const END_TOLERANCE: f32 = 3e-7;
const RESIDUAL_NOISE: f32 = 1e-6;

struct PatchHit {
    t: f32,
    theta: f32,
    tau: f32,
    steps: u32,
}

fn patch_miss() -> PatchHit {
    return PatchHit(FAR, 0.0, 0.0, 0u);
}

// Returns (dl, dtheta, dtau, D), or zero if D is negligible.
fn newton_step(direction: vec3f, f: vec3f, at: RingPoint) -> vec4f {
    let det = dot(direction, cross(at.d_theta, at.d_tau));
    if det * det <= (1e-8 * dot(at.d_theta, at.d_theta)) * dot(at.d_tau, at.d_tau) {
        return vec4f(0.0);
    }
    let g = cross(at.d_tau, f);
    let dl = -dot(at.d_theta, g) / det;
    let d_theta = -dot(direction, g) / det;
    let d_tau = dot(direction, cross(at.d_theta, f)) / det;
    return vec4f(dl, d_theta, d_tau, det);
}

fn newton(piece: Patch, ray: LocalRay, start: PatchHit) -> PatchHit {
    var x = start;
    var error_sq = FAR;
    var advance = vec4f(0.0);
    var part = 1.0;
    var halvings = 0u;
    for (var i = 0u; i < (NEWTON_STEPS + 1u) * (NEWTON_HALVINGS + 1u); i++) {
        let l = x.t + advance.x * part;
        let theta = x.theta + advance.y * part;
        let tau = x.tau + advance.z * part;
        let at = ring_point(piece, theta, tau);
        let f = (ray.origin + ray.direction * l) - at.point;
        let f_sq = dot(f, f);
        // accept the step if it reduces the residual; the curve is meaningless far outside the
        // patch
        if f_sq < error_sq && tau > -1.0 && tau < 2.0 {
            x = PatchHit(l, theta, tau, x.steps);
            error_sq = f_sq;
            advance = newton_step(ray.direction, f, at);
            if advance.w == 0.0 || x.steps == NEWTON_STEPS {
                break;
            }
            x.steps += 1u;
            let moved = (abs(advance.x) + abs(advance.y) * sqrt(dot(at.d_theta, at.d_theta)))
                + abs(advance.z) * sqrt(dot(at.d_tau, at.d_tau));
            if moved <= piece.step_tolerance {
                return PatchHit(x.t + advance.x, x.theta + advance.y, x.tau + advance.z, x.steps);
            }
            part = 1.0;
            halvings = 0u;
        } else {
            // otherwise halve the step, unless the residual is already down to rounding
            if error_sq <= RESIDUAL_NOISE * RESIDUAL_NOISE {
                return x;
            }
            halvings += 1u;
            if halvings > NEWTON_HALVINGS {
                break;
            }
            part *= 0.5;
        }
    }
    x.t = FAR;
    return x;
}

fn bracketed_root(piece: Patch, ray: LocalRay, a: RayPoint, b: RayPoint) -> PatchHit {
    var low = a.l;
    var high = b.l;
    var f_low = 0.0;
    var f_high = 0.0;
    var rising = false;
    var at = a;
    var tau = 0.0;
    for (var i = 0u; i < 64u; i++) {
        let offset = profile_offset(piece, at, true);
        let f = offset.x;
        tau = offset.z;
        if i == 0u {
            f_low = f;
            at = b;
            continue;
        }
        if i == 1u {
            f_high = f;
            rising = f >= 0.0;
        } else if (f >= 0.0) == rising {
            high = at.l;
            f_high = f;
            f_low *= 0.5;
        } else {
            low = at.l;
            f_low = f;
            f_high *= 0.5;
        }
        let secant = low - f_low * ((high - low) / (f_high - f_low));
        let bisect = i % 3u == 0u || !(secant > low && secant < high);
        let l = select(secant, 0.5 * (low + high), bisect);
        if l <= low || l >= high {
            break;
        }
        at = ray_point(piece, ray, l);
    }
    if at.s < -END_TOLERANCE || at.s > piece.length + END_TOLERANCE {
        return patch_miss();
    }
    let x = ray.origin.x + ray.direction.x * at.l;
    let z = ray.origin.z + ray.direction.z * at.l;
    return PatchHit(at.l, arctan2(z, x), tau, BRACKETED);
}

fn find_root(piece: Patch, ray: LocalRay, a: RayPoint, b: RayPoint, slack: f32) -> PatchHit {
    // initial guess: h = 0 is the cone over the chord; two Newton steps refine it
    let rise = b.h - a.h;
    var part = 0.5;
    if abs(rise) > 1e-12 {
        part = clamp(-a.h / rise, 0.0, 1.0);
    }
    var l = a.l + (b.l - a.l) * part;
    var at = ray_point(piece, ray, l);
    for (var i = 0u; i < 2u; i++) {
        if abs(at.dh) > 1e-12 {
            l = clamp(l - at.h / at.dh, a.l, b.l);
            at = ray_point(piece, ray, l);
        }
    }
    let reach = (max(piece.phi_max, -piece.phi_min) + abs(at.h)) * slack + END_TOLERANCE;
    if at.s < -reach || at.s > piece.length + reach {
        return patch_miss();
    }
    let x = ray.origin.x + ray.direction.x * l;
    let z = ray.origin.z + ray.direction.z * l;
    let tau = clamp(at.s / piece.length, 0.0, 1.0);
    // solve the 3x3 system; if that fails, solve F by bracketing
    var root = newton(piece, ray, PatchHit(l, arctan2(z, x), tau, 0u));
    let over = END_TOLERANCE / piece.length;
    if root.t >= a.l && root.t <= b.l && root.tau >= -over && root.tau <= 1.0 + over {
        root.tau = clamp(root.tau, 0.0, 1.0);
        return root;
    }
    var bracketed = bracketed_root(piece, ray, a, b);
    bracketed.steps |= root.steps;
    return bracketed;
}

fn slope_range(a: RayPoint, b: RayPoint, d_phi_low: f32, d_phi_high: f32) -> vec2f {
    let s_low = min(a.ds, b.ds);
    let s_high = max(a.ds, b.ds);
    let least =
        min(
            min(d_phi_low * s_low, d_phi_low * s_high), min(d_phi_high * s_low, d_phi_high * s_high)
        );
    let most = max(
        max(d_phi_low * s_low, d_phi_low * s_high), max(d_phi_high * s_low, d_phi_high * s_high)
    );
    return vec2f(min(a.dh, b.dh) - most, max(a.dh, b.dh) - least);
}

fn first_root(piece: Patch, ray: LocalRay, begin: f32, end: f32) -> PatchHit {
    if begin >= end {
        return patch_miss();
    }
    let least = (end - begin) * MARCH_LEAST;
    var width = end - begin;
    var l = begin;
    var a = ray_point(piece, ray, l);
    for (var i = 0u; i < MARCH_LIMIT; i++) {
        if l >= end {
            break;
        }
        let next = min(l + width, end);
        let b = ray_point(piece, ray, next);
        // a function whose slope lies in an interval deviates from its chord by at most a quarter
        // of that interval's width times the distance
        let quarter = 0.25 * (next - l);
        let bow_s = abs(b.ds - a.ds) * quarter + END_TOLERANCE;
        let bow_h = abs(b.dh - a.dh) * quarter;
        let s_low = min(a.s, b.s) - bow_s;
        let s_high = max(a.s, b.s) + bow_s;
        let past = max(max(-s_low, s_high - piece.length), 0.0) * piece.slope;
        let outside = s_low > piece.length
            || s_high < 0.0
            || min(a.h, b.h) - bow_h > piece.phi_max + past
            || max(a.h, b.h) + bow_h < piece.phi_min - past;
        if !outside {
            // bound F' by the slope limit of the patch; unless F' may change sign, the sign of F
            // suffices
            var range = slope_range(a, b, -piece.slope, piece.slope);
            let exact = range.x <= 0.0 && range.y >= 0.0;
            var f_a = vec3f(0.0);
            var f_b = vec3f(0.0);
            var at = a;
            for (var e = 0u; e < 2u; e++) {
                f_a = f_b;
                f_b = profile_offset(piece, at, exact);
                at = b;
            }
            // if s is monotone, its ends bound phi'
            if exact && (a.ds > 0.0) == (b.ds > 0.0) {
                range = slope_range(
                    a, b, min(f_a.y, f_b.y) - piece.wobble, max(f_a.y, f_b.y) + piece.wobble
                );
            }
            // halve the interval if it may contain more than one root
            let bow = (range.y - range.x) * quarter;
            let touches = !exact
                || (min(f_a.x, f_b.x) - bow <= 0.0 && max(f_a.x, f_b.x) + bow >= 0.0);
            if touches && range.x <= 0.0 && range.y >= 0.0 && width > least {
                width *= 0.5;
                continue;
            }
            // at most one root is left: find it if F changes sign
            let crosses = touches && ((f_a.x >= 0.0) != (f_b.x >= 0.0));
            if crosses {
                let most_ds = max(abs(a.ds), abs(b.ds));
                let steepness = max(range.x, -range.y) - piece.slope * most_ds;
                var slack = FAR;
                if steepness > 0.0 {
                    slack = 1.01 * most_ds / steepness;
                }
                let root = find_root(piece, ray, a, b, slack);
                if root.t < FAR {
                    return root;
                }
            }
        }
        l = next;
        a = b;
        width *= 2.0;
    }
    return patch_miss();
}
