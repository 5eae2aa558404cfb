// Surface data at a hit: position, normals, texture coordinates, material. Twin:
// src/geometry/surface.rs, which documents the fields.

struct Surface {
    position: vec3f,
    error: f32,
    normal: vec3f,
    material: u32,
    shading: vec3f,
    light: u32,
    uv: vec2f,
    v: f32,
    outline: u32,
}

//#if instances
fn shape_surface(ray: Ray, hit: Hit) -> Surface {
//#else
fn surface_at(ray: Ray, hit: Hit) -> Surface {
//#end
    let index = index_of(hit.reference);
    let p = ray.origin + ray.direction * hit.t;
    var planar = UV_NATURAL;
    var s: Surface;
    switch kind_of(hit.reference) {
        //#if triangle
        case KIND_TRIANGLE: {
            let triangle = triangles[index];
            let n = triangle_normal(triangle);
            s = Surface(
                triangle_point(triangle, hit.u, hit.v),
                triangle_error(triangle),
                n,
                triangle.material,
                n,
                triangle.light,
                vec2f(0.0),
                0.0,
                NONE,
            );
            //#if attributes
            if triangle.attributes != NONE {
                let a = attributes[triangle.attributes];
                let w = 1.0 - hit.u - hit.v;
                s.uv = vec2f(
                    a.u0 * w + a.u1 * hit.u + a.u2 * hit.v,
                    a.v0 * w + a.v1 * hit.u + a.v2 * hit.v,
                );
                s.outline = (a.outline_smooth >> 1u) - 1u;
                if (a.outline_smooth & 1u) == 1u {
                    let m = a.n0 * w + a.n1 * hit.u + a.n2 * hit.v;
                    if dot(m, m) > 0.0 {
                        let um = unit(m);
                        s.shading = select(-um, um, dot(um, n) >= 0.0);
                    }
                }
            }
            //#end
        }
        //#end
        //#if sphere
        case KIND_SPHERE: {
            let sphere = scene.spheres[index];
            let q = sphere_project(sphere, p);
            let n = sphere_normal(sphere, q);
            s = Surface(
                q,
                sphere_error(sphere, q),
                n,
                sphere.material,
                n,
                sphere.light,
                vec2f(0.0),
                0.0,
                NONE,
            );
            planar = sphere.uv;
            // skip the two arctangents for the many spheres without a texture
            if planar == UV_NATURAL && scene.materials[sphere.material].textured != 0u {
                let uv = sphere_uv(n);
                s.uv = uv;
                //#if texels
                s.uv.y = within_ends(s.material, uv.y);
                //#end
            }
        }
        //#end
        //#if rectangle
        case KIND_RECTANGLE: {
            let rectangle = scene.rectangles[index];
            s = Surface(
                rectangle_point(rectangle, hit.u, hit.v),
                rectangle_error(rectangle),
                rectangle.normal,
                rectangle.material,
                rectangle.normal,
                rectangle.light,
                vec2f(hit.u, hit.v),
                0.0,
                rectangle.outline,
            );
            planar = rectangle.uv;
        }
        //#end
        //#if disc
        case KIND_DISC: {
            let disc = scene.discs[index];
            let q = plane_project(p, disc.center, disc.normal);
            s = Surface(
                q,
                disc_error(disc),
                disc.normal,
                disc.material,
                disc.normal,
                disc.light,
                disc_uv(disc, q),
                0.0,
                disc.outline,
            );
            planar = disc.uv;
        }
        //#end
        //#if cuboid
        case KIND_CUBOID: {
            let cuboid = scene.cuboids[index];
            let q = cuboid_project(cuboid, p, hit.u);
            let n = cuboid_normal(hit.u);
            s = Surface(
                q,
                cuboid_error(cuboid),
                n,
                cuboid.material,
                n,
                cuboid.light,
                cuboid_uv(cuboid, q, hit.u),
                0.0,
                cuboid.outline + cuboid_axis(hit.u),
            );
            planar = cuboid.uv;
        }
        //#end
        //#if revolution
        case KIND_REVOLUTION: {
            let patch_data = scene.patches[index];
            let revolution = scene.revolutions[patch_data.revolution];
            let r = revolution_surface(revolution, patch_data, hit.u, hit.v);
            s = Surface(
                r.position,
                r.error,
                r.normal,
                revolution.material,
                r.normal,
                revolution.light,
                r.uv,
                r.uv.y,
                NONE,
            );
            planar = revolution.uv;
            //#if texels
            if planar == UV_NATURAL {
                s.uv.y = within_ends(s.material, r.uv.y);
            }
            //#end
        }
        //#end
        //#if plane
        case KIND_PLANE: {
            let plane = scene.planes[index];
            let q = plane_project(p, plane.point, plane.normal);
            let d = q - plane.point;
            s = Surface(
                q,
                plane_error(plane, q),
                plane.normal,
                plane.material,
                plane.normal,
                NONE,
                vec2f(plane.u0 + dot(d, plane.tangent), plane.v0 + dot(d, plane.bitangent)),
                0.0,
                plane.outline,
            );
            planar = plane.uv;
        }
        //#end
        default: {}
    }
    if planar == UV_PLANAR {
        s.uv = s.position.xz * scene.world.unit + scene.materials[s.material].planar_origin;
    }
    return s;
}

//#if texels
// Clamps v to half a texel row from its ends, so that filtering does not mix in the opposite end.
fn within_ends(material: u32, v: f32) -> f32 {
    let index = scene.materials[material].texture;
    if index == NONE || scene.textures[index].kind != TEXTURE_IMAGE {
        return v;
    }
    let texture = scene.textures[index];
    let half = min(0.5 / (f32(texture.height) * abs(texture.scale.y)), 0.5);
    return min(max(v, half), 1.0 - half);
}
//#end
