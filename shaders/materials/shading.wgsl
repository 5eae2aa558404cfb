// Shading point, shading normals and their adjoint correction, shared by all materials. Twin:
// src/materials/shading.rs.

const RADIANCE: u32 = 0u;
const IMPORTANCE: u32 = 1u;
const ADJOINT_COS_MIN: f32 = 1e-2;

struct Lobe {
    bsdf: u32,
    alpha: f32,
    reflectance: vec3f,
    //#if lobe_parameters || layered || thin_glass || smooth_metal
    material: u32,
    //#end
}

//#if scene
const NARROW: f32 = 0.08;
const NARROW_GLASS: f32 = 0.3;

fn is_narrow(lobe: Lobe) -> bool {
    let limit = select(NARROW, NARROW_GLASS, is_body(lobe.bsdf));
    return !is_wide(lobe.bsdf) && !is_specular(lobe.bsdf) && lobe.alpha < limit;
}

struct ShadingPoint {
    s: Surface,
    wo: vec3f,
    ng: vec3f,
    ns: vec3f,
    n: vec3f,
    lobe: Lobe,
}

struct Sample {
    direction: vec3f,
    weight: vec3f,
}

struct Scatter {
    direction: vec3f,
    interior: Interior,
    weight: vec3f,
}

fn reflectance_at(material: u32, uv: vec2f) -> vec3f {
    let m = scene.materials[material];
    //#if textures
    if m.texture != NONE {
        return eval_texture(m.texture, uv);
    }
    //#end
    return m.reflectance;
}

fn lobe_at(material: u32, uv: vec2f) -> Lobe {
    var lobe: Lobe;
    lobe.bsdf = scene.materials[material].kind;
    lobe.alpha = scene.materials[material].alpha;
    lobe.reflectance = reflectance_at(material, uv);
    //#if lobe_parameters || layered || thin_glass || smooth_metal
    lobe.material = material;
    //#end
    return lobe;
}

//#if lobe_parameters
fn reads_table(lobe: Lobe) -> bool {
    if lobe.bsdf == MATERIAL_METAL {
        return scene.materials[lobe.material].mean_albedo < 1.0;
    }
    return is_parametric(lobe.bsdf);
}
//#end

fn toward(v: vec3f, w: vec3f) -> vec3f {
    return select(-v, v, dot(v, w) >= 0.0);
}

fn shading_point(s: Surface, wo: vec3f, interior: Interior) -> ShadingPoint {
    var lobe = lobe_at(s.material, s.uv);
    //#if rough_glass
    if lobe.bsdf == MATERIAL_ROUGH_GLASS {
        let beyond = interior_beyond(s, wo, interior);
        lobe.reflectance = vec3f(relative_ior(s, wo, interior, beyond));
    }
    //#end
    let ng = toward(s.normal, wo);
    let ns = toward(s.shading, ng);
    // wide lobes do not depend on the viewing direction
    let n = select(ng, ns, is_wide(lobe.bsdf) || dot(wo, ns) > 0.0);
    return ShadingPoint(s, wo, ng, ns, n, lobe);
}

fn mirror_normal(p: ShadingPoint) -> vec3f {
    return select(p.n, p.ng, dot(mirrored(p.wo, p.n), p.ng) <= 0.0);
}

fn reflected(p: ShadingPoint, mode: u32) -> Sample {
    let n = mirror_normal(p);
    let wi = mirrored(p.wo, n);
    var weight = vec3f(1.0);
    if mode == IMPORTANCE {
        weight *= shading_correction(p, n, wi);
    }
    return Sample(wi, weight);
}

struct CosineAxis {
    axis: vec3f,
    weight: vec3f,
}

fn cosine_axis(p: ShadingPoint, mode: u32) -> CosineAxis {
    var axis = p.n;
    var weight = p.lobe.reflectance;
    if mode == IMPORTANCE {
        axis = p.ng;
        if any(p.s.shading != p.s.normal) {
            weight *= max(dot(p.wo, p.n), 0.0) / max(dot(p.wo, p.ng), ADJOINT_COS_MIN);
        }
    }
    return CosineAxis(axis, weight);
}

fn pdf_cosine(n: vec3f, wi: vec3f) -> f32 {
    let cos = dot(wi, n);
    if cos <= 0.0 {
        return 0.0;
    }
    return cos * INV_PI;
}

fn shading_correction(p: ShadingPoint, n: vec3f, wi: vec3f) -> f32 {
    if all(p.s.shading == p.s.normal) {
        return 1.0;
    }
    let denominator = abs(dot(p.wo, p.ng) * dot(wi, n));
    if denominator <= 1e-6 {
        return 0.0;
    }
    return abs(dot(p.wo, n) * dot(wi, p.ng)) / denominator;
}

fn renormalized(v: vec3f) -> vec3f {
    return v * (1.0 / sqrt(dot(v, v)));
}

fn scatter_rough(p: ShadingPoint, interior: Interior, u: vec3f, mode: u32) -> Scatter {
    let drawn = sample_rough(p, u, mode);
    //#if rough_glass
    if is_body(p.lobe.bsdf) && dot(drawn.direction, p.ng) < 0.0 {
        return Scatter(drawn.direction, interior_beyond(p.s, p.wo, interior), drawn.weight);
    }
    //#end
    return Scatter(drawn.direction, interior, drawn.weight);
}

//#if layered
const LAYERS: u32 = 8u;

struct Layer {
    lobe: Lobe,
    weight: f32,
    u: f32,
}

fn amount_at(p: ShadingPoint) -> f32 {
    let color = p.lobe.reflectance;
    return (color.x + color.y + color.z) * (1.0 / 3.0);
}

fn choose_layer(p: ptr<function, ShadingPoint>, u: f32) -> f32 {
    var layer = Layer((*p).lobe, 1.0, u);
    var weight = 1.0;
    for (var k = 0u; k < LAYERS; k += 1u) {
        if is_layered((*p).lobe.bsdf) {
            layer = choose_once(*p, layer.u);
            (*p).lobe = layer.lobe;
            weight *= layer.weight;
        }
    }
    // wide lobes do not depend on the viewing direction
    if is_wide((*p).lobe.bsdf) {
        (*p).n = (*p).ns;
    }
    return weight;
}
//#end
//#end
