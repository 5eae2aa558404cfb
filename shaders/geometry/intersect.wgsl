// Intersection of a ray with the whole scene: shapes outside the kd-tree one by one, then the
// kd-tree. Twin: src/geometry/intersect.rs.
//#if unbounded
fn intersect_unbounded(reference: u32, ray: Ray, hit: ptr<function, Hit>) {
    switch kind_of(reference) {
        //#if sphere
        case KIND_SPHERE: {
            intersect_sphere(scene.spheres[index_of(reference)], reference, ray, hit);
        }
        //#end
        //#if plane
        case KIND_PLANE: {
            intersect_plane(scene.planes[index_of(reference)], reference, ray, hit);
        }
        //#end
        default: {}
    }
}
//#end

//#if revolution
fn intersect_revolution(reference: u32, ray: Ray, hit: ptr<function, Hit>) {
    let patch_data = scene.patches[index_of(reference)];
    let revolution = scene.revolutions[patch_data.revolution];
    let at = intersect_patch(
        revolution, patch_data, ray.origin, ray.direction, ray.t_min, (*hit).t
    );
    if at.t < (*hit).t {
        *hit = Hit(at.t, reference, at.theta, at.tau, NONE);
    }
}
//#end

//#if kdtree
// Returns true if reference `i` of a leaf, which ends before `last`, has this kind.
fn names(kind: u32, i: u32, last: u32) -> bool {
    return i < last && kind_of(refs[i]) == kind;
}

// References are ordered by kind. Each kind has a separate loop, because a software driver executes
// every test that a loop may contain.
fn intersect_leaf(first: u32, last: u32, ray: Ray, any_hit: bool, hit: ptr<function, Hit>) {
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
    //#if patch_set
    while names(KIND_REVOLUTION, i, last) {
        put_off |= bit_of(index_of(refs[i]));
        i++;
    }
    //#else
    //#if revolution
    while names(KIND_REVOLUTION, i, last) {
        intersect_revolution(refs[i], ray, hit);
        if any_hit && (*hit).reference != NONE {
            return;
        }
        i++;
    }
    //#end
    //#end
    //#if instances
    while names(KIND_INSTANCE, i, last) {
        intersect_instance(refs[i], ray, any_hit, hit);
        if any_hit && (*hit).reference != NONE {
            return;
        }
        i++;
    }
    //#end
}
//#end

//#if patch_set
// Set of the patches, by index, in the leaves visited so far.
var<private> put_off: vec4u;

fn bit_of(index: u32) -> vec4u {
    return select(
        vec4u(0u), vec4u(1u << (index & 31u)), vec4u(index >> 5u) == vec4u(0u, 1u, 2u, 3u)
    );
}

// Searches the deferred patches in the order of their indices.
fn search_put_off(ray: Ray, any_hit: bool, hit: ptr<function, Hit>) {
    if any(put_off != vec4u(0u)) {
        loop {
            let some = put_off != vec4u(0u);
            let word = select(select(select(3u, 2u, some.z), 1u, some.y), 0u, some.x);
            let bits = select(
                select(select(put_off.w, put_off.z, some.z), put_off.y, some.y), put_off.x, some.x
            );
            let index = 32u * word + firstTrailingBit(bits);
            put_off &= ~bit_of(index);
            intersect_revolution((KIND_REVOLUTION << REFERENCE_BITS) | index, ray, hit);
            if all(put_off == vec4u(0u)) || (any_hit && (*hit).reference != NONE) {
                break;
            }
        }
    }
}
//#end

fn intersect_scene(ray: Ray) -> Hit {
    var hit = Hit(ray.t_max, NONE, 0.0, 0.0, NONE);
    //#if unbounded
    for (var i = 0u; i < scene.world.unbounded_count; i++) {
        intersect_unbounded(scene.unbounded[i], ray, &hit);
    }
    //#end
    //#if patch_set
    put_off = vec4u(0u);
    //#end
    //#if kdtree
    traverse_closest(ray, &hit);
    //#end
    //#if patch_set
    search_put_off(ray, false, &hit);
    //#end
    //#if few
    intersect_few(ray, false, &hit);
    //#end
    return hit;
}

fn occluded(ray: Ray) -> bool {
    var hit = Hit(ray.t_max, NONE, 0.0, 0.0, NONE);
    //#if unbounded
    for (var i = 0u; i < scene.world.unbounded_count; i++) {
        intersect_unbounded(scene.unbounded[i], ray, &hit);
        if hit.reference != NONE {
            return true;
        }
    }
    //#end
    //#if patch_set
    put_off = vec4u(0u);
    if !traverse_any(ray, &hit) {
        search_put_off(ray, true, &hit);
    }
    return hit.reference != NONE;
    //#else
    //#if kdtree
    return traverse_any(ray, &hit);
    //#else
    //#if few
    intersect_few(ray, true, &hit);
    //#end
    return hit.reference != NONE;
    //#end
    //#end
}
