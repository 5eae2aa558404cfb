// Mix of two materials. Twin: src/materials/mix.rs.

fn choose_mix(p: ShadingPoint, u: f32) -> Layer {
    let m = p.lobe.material;
    let amount = amount_at(p);
    if u < amount {
        return another(p, scene.materials[m].second, u / amount);
    }
    let rest = (u - amount) / max(1.0 - amount, 1e-6);
    return another(p, scene.materials[m].first, rest);
}
