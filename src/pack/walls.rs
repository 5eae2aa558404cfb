//! Walls: flat shapes that stand on outlines and planes, and separate what lies on their two sides.

use super::flat_regions::{self, Region};
use super::real::{ToDouble, ToReal, Vec3};
use super::shapes::outline::WALL_BITS;
use super::shapes::rectangle::rectangle_error;
use super::tables::*;
use bytemuck::Zeroable;
use glam::DVec3;
use rayon::prelude::*;

/// Maximum cosine of the angle between the normals of a wall and of the floor below it.
const STEEP: f64 = 0.5;
/// Maximum gap between a wall and the floor below it, relative to the wall's height.
const GAP: f64 = 1e-3;
/// Distance from an edge, in edge lengths, within which a foot belongs to the outline itself.
const EDGE: f64 = 1e-4;
/// Maximum number of walls of one outline; the longest ones are kept.
const WALLS: usize = (1 << WALL_BITS) - 1;
/// Maximum number of pairs of outline and polygon that are tested. If there are more, triangles are
/// not tested as walls, or there are no walls at all.
const PAIRS: usize = 1 << 26;
/// Edge length of the outline of an infinite plane, in scene units.
const ENDLESS: f64 = (1u64 << 30) as f64;

/// A flat shape on which walls may stand.
struct Floor {
    point: DVec3,
    normal: DVec3,
    outline: Outline,
    /// The outline or plane that it belongs to.
    place: FloorId,
    /// Edges of a mesh region that are not on the outline.
    edges: Vec<[DVec3; 2]>,
    /// True if walls are searched for on it.
    walls: bool,
}

impl Floor {
    fn new(point: DVec3, normal: DVec3, outline: Outline, place: FloorId) -> Self {
        Self { point, normal, outline, place, edges: Vec::new(), walls: true }
    }
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum FloorId {
    Outline(u32),
    Plane(usize),
}

/// A rectangle or triangle that may be a wall.
#[derive(Clone, Copy)]
struct Polygon {
    corners: [DVec3; 4],
    count: usize,
    low: DVec3,
    high: DVec3,
}

impl Polygon {
    fn new(points: &[Vec3]) -> Polygon {
        let mut corners = [DVec3::ZERO; 4];
        let count = points.len().min(corners.len());
        corners.iter_mut().zip(points).for_each(|(corner, p)| *corner = p.to_double());
        let (low, high) = (corners[..count].iter().copied(), corners[..count].iter().copied());
        Polygon {
            corners,
            count,
            low: low.reduce(DVec3::min).unwrap_or_default(),
            high: high.reduce(DVec3::max).unwrap_or_default(),
        }
    }

    fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }
}

/// Foot of a wall, or an edge of a mesh region.
#[derive(Clone, Copy)]
struct Foot {
    from: DVec3,
    to: DVec3,
    up: DVec3,
    /// True if it counts on both sides of the floor.
    both: bool,
}

/// Adds outlines for the flat regions of meshes, the walls that stand on outlines, and outlines for
/// planes with walls.
pub fn find_walls(out: &mut SceneTables) {
    let regions = flat_regions::regions(out);
    flat_regions::add_outlines(out, &regions);
    let mut floors = floors(out);
    let first = out.outlines.len() - regions.len();
    let floor = |(k, region): (usize, Region)| Floor {
        point: region.point,
        normal: region.normal,
        outline: region.outline,
        place: FloorId::Outline((first + k) as u32),
        edges: region.edges,
        walls: true,
    };
    let flat = regions.into_iter().enumerate().map(floor);
    let mut polygons = polygons(out);
    if (floors.len() + flat.len()) * (polygons.len() + out.triangles.len()) <= PAIRS {
        floors.extend(flat);
    } else {
        floors.extend(flat.map(|floor| Floor { walls: false, ..floor }));
    }
    if floors.len() * (polygons.len() + out.triangles.len()) <= PAIRS {
        polygons.extend(out.triangles.iter().map(|t| Polygon::new(&[t.p0, t.p1, t.p2])));
    }
    if floors.len() * polygons.len() > PAIRS {
        return;
    }
    let mut found: Vec<(FloorId, Outline, Vec<Foot>)> = floors
        .par_iter()
        .map(|f| (f.place, f.outline, feet(f, &polygons)))
        .filter(|(_, _, feet)| !feet.is_empty())
        .collect();
    // opposite faces of a cuboid share an outline
    found.sort_by_key(|(place, ..)| *place);
    for same in found.chunk_by(|a, b| a.0 == b.0) {
        let mut feet: Vec<Foot> = same.iter().flat_map(|(_, _, feet)| feet).copied().collect();
        let length = |f: &Foot| f.from.distance_squared(f.to);
        feet.sort_by(|a, b| length(b).total_cmp(&length(a)));
        feet.truncate(WALLS);
        let index = match same[0].0 {
            FloorId::Outline(index) => index as usize,
            FloorId::Plane(plane) => {
                out.planes[plane].outline = out.outlines.len() as u32;
                out.outlines.push(same[0].1);
                out.outlines.len() - 1
            }
        };
        out.outlines[index].walls = (out.outlines.len() as u32) << WALL_BITS | feet.len() as u32;
        out.outlines.extend(feet.iter().map(|f| Outline {
            origin: f.from.to_real(),
            u: (f.to - f.from).to_real(),
            v: f.up.to_real(),
            radius: if f.both { 1.0 } else { 0.0 },
            ..Outline::zeroed()
        }));
    }
}

fn floors(out: &SceneTables) -> Vec<Floor> {
    let mut floors = Vec::new();
    for r in &out.rectangles {
        let outline = out.outlines[r.outline as usize];
        let (point, normal) = (r.origin.to_double(), r.normal.to_double());
        floors.push(Floor::new(point, normal, outline, FloorId::Outline(r.outline)));
    }
    for c in &out.cuboids {
        for face in 0..6 {
            let axis = face % 3;
            let (corner, sign) = if face < 3 { (c.lower, -1.0) } else { (c.upper, 1.0) };
            let index = c.outline + axis as u32;
            let outline = out.outlines[index as usize];
            let normal =
                DVec3::from_array(std::array::from_fn(|i| if i == axis { sign } else { 0.0 }));
            floors.push(Floor::new(corner.to_double(), normal, outline, FloorId::Outline(index)));
        }
    }
    for (i, plane) in out.planes.iter().enumerate() {
        let (point, normal) = (plane.point.to_double(), plane.normal.to_double());
        let u = plane.tangent.to_double().normalize();
        let v = normal.cross(u);
        let outline = Outline {
            origin: (point - (u + v) * (0.5 * ENDLESS)).to_real(),
            u: (u * ENDLESS).to_real(),
            v: (v * ENDLESS).to_real(),
            dual_u: (u / ENDLESS).to_real(),
            dual_v: (v / ENDLESS).to_real(),
            error: rectangle_error(&Rectangle {
                origin: plane.point,
                u: Vec3::X,
                v: Vec3::Y,
                ..Rectangle::zeroed()
            }),
            ..Outline::zeroed()
        };
        floors.push(Floor::new(point, normal, outline, FloorId::Plane(i)));
    }
    floors
}

/// Rectangles and faces of cuboids, which may be walls.
fn polygons(out: &SceneTables) -> Vec<Polygon> {
    let mut polygons = Vec::new();
    for r in &out.rectangles {
        let (o, u, v) = (r.origin, r.u, r.v);
        polygons.push(Polygon::new(&[o, o + u, o + u + v, o + v]));
    }
    for c in &out.cuboids {
        for face in 0..6 {
            let axis = face % 3;
            let (b, d) = ((axis + 1) % 3, (axis + 2) % 3);
            let corners =
                [(false, false), (true, false), (true, true), (false, true)].map(|(on_b, on_d)| {
                    let mut p = if face < 3 { c.lower } else { c.upper };
                    p[b] = if on_b { c.upper[b] } else { c.lower[b] };
                    p[d] = if on_d { c.upper[d] } else { c.lower[d] };
                    p
                });
            polygons.push(Polygon::new(&corners));
        }
    }
    polygons
}

/// Edges of a floor, and feet of the walls that stand elsewhere on it.
fn feet(floor: &Floor, polygons: &[Polygon]) -> Vec<Foot> {
    let edge =
        |[from, to]: &[DVec3; 2]| Foot { from: *from, to: *to, up: floor.normal, both: true };
    let mut feet: Vec<Foot> = floor.edges.iter().map(edge).collect();
    if floor.walls {
        let inside = |foot: &Foot| !floor.edges.iter().any(|edge| along(edge, foot));
        feet.extend(polygons.iter().flat_map(|p| feet_of(floor, p)).filter(inside));
    }
    feet
}

/// Returns whether a foot lies on an edge of the floor.
fn along([a, b]: &[DVec3; 2], foot: &Foot) -> bool {
    let (length, direction) = (a.distance(*b), (*b - *a).normalize_or_zero());
    [foot.from, foot.to].iter().all(|p| {
        let place = (*p - *a).dot(direction).clamp(0.0, length);
        p.distance(*a + direction * place) <= EDGE * length
    })
}

/// Feet of a polygon on the two sides of a floor.
fn feet_of(floor: &Floor, polygon: &Polygon) -> impl Iterator<Item = Foot> {
    let error = 8.0 * f64::from(floor.outline.error);
    // most boxes lie off the plane
    let (center, half) = (0.5 * (polygon.low + polygon.high), 0.5 * (polygon.high - polygon.low));
    let reach = (1.0 + 2.0 * GAP) * half.dot(floor.normal.abs()) + error;
    let near = (center - floor.point).dot(floor.normal).abs() <= reach;
    let sides =
        near.then(|| [foot(floor, floor.normal, polygon), foot(floor, -floor.normal, polygon)]);
    sides.into_iter().flatten().flatten()
}

/// Foot of a polygon that stands on the side of a floor that `up` points to.
fn foot(floor: &Floor, up: DVec3, polygon: &Polygon) -> Option<Foot> {
    let polygon = polygon.corners();
    let heights = || polygon.iter().map(|p| (*p - floor.point).dot(up));
    let top = heights().fold(f64::NEG_INFINITY, f64::max);
    let bottom = heights().fold(f64::INFINITY, f64::min);
    let error = 4.0 * f64::from(floor.outline.error);
    let level = GAP * (top - bottom) + error;
    if bottom > level || top < 4.0 * level {
        return None;
    }
    let across = (polygon[1] - polygon[0]).cross(polygon[2] - polygon[0]);
    if across.dot(floor.normal).abs() > STEEP * across.length() {
        return None;
    }
    // intersect its edges with a level just above the floor
    let mut ends = Vec::new();
    for (i, a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (ha, hb) = ((*a - floor.point).dot(up) - level, (b - floor.point).dot(up) - level);
        if (ha < 0.0) != (hb < 0.0) {
            let p = *a + (b - *a) * (ha / (ha - hb));
            ends.push(p - up * (p - floor.point).dot(up));
        }
    }
    let (from, to) = (*ends.first()?, *ends.get(1)?);
    if from.distance(to) <= error || !within(&floor.outline, from, to) {
        return None;
    }
    Some(Foot { from, to, up, both: false })
}

/// Returns whether a foot crosses the inside of an outline.
fn within(outline: &Outline, from: DVec3, to: DVec3) -> bool {
    [outline.dual_u, outline.dual_v].iter().all(|dual| {
        let place = |p: DVec3| (p - outline.origin.to_double()).dot(dual.to_double());
        place(from).max(place(to)) > EDGE && place(from).min(place(to)) < 1.0 - EDGE
    })
}
