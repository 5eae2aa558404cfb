// Data that kernels pass to one another. Twin: src/kernels/records.rs, which documents the fields.

struct Dispatch {
    first: u32,
    end: u32,
    pass_number: u32,
    seed: u32,
    chunk_first: u32,
    batch_first: u32,
    key_bits: u32,
    capacity: u32,
    max_bounces: u32,
    eye_samples: u32,
    mask: u32,
    inv_cell: f32,
    scale_sq: f32,
    photons: f32,
    alpha: f32,
    radius_pixels: f32,
    radius_units: f32,
    radius_max: f32,
    strata: u32,
    passes_done: u32,
    classes: u32,
    indirect_radius: f32,
    inv_cell_indirect: f32,
    window_first: u32,
    window_width: u32,
    fixed_points: u32,
    continued: u32,
    bounce_shift: u32,
    points: array<vec4u, 4>,
}

const HIDDEN_FACES: u32 = 256u;
const STOPPED: u32 = 1u;
const BAD_EYE: u32 = 2u;
const BAD_DIRECT: u32 = 4u;
const ONLY_FOCUSED: u32 = 8u;

const CONTINUED: u32 = 1u;
const FOCUSED: u32 = 2u;

const BSDF_BITS: u32 = 8u;

struct VisiblePoint {
    position: vec3f,
    radius: f32,
    weight: vec3f,
    normal: u32,
    radiance: vec3f,
    shading: u32,
    reflectance: vec3f,
    alpha: f32,
    wo: u32,
    outline: u32,
    state: u32,
    bsdf: u32,
}

struct PhotonRecord {
    position: vec3f,
    key: u32,
    flux: vec3f,
    direction: u32,
}

struct Gathered {
    flux: vec3f,
    count: u32,
    caustic: vec3f,
    bias_probe: f32,
}

struct Statistics {
    scale_sq: f32,
    drop: f32,
    count_low: u32,
    count_high: u32,
}

const REJECTED_EYE: u32 = 0u;
const REJECTED_DIRECT: u32 = 1u;
const REJECTED_PHOTONS: u32 = 2u;
const REJECTED_ESTIMATE: u32 = 3u;
const ACCEPTED: u32 = 4u;

struct FilmPixel {
    mean: vec3f,
    spread: f32,
    carry: vec3f,
    mean_at_pow2: f32,
    rejected: vec4u,
    bias_probe: f32,
    bias_probe_alternating: f32,
    halves: f32,
    mean_at_half_pow2: f32,
}

// Counters of a pass: records appended in the batch (including those past the capacity, which are
// not stored), rays in two words, invocations whose loops the driver stopped, and photons by how
// their path ended (the last entry is unused).
struct Counters {
    records: atomic<u32>,
    rays_low: atomic<u32>,
    rays_high: atomic<u32>,
    stopped: atomic<u32>,
    ends: array<atomic<u32>, 4>,
}

// Index of the invocation in a dispatch of workgroups of 64 laid out in rows.
fn invocation(gid: vec3u, groups: vec3u) -> u32 {
    return gid.y * groups.x * 64u + gid.x + dispatch.first;
}

//#if eye_trace || aov_trace || photon_trace || grid_sort_long || gather
// Returns true, and counts it, if the driver has stopped running loops. Mesa's software driver
// silently leaves every loop once all loops of an invocation together have run 65535 rounds; from
// then on each loop, including this one, is left after its first round. (`end` is below 2^31, which
// no compiler can know.)
fn loops_stopped() -> bool {
    let wanted = 2u + (dispatch.end >> 31u);
    var rounds = 0u;
    while rounds < wanted {
        rounds += 1u;
    }
    if rounds < wanted {
        atomicAdd(&counters.stopped, 1u);
        return true;
    }
    return false;
}
//#end

//#if local
// Twin of `scale_sq` in src/kernels/gather.rs.
fn local_scale_sq(s: Statistics) -> f32 {
    return select(s.scale_sq - s.drop, 1.0, s.scale_sq == 0.0);
}
//#end
