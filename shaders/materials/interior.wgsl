// Interior list: the glass bodies that contain a point. Twin: src/materials/interior.rs, which
// explains it.

//#if nested
const BODIES: u32 = 8u;
//#else
const BODIES: u32 = 1u;
//#end

struct Interior {
    bodies: array<u32, BODIES>,
}

fn interior_of(body: u32) -> Interior {
    var interior: Interior;
    for (var k = 0u; k < BODIES; k++) {
        interior.bodies[k] = NONE;
    }
    interior.bodies[0] = body;
    return interior;
}

fn medium_of(interior: Interior) -> u32 {
    return interior.bodies[0];
}

//#if glass || rough_glass
//#if astride
fn holds(interior: Interior, body: u32) -> bool {
    var list = interior;
    var found = false;
    for (var k = 0u; k < BODIES; k++) {
        found = found || list.bodies[k] == body;
    }
    return found;
}
//#end

fn entered(interior: Interior, body: u32) -> Interior {
    //#if nested
    var next = interior;
    var carry = body;
    for (var k = 0u; k < BODIES; k++) {
        let here = next.bodies[k];
        next.bodies[k] = min(here, carry);
        carry = select(max(here, carry), NONE, here == carry);
    }
    return next;
    //#else
    return interior_of(body);
    //#end
}

fn left(interior: Interior, body: u32) -> Interior {
    //#if nested
    var next = interior;
    var gap = false;
    for (var k = 0u; k < BODIES; k++) {
        gap = gap || next.bodies[k] == body;
        if gap {
            var after = NONE;
            if k + 1u < BODIES {
                after = next.bodies[k + 1u];
            }
            next.bodies[k] = after;
        }
    }
    return next;
    //#else
    return interior_of(NONE);
    //#end
}

fn ior_of(medium: u32) -> f32 {
    if medium == NONE {
        return 1.0;
    }
    return scene.materials[medium].ior;
}
//#end

fn interior_before(s: Surface, wo: vec3f, interior: Interior) -> Interior {
    //#if glass || rough_glass
    let inside = is_body(scene.materials[s.material].kind) && dot(wo, s.normal) < 0.0;
    if inside {
        return entered(interior, s.material);
    }
    //#end
    return interior;
}

//#if glass || rough_glass
fn interior_beyond(s: Surface, wo: vec3f, before: Interior) -> Interior {
    if dot(wo, s.normal) >= 0.0 {
        return entered(before, s.material);
    }
    return left(before, s.material);
}

fn relative_ior(s: Surface, wo: vec3f, before: Interior, beyond: Interior) -> f32 {
    var here = medium_of(before);
    //#if nested
    //#else
    if dot(wo, s.normal) >= 0.0 {
        here = NONE;
    }
    //#end
    return ior_of(here) / ior_of(medium_of(beyond));
}
//#end

//#if nested
fn passes_hidden(s: Surface, ray: ptr<function, Ray>, interior: ptr<function, Interior>) -> bool {
    if !is_body(scene.materials[s.material].kind) {
        return false;
    }
    let direction = (*ray).direction;
    let beyond = interior_beyond(s, -direction, *interior);
    if ior_of(medium_of(*interior)) != ior_of(medium_of(beyond)) {
        return false;
    }
    *ray = Ray(offset_origin(s.position, s.error, s.normal, direction), 0.0, direction, FAR);
    *interior = beyond;
    return true;
}
//#end

//#if photon_trace && infinite
fn interior_from(direction: vec3f) -> Interior {
    var interior = interior_of(NONE);
    //#if glass && plane && unbounded || rough_glass && plane && unbounded
    for (var i = 0u; i < scene.world.unbounded_count; i++) {
        let reference = scene.unbounded[i];
        if kind_of(reference) == KIND_PLANE {
            let index = index_of(reference);
            let material = scene.planes[index].material;
            let glass = is_body(scene.materials[material].kind);
            if glass && dot(direction, scene.planes[index].normal) > 0.0 {
                interior = entered(interior, material);
            }
        }
    }
    //#end
    return interior;
}
//#end
