// Outlines of flat shapes, and clipping of gather discs against them. Twin: src/shapes/outline.rs,
// which documents the fields and functions.

const SHARE_MIN: f32 = 1e-6;
const DEPTH: f32 = 0.02;
const SLIM: f32 = 30.0;
const MARGIN: f32 = 0.25;
const PLANE_ERROR: f32 = 16.0 * EPS;
const RIM: f32 = 1e-5;
const CUTS: u32 = 4u;
const WALL_BITS: u32 = 6u;
const CORNERS: u32 = 12u;

struct Outline {
    origin: vec3f,
    radius: f32,
    u: vec3f,
    error: f32,
    v: vec3f,
    walls: u32,
    dual_u: vec3f,
    margin_s: f32,
    dual_v: vec3f,
    margin_t: f32,
}

struct Clip {
    crossed: bool,
    whole: f32,
    inner: f32,
    depth: f32,
    cuts: array<vec4f, CUTS>,
    count: u32,
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

fn outline_share(outline: Outline, position: vec3f, normal: vec3f, radius: f32) -> f32 {
    let scale = 1.0 / radius;
    let d = (outline.origin - position) * scale;
    var area: f32;
    if outline.radius > 0.0 {
        area = discs_area(sqrt(dot(d, d)), outline.radius * scale);
    } else {
        let first = unit(outline.u);
        let second = cross(normal, first);
        let corner = vec2f(dot(d, first), dot(d, second));
        let v = vec2f(dot(outline.v, first), dot(outline.v, second)) * scale;
        area = parallelogram_area(corner, dot(outline.u, first) * scale, v);
    }
    return clamp(area / PI, SHARE_MIN, 1.0);
}

fn cut_polygon(
    polygon: ptr<function,
    array<vec2f,
    CORNERS>>,
    count: u32,
    normal: vec2f,
    distance: f32,
) -> u32 {
    let old = *polygon;
    var kept = 0u;
    var a = old[max(count, 1u) - 1u];
    var da = dot(a, normal) - distance;
    for (var i = 0u; i < count; i++) {
        let b = old[i];
        let db = dot(b, normal) - distance;
        if (da < 0.0) != (db < 0.0) && kept < CORNERS {
            (*polygon)[kept] = a + (b - a) * (da / (da - db));
            kept += 1u;
        }
        if db < 0.0 && kept < CORNERS {
            (*polygon)[kept] = b;
            kept += 1u;
        }
        a = b;
        da = db;
    }
    return kept;
}

fn cut_share(outline: Outline, clip: Clip, position: vec3f, normal: vec3f, radius: f32) -> f32 {
    let first = unit(outline.u);
    let second = cross(normal, first);
    let d = position - outline.origin;
    let scale = 1.0 / radius;
    var cuts = clip.cuts;
    // start from a square about the unit disc, so that all corners have its scale
    var polygon: array<vec2f, CORNERS>;
    polygon[0] = vec2f(-2.0, -2.0);
    polygon[1] = vec2f(2.0, -2.0);
    polygon[2] = vec2f(2.0, 2.0);
    polygon[3] = vec2f(-2.0, 2.0);
    var count = 4u;
    // clip the square by the four edges of the parallelogram, then by the walls
    for (var k = 0u; k < 4u + clip.count; k++) {
        var toward = outline.dual_u;
        var distance = 0.0;
        if k >= 4u {
            let cut = cuts[k - 4u];
            toward = cut.xyz;
            distance = cut.w;
        } else {
            if k >= 2u {
                toward = outline.dual_v;
            }
            let place = dot(d, toward);
            let inverse = 1.0 / sqrt(dot(toward, toward));
            distance = select(1.0 - place, place, k % 2u == 0u) * inverse;
            toward = toward * select(inverse, -inverse, k % 2u == 0u);
        }
        distance *= scale;
        if distance < 1.0 {
            let across = vec2f(dot(toward, first), dot(toward, second));
            count = cut_polygon(&polygon, count, across, distance);
        }
    }
    // add up the area of the unit disc inside the polygon, edge by edge
    var area = 0.0;
    var a = polygon[max(count, 1u) - 1u];
    for (var i = 0u; i < count; i++) {
        let b = polygon[i];
        let edge = b - a;
        let length = sqrt(dot(edge, edge));
        if length > 0.0 {
            let along = edge * (1.0 / length);
            let start = dot(a, along);
            area += wedge(cross_2d(a, along), start, start + length);
        }
        a = b;
    }
    return clamp(abs(area) / PI, SHARE_MIN, 1.0);
}

fn find_cuts(
    outline: Outline,
    position: vec3f,
    normal: vec3f,
    clip: ptr<function,
    Clip>,
    radius: f32,
) {
    let first = outline.walls >> WALL_BITS;
    let last = first + (outline.walls & ((1u << WALL_BITS) - 1u));
    for (var i = first; i < last; i++) {
        let wall = outlines[i];
        let d = wall.origin - position;
        let rise = dot(d, wall.v);
        // walls on the other side, or on the opposite face of a box, do not count
        if (dot(wall.v, normal) > 0.5 || wall.radius > 0.0) && abs(rise) <= (*clip).depth {
            let place = clamp(-dot(d, wall.u) / dot(wall.u, wall.u), 0.0, 1.0);
            let nearest = d + wall.u * place;
            if dot(nearest, nearest) < radius * radius && (*clip).count < CUTS {
                let across = unit(cross(wall.v, wall.u));
                let distance = dot(d, across);
                let toward = across * select(1.0, -1.0, distance < 0.0);
                (*clip).cuts[(*clip).count] = vec4f(toward, abs(distance) - MARGIN * outline.error);
                (*clip).count += 1u;
            }
        }
    }
}

fn before_walls(clip: ptr<function, Clip>, center: vec3f, position: vec3f) -> bool {
    let d = position - center;
    let a = (*clip).cuts[0];
    let b = (*clip).cuts[1];
    let c = (*clip).cuts[2];
    let e = (*clip).cuts[3];
    return dot(d, a.xyz) < a.w && dot(d, b.xyz) < b.w && dot(d, c.xyz) < c.w && dot(d, e.xyz) < e.w;
}

fn clip_at(number: u32, position: vec3f, normal: vec3f, radius: f32) -> Clip {
    let open = vec4f(0.0, 0.0, 0.0, 1.0);
    var clip = Clip(false, 1.0, 1.0, radius, array<vec4f, CUTS>(open, open, open, open), 0u);
    if number == NONE {
        return clip;
    }
    let outline = outlines[number];
    let d = position - outline.origin;
    //#if disc
    let round = outline.radius > 0.0;
    //#else
    let round = false;
    //#end
    // does the outline cross the disc?
    if round {
        let within = outline.radius - radius;
        clip.crossed = within <= 0.0 || dot(d, d) > within * within;
    } else {
        let s = dot(d, outline.dual_u);
        let t = dot(d, outline.dual_v);
        let margin_s = max(min(s, 1.0 - s), 0.0);
        let margin_t = max(min(t, 1.0 - t), 0.0);
        let radius_sq = radius * radius;
        clip.crossed = margin_s * margin_s < radius_sq * dot(outline.dual_u, outline.dual_u)
            || margin_t * margin_t < radius_sq * dot(outline.dual_v, outline.dual_v);
    }
    clip.depth = DEPTH * radius + 2.0 * (outline.error + PLANE_ERROR * max_abs(position));
    // share of the disc inside the outline and before the walls
    find_cuts(outline, position, normal, &clip, radius);
    if clip.count > 0u {
        clip.crossed = true;
        for (var k = 0u; k < 2u; k++) {
            let share = cut_share(
                outline, clip, position, normal, select(radius, 0.70710677 * radius, k == 1u)
            );
            clip.whole = select(clip.whole, 1.0 / share, k == 0u);
            clip.inner = select(clip.inner, 1.0 / share, k == 1u);
        }
        return clip;
    }
    if clip.crossed {
        // in a loop, so that the function is inlined only once
        for (var k = 0u; k < 2u; k++) {
            let share = outline_share(
                outline, position, normal, select(radius, 0.70710677 * radius, k == 1u)
            );
            clip.whole = select(clip.whole, 1.0 / share, k == 0u);
            clip.inner = select(clip.inner, 1.0 / share, k == 1u);
        }
    }
    return clip;
}

fn in_outline(outline: Outline, position: vec3f) -> bool {
    let d = position - outline.origin;
    //#if disc
    if outline.radius > 0.0 {
        return dot(d, d) < outline.radius * outline.radius * (1.0 - RIM);
    }
    //#end
    let s = dot(d, outline.dual_u);
    let t = dot(d, outline.dual_v);
    let low_s = outline.margin_s;
    let low_t = outline.margin_t;
    return s > low_s && s < 1.0 - low_s && t > low_t && t < 1.0 - low_t;
}
