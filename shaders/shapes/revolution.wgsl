// Bezier surfaces of revolution: local frame, ray intersection and surface data. Twin:
// src/shapes/revolution.rs, which documents the fields. Needs math/vector.wgsl, math/trig.wgsl,
// revolution_profile.wgsl, revolution_roots.wgsl.

const REVOLUTION_ERROR: f32 = 9.6e-7;

struct Revolution {
    x_axis: vec3f,
    scale: f32,
    y_axis: vec3f,
    inv_scale: f32,
    z_axis: vec3f,
    segments: u32,
    center: vec3f,
    material: u32,
    light: u32,
    uv: u32,
    padding: vec2u,
}

struct RevolutionSurface {
    position: vec3f,
    error: f32,
    normal: vec3f,
    uv: vec2f,
}

fn leading_bits(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) & 0xfffff000u);
}

fn local_ray(revolution: Revolution, origin: vec3f, direction: vec3f) -> LocalRay {
    let high = vec3f(
        leading_bits(direction.x), leading_bits(direction.y), leading_bits(direction.z)
    );
    let low = direction - high;
    let far = leading_bits(dot(revolution.center - origin, direction));
    let p = ((origin + high * far) - revolution.center) + low * far;
    let near = -dot(p, direction);
    let q = (p + direction * near) * revolution.inv_scale;
    let local_origin = vec3f(
        dot(revolution.x_axis, q), dot(revolution.y_axis, q), dot(revolution.z_axis, q)
    );
    let local_direction = vec3f(
        dot(revolution.x_axis, direction),
        dot(revolution.y_axis, direction),
        dot(revolution.z_axis, direction),
    );
    return LocalRay(local_origin, far + near, local_direction, -1.0);
}

fn intersect_patch(
    revolution: Revolution,
    piece: Patch,
    origin: vec3f,
    direction: vec3f,
    t_min: f32,
    t_max: f32,
) -> PatchHit {
    load_control_points(piece);
    var ray = local_ray(revolution, origin, direction);
    let o = ray.origin;
    let d = ray.direction;
    var begin = (t_min - ray.start) * revolution.inv_scale;
    var end = (t_max - ray.start) * revolution.inv_scale;
    // clip the interval to the slab of the ring's heights
    if abs(d.y) > 1e-30 {
        let l0 = (piece.y_min - o.y) / d.y;
        let l1 = (piece.y_max - o.y) / d.y;
        begin = max(begin, min(l0, l1));
        end = min(end, max(l0, l1));
    } else if o.y < piece.y_min || o.y > piece.y_max {
        return patch_miss();
    }
    // clip to the outer cylinder and cut out the inner one, which contains no surface
    let a = max(d.x * d.x + d.z * d.z, 1e-20);
    let l_axis = -(o.x * d.x + o.z * d.z) / a;
    let x = o.x + d.x * l_axis;
    let z = o.z + d.z * l_axis;
    let axis_sq = x * x + z * z;
    let outer_sq = piece.r_max * piece.r_max - axis_sq;
    if outer_sq < 0.0 {
        return patch_miss();
    }
    let outer = sqrt(outer_sq / a);
    let inner = sqrt(max(piece.r_min * piece.r_min - axis_sq, 0.0) / a);
    begin = max(begin, l_axis - outer);
    end = min(end, l_axis + outer);
    // search the part before the closest approach to the axis, then the part after it
    var hit = patch_miss();
    for (var i = 0u; i < 2u; i++) {
        ray.side = select(1.0, -1.0, i == 0u);
        let first = select(max(begin, l_axis + inner), begin, i == 0u);
        let last = select(end, min(end, l_axis - inner), i == 0u);
        hit = first_root(piece, ray, first, last);
        if hit.t < FAR {
            break;
        }
    }
    if hit.t < FAR {
        let t = ray.start + hit.t * revolution.scale;
        hit.t = select(FAR, max(t, t_min), t < t_max);
    }
    return hit;
}

fn revolution_surface(
    revolution: Revolution,
    piece: Patch,
    theta: f32,
    tau: f32,
) -> RevolutionSurface {
    load_control_points(piece);
    var at = ring_point(piece, theta, tau);
    let p = at.point * revolution.scale;
    // the tangent alone gives the normal, even on the axis; at a cusp, use the tangent next to it
    if dot(at.d_tau, at.d_tau) <= 1e-8 * piece.length * piece.length {
        at = ring_point(piece, theta, tau + (0.5 - tau) * 0.001);
    }
    let sc = sin_cos(theta);
    let sin = sc.x;
    let cos = sc.y;
    let dr = at.d_tau.x * cos + at.d_tau.z * sin;
    let dy = at.d_tau.y;
    let n = unit(vec3f(dy * cos, -dr, dy * sin));
    let position =
        ((revolution.center + revolution.x_axis * p.x) + revolution.y_axis * p.y)
            + revolution.z_axis * p.z;
    let normal = (revolution.x_axis * n.x + revolution.y_axis * n.y) + revolution.z_axis * n.z;
    let c = revolution.center;
    let size = revolution.scale + max(max(abs(c.x), abs(c.y)), abs(c.z));
    let u = 0.5 - theta / TAU;
    let t = piece.t0 + (piece.t1 - piece.t0) * tau;
    return RevolutionSurface(
        position,
        REVOLUTION_ERROR * size,
        normal,
        vec2f(u - floor(u), (f32(piece.segment) + t) / f32(revolution.segments)),
    );
}
