// A material with a parameter that a texture gives: one of the two materials of a graded series
// between which the texture's value lies. Twin: src/materials/graded.rs.

fn choose_graded(p: ShadingPoint, u: f32) -> Layer {
    let material = p.lobe.material;
    let first = scene.materials[material].first;
    let least = scene.materials[material].ior;
    let steps = scene.materials[material].alpha;
    let last = f32(scene.materials[material].second);
    let at = clamp((amount_at(p) - least) * steps, 0.0, last);
    let below = floor(at);
    let share = at - below;
    let k = first + u32(below);
    if u < share {
        return another(p, k + 1u, u / share);
    }
    let v = (u - share) / max(1.0 - share, 1e-6);
    return another(p, k, v);
}
