// Point-in-body test by ray casting. Twin: src/materials/enclosing.rs, which explains the method.

const FACES: u32 = 256u;
const LOOK: vec3f = vec3f(0.3104505, 0.8912933, 0.3304795);

fn interior_at(known: u32, position: vec3f) -> Interior {
    //#if astride
    if known == ASTRIDE {
        return enclosing(position);
    }
    //#end
    return interior_of(known);
}

//#if astride
fn enclosing(position: vec3f) -> Interior {
    // closed bodies first, then each open sheet along its mean normal
    var interior = looked(position, LOOK, NONE, interior_of(NONE));
    for (var k = 0u; k < scene.world.body_count; k++) {
        let body = scene.world.body_first + k;
        let direction = scene.materials[body].reflectance;
        if dot(direction, direction) > 0.0 {
            interior = looked(position, direction, body, interior);
        }
    }
    return interior;
}

fn looked(position: vec3f, direction: vec3f, body: u32, known: Interior) -> Interior {
    var found = known;
    var ahead = interior_of(NONE);
    var origin = position;
    for (var face = 0u; face < FACES; face++) {
        let ray = Ray(origin, 0.0, direction, FAR);
        let hit = intersect_scene(ray);
        if hit.reference == NONE {
            break;
        }
        let s = surface_at(ray, hit);
        let m = scene.materials[s.material];
        let closed = is_body(m.kind) && dot(m.reflectance, m.reflectance) == 0.0;
        if s.material == body || (body == NONE && closed) {
            if dot(direction, s.normal) < 0.0 {
                ahead = entered(ahead, s.material);
            } else if holds(ahead, s.material) {
                ahead = left(ahead, s.material);
            } else {
                found = entered(found, s.material);
            }
            if body != NONE {
                break;
            }
        }
        origin = offset_origin(s.position, s.error, s.normal, direction);
    }
    return found;
}
//#end
