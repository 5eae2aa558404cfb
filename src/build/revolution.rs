//! Cuts Bezier profiles into the patches that `shapes::revolution` intersects, and boxes them for the
//! kd-tree. All in f64; rounded to f32 at the end.

use glam::{DMat3, DQuat, DVec2, DVec3, Vec2, Vec3};

use super::bezier::{derivative, point, restrict, roots};
use crate::shapes::revolution::{MAX_DEGREE, Patch, Revolution};

/// Slope over the chord at which a piece of profile counts as flat: a bend of about 11 degrees to each side.
const FLAT_SLOPE: f64 = 0.2;
/// Halvings of a segment at most; what bends below that becomes a straight sliver.
const MAX_DEPTH: u32 = 24;
/// Part of its length by which a patch reaches over its neighbour on the same segment, so that no hit is
/// lost between them: both are the same polynomial there.
const OVERLAP: f64 = 1.0 / 64.0;
/// Bounds are widened by this, in local units: more than the intersection's rounding errors.
const BOUNDS_PAD: f64 = 2e-6;
/// Pieces of profile that are no longer than this, in local units, are left out: two roundings of their ends.
const SHORTEST: f64 = 1.2e-7;
/// Sectors of a ring that is thin against its radius; others get one box.
const SECTORS: u32 = 8;

/// Why a profile cannot be turned into a surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ProfileError {
    /// A segment has too few or too many control points.
    #[error("segment {segment} has {points} control points; a Bezier segment has 2 to {}", MAX_DEGREE + 1)]
    Degree {
        /// Index of the segment.
        segment: usize,
        /// Its number of control points.
        points: usize,
    },
    /// A coordinate, the scale or the placement is NaN or infinite, or the scale is not positive.
    #[error(
        "the profile or its transform holds a number that is not finite, or a scale that is not positive"
    )]
    NotFinite,
    /// Nothing is left of the surface: all points coincide or lie on the axis.
    #[error("the profile encloses no surface: it is a point, or lies on the axis")]
    Empty,
}

/// Rotation, uniform scale and translation from a profile's own coordinates to the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Applied first.
    pub rotation: DQuat,
    /// Positive.
    pub scale: f64,
    /// Applied last, scene units.
    pub translation: DVec3,
}

impl Default for Placement {
    fn default() -> Self {
        Self { rotation: DQuat::IDENTITY, scale: 1.0, translation: DVec3::ZERO }
    }
}

/// What the caller attaches to a surface; kept as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attributes {
    /// Index of the material.
    pub material: u32,
    /// Index of the light, or the caller's mark for none.
    pub light: u32,
    /// The caller's uv mode.
    pub uv: u32,
}

/// An axis-aligned box that encloses an angular sector of a patch, scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatchBox {
    /// Index of the patch.
    pub patch: u32,
    /// Least corner.
    pub min: Vec3,
    /// Greatest corner.
    pub max: Vec3,
}

/// All surfaces of revolution of a scene, as the kernels read them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RevolutionTables {
    /// One for each surface.
    pub revolutions: Vec<Revolution>,
    /// The patches of all surfaces.
    pub patches: Vec<Patch>,
    /// Control points of all patches, in chord coordinates.
    pub profile_points: Vec<Vec2>,
}

/// A piece [t0, t1] of a segment that is a graph over its chord.
struct Piece {
    t0: f64,
    t1: f64,
    points: Vec<DVec2>,
    slope: f64,
    wobble: f64,
}

impl RevolutionTables {
    /// Adds the surface that `segments` (control points (radius, height), any degree from 1 to 15) make about
    /// the y axis, placed in the scene, and returns the boxes of its patches.
    ///
    /// # Errors
    /// When the profile is no surface; nothing is added then.
    pub fn push(
        &mut self,
        segments: &[Vec<DVec2>],
        placement: &Placement,
        attributes: Attributes,
    ) -> Result<Vec<PatchBox>, ProfileError> {
        check(segments, placement)?;
        let all = segments.iter().flatten();
        let (low, high) =
            all.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(a, b), p| (a.min(*p), b.max(*p)));
        let middle = 0.5 * (low.y + high.y);
        let size = (0.5 * (high.y - low.y)).max(high.x.abs()).max(low.x.abs());
        if !(size > 0.0 && size.is_finite()) {
            return Err(ProfileError::Empty);
        }
        // The kernels' frame is what f32 leaves of this one.
        let revolution = frame(placement, middle, size, segments.len(), attributes);
        let to_local = |p: &DVec2| DVec2::new(p.x, p.y - middle) / size;
        let mut boxes = Vec::new();
        let before = (self.patches.len(), self.profile_points.len());
        for (index, segment) in segments.iter().enumerate() {
            let local: Vec<DVec2> = segment.iter().map(to_local).collect();
            for piece in pieces(&local) {
                self.push_piece(&piece, index as u32, &revolution, &mut boxes);
            }
        }
        if boxes.is_empty() {
            self.patches.truncate(before.0);
            self.profile_points.truncate(before.1);
            return Err(ProfileError::Empty);
        }
        self.revolutions.push(revolution);
        Ok(boxes)
    }

    fn push_piece(
        &mut self,
        piece: &Piece,
        segment: u32,
        revolution: &Revolution,
        boxes: &mut Vec<PatchBox>,
    ) {
        let (first, last) = (piece.points[0], piece.points[piece.points.len() - 1]);
        let length = first.distance(last);
        let reach = piece.points.iter().fold(0.0_f64, |a, p| a.max(p.x));
        if !(length > SHORTEST && reach > 1e-9) {
            return;
        }
        // The origin and frame that f32 holds; the control points make up for their rounding.
        let origin = first.as_vec2();
        let axis = ((last - first) / length).as_vec2();
        let (o, e) = (origin.as_dvec2(), axis.as_dvec2());
        let chord = |p: DVec2| {
            let q = p - o;
            DVec2::new(e.dot(q), e.y * q.x - e.x * q.y) / e.length_squared()
        };
        let local: Vec<DVec2> = piece.points.iter().map(|&p| chord(p)).collect();
        let low = piece.points.iter().fold(DVec2::INFINITY, |a, p| a.min(*p)) - BOUNDS_PAD;
        let high = piece.points.iter().fold(DVec2::NEG_INFINITY, |a, p| a.max(*p)) + BOUNDS_PAD;
        let (phi_min, phi_max) = local.iter().fold((0.0_f64, 0.0_f64), |(a, b), p| (a.min(p.y), b.max(p.y)));
        let patch = Patch {
            revolution: self.revolutions.len() as u32,
            segment,
            first_point: self.profile_points.len() as u32,
            degree: (local.len() - 1) as u32,
            origin,
            axis,
            r_min: low.x.max(0.0) as f32,
            r_max: high.x as f32,
            y_min: low.y as f32,
            y_max: high.y as f32,
            phi_min: (phi_min - 2e-7) as f32,
            phi_max: (phi_max + 2e-7) as f32,
            slope: (piece.slope * 1.001 + 1e-6) as f32,
            length: local[local.len() - 1].x as f32,
            t0: piece.t0 as f32,
            t1: piece.t1 as f32,
            wobble: (piece.wobble * 1.001 + 1e-6) as f32,
            padding: 0,
        };
        let index = self.patches.len() as u32;
        self.patches.push(patch);
        self.profile_points.extend(local.iter().map(|p| p.as_vec2()));
        let sectors = if f64::from(patch.r_min) > 0.4 * reach { SECTORS } else { 1 };
        boxes.extend((0..sectors).map(|k| sector_box(revolution, index, &piece.points, k, sectors)));
    }
}

fn check(segments: &[Vec<DVec2>], placement: &Placement) -> Result<(), ProfileError> {
    for (segment, points) in segments.iter().enumerate() {
        if !(2..=MAX_DEGREE + 1).contains(&points.len()) {
            return Err(ProfileError::Degree { segment, points: points.len() });
        }
    }
    let finite = segments.iter().flatten().all(|p| p.is_finite())
        && placement.rotation.is_finite()
        && placement.translation.is_finite()
        && placement.scale.is_finite()
        && placement.scale > 0.0;
    if finite { Ok(()) } else { Err(ProfileError::NotFinite) }
}

fn frame(
    placement: &Placement,
    middle: f64,
    size: f64,
    segments: usize,
    attributes: Attributes,
) -> Revolution {
    let axes = DMat3::from_quat(placement.rotation.normalize());
    let scale = placement.scale * size;
    Revolution {
        x_axis: axes.x_axis.as_vec3(),
        scale: scale as f32,
        y_axis: axes.y_axis.as_vec3(),
        inv_scale: (1.0 / scale) as f32,
        z_axis: axes.z_axis.as_vec3(),
        segments: segments as u32,
        center: (placement.translation + axes.y_axis * (placement.scale * middle)).as_vec3(),
        material: attributes.material,
        light: attributes.light,
        uv: attributes.uv,
        padding: [0; 2],
    }
}

/// Cuts a segment (local units) where it has a cusp or crosses the axis, and then in halves until every
/// piece is a flat graph over its chord. Pieces on the far side of the axis are mirrored to radius >= 0.
fn pieces(segment: &[DVec2]) -> Vec<Piece> {
    let mut out = Vec::new();
    let extent = segment.iter().fold(0.0_f64, |a, p| a.max(p.distance(segment[0])));
    if extent < 1e-9 {
        return out;
    }
    let velocity = derivative(segment);
    let speed = velocity.iter().fold(0.0_f64, |a, v| a.max(v.length()));
    let component = |points: &[DVec2], of: fn(&DVec2) -> f64| points.iter().map(of).collect::<Vec<f64>>();
    let mut cuts = roots(&component(segment, |p| p.x), 1e-12);
    let stops = [component(&velocity, |v| v.x), component(&velocity, |v| v.y)];
    let stops = stops.iter().flat_map(|c| roots(c, 1e-12 * speed));
    cuts.extend(stops.filter(|&t| point(&velocity, t).length() < 1e-6 * speed));
    cuts.extend([0.0, 1.0]);
    cuts.sort_by(f64::total_cmp);
    cuts.dedup_by(|b, a| *b - *a < 1e-6);
    for w in cuts.windows(2) {
        let side =
            if point(segment, 0.5 * (w[0] + w[1])).x < 0.0 { DVec2::new(-1.0, 1.0) } else { DVec2::ONE };
        let mirrored: Vec<DVec2> = segment.iter().map(|&p| p * side).collect();
        halve(&mirrored, [w[0], w[1]], w[0], w[1], 0, &mut out);
    }
    out
}

fn halve(segment: &[DVec2], limits: [f64; 2], t0: f64, t1: f64, depth: u32, out: &mut Vec<Piece>) {
    let over = OVERLAP * (t1 - t0);
    let (a, b) = ((t0 - over).max(limits[0]), (t1 + over).min(limits[1]));
    let points = restrict(segment, a, b);
    if let Some((slope, wobble)) = slopes(&points) {
        out.push(Piece { t0: a, t1: b, points, slope, wobble });
    } else if depth < MAX_DEPTH {
        let middle = 0.5 * (t0 + t1);
        halve(segment, limits, t0, middle, depth + 1, out);
        halve(segment, limits, middle, t1, depth + 1, out);
    } else {
        let ends = vec![points[0], points[points.len() - 1]];
        out.push(Piece { t0: a, t1: b, points: ends, slope: 0.0, wobble: 0.0 });
    }
}

/// Bounds on |dh/ds| of a curve over its chord and on how far it leaves the range between its ends, from the
/// legs of its control polygon (variation diminishing: dh/ds is a rational Bezier function with their slopes
/// as coefficients). None when it is no flat graph.
fn slopes(points: &[DVec2]) -> Option<(f64, f64)> {
    let chord = points[points.len() - 1] - points[0];
    let length = chord.length();
    if length < 1e-12 {
        return None;
    }
    let e = chord / length;
    // A leg of no length (at a cusp) turns no tangent.
    let legs = points.windows(2).map(|w| w[1] - w[0]).filter(|leg| leg.length() > 1e-7 * length);
    let slope = |leg: DVec2| if e.dot(leg) > 0.0 { leg.perp_dot(e) / e.dot(leg) } else { f64::INFINITY };
    let slopes: Vec<f64> = legs.map(slope).collect();
    let bound = slopes.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
    if bound > FLAT_SLOPE {
        return None;
    }
    let variation: f64 = slopes.windows(2).map(|w| (w[1] - w[0]).abs()).sum();
    let net = slopes[slopes.len() - 1] - slopes[0];
    Some((bound, 0.5 * (variation - net.abs())))
}

/// Box of sector `k` of `sectors` of the ring that the hull of `points` (local r, y) sweeps.
fn sector_box(revolution: &Revolution, patch: u32, points: &[DVec2], k: u32, sectors: u32) -> PatchBox {
    let [from, to] = [k, k + 1].map(|i| std::f64::consts::TAU * f64::from(i) / f64::from(sectors));
    let scale = f64::from(revolution.scale);
    let center = revolution.center.as_dvec3();
    let axes = [revolution.x_axis, revolution.y_axis, revolution.z_axis].map(Vec3::as_dvec3);
    // Largest value over the sector of the scene direction's component; linear in the hull's points.
    let support = |direction: DVec3| {
        let [x, y, z] = axes.map(|a| a.dot(direction));
        let (g_min, g_max) = cosine_range(x, z, from, to);
        let value = |p: &DVec2| p.x * (if p.x >= 0.0 { g_max } else { g_min }) + p.y * y;
        points.iter().map(value).fold(f64::NEG_INFINITY, f64::max)
    };
    let pad = BOUNDS_PAD + 1e-6 * center.abs().max_element() / scale;
    let extent = |sign: f64| {
        DVec3::from_array([DVec3::X, DVec3::Y, DVec3::Z].map(|e| sign * (support(e * sign) + pad)))
    };
    PatchBox {
        patch,
        min: (center + extent(-1.0) * scale).as_vec3(),
        max: (center + extent(1.0) * scale).as_vec3(),
    }
}

/// Range of x cos a + z sin a for a in [from, to], within one turn.
fn cosine_range(x: f64, z: f64, from: f64, to: f64) -> (f64, f64) {
    let at = |a: f64| x * a.cos() + z * a.sin();
    let (mut low, mut high) = (at(from).min(at(to)), at(from).max(at(to)));
    let peak = z.atan2(x);
    let holds = |a: f64| (a - from).rem_euclid(std::f64::consts::TAU) <= to - from;
    if holds(peak) {
        high = x.hypot(z);
    }
    if holds(peak + std::f64::consts::PI) {
        low = -x.hypot(z);
    }
    (low, high)
}
