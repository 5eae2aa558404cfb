// Smooth dielectric: Fresnel reflection and refraction, total internal reflection. Twin:
// src/materials/glass.rs.

fn scatter_glass(p: ShadingPoint, interior: Interior, u: f32, mode: u32) -> Scatter {
    let beyond = interior_beyond(p.s, p.wo, interior);
    let eta = relative_ior(p.s, p.wo, interior, beyond);
    let cos_i = dot(p.wo, p.n);
    let interface_n = fresnel(cos_i, eta);
    if u < interface_n.reflectance {
        let mirror = reflected(p, mode);
        return Scatter(mirror.direction, interior, mirror.weight);
    }
    var n = p.n;
    var wi = refracted(p.wo, n, cos_i, interface_n.cos_t, eta);
    // a direction on the wrong side of the surface is replaced by refraction at the geometric
    // normal
    if dot(wi, p.ng) >= 0.0 {
        n = p.ng;
        let cos_g = dot(p.wo, p.ng);
        let flat_ng = fresnel(cos_g, eta);
        wi = refracted(p.wo, p.ng, cos_g, flat_ng.cos_t, eta);
    }
    // radiance is compressed into a smaller solid angle inside (Veach 1997, section 5.2)
    var weight = eta * eta;
    if mode == IMPORTANCE {
        weight = shading_correction(p, n, wi);
    }
    return Scatter(wi, beyond, vec3f(weight));
}
