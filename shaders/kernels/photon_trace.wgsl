// Path of one photon: emission, then a record at every non-specular hit, until roulette ends the
// path. Run by one invocation per photon of a batch; reads the scene, appends to `records` (in any
// order) and adds to `counters`. Past the capacity it counts records but does not store them. A
// record with direction 0, which encodes no vector, marks that the driver stopped the loops of
// photon `key`, which must be traced again. Twin: src/kernels/photon_trace.rs.

const ESCAPED: u32 = 0u;
const ABSORBED: u32 = 1u;
const CUT: u32 = 2u;

@compute @workgroup_size(64)
fn photon_trace(@builtin(global_invocation_id) gid: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = invocation(gid, groups);
    if id >= dispatch.end {
        return;
    }
    var rng = rng_new(
        dispatch.batch_first + id, dispatch.pass_number, STREAM_PHOTON, dispatch.seed
    );
    let emission = emit_photon(&rng);
    var ray = emission.ray;
    var flux = emission.flux;
    //#if far || guided
    var relative_flux = emission.relative_flux;
    //#end
    var interior = emission.interior;
    var hidden = 0u;
    var bounce = 0u;
    var photon_class = 0u;
    var focus = 0u;
    //#if continued
    focus = select(dispatch.continued & FOCUSED, 0u, emission.extended);
    //#end
    var rays = 0u;
    var end = CUT;
    while bounce <= dispatch.max_bounces && hidden <= HIDDEN_FACES {
        if max_component(flux) <= 0.0 {
            end = ABSORBED;
            break;
        }
        rays += 1u;
        let hit = intersect_scene(ray);
        if hit.reference == NONE {
            end = ESCAPED;
            break;
        }
        let s = surface_at(ray, hit);
        // absorption on the way, and hidden faces
        let wo = -ray.direction;
        interior = interior_before(s, wo, interior);
        flux *= transmittance(medium_of(interior), max(hit.t, 0.0));
        //#if nested
        if passes_hidden(s, &ray, &interior) {
            hidden += 1u;
            continue;
        }
        //#end
        // choose a layer
        var p = shading_point(hit, s, wo, interior);
        var stores = !is_specular(p.lobe.bsdf) && max_component(p.lobe.reflectance) > 0.0;
        //#if layered
        var layer = 1.0;
        if is_layered(p.lobe.bsdf) {
            stores = scene.materials[p.lobe.material].stores != 0u;
            let choice = rng_next(&rng);
            layer = choose_layer(hit, &p, choice.x);
        }
        //#end
        // store a record at non-specular hits, unless shadow rays account for the light
        //#if sampled
        // shadow rays end at faces, hidden ones included
        stores = stores && (bounce > 0u || hidden > 0u);
        //#end
        if stores {
            let kind = focus | photon_class;
            let key = (id << dispatch.key_bits) | (bounce << dispatch.bounce_shift) | kind;
            append(PhotonRecord(s.position, key, flux, oct_encode(wo)));
        }
        // scatter
        let u = rng_next(&rng);
        var scattered: Scatter;
        //#if specular
        if is_specular(p.lobe.bsdf) {
            scattered = scatter_specular(p, interior, u.x, IMPORTANCE);
        } else {
            focus = 0u;
            scattered = scattered_rough(&photon_class, p, interior, u);
        }
        //#else
        focus = 0u;
        scattered = scattered_rough(&photon_class, p, interior, u);
        //#end
        //#if layered
        scattered.weight *= layer;
        //#end
        // Russian roulette
        let weight = max_component(scattered.weight);
        //#if far || guided
        let kept = select(relative_flux, max(relative_flux, 1.0), is_specular(p.lobe.bsdf));
        let survival = min(weight * kept, 1.0);
        relative_flux *= weight / survival;
        //#else
        let survival = min(weight, 1.0);
        //#end
        if u.w >= survival {
            end = ABSORBED;
            break;
        }
        // next ray
        scattered.weight *= 1.0 / survival;
        flux *= scattered.weight;
        interior = scattered.interior;
        let origin = offset_origin(s.position, s.error, s.normal, scattered.direction);
        ray = Ray(origin, 0.0, scattered.direction, FAR);
        bounce += 1u;
    }
    if loops_stopped() {
        append(PhotonRecord(vec3f(0.0), id, vec3f(0.0), 0u));
    } else {
        count_rays(rays);
        atomicAdd(&counters.ends[end], 1u);
    }
}

fn scattered_rough(
    photon_class: ptr<function, u32>,
    p: ShadingPoint,
    interior: Interior,
    u: vec4f,
) -> Scatter {
    let scattered = scatter_rough(p, interior, u.xyz, IMPORTANCE);
    //#if split
    if is_wide(p.lobe.bsdf) {
        *photon_class = 1u;
    }
    //#end
    //#if far
    return aimed_scatter(p, u, scattered);
    //#else
    return scattered;
    //#end
}

fn append(record: PhotonRecord) {
    let slot = atomicAdd(&counters.records, 1u);
    if slot < dispatch.capacity {
        records[slot] = record;
    }
}
