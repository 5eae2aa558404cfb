// Traces one ray per thread: the nearest hit, and whether there is any. Triangles only.

const NONE: u32 = 0xffffffffu;

struct World {
    bounds_min: vec3f,
    ray_count: u32,
    bounds_max: vec3f,
    primitive_size: f32,
}

struct Scene {
    world: World,
}

@group(0) @binding(0) var<storage, read> scene: Scene;
@group(0) @binding(1) var<storage, read> nodes: array<vec2u>;
@group(0) @binding(2) var<storage, read> refs: array<u32>;
@group(0) @binding(3) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(4) var<storage, read> rays: array<Ray>;
@group(0) @binding(5) var<storage, read_write> hits: array<Hit>;
@group(0) @binding(6) var<storage, read_write> shadows: array<u32>;

fn intersect_leaf(first: u32, last: u32, ray: Ray, any_hit: bool, hit: ptr<function, Hit>) {
    for (var i = first; i < last; i++) {
        intersect_triangle(triangles[refs[i]], refs[i], ray, hit);
        if any_hit && (*hit).reference != NONE {
            return;
        }
    }
}

@compute @workgroup_size(64)
fn trace(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= scene.world.ray_count {
        return;
    }
    let ray = rays[id.x];
    var hit = Hit(ray.t_max, NONE, 0.0, 0.0, NONE);
    traverse_closest(ray, &hit);
    hits[id.x] = hit;
    var shadow = Hit(ray.t_max, NONE, 0.0, 0.0, NONE);
    shadows[id.x] = select(0u, 1u, traverse_any(ray, &shadow));
}
