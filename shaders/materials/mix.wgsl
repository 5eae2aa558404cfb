// Mix of two materials. Twin: src/materials/mix.rs.

fn choose_mix(p: ShadingPoint, u: f32) -> Layer {
    let m = p.lobe.material;
    let amount = amount_at(p);
    if u < amount {
        return Layer(lobe_at(scene.materials[m].second, p.s.uv), 1.0, u / amount);
    }
    let rest = (u - amount) / max(1.0 - amount, 1e-6);
    return Layer(lobe_at(scene.materials[m].first, p.s.uv), 1.0, rest);
}
