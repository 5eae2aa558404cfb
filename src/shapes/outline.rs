//! Outlines of flat shapes, and clipping of gather discs against them. A gather disc near an edge
//! extends past the outline, where no photon can land; the estimate divides by the area inside the
//! outline. If a wall stands on the shape, only the part of the disc on the query point's side of
//! the wall counts. Twin: `shaders/shapes/outline.wgsl`.

use super::math::trig::{arctan2, kept};
use super::math::{EPS, PI, max_abs, unit};
use super::real::{Plain, Real, Vec2, Vec3, Vec4};
use super::table::NONE;
use bytemuck::Zeroable;

/// Lower bound of the covered share of a disc.
const SHARE_MIN: Real = 1e-6;
/// Photons of an outline lie within this fraction of the disc's radius of its plane, plus the
/// rounding of their positions.
const DEPTH: Real = 0.02;
/// For ratios of radii above this, the circular segment inside the smaller circle is computed as a
/// parabolic one.
const SLIM: Real = 30.0;
/// Distance from the outline or from a wall, in units of [`Outline::error`], within which a photon
/// may lie on the adjacent face.
const MARGIN: Real = 0.25;
/// Error of a computed point on an infinite plane, as a fraction of its largest coordinate.
const PLANE_ERROR: Real = 16.0 * EPS;
/// Relative margin on a circle's squared radius; photons within it may lie on the surface that the
/// disc closes off.
const RIM: Real = 1e-5;
/// Greatest number of walls that clip one disc; further walls are ignored.
pub const CUTS: usize = 4;
/// Number of low bits of [`Outline::walls`] that store the number of walls.
pub const WALL_BITS: u32 = 6;
/// Greatest number of corners of a square clipped by the four edges of an outline and by walls.
const CORNERS: usize = 8 + CUTS;

/// Outline of a flat shape: a parallelogram `origin + s u + t v`, s and t in [0, 1], or a circle.
/// Scene units.
///
/// The same struct describes a wall on an outline: it stands on the segment `origin + s u`, on the
/// side that the unit vector `v` points to. An edge of a flat mesh region is a wall on both sides
/// and has `radius` 1.
#[repr(C)]
#[derive(Clone, Copy, Debug, Plain, Zeroable)]
pub struct Outline {
    /// Corner of the parallelogram (its offset along the normal has no effect) or centre of the
    /// circle.
    pub origin: Vec3,
    /// Radius of the circle; 0 for a parallelogram.
    pub radius: Real,
    /// First edge.
    pub u: Vec3,
    /// Bound on the distance of computed points from the plane.
    pub error: Real,
    /// Second edge.
    pub v: Vec3,
    /// Index of its first wall in the outline table << [`WALL_BITS`], | the number of walls.
    pub walls: u32,
    /// In-plane vector with `dual_u . u = 1` and `dual_u . v = 0`.
    pub dual_u: Vec3,
    /// Margin on s: photons with s this close to 0 or 1 may lie on the adjacent face.
    pub margin_s: Real,
    /// In-plane vector with `dual_v . v = 1` and `dual_v . u = 0`.
    pub dual_v: Vec3,
    /// Margin on t, likewise.
    pub margin_t: Real,
}

/// Clipping of a gather disc by the outline that its centre lies in.
#[derive(Clone, Copy, Debug)]
pub struct Clip {
    /// True if the outline or a wall passes through the disc.
    pub crossed: bool,
    /// Reciprocal of the share of the disc that the outline covers.
    pub whole: Real,
    /// The same for the concentric disc of half the area.
    pub inner: Real,
    /// Greatest distance of the outline's photons from its plane; the disc's radius if there is no
    /// outline.
    pub depth: Real,
    /// In-plane unit vector towards each wall within the disc, and the distance of the wall's line
    /// from the centre; entries from `count` on are (0, 0, 0, 1), which clips nothing.
    pub cuts: [Vec4; CUTS],
    /// Number of walls in `cuts`.
    pub count: u32,
}

/// Angle subtended at the origin by the piece from `start` to `end` of a line that passes at
/// `distance`.
fn turn(distance: Real, start: Real, end: Real) -> Real {
    arctan2(distance * (kept(end) - start), distance * distance + start * end)
}

/// Signed area of the intersection of the unit disc about the origin with the triangle formed by
/// the origin and a piece of a line. The line passes at `distance`, positive to the right; the
/// piece runs from `start` to `end` along it.
fn wedge(distance: Real, start: Real, end: Real) -> Real {
    let half_sq = 1.0 - distance * distance;
    let half = half_sq.max(0.0).sqrt();
    let enter = start.max(-half);
    let leave = end.min(half);
    if half_sq <= 0.0 || enter >= leave {
        return 0.5 * turn(distance, start, end);
    }
    let outside = turn(distance, start, enter) + turn(distance, leave, end);
    0.5 * (outside + distance * (leave - enter))
}

fn cross_2d(a: Vec2, b: Vec2) -> Real {
    a.x * b.y - a.y * b.x
}

/// Area of the intersection of the unit disc about the origin with the parallelogram
/// `corner + s (width, 0) + t v`.
fn parallelogram_area(corner: Vec2, width: Real, v: Vec2) -> Real {
    let length = v.dot(v).sqrt();
    let along = v * (1.0 / length);
    let far = corner + v;
    let side = Vec2::new(corner.x + width, corner.y);
    let left_start = corner.dot(along);
    let right_start = side.dot(along);
    let front = wedge(-corner.y, corner.x, side.x);
    let right = wedge(cross_2d(side, along), right_start, right_start + length);
    let back = wedge(-far.y, far.x, far.x + width);
    let left = wedge(cross_2d(corner, along), left_start, left_start + length);
    ((front - back) + (right - left)).abs()
}

/// Area of the intersection of the unit disc with a disc of `radius` whose centre is `distance`
/// away.
fn discs_area(distance: Real, radius: Real) -> Real {
    if distance + 1.0 <= radius {
        return PI;
    }
    if distance + radius <= 1.0 {
        return PI * radius * radius;
    }
    let x = 0.5 * ((distance - radius) * (distance + radius) + 1.0) / distance;
    let y = (1.0 - x * x).max(0.0).sqrt();
    let near = arctan2(y, x) - x * y;
    if radius < SLIM {
        let rest = distance - x;
        return near + (kept(radius * radius * arctan2(y, rest)) - rest * y);
    }
    // the other segment is too slim for a difference of terms: use the first term of its series
    near + 0.666_666_7 * (y * y) * (y / radius)
}

/// Share of the disc of `radius` about `position`, a point of `outline`, that the outline covers.
pub fn outline_share(outline: &Outline, position: Vec3, normal: Vec3, radius: Real) -> Real {
    let scale = 1.0 / radius;
    let d = (outline.origin - position) * scale;
    let area = if outline.radius > 0.0 {
        discs_area(d.dot(d).sqrt(), outline.radius * scale)
    } else {
        let first = unit(outline.u);
        let second = normal.cross(first);
        let corner = Vec2::new(d.dot(first), d.dot(second));
        let v = Vec2::new(outline.v.dot(first), outline.v.dot(second)) * scale;
        parallelogram_area(corner, outline.u.dot(first) * scale, v)
    };
    (area / PI).clamp(SHARE_MIN, 1.0)
}

/// Clips a convex polygon by the line at `distance` from the origin along the unit vector `normal`,
/// keeping the side of smaller distances. Returns the number of corners.
fn cut_polygon(polygon: &mut [Vec2; CORNERS], count: u32, normal: Vec2, distance: Real) -> u32 {
    let old = *polygon;
    let mut kept = 0;
    let mut a = old[(count.max(1) - 1) as usize];
    let mut da = a.dot(normal) - distance;
    for i in 0..count {
        let b = old[i as usize];
        let db = b.dot(normal) - distance;
        if (da < 0.0) != (db < 0.0) && kept < CORNERS as u32 {
            polygon[kept as usize] = a + (b - a) * (da / (da - db));
            kept += 1;
        }
        if db < 0.0 && kept < CORNERS as u32 {
            polygon[kept as usize] = b;
            kept += 1;
        }
        a = b;
        da = db;
    }
    kept
}

/// Share of the disc of `radius` about `position`, a point of the parallelogram, that the
/// parallelogram covers on the near side of all cuts.
fn cut_share(outline: &Outline, clip: &Clip, position: Vec3, normal: Vec3, radius: Real) -> Real {
    let first = unit(outline.u);
    let second = normal.cross(first);
    let d = position - outline.origin;
    let scale = 1.0 / radius;
    // start from a square about the unit disc, so that all corners have its scale
    let mut polygon = [Vec2::ZERO; CORNERS];
    polygon[0] = Vec2::new(-2.0, -2.0);
    polygon[1] = Vec2::new(2.0, -2.0);
    polygon[2] = Vec2::new(2.0, 2.0);
    polygon[3] = Vec2::new(-2.0, 2.0);
    let mut count = 4;
    // clip the square by the four edges of the parallelogram, then by the walls
    for k in 0..4 + clip.count {
        let mut toward = outline.dual_u;
        let mut distance;
        if k >= 4 {
            let cut = clip.cuts[(k - 4) as usize];
            toward = cut.truncate();
            distance = cut.w;
        } else {
            if k >= 2 {
                toward = outline.dual_v;
            }
            let place = d.dot(toward);
            let inverse = 1.0 / toward.dot(toward).sqrt();
            distance = if k % 2 == 0 { place } else { 1.0 - place } * inverse;
            toward *= if k % 2 == 0 { -inverse } else { inverse };
        }
        distance *= scale;
        if distance < 1.0 {
            let across = Vec2::new(toward.dot(first), toward.dot(second));
            count = cut_polygon(&mut polygon, count, across, distance);
        }
    }
    // add up the area of the unit disc inside the polygon, edge by edge
    let mut area = 0.0;
    let mut a = polygon[(count.max(1) - 1) as usize];
    for i in 0..count {
        let b = polygon[i as usize];
        let edge = b - a;
        let length = edge.dot(edge).sqrt();
        if length > 0.0 {
            let along = edge * (1.0 / length);
            let start = a.dot(along);
            area += wedge(cross_2d(a, along), start, start + length);
        }
        a = b;
    }
    (area.abs() / PI).clamp(SHARE_MIN, 1.0)
}

/// Finds the walls of `outline` that stand within the disc and stores their lines in `clip`.
fn find_cuts(
    outlines: &[Outline],
    outline: &Outline,
    position: Vec3,
    normal: Vec3,
    clip: &mut Clip,
    radius: Real,
) {
    let first = outline.walls >> WALL_BITS;
    let last = first + (outline.walls & ((1 << WALL_BITS) - 1));
    for i in first..last {
        let wall = &outlines[i as usize];
        let d = wall.origin - position;
        let rise = d.dot(wall.v);
        // walls on the other side, or on the opposite face of a box, do not count
        if (wall.v.dot(normal) > 0.5 || wall.radius > 0.0) && rise.abs() <= clip.depth {
            let place = (-d.dot(wall.u) / wall.u.dot(wall.u)).clamp(0.0, 1.0);
            let nearest = d + wall.u * place;
            if nearest.dot(nearest) < radius * radius && clip.count < CUTS as u32 {
                let across = unit(wall.v.cross(wall.u));
                let distance = d.dot(across);
                let toward = across * if distance < 0.0 { -1.0 } else { 1.0 };
                clip.cuts[clip.count as usize] =
                    toward.extend(distance.abs() - MARGIN * outline.error);
                clip.count += 1;
            }
        }
    }
}

/// Returns true if a point of the outline's plane lies on the near side of all cuts of a disc about
/// `center`.
pub fn before_walls(clip: &Clip, center: Vec3, position: Vec3) -> bool {
    let d = position - center;
    // unrolled: Mesa's software driver runs a loop for at most 65535 rounds
    let [a, b, c, e] = clip.cuts;
    d.dot(a.truncate()) < a.w
        && d.dot(b.truncate()) < b.w
        && d.dot(c.truncate()) < c.w
        && d.dot(e.truncate()) < e.w
}

/// Clips the disc of `radius` about `position`, a point of outline `number`, by that outline; the
/// disc stays whole if `number` is [`NONE`].
pub fn clip_at(
    outlines: &[Outline],
    number: u32,
    position: Vec3,
    normal: Vec3,
    radius: Real,
) -> Clip {
    let cuts = [Vec4::W; CUTS];
    let mut clip = Clip { crossed: false, whole: 1.0, inner: 1.0, depth: radius, cuts, count: 0 };
    if number == NONE {
        return clip;
    }
    let outline = &outlines[number as usize];
    let d = position - outline.origin;
    // does the outline cross the disc?
    if outline.radius > 0.0 {
        let within = outline.radius - radius;
        clip.crossed = within <= 0.0 || d.dot(d) > within * within;
    } else {
        let s = d.dot(outline.dual_u);
        let t = d.dot(outline.dual_v);
        let margin_s = s.min(1.0 - s).max(0.0);
        let margin_t = t.min(1.0 - t).max(0.0);
        let radius_sq = radius * radius;
        clip.crossed = margin_s * margin_s < radius_sq * outline.dual_u.dot(outline.dual_u)
            || margin_t * margin_t < radius_sq * outline.dual_v.dot(outline.dual_v);
    }
    clip.depth = DEPTH * radius + 2.0 * (outline.error + PLANE_ERROR * max_abs(position));
    // share of the disc inside the outline and before the walls
    find_cuts(outlines, outline, position, normal, &mut clip, radius);
    if clip.count > 0 {
        clip.crossed = true;
        clip.whole = 1.0 / cut_share(outline, &clip, position, normal, radius);
        clip.inner = 1.0 / cut_share(outline, &clip, position, normal, 0.707_106_77 * radius);
        return clip;
    }
    if clip.crossed {
        clip.whole = 1.0 / outline_share(outline, position, normal, radius);
        clip.inner = 1.0 / outline_share(outline, position, normal, 0.707_106_77 * radius);
    }
    clip
}

/// Returns true if a point of the outline's plane lies inside the outline and outside the margin
/// along its edges, where it may belong to the adjacent face.
pub fn in_outline(outline: &Outline, position: Vec3) -> bool {
    let d = position - outline.origin;
    if outline.radius > 0.0 {
        return d.dot(d) < outline.radius * outline.radius * (1.0 - RIM);
    }
    let s = d.dot(outline.dual_u);
    let t = d.dot(outline.dual_v);
    let (low_s, low_t) = (outline.margin_s, outline.margin_t);
    s > low_s && s < 1.0 - low_s && t > low_t && t < 1.0 - low_t
}

/// Sets the margins of an outline from its error.
pub fn with_margins(outline: Outline) -> Outline {
    let margin = |dual: Vec3| (MARGIN * outline.error * dual.dot(dual).sqrt()).min(0.25);
    Outline { margin_s: margin(outline.dual_u), margin_t: margin(outline.dual_v), ..outline }
}
