// Smooth conductor. Twin: src/materials/smooth_metal.rs.

fn scatter_smooth_metal(p: ShadingPoint, interior: Interior, u: f32, mode: u32) -> Scatter {
    let mirror = reflected(p, mode);
    let cos = abs(dot(p.wo, mirror_normal(p)));
    let m = scene.materials[p.lobe.material];
    var fresnel_term = p.lobe.reflectance * fresnel_conductor(cos, m.eta, m.k);
    if all(m.eta == vec3f(1.0)) {
        fresnel_term = schlick(p.lobe.reflectance, cos);
    }
    return Scatter(mirror.direction, interior, mirror.weight * fresnel_term);
}
