// A ray against the whole scene: twin of src/shapes/intersect.rs.

fn intersect_primitive(reference: u32, ray: Ray, hit: ptr<function, Hit>) {
    let index = reference & ((1u << REFERENCE_BITS) - 1u);
    switch reference >> REFERENCE_BITS {
        //#if triangle
        case KIND_TRIANGLE: {
            intersect_triangle(triangles[index], reference, ray, hit);
        }
        //#end
        //#if sphere
        case KIND_SPHERE: {
            intersect_sphere(scene.spheres[index], reference, ray, hit);
        }
        //#end
        //#if rectangle
        case KIND_RECTANGLE: {
            intersect_rectangle(scene.rectangles[index], reference, ray, hit);
        }
        //#end
        //#if disc
        case KIND_DISC: {
            intersect_disc(scene.discs[index], reference, ray, hit);
        }
        //#end
        //#if cuboid
        case KIND_CUBOID: {
            intersect_cuboid(scene.cuboids[index], reference, ray, hit);
        }
        //#end
        //#if plane
        case KIND_PLANE: {
            intersect_plane(scene.planes[index], reference, ray, hit);
        }
        //#end
        default: {}
    }
}

//#if revolution
fn intersect_revolution(reference: u32, ray: Ray, hit: ptr<function, Hit>) {
    let patch_data = scene.patches[reference & ((1u << REFERENCE_BITS) - 1u)];
    let revolution = scene.revolutions[patch_data.revolution];
    let at = intersect_patch(revolution, patch_data, ray.origin, ray.direction, ray.t_min, (*hit).t);
    if at.t < (*hit).t {
        *hit = Hit(at.t, reference, at.theta, at.tau);
    }
}
//#end

//#if kdtree
fn intersect_leaf(first: u32, last: u32, ray: Ray, any_hit: bool, hit: ptr<function, Hit>) {
    //#if revolution
    var patches = last;
    //#end
    for (var i = first; i < last; i++) {
        let reference = refs[i];
        //#if revolution
        if reference >> REFERENCE_BITS == KIND_REVOLUTION {
            patches = min(patches, i);
            continue;
        }
        //#end
        intersect_primitive(reference, ray, hit);
        if any_hit && (*hit).reference != NONE {
            return;
        }
    }
    //#if revolution
    // in a loop of their own, since a software driver runs through what it tests for every shape
    for (var i = patches; i < last; i++) {
        if refs[i] >> REFERENCE_BITS == KIND_REVOLUTION {
            intersect_revolution(refs[i], ray, hit);
            if any_hit && (*hit).reference != NONE {
                return;
            }
        }
    }
    //#end
}
//#end

fn intersect_scene(ray: Ray) -> Hit {
    var hit = Hit(ray.t_max, NONE, 0.0, 0.0);
    //#if unbounded
    for (var i = 0u; i < scene.world.unbounded_count; i++) {
        intersect_primitive(scene.unbounded[i], ray, &hit);
    }
    //#end
    //#if kdtree
    traverse_closest(ray, &hit);
    //#end
    //#if few
    intersect_few(ray, false, &hit);
    //#end
    return hit;
}

fn occluded(ray: Ray) -> bool {
    var hit = Hit(ray.t_max, NONE, 0.0, 0.0);
    //#if unbounded
    for (var i = 0u; i < scene.world.unbounded_count; i++) {
        intersect_primitive(scene.unbounded[i], ray, &hit);
        if hit.reference != NONE {
            return true;
        }
    }
    //#end
    //#if kdtree
    return traverse_any(ray, &hit);
    //#else
    //#if few
    intersect_few(ray, true, &hit);
    //#end
    return hit.reference != NONE;
    //#end
}
