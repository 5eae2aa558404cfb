// Triangles: watertight ray-triangle test of Woop, Benthin & Wald (JCGT 2013). Twin:
// src/shapes/triangle.rs, which explains the method.

struct Triangle {
    p0: vec3f,
    material: u32,
    p1: vec3f,
    light: u32,
    p2: vec3f,
    attributes: u32,
}

struct RayShear {
    shear: vec3f,
    axis: u32,
}

// Shear of the current ray, set at the start of each tree walk.
var<private> ray_shear: RayShear;

fn shear_of(ray: Ray) -> RayShear {
    let a = abs(ray.direction);
    let axis = select(select(2u, 1u, a.y >= a.z), 0u, a.x >= a.y && a.x >= a.z);
    let d = permuted(ray.direction, axis);
    return RayShear(vec3f(d.x / d.z, d.y / d.z, 1.0 / d.z), axis);
}

fn permuted(v: vec3f, axis: u32) -> vec3f {
    return select(select(v, v.zxy, axis == 1u), v.yzx, axis == 0u);
}

fn sheared(p: vec3f, ray: Ray) -> vec3f {
    let q = permuted(p - ray.origin, ray_shear.axis);
    return vec3f(
        q.x - ray_shear.shear.x * q.z, q.y - ray_shear.shear.y * q.z, ray_shear.shear.z * q.z
    );
}

// Returns p unchanged. The compiler cannot know that, so it cannot fuse the product that gave `p`
// with a later sum.
fn rounded(p: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(p) | (ray_shear.axis >> 2u));
}

// Returns p - q for two products. If a compiler fuses one of them into the difference, the sign
// stays correct: a fused difference can only be wrong where the rounded products are equal, and
// there the result is 0.
fn edge(p: f32, q: f32) -> f32 {
    return select(p - q, 0.0, p == q);
}

fn product_error(a: f32, b: f32, p: f32) -> f32 {
    let a_high = bitcast<f32>(bitcast<u32>(a) & 0xfffff000u);
    let b_high = bitcast<f32>(bitcast<u32>(b) & 0xfffff000u);
    let a_low = a - a_high;
    let b_low = b - b_high;
    return ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low;
}

fn exact_cross(a: f32, b: f32, c: f32, d: f32) -> f32 {
    let p = rounded(a * d);
    let q = rounded(b * c);
    return (p - q) + (product_error(a, d, p) - product_error(b, c, q));
}

fn intersect_triangle(triangle: Triangle, reference: u32, ray: Ray, hit: ptr<function, Hit>) {
    // shear the vertices into the ray's space
    let a = sheared(triangle.p0, ray);
    let b = sheared(triangle.p1, ray);
    let c = sheared(triangle.p2, ray);
    // edge functions; the ray misses if their signs differ
    let cb0 = c.x * b.y;
    let cb1 = c.y * b.x;
    let ac0 = a.x * c.y;
    let ac1 = a.y * c.x;
    let ba0 = b.x * a.y;
    let ba1 = b.y * a.x;
    var u = edge(cb0, cb1);
    var v = edge(ac0, ac1);
    var w = edge(ba0, ba1);
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return;
    }
    var det = u + v + w;
    // thin in projection: recompute the edge functions with the rounding errors of their products
    let products = max(
        max(max(max(max(abs(cb0), abs(cb1)), abs(ac0)), abs(ac1)), abs(ba0)), abs(ba1)
    );
    if abs(det) < 0.5 * products {
        u = exact_cross(c.x, c.y, b.x, b.y);
        v = exact_cross(a.x, a.y, c.x, c.y);
        w = exact_cross(b.x, b.y, a.x, a.y);
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return;
        }
        det = u + v + w;
    }
    if det == 0.0 {
        return;
    }
    let t = (u * a.z + v * b.z + w * c.z) / det;
    if t > ray.t_min && t < (*hit).t {
        *hit = Hit(t, reference, abs(v / det), abs(w / det), NONE);
    }
}

fn triangle_normal(triangle: Triangle) -> vec3f {
    let n = cross(triangle.p1 - triangle.p0, triangle.p2 - triangle.p0);
    let size = max(max(abs(n).x, abs(n).y), abs(n).z);
    let m = select(vec3f(0.0, 0.0, 1.0), n / select(1.0, size, size > 0.0), size > 0.0);
    return m * (1.0 / sqrt(dot(m, m)));
}

fn triangle_point(triangle: Triangle, u: f32, v: f32) -> vec3f {
    return triangle.p0 + (triangle.p1 - triangle.p0) * u + (triangle.p2 - triangle.p0) * v;
}

fn triangle_error(triangle: Triangle) -> f32 {
    let m = max(max(abs(triangle.p0), abs(triangle.p1)), abs(triangle.p2));
    return 9.536743e-7 * max(max(m.x, m.y), m.z);
}
