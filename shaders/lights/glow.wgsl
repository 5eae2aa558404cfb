// Textured emission: a texture scales the radiance of an area light. Twin: src/lights/glow.rs,
// which documents the functions.

const MAP_SIDE: u32 = 32u;

struct Warped {
    across: vec2f,
    pick: f32,
    pdf: f32,
}

fn warped(light: Light, u: vec4f) -> Warped {
    if (light.flags & LIGHT_MAPPED) == 0u {
        return Warped(vec2f(u.y, u.z), u.w, 1.0);
    }
    let row = find_interval(light.map, MAP_SIDE, u.y);
    let columns = light.map + MAP_SIDE + row * MAP_SIDE;
    let column = find_interval(columns, MAP_SIDE, u.z);
    // the offset in the row comes from the lower bits of u.w, as in an environment image
    let fine = u.w * 4096.0;
    let x = (f32(column) + u.w) * (1.0 / f32(MAP_SIDE));
    let y = (f32(row) + (fine - floor(fine))) * (1.0 / f32(MAP_SIDE));
    let pdf = pdf_bin(light.map, row, MAP_SIDE) * pdf_bin(columns, column, MAP_SIDE);
    return Warped(vec2f(x, y), u.w, pdf);
}

fn pdf_map(light: Light, st: vec2f) -> f32 {
    if (light.flags & LIGHT_MAPPED) == 0u {
        return 1.0;
    }
    let row = min(u32(max(floor(st.y * f32(MAP_SIDE)), 0.0)), MAP_SIDE - 1u);
    let column = min(u32(max(floor(st.x * f32(MAP_SIDE)), 0.0)), MAP_SIDE - 1u);
    let columns = light.map + MAP_SIDE + row * MAP_SIDE;
    return pdf_bin(light.map, row, MAP_SIDE) * pdf_bin(columns, column, MAP_SIDE);
}

fn glow_at_sample(light: Light, p: ShapePoint, across: vec2f, pick: f32) -> vec3f {
    if (light.flags & LIGHT_TEXTURED) == 0u {
        return light.color;
    }
    return light.color * eval_texture(light.texture, sample_uv(light, p, across, pick));
}

fn glow_at_surface(light: Light, s: Surface) -> vec3f {
    if (light.flags & LIGHT_TEXTURED) == 0u {
        return light.color;
    }
    return light.color * eval_texture(light.texture, surface_uv(light, s));
}

fn surface_uv(light: Light, s: Surface) -> vec2f {
    let index = index_of(light.reference);
    switch kind_of(light.reference) {
        //#if area_sphere
        case KIND_SPHERE: {
            if scene.spheres[index].uv == UV_NATURAL {
                return between_ends(light, sphere_uv(s.normal));
            }
            return s.uv;
        }
        //#end
        //#if area_revolution
        case KIND_REVOLUTION: {
            if scene.revolutions[index].uv == UV_NATURAL {
                return between_ends(light, vec2f(s.uv.x, s.v));
            }
            return s.uv;
        }
        //#end
        default: {
            return s.uv;
        }
    }
}

fn sample_uv(light: Light, p: ShapePoint, across: vec2f, pick: f32) -> vec2f {
    let index = index_of(light.reference);
    switch kind_of(light.reference) {
        //#if area_triangle
        case KIND_TRIANGLE: {
            //#if attributes
            let triangle = triangles[index];
            if triangle.attributes != NONE {
                let a = attributes[triangle.attributes];
                let b = sample_triangle(across);
                let w = 1.0 - b.x - b.y;
                return vec2f(
                    a.u0 * w + a.u1 * b.x + a.u2 * b.y, a.v0 * w + a.v1 * b.x + a.v2 * b.y
                );
            }
            //#end
            return vec2f(0.0);
        }
        //#end
        //#if area_sphere
        case KIND_SPHERE: {
            let sphere = scene.spheres[index];
            if sphere.uv == UV_PLANAR {
                return planar_uv(sphere.material, p.position);
            }
            return between_ends(light, sphere_uv(p.normal));
        }
        //#end
        //#if area_rectangle
        case KIND_RECTANGLE: {
            let rectangle = scene.rectangles[index];
            if rectangle.uv == UV_PLANAR {
                return planar_uv(rectangle.material, p.position);
            }
            return across;
        }
        //#end
        //#if area_disc
        case KIND_DISC: {
            let disc = scene.discs[index];
            if disc.uv == UV_PLANAR {
                return planar_uv(disc.material, p.position);
            }
            return disc_uv(disc, p.position);
        }
        //#end
        //#if area_cuboid
        case KIND_CUBOID: {
            let cuboid = scene.cuboids[index];
            if cuboid.uv == UV_PLANAR {
                return planar_uv(cuboid.material, p.position);
            }
            let n = p.normal;
            let axis = select(select(2.0, 1.0, n.y != 0.0), 0.0, n.x != 0.0);
            let upper = select(0.0, 3.0, n.x + n.y + n.z > 0.0);
            return cuboid_uv(cuboid, p.position, axis + upper);
        }
        //#end
        //#if area_revolution
        case KIND_REVOLUTION: {
            let revolution = scene.revolutions[index];
            if revolution.uv == UV_PLANAR {
                return planar_uv(revolution.material, p.position);
            }
            let k = find_interval(light.first + light.patch_count, light.patch_count, pick);
            let start = scene.distributions[light.first + k];
            let end = patch_end(light, k);
            // u = 0.5 - angle / 2 pi, and the angle is 2 pi across.y - pi
            let uv = vec2f(1.0 - across.y, start + (end - start) * across.x);
            if revolution.uv == UV_NATURAL {
                return between_ends(light, uv);
            }
            return uv;
        }
        //#end
        default: {
            return vec2f(0.0);
        }
    }
}

fn planar_uv(material: u32, position: vec3f) -> vec2f {
    return position.xz * scene.world.unit + scene.materials[material].planar_origin;
}

fn between_ends(light: Light, uv: vec2f) -> vec2f {
    let texture = scene.textures[light.texture];
    if texture.kind != TEXTURE_IMAGE {
        return uv;
    }
    let half = min(0.5 / (f32(texture.height) * abs(texture.scale.y)), 0.5);
    return vec2f(uv.x, min(max(uv.y, half), 1.0 - half));
}
