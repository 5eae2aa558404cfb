// A material for each side of a surface. Twin: src/materials/two_sided.rs.

fn choose_two_sided(p: ShadingPoint, u: f32) -> Layer {
    let m = p.lobe.material;
    let front = dot(p.wo, p.s.normal) >= 0.0;
    let side = select(scene.materials[m].second, scene.materials[m].first, front);
    return another(p, side, u);
}
