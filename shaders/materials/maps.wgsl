// Normal maps and bump maps: textures that bend the shading normal. Twin: src/materials/maps.rs.

const LEAST_COS: f32 = 0.02;

fn mapped_normal(material: u32, hit: Hit, s: Surface) -> vec3f {
    let t = tangents_at(hit, s);
    var n = s.shading;
    //#if bump_map
    if scene.materials[material].bump_map != NONE {
        n = normal_from_bumps(material, s.uv, n, t);
    }
    //#end
    //#if normal_map
    if scene.materials[material].normal_map != NONE {
        n = normal_from_map(material, s.uv, n, t);
    }
    //#end
    let cos = dot(n, s.normal);
    if cos < LEAST_COS {
        n = unit(n + s.normal * (LEAST_COS - cos));
    }
    return n;
}

//#if bump_map
const CHECKER_CELLS: f32 = 64.0;

fn normal_from_bumps(material: u32, uv: vec2f, n: vec3f, t: Tangents) -> vec3f {
    let bump_map = scene.materials[material].bump_map;
    let texture = scene.textures[bump_map];
    // central differences over one texel: continuous, because textures are filtered bilinearly
    var du = CHECKER_CELLS;
    var dv = CHECKER_CELLS;
    if texture.kind != TEXTURE_CHECKER {
        du = f32(texture.width);
        dv = f32(texture.height);
    }
    du = 0.5 / (du * abs(texture.scale.x));
    dv = 0.5 / (dv * abs(texture.scale.y));
    let u = vec2f(du, 0.0);
    let v = vec2f(0.0, dv);
    let by_u = (height_at(material, uv + u) - height_at(material, uv - u)) / (2.0 * du);
    let by_v = (height_at(material, uv + v) - height_at(material, uv - v)) / (2.0 * dv);
    let area = dot(n, cross(t.u, t.v));
    if area == 0.0 {
        return n;
    }
    let slope = (cross(t.v, n) * by_u + cross(n, t.u) * by_v) * (1.0 / area);
    return unit(n - slope);
}

fn height_at(material: u32, uv: vec2f) -> f32 {
    let color = eval_texture(scene.materials[material].bump_map, uv);
    return (color.x + color.y + color.z) * (scene.materials[material].bump_height * (1.0 / 3.0));
}
//#end

//#if normal_map
fn normal_from_map(material: u32, uv: vec2f, n: vec3f, t: Tangents) -> vec3f {
    let color = eval_texture(scene.materials[material].normal_map, uv);
    let strength = scene.materials[material].normal_strength;
    let x = (2.0 * color.x - 1.0) * strength;
    let y = (2.0 * color.y - 1.0) * strength;
    let z = 2.0 * color.z - 1.0;
    let along = t.u - n * dot(n, t.u);
    if dot(along, along) == 0.0 || x * x + y * y + z * z < 1e-6 {
        return n;
    }
    let tangent = unit(along);
    var bitangent = cross(n, tangent);
    if dot(n, cross(t.u, t.v)) < 0.0 {
        bitangent = -bitangent;
    }
    return unit((tangent * x + bitangent * y) + n * z);
}
//#end
