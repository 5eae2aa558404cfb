// Facets, flat outlines: twin of src/shapes/facet.rs, where each field is explained.

const SHARE_MIN: f32 = 1e-6;
const DEPTH: f32 = 0.02;
const SLIM: f32 = 30.0;

struct Facet {
    origin: vec3f,
    radius: f32,
    u: vec3f,
    error: f32,
    v: vec3f,
    pad0: u32,
    dual_u: vec3f,
    pad1: u32,
    dual_v: vec3f,
    pad2: u32,
}

struct Clip {
    crossed: bool,
    whole: f32,
    inner: f32,
    depth: f32,
}

fn turn(distance: f32, start: f32, end: f32) -> f32 {
    return arctan2(distance * (kept(end) - start), distance * distance + start * end);
}

fn wedge(distance: f32, start: f32, end: f32) -> f32 {
    let half_sq = 1.0 - distance * distance;
    let half = sqrt(max(half_sq, 0.0));
    let enter = max(start, -half);
    let leave = min(end, half);
    if half_sq <= 0.0 || enter >= leave {
        return 0.5 * turn(distance, start, end);
    }
    let outside = turn(distance, start, enter) + turn(distance, leave, end);
    return 0.5 * (outside + distance * (leave - enter));
}

fn cross_2d(a: vec2f, b: vec2f) -> f32 {
    return a.x * b.y - a.y * b.x;
}

fn parallelogram_area(corner: vec2f, width: f32, v: vec2f) -> f32 {
    let length = sqrt(dot(v, v));
    let along = v * (1.0 / length);
    let far = corner + v;
    let side = vec2f(corner.x + width, corner.y);
    let left_start = dot(corner, along);
    let right_start = dot(side, along);
    let front = wedge(-corner.y, corner.x, side.x);
    let right = wedge(cross_2d(side, along), right_start, right_start + length);
    let back = wedge(-far.y, far.x, far.x + width);
    let left = wedge(cross_2d(corner, along), left_start, left_start + length);
    return abs((front - back) + (right - left));
}

fn discs_area(distance: f32, radius: f32) -> f32 {
    if distance + 1.0 <= radius {
        return PI;
    }
    if distance + radius <= 1.0 {
        return PI * radius * radius;
    }
    let x = 0.5 * ((distance - radius) * (distance + radius) + 1.0) / distance;
    let y = sqrt(max(1.0 - x * x, 0.0));
    let near = arctan2(y, x) - x * y;
    if radius < SLIM {
        let rest = distance - x;
        return near + (kept(radius * radius * arctan2(y, rest)) - rest * y);
    }
    return near + 0.6666667 * (y * y) * (y / radius);
}

fn facet_share(facet: Facet, position: vec3f, normal: vec3f, radius: f32) -> f32 {
    let scale = 1.0 / radius;
    let d = (facet.origin - position) * scale;
    var area: f32;
    if facet.radius > 0.0 {
        area = discs_area(sqrt(dot(d, d)), facet.radius * scale);
    } else {
        let first = unit(facet.u);
        let second = cross(normal, first);
        let corner = vec2f(dot(d, first), dot(d, second));
        let v = vec2f(dot(facet.v, first), dot(facet.v, second)) * scale;
        area = parallelogram_area(corner, dot(facet.u, first) * scale, v);
    }
    return clamp(area / PI, SHARE_MIN, 1.0);
}

fn clip_at(number: u32, position: vec3f, normal: vec3f, radius: f32) -> Clip {
    var clip = Clip(false, 1.0, 1.0, 0.0);
    if number == NONE {
        return clip;
    }
    let facet = facets[number];
    let d = position - facet.origin;
    //#if disc
    let round = facet.radius > 0.0;
    //#else
    let round = false;
    //#end
    if round {
        let within = facet.radius - radius;
        clip.crossed = within <= 0.0 || dot(d, d) > within * within;
    } else {
        let s = dot(d, facet.dual_u);
        let t = dot(d, facet.dual_v);
        let margin_s = max(min(s, 1.0 - s), 0.0);
        let margin_t = max(min(t, 1.0 - t), 0.0);
        let radius_sq = radius * radius;
        clip.crossed = margin_s * margin_s < radius_sq * dot(facet.dual_u, facet.dual_u)
            || margin_t * margin_t < radius_sq * dot(facet.dual_v, facet.dual_v);
    }
    if clip.crossed {
        // a loop, so that the function is there once
        for (var k = 0u; k < 2u; k++) {
            let share = facet_share(facet, position, normal, select(radius, 0.70710677 * radius, k == 1u));
            clip.whole = select(clip.whole, 1.0 / share, k == 0u);
            clip.inner = select(clip.inner, 1.0 / share, k == 1u);
        }
        clip.depth = DEPTH * radius + 2.0 * facet.error;
    }
    return clip;
}

fn on_facet(facet: Facet, position: vec3f) -> bool {
    let d = position - facet.origin;
    //#if disc
    if facet.radius > 0.0 {
        return dot(d, d) < facet.radius * facet.radius;
    }
    //#end
    let s = dot(d, facet.dual_u);
    let t = dot(d, facet.dual_v);
    return s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0;
}
