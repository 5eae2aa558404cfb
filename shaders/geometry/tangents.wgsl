// Derivatives of a surface point by its texture coordinates, for maps that bend its normal. Twin:
// src/geometry/tangents.rs, which documents the fields.

// Least distance from the axis of a sphere, over its radius, and least slope of a surface with
// planar texture coordinates.
const LEAST_SLOPE: f32 = 1e-3;

struct Tangents {
    u: vec3f,
    v: vec3f,
}

fn tangents_at(hit: Hit, s: Surface) -> Tangents {
    var reference = hit.reference;
    //#if instances
    let instance = kind_of(hit.reference) == KIND_INSTANCE;
    if instance {
        reference = hit.member;
    }
    //#end
    var t = shape_tangents(reference, hit.u, hit.v, s.uv);
    var planar = planar_of(reference);
    //#if instances
    if instance {
        let placed = scene.instances[index_of(hit.reference)];
        t = Tangents(placed_direction(placed, t.u), placed_direction(placed, t.v));
        planar = placed.uv == UV_PLANAR;
    }
    //#end
    if planar {
        t = planar_tangents(s.normal);
    }
    let area = abs(dot(cross(t.u, t.v), s.normal));
    let lengths = sqrt(dot(t.u, t.u) * dot(t.v, t.v));
    if area > 1e-5 * lengths {
        return t;
    }
    let frame = basis(s.normal);
    return Tangents(frame.t, frame.b);
}

// Returns true if the texture coordinates of a shape are its world coordinates (x, z).
fn planar_of(reference: u32) -> bool {
    let index = index_of(reference);
    var source = UV_NATURAL;
    switch kind_of(reference) {
        //#if sphere
        case KIND_SPHERE: { source = scene.spheres[index].uv; }
        //#end
        //#if rectangle
        case KIND_RECTANGLE: { source = scene.rectangles[index].uv; }
        //#end
        //#if disc
        case KIND_DISC: { source = scene.discs[index].uv; }
        //#end
        //#if cuboid
        case KIND_CUBOID: { source = scene.cuboids[index].uv; }
        //#end
        //#if revolution
        case KIND_REVOLUTION: {
            source = scene.revolutions[scene.patches[index].revolution].uv;
        }
        //#end
        //#if plane
        case KIND_PLANE: { source = scene.planes[index].uv; }
        //#end
        default: {}
    }
    return source == UV_PLANAR;
}

fn planar_tangents(normal: vec3f) -> Tangents {
    var slope = normal.y;
    if abs(slope) < LEAST_SLOPE {
        slope = LEAST_SLOPE;
    }
    let scale = 1.0 / scene.world.unit;
    return Tangents(
        vec3f(1.0, -normal.x / slope, 0.0) * scale,
        vec3f(0.0, -normal.z / slope, 1.0) * scale,
    );
}

// Derivatives by the shape's own texture coordinates `uv`, in the space of the shape.
fn shape_tangents(reference: u32, u: f32, v: f32, uv: vec2f) -> Tangents {
    let index = index_of(reference);
    switch kind_of(reference) {
        //#if triangle
        case KIND_TRIANGLE: {
            //#if attributes
            let triangle = triangles[index];
            let e1 = triangle.p1 - triangle.p0;
            let e2 = triangle.p2 - triangle.p0;
            if triangle.attributes == NONE {
                return Tangents(vec3f(0.0), vec3f(0.0));
            }
            let a = attributes[triangle.attributes];
            let du1 = a.u1 - a.u0;
            let du2 = a.u2 - a.u0;
            let dv1 = a.v1 - a.v0;
            let dv2 = a.v2 - a.v0;
            let determinant = du1 * dv2 - du2 * dv1;
            if determinant == 0.0 {
                return Tangents(vec3f(0.0), vec3f(0.0));
            }
            let inverse = 1.0 / determinant;
            return Tangents((e1 * dv2 - e2 * dv1) * inverse, (e2 * du1 - e1 * du2) * inverse);
            //#else
            return Tangents(vec3f(0.0), vec3f(0.0));
            //#end
        }
        //#end
        //#if sphere
        case KIND_SPHERE: {
            let sphere = scene.spheres[index];
            let around = sin_cos((0.5 - uv.x) * TAU);
            let up = sin_cos((uv.y - 0.5) * PI);
            let r = max(up.y, LEAST_SLOPE) * (TAU * sphere.radius);
            return Tangents(
                vec3f(around.x * r, 0.0, -around.y * r),
                vec3f(-around.y * up.x, up.y, -around.x * up.x) * (PI * sphere.radius),
            );
        }
        //#end
        //#if rectangle
        case KIND_RECTANGLE: {
            let rectangle = scene.rectangles[index];
            return Tangents(rectangle.u, rectangle.v);
        }
        //#end
        //#if disc
        case KIND_DISC: {
            let disc = scene.discs[index];
            let frame = basis(disc.normal);
            return Tangents(frame.t * (2.0 * disc.radius), frame.b * (2.0 * disc.radius));
        }
        //#end
        //#if cuboid
        case KIND_CUBOID: {
            let cuboid = scene.cuboids[index];
            let d = cuboid.upper - cuboid.lower;
            let n = cuboid_normal(u);
            if n.x != 0.0 {
                return Tangents(vec3f(0.0, 0.0, -n.x * d.z), vec3f(0.0, d.y, 0.0));
            }
            if n.y != 0.0 {
                return Tangents(vec3f(d.x, 0.0, 0.0), vec3f(0.0, 0.0, -n.y * d.z));
            }
            return Tangents(vec3f(n.z * d.x, 0.0, 0.0), vec3f(0.0, d.y, 0.0));
        }
        //#end
        //#if revolution
        case KIND_REVOLUTION: {
            let piece = scene.patches[index];
            let revolution = scene.revolutions[piece.revolution];
            let at = ring_point(piece, u, v);
            let along = f32(revolution.segments) / (piece.t1 - piece.t0);
            let d_u = at.d_theta * (-TAU * revolution.scale);
            let d_v = at.d_tau * (along * revolution.scale);
            return Tangents(
                (revolution.x_axis * d_u.x + revolution.y_axis * d_u.y)
                    + revolution.z_axis * d_u.z,
                (revolution.x_axis * d_v.x + revolution.y_axis * d_v.y)
                    + revolution.z_axis * d_v.z,
            );
        }
        //#end
        //#if plane
        case KIND_PLANE: {
            let plane = scene.planes[index];
            let t = plane.tangent;
            let b = plane.bitangent;
            return Tangents(t * (1.0 / dot(t, t)), b * (1.0 / dot(b, b)));
        }
        //#end
        default: {
            return Tangents(vec3f(0.0), vec3f(0.0));
        }
    }
}
