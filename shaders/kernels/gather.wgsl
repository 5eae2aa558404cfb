// Density estimate at one visible point: the sum over the photons in its disc, or in two discs if
// indirect photons use a wider one. Run by one invocation per visible point of a chunk and photon
// batch; reads `visible_points`, `starts`, `sorted` (and `statistics` under the local rule), adds
// to `gathered` and, if the driver stopped its loops, to `counters`. Twin: src/kernels/gather.rs.

const FLATNESS: f32 = 0.25;
const COS_MIN: f32 = 1e-2;
const BOX_SLACK: f32 = 1e-4;
const BLOCK: u32 = 1024u;

// A sorted record is read as two groups of four words, since drivers read four words as fast as
// one: position and code, flux and direction.
const PLACE: u32 = 0u;
const LIGHT: u32 = 1u;

struct Frame {
    ng: vec3f,
    n: vec3f,
    //#if lobes
    wo: vec3f,
    lobe: Lobe,
    //#end
}

fn frame_at(point: VisiblePoint) -> Frame {
    var frame: Frame;
    frame.ng = oct_decode(point.normal);
    frame.n = frame.ng;
    if point.normal != point.shading {
        frame.n = oct_decode(point.shading);
    }
    //#if lobes
    frame.wo = oct_decode(point.wo);
    frame.lobe.bsdf = point.bsdf & ((1u << BSDF_BITS) - 1u);
    frame.lobe.alpha = point.alpha;
    frame.lobe.reflectance = point.reflectance;
    //#if lobe_parameters
    frame.lobe.material = point.bsdf >> BSDF_BITS;
    //#end
    //#end
    return frame;
}

@compute @workgroup_size(64)
fn gather(@builtin(global_invocation_id) gid: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let id = invocation(gid, groups);
    if id >= dispatch.end {
        return;
    }
    let point = visible_points[id];
    if point.radius <= 0.0 {
        return;
    }
    //#if local
    let radius_sq = point.radius * point.radius * local_scale_sq(statistics[id]);
    //#else
    let radius_sq = point.radius * point.radius * dispatch.scale_sq;
    //#end
    let frame = frame_at(point);
    //#if split
    var found = Gathered();
    let wider_sq = dispatch.indirect_radius * dispatch.indirect_radius;
    // one call in a loop, because software drivers inline every call
    var photon_class = 0u;
    loop {
        let one = gather_class(
            point, frame, photon_class, select(radius_sq, radius_sq * wider_sq, photon_class == 1u)
        );
        if photon_class == 0u {
            gathered[id].caustic += point.weight * one.flux;
        }
        found.flux += select(one.flux, one.flux * (1.0 / wider_sq), photon_class == 1u);
        found.count += one.count;
        found.bias_probe += select(
            one.bias_probe, one.bias_probe * (1.0 / wider_sq), photon_class == 1u
        );
        photon_class += 1u;
        continuing {
            break if photon_class == 2u;
        }
    }
    //#else
    let found = gather_class(point, frame, 0u, radius_sq);
    //#end
    gathered[id].flux += point.weight * found.flux;
    gathered[id].count += found.count;
    gathered[id].bias_probe += found.bias_probe;
    loops_stopped();
}

fn disc_reach(normal: vec3f, radius: f32, depth: f32) -> vec3f {
    let sine_sq = max(vec3f(1.0 + BOX_SLACK) - normal * normal, vec3f(0.0));
    return sqrt(sine_sq) * radius + abs(normal) * depth;
}

fn gather_class(point: VisiblePoint, frame: Frame, photon_class: u32, radius_sq: f32) -> Gathered {
    //#if split
    let inv_cell = select(dispatch.inv_cell, dispatch.inv_cell_indirect, photon_class == 1u);
    //#else
    let inv_cell = dispatch.inv_cell;
    //#end
    let radius = sqrt(radius_sq);
    let ng = frame.ng;
    let n = frame.n;
    //#if lobes
    let wo = frame.wo;
    let lobe = frame.lobe;
    let folded = lobe.bsdf == MATERIAL_DIFFUSE;
    let both = transmits(lobe.bsdf);
    //#end
    let flat_normal = point.normal == point.shading;
    //#if continued
    let only_focused = (point.state & ONLY_FOCUSED) != 0u;
    //#end
    //#if outlines
    // clip the disc to the outline
    var clip = clip_at(point.outline, point.position, ng, radius);
    let depth = min(clip.depth, FLATNESS * radius);
    let inner = clip.whole - 2.0 * clip.inner;
    //#else
    let depth = FLATNESS * radius;
    //#end
    // range of cells that the disc overlaps
    let reach = disc_reach(ng, radius, depth);
    let low = grid_cell(point.position - reach, inv_cell);
    let high = grid_cell(point.position + reach, inv_cell);
    //#if outlines
    // read once here; in the loop a driver would read it for every photon
    let outline = outlines[select(point.outline, 0u, point.outline == NONE)];
    //#end
    var count = 0u;
    var sum = vec3f(0.0);
    var ring = vec3f(0.0);
    // cells of a row, at most as many as the table has buckets, so that none is visited twice
    let wide = min(u32(high.x - low.x), dispatch.mask);
    var row = low.yz;
    var done = 0u;
    // loops test their condition at the end: software drivers run a body once more if it is tested
    // first
    loop {
        // walk the rows of cells
        let cell = vec3i(low.x + i32(done), row);
        let code = grid_code(cell, photon_class);
        let bucket = grid_bucket(cell, dispatch.mask);
        // a row that passes the end of the table continues at its start
        let cells = min(wide - done, dispatch.mask - bucket) + 1u;
        let end = starts[bucket + cells];
        var i = starts[bucket];
        // walk the row's photons block by block
        loop {
            let stop = min(i + BLOCK, end);
            var block = vec3f(0.0);
            loop {
                if i < stop {
                    let place = sorted[i][PLACE];
                    let position = bitcast<vec3f>(place.xyz);
                    let d = position - point.position;
                    let distance_sq = dot(d, d);
                    if distance_sq <= radius_sq
                        && abs(dot(d, ng)) <= depth
                        && is_code(place.w, code)
                    {
                        // read the rest of a record only if the photon is inside
                        let light = sorted[i][LIGHT];
                        let toward_light = oct_vector(light.w);
                        //#if lobes
                        var counts = dot(toward_light, ng) > 0.0 || both;
                        //#else
                        var counts = dot(toward_light, ng) > 0.0;
                        //#end
                        //#if continued
                        // reject photons whose light the continued path carries
                        counts = counts && (!only_focused || is_focused(place.w));
                        //#end
                        //#if outlines
                        // reject photons outside the outline or behind a wall
                        if counts && clip.crossed {
                            counts = in_outline(outline, position)
                                && before_walls(&clip, point.position, position);
                        }
                        //#end
                        if counts {
                            count += 1u;
                            var flux = bitcast<vec3f>(light.xyz);
                            //#if lobes
                            // flux arrives with the geometric cosine, the BSDF uses the shading one
                            if !flat_normal || !folded {
                                let wi = unit(toward_light);
                                if folded {
                                    flux *= max(dot(wi, n), 0.0) / max(dot(wi, ng), COS_MIN);
                                } else {
                                    let cos_g = max(abs(dot(wi, ng)), COS_MIN);
                                    let f = eval_rough(lobe, n, wo, wi);
                                    flux = f * flux * (1.0 / cos_g);
                                }
                            }
                            //#else
                            //#if attributes || maps
                            if !flat_normal {
                                let wi = unit(toward_light);
                                flux *= max(dot(wi, n), 0.0) / max(dot(wi, ng), COS_MIN);
                            }
                            //#end
                            //#end
                            block += flux;
                            //#if outlines
                            ring += flux * select(inner, clip.whole, distance_sq > 0.5 * radius_sq);
                            //#else
                            ring += flux * select(-1.0, 1.0, distance_sq > 0.5 * radius_sq);
                            //#end
                        }
                    }
                }
                i += 1u;
                continuing {
                    break if i >= stop;
                }
            }
            sum += block;
            continuing {
                break if i >= end;
            }
        }
        done += cells;
        if done > wide {
            row = select(vec2i(low.y, row.y + 1), vec2i(row.x + 1, row.y), row.x < high.y);
            done = 0u;
        }
        continuing {
            break if row.y > high.z;
        }
    }
    //#if outlines
    sum *= clip.whole;
    //#end
    return Gathered(sum, count, vec3f(0.0), dot(point.weight * LUMINANCE, ring));
}
