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

//#if coated
fn coated(lobe: Lobe, cos: f32) -> f32 {
    let ior = scene.materials[lobe.material].coated;
    if ior == 0.0 {
        return 1.0;
    }
    return 1.0 - fresnel(abs(cos), ior).reflectance;
}

fn eval_rough(lobe: Lobe, n: vec3f, wo: vec3f, wi: vec3f) -> vec3f {
    return eval_rough_uncoated(lobe, n, wo, wi) * coated(lobe, dot(wi, n));
}
//#end

//#if scene
const NARROW: f32 = 0.08;
const NARROW_GLASS: f32 = 0.3;

fn is_narrow(lobe: Lobe) -> bool {
    let limit = select(NARROW, NARROW_GLASS, is_body(lobe.bsdf));
    var width = lobe.alpha;
    //#if brushed
    if lobe.bsdf == MATERIAL_BRUSHED {
        width = max(scene.materials[lobe.material].alpha, scene.materials[lobe.material].ior);
    }
    //#end
    return !is_wide(lobe.bsdf) && !is_specular(lobe.bsdf) && width < limit;
}

struct ShadingPoint {
    s: Surface,
    wo: vec3f,
    ng: vec3f,
    ns: vec3f,
    n: vec3f,
    //#if maps
    bent: bool,
    //#end
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
    //#if coated
    if scene.materials[lobe.material].coated > 0.0 {
        return true;
    }
    //#end
    if lobe.bsdf == MATERIAL_METAL {
        return scene.materials[lobe.material].mean_albedo < 1.0;
    }
    return is_parametric(lobe.bsdf);
}
//#end

fn toward(v: vec3f, w: vec3f) -> vec3f {
    return select(-v, v, dot(v, w) >= 0.0);
}

fn shading_point(hit: Hit, surface: Surface, wo: vec3f, interior: Interior) -> ShadingPoint {
    var s = surface;
    var lobe = lobe_at(s.material, s.uv);
    //#if rough_glass
    if lobe.bsdf == MATERIAL_ROUGH_GLASS {
        let beyond = interior_beyond(s, wo, interior);
        lobe.reflectance = vec3f(relative_ior(s, wo, interior, beyond));
    }
    //#end
    //#if maps
    if scene.materials[s.material].bent != 0u {
        s.shading = mapped_normal(s.material, hit, s);
    }
    //#end
    let ng = toward(s.normal, wo);
    var p: ShadingPoint;
    p.s = s;
    p.wo = wo;
    p.ng = ng;
    //#if maps
    p.bent = scene.materials[s.material].bent != 0u;
    //#end
    p.lobe = lobe;
    set_normals(&p);
    //#if brushed
    if lobe.bsdf == MATERIAL_BRUSHED {
        p.lobe.alpha = grain_angle(hit, p);
    }
    //#end
    return p;
}

fn set_normals(p: ptr<function, ShadingPoint>) {
    (*p).ns = toward((*p).s.shading, (*p).ng);
    // wide lobes do not depend on the viewing direction
    let faces = is_wide((*p).lobe.bsdf) || dot((*p).wo, (*p).ns) > 0.0;
    (*p).n = select((*p).ng, (*p).ns, faces);
    //#if maps
    if (*p).bent && is_reflector((*p).lobe.bsdf) {
        (*p).n = facing_normal((*p).ns, (*p).ng, (*p).wo, (*p).lobe.alpha);
    }
    //#end
}

//#if maps
fn facing_normal(ns: vec3f, ng: vec3f, wo: vec3f, alpha: f32) -> vec3f {
    let wi = mirrored(wo, ns);
    let least = min(2.0 * alpha, dot(wo, ng));
    let lift = least - dot(wi, ng);
    if lift <= 0.0 {
        return ns;
    }
    return unit(wo + renormalized(wi + ng * lift));
}
//#end

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

//#if coated
fn sample_rough(p: ShadingPoint, u: vec3f, mode: u32) -> Sample {
    let drawn = sample_rough_uncoated(p, u, mode);
    return Sample(drawn.direction, drawn.weight * coated(p.lobe, dot(drawn.direction, p.n)));
}

fn scatter_specular(p: ShadingPoint, interior: Interior, u: f32, mode: u32) -> Scatter {
    let s = scatter_specular_uncoated(p, interior, u, mode);
    return Scatter(s.direction, s.interior, s.weight * coated(p.lobe, dot(s.direction, p.n)));
}
//#end

fn scatter_rough(p: ShadingPoint, interior: Interior, u: vec3f, mode: u32) -> Scatter {
    //#if maps
    var drawn: Sample;
    if mode == IMPORTANCE && p.bent {
        drawn = sample_adjoint(p, u);
    } else {
        drawn = sample_rough(p, u, mode);
    }
    //#else
    let drawn = sample_rough(p, u, mode);
    //#end
    //#if rough_glass
    if is_body(p.lobe.bsdf) && dot(drawn.direction, p.ng) < 0.0 {
        return Scatter(drawn.direction, interior_beyond(p.s, p.wo, interior), drawn.weight);
    }
    //#end
    return Scatter(drawn.direction, interior, drawn.weight);
}

//#if maps
fn sample_adjoint(p: ShadingPoint, u: vec3f) -> Sample {
    if !is_reflector(p.lobe.bsdf) {
        return sample_rough(p, u, IMPORTANCE);
    }
    let direction = sample_rough(p, u, RADIANCE).direction;
    let cos = dot(direction, p.ng);
    let pdf = pdf_rough(p.lobe, p.n, p.wo, direction);
    if cos <= 0.0 || pdf <= 0.0 {
        return Sample(direction, vec3f(0.0));
    }
    let n = facing_normal(p.ns, p.ng, direction, p.lobe.alpha);
    let f = eval_rough(p.lobe, n, direction, p.wo);
    let arrived = max(dot(p.wo, p.ng), ADJOINT_COS_MIN);
    return Sample(direction, f * (cos / (arrived * pdf)));
}
//#end

//#if layered
const LAYERS: u32 = 12u;

struct Layer {
    lobe: Lobe,
    weight: f32,
    u: f32,
}

fn another(p: ShadingPoint, material: u32, u: f32) -> Layer {
    var lobe = p.lobe;
    lobe.material = material;
    return Layer(lobe, 1.0, u);
}

fn amount_at(p: ShadingPoint) -> f32 {
    let color = p.lobe.reflectance;
    return (color.x + color.y + color.z) * (1.0 / 3.0);
}

fn choose_layer(hit: Hit, p: ptr<function, ShadingPoint>, u: f32) -> f32 {
    var layer = Layer((*p).lobe, 1.0, u);
    var weight = 1.0;
    var depth = 0u;
    while depth < LAYERS && is_layered((*p).lobe.bsdf) {
        layer = choose_once(*p, layer.u);
        if layer.lobe.material != (*p).lobe.material {
            layer.lobe = lobe_at(layer.lobe.material, (*p).s.uv);
        }
        (*p).lobe = layer.lobe;
        weight *= layer.weight;
        depth += 1u;
    }
    //#if part_maps
    let material = (*p).lobe.material;
    if scene.materials[material].bent != 0u && material != (*p).s.material {
        (*p).s.shading = mapped_normal(material, hit, (*p).s);
        (*p).bent = true;
    }
    //#end
    set_normals(p);
    //#if brushed
    if (*p).lobe.bsdf == MATERIAL_BRUSHED {
        (*p).lobe.alpha = grain_angle(hit, *p);
    }
    //#end
    return weight;
}
//#end
//#end
