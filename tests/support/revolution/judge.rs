//! Allowed difference of an f32 hit from the oracle's.

use super::oracle::{self, OracleHit};
use super::profiles::Placed;
use super::rays::curve;
use glam::{DVec3, Vec3};

/// Allowed error relative to the distance, or to the surface's size if that is larger.
const DISTANCE: f64 = 1e-5;
/// Four roundings of the ray's and surface's coordinates.
const ROUNDINGS: f64 = 4.0 / 16_777_216.0;

/// Counts of rays whose first f32 hits differ from the oracle's.
#[derive(Clone, Default)]
pub struct Tally {
    pub rays: u64,
    pub hits: u64,
    /// Missed hits that rounding does not explain: the oracle's hit is not found, or one behind it
    /// is.
    pub lost: u64,
    /// False hits that rounding does not explain: the oracle has none, or a farther one.
    pub false_hits: u64,
    /// Hits whose error in distance rounding does not explain.
    pub off: u64,
    /// Largest error of all hits, and of those that rounding does not explain.
    pub worst: f64,
    pub worst_well: f64,
    /// Rays whose larger differences the ray's own rounding explains.
    pub ill_conditioned: u64,
    pub bracketed: u64,
    pub steps: [u64; 16],
}

impl Tally {
    pub fn wrong(&self) -> u64 {
        self.lost + self.false_hits + self.off
    }

    /// The counts in one line.
    pub fn report(&self) -> String {
        format!(
            "{} rays, {} hits; lost {}, false {}, off {}; ill-conditioned {} (worst {:.1e}); others' worst {:.1e}; bracketed {}; Newton steps {:?}",
            self.rays,
            self.hits,
            self.lost,
            self.false_hits,
            self.off,
            self.ill_conditioned,
            self.worst,
            self.worst_well,
            self.bracketed,
            self.steps
        )
    }

    pub fn add(mut self, o: Tally) -> Tally {
        self.rays += o.rays;
        self.hits += o.hits;
        self.lost += o.lost;
        self.false_hits += o.false_hits;
        self.off += o.off;
        self.worst = self.worst.max(o.worst);
        self.worst_well = self.worst_well.max(o.worst_well);
        self.ill_conditioned += o.ill_conditioned;
        self.bracketed += o.bracketed;
        self.steps.iter_mut().zip(o.steps).for_each(|(a, b)| *a += b);
        self
    }
}

/// Distance that represents a miss.
const MISS: f64 = 1e30;

/// Whether moving the ray by a few f32 roundings, across the surface that it grazes or sideways,
/// moves the true hit at least as far as `t`. No f32 solver can be more accurate than that.
fn excused(placed: &Placed, o: Vec3, d: Vec3, t: f64, first: Option<&OracleHit>) -> bool {
    let revolution = &placed.tables.revolutions[0];
    let scale = f64::from(revolution.scale);
    let (lo, ld) = oracle::local_ray(revolution, o, d);
    let mut directions = vec![DVec3::X, DVec3::Y, DVec3::Z];
    // towards the axis and away from it
    directions.extend(ld.cross(DVec3::Y).try_normalize());
    if let Some(first) = first {
        let p = lo + ld * first.t;
        let (_, v) = curve(&placed.segments[first.segment], first.parameter);
        let r = p.x.hypot(p.z).max(1e-30);
        directions.extend(DVec3::new(v.y * p.x / r, -v.x, v.y * p.z / r).try_normalize());
    }
    let size = scale + f64::from(revolution.center.abs().max_element().max(o.abs().max_element()));
    let shift = ROUNDINGS * size / scale;
    let mut shifts: Vec<DVec3> =
        directions.into_iter().flat_map(|n| [n * shift, n * -shift]).collect();
    // a ray along the axis may lie on it
    if ld.x.hypot(ld.z) < 1e-3 && lo.x.hypot(lo.z) < shift {
        shifts.push(DVec3::new(-lo.x, 0.0, -lo.z));
    }
    let moved = shifts
        .into_iter()
        .chain([DVec3::ZERO])
        .map(|s| oracle::all_hits(&placed.segments, lo + s, ld).first().map_or(MISS, |h| h.t));
    let (low, high) = moved.fold((MISS, 0.0), |(low, high), t| (t.min(low), t.max(high)));
    low <= t && t <= high
}

/// Compares a first hit at distance `found` with the oracle's. The caller counts Newton's steps.
pub fn judge(placed: &Placed, o: Vec3, d: Vec3, found: Option<f64>) -> Tally {
    let mut tally = Tally { rays: 1, ..Tally::default() };
    let revolution = &placed.tables.revolutions[0];
    let (lo, ld) = oracle::local_ray(revolution, o, d);
    let truth = oracle::all_hits(&placed.segments, lo, ld);
    tally.hits = u64::from(found.is_some());
    let (t, first) = (found.unwrap_or(MISS), truth.first().map_or(MISS, |first| first.t));
    let error = if t == first {
        0.0
    } else {
        (t - first).abs() / f64::from(revolution.scale).max(first.min(t))
    };
    let other = error > 1e-3;
    if !other {
        tally.worst = error;
    }
    if error <= DISTANCE {
        tally.worst_well = error;
    } else if excused(placed, o, d, t, truth.first()) {
        tally.ill_conditioned = 1;
    } else {
        tally.lost = u64::from(other && t > first);
        tally.false_hits = u64::from(other && t < first);
        tally.off = u64::from(!other);
        tally.worst_well = tally.worst;
    }
    tally
}
