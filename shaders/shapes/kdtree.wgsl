// Ray traversal of the kd-tree. Twin: src/shapes/kdtree.rs, which explains the method. Reads
// `nodes: array<vec2u>` and `scene.world.bounds_min`, `bounds_max`, `primitive_size`; calls
// `intersect_leaf(first, last, ray, any_hit, hit)` for the references of a leaf.

const MAX_DEPTH: u32 = 32u;
const SLACK: f32 = 3.8146973e-6;
const LEVEL: f32 = 1e-20;
const NOTHING: u32 = 1u;

struct Waiting {
    node: u32,
    begin: f32,
    end: f32,
}

fn children(word1: u32) -> u32 {
    return (word1 >> 3u) & ~1u;
}

fn is_empty(word1: u32, child: u32) -> bool {
    return ((word1 >> (2u + child)) & 1u) != 0u;
}

fn reciprocal(d: f32) -> f32 {
    return 1.0 / select(d, LEVEL, abs(d) < LEVEL);
}

fn traverse_closest(ray: Ray, hit: ptr<function, Hit>) {
    traverse(ray, false, hit);
}

fn traverse_any(ray: Ray, hit: ptr<function, Hit>) -> bool {
    traverse(ray, true, hit);
    return (*hit).reference != NONE;
}

fn traverse(ray: Ray, any_hit: bool, hit: ptr<function, Hit>) {
    //#if triangle
    ray_shear = shear_of(ray);
    //#end
    // clip the ray to the tree's box, widened by the slab at its far end
    let inverse = vec3f(
        reciprocal(ray.direction.x), reciprocal(ray.direction.y), reciprocal(ray.direction.z)
    );
    let to_min = scene.world.bounds_min - ray.origin;
    let to_max = scene.world.bounds_max - ray.origin;
    let reach = max(abs(to_min), abs(to_max));
    let slack = SLACK * abs(inverse);
    let margin = slack * max(max(reach.x, reach.y), reach.z);
    let t0 = to_min * inverse;
    let t1 = to_max * inverse;
    let enter = min(t0, t1) - margin;
    let leave = max(t0, t1) + margin;
    let root_begin = max(max(max(ray.t_min, enter.x), enter.y), enter.z);
    let root_end = min(min(min((*hit).t, leave.x), leave.y), leave.z);
    if root_begin > root_end {
        return;
    }

    let backward = select(vec3u(0u), vec3u(1u), inverse < vec3f(0.0));

    var stack: array<Waiting, MAX_DEPTH>;
    var waiting = 0u;
    var index = 0u;
    var begin = root_begin;
    var end = root_end;
    loop {
        // descend to a leaf: near child first, the far one deferred if the ray enters it too
        var node = nodes[index];
        while (node.y & 3u) != 3u {
            let axis = node.y & 3u;
            let near = children(node.y) | backward[axis];
            let far = near ^ 1u;
            let t = (bitcast<f32>(node.x) - ray.origin[axis]) * inverse[axis];
            let margin = slack[axis] * (max(end, -begin) + scene.world.primitive_size);
            let t_first = t - margin;
            let t_last = t + margin;
            let enter_near = (t_last >= begin) & !is_empty(node.y, backward[axis]);
            let enter_far = (t_first <= end) & !is_empty(node.y, backward[axis] ^ 1u);
            if enter_near {
                if enter_far {
                    stack[waiting] = Waiting(far, max(begin, t_first), end);
                    waiting++;
                }
                index = near;
                end = min(end, t_last);
            } else if enter_far {
                index = far;
                begin = max(begin, t_first);
            } else {
                index = NOTHING;
            }
            node = nodes[index];
        }

        let last = node.x + (node.y >> 2u);
        intersect_leaf(node.x, last, ray, any_hit, hit);
        if any_hit && (*hit).reference != NONE {
            return;
        }

        // resume at the nearest deferred child that starts before the hit
        loop {
            if waiting == 0u {
                return;
            }
            waiting--;
            index = stack[waiting].node;
            begin = stack[waiting].begin;
            end = stack[waiting].end;
            if begin <= (*hit).t {
                end = min(end, (*hit).t);
                break;
            }
        }
    }
}
