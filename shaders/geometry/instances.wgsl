// Instances: intersection with the kd-tree of the group that an instance places, and the surface
// there. Twin: src/geometry/instances.rs. The traversal is that of shapes/kdtree.wgsl within the
// nodes of a group, since WGSL has no recursion.

// References are ordered by kind, as in `intersect_leaf`.
fn intersect_members(first: u32, last: u32, ray: Ray, any_hit: bool, hit: ptr<function, Hit>) {
    var i = first;
    //#if triangle
    while names(KIND_TRIANGLE, i, last) {
        intersect_triangle(triangles[index_of(refs[i])], refs[i], ray, hit);
        if any_hit && (*hit).reference != NONE {
            return;
        }
        i++;
    }
    //#end
    //#if sphere
    while names(KIND_SPHERE, i, last) {
        intersect_sphere(scene.spheres[index_of(refs[i])], refs[i], ray, hit);
        if any_hit && (*hit).reference != NONE {
            return;
        }
        i++;
    }
    //#end
    //#if rectangle
    while names(KIND_RECTANGLE, i, last) {
        intersect_rectangle(scene.rectangles[index_of(refs[i])], refs[i], ray, hit);
        if any_hit && (*hit).reference != NONE {
            return;
        }
        i++;
    }
    //#end
    //#if disc
    while names(KIND_DISC, i, last) {
        intersect_disc(scene.discs[index_of(refs[i])], refs[i], ray, hit);
        if any_hit && (*hit).reference != NONE {
            return;
        }
        i++;
    }
    //#end
    //#if cuboid
    while names(KIND_CUBOID, i, last) {
        intersect_cuboid(scene.cuboids[index_of(refs[i])], refs[i], ray, hit);
        if any_hit && (*hit).reference != NONE {
            return;
        }
        i++;
    }
    //#end
    //#if revolution
    while names(KIND_REVOLUTION, i, last) {
        intersect_revolution(refs[i], ray, hit);
        if any_hit && (*hit).reference != NONE {
            return;
        }
        i++;
    }
    //#end
}

fn traverse_group(ray: Ray, any_hit: bool, group: Group, hit: ptr<function, Hit>) {
    // clip the ray to the tree's box, widened by the slab at its far end
    let inverse = vec3f(
        reciprocal(ray.direction.x), reciprocal(ray.direction.y), reciprocal(ray.direction.z)
    );
    let to_min = group.bounds_min - ray.origin;
    let to_max = group.bounds_max - ray.origin;
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
        var node = nodes[group.root + index];
        while (node.y & 3u) != 3u {
            let axis = node.y & 3u;
            let near = children(node.y) | backward[axis];
            let far = near ^ 1u;
            let t = (bitcast<f32>(node.x) - ray.origin[axis]) * inverse[axis];
            let margin = slack[axis] * (max(end, -begin) + group.primitive_size);
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
            node = nodes[group.root + index];
        }

        let first = group.first_ref + node.x;
        intersect_members(first, first + (node.y >> 2u), ray, any_hit, hit);
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

fn intersect_instance(reference: u32, ray: Ray, any_hit: bool, hit: ptr<function, Hit>) {
    let instance = scene.instances[index_of(reference)];
    let object = object_ray(instance, ray, (*hit).t);
    var found = Hit(object.ray.t_max, NONE, 0.0, 0.0, NONE);
    //#if triangle
    let outer_shear = ray_shear;
    ray_shear = shear_of(object.ray);
    //#end
    traverse_group(object.ray, any_hit, scene.groups[instance.group], &found);
    //#if triangle
    ray_shear = outer_shear;
    //#end
    if found.reference == NONE {
        return;
    }
    let t = object.start + found.t / object.length;
    if t > ray.t_min && t < (*hit).t {
        *hit = Hit(t, reference, found.u, found.v, found.reference);
    }
}

fn surface_at(ray: Ray, hit: Hit) -> Surface {
    let placed = kind_of(hit.reference) == KIND_INSTANCE;
    var own_ray = ray;
    var own_hit = hit;
    var instance: Instance;
    if placed {
        instance = scene.instances[index_of(hit.reference)];
        own_ray = object_ray(instance, ray, hit.t).ray;
        own_hit.t = own_ray.t_max;
        own_hit.reference = hit.member;
    }
    let s = shape_surface(own_ray, own_hit);
    if placed {
        return instance_surface(instance, s);
    }
    return s;
}

// Moves surface data from the group's space to scene space.
fn instance_surface(instance: Instance, own: Surface) -> Surface {
    var s = own;
    let n = placed_normal(instance, own.normal);
    let inverse_length = 1.0 / sqrt(dot(n, n));
    s.error = placed_error(instance, own.error, own.normal, inverse_length);
    s.position = placed_point(instance, own.position);
    s.normal = n * inverse_length;
    s.shading = s.normal;
    if any(own.shading != own.normal) {
        s.shading = placed_shading(instance, own.shading, s.normal);
    }
    if instance.material != NONE {
        s.material = instance.material;
    }
    s.light = NONE;
    s.outline = NONE;
    if instance.uv == UV_PLANAR {
        s.uv = s.position.xz * scene.world.unit + scene.materials[s.material].planar_origin;
    }
    return s;
}
