//! Outlines of the flat regions of meshes, so that a box or a room that was modelled as triangles
//! gets the same outlines as a `box` shape.
//!
//! A region is a maximal set of coplanar triangles that share edges. It gets an outline if all of
//! its boundary is open or a crease. Triangles of curved surfaces are in no region.

use super::materials::Bsdf;
use super::real::{Real, ToDouble, ToReal, Vec3};
use super::shapes::outline::with_margins;
use super::tables::*;
use bytemuck::Zeroable;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Scenes with more triangles get no outlines.
const TRIANGLES: usize = 1 << 20;
/// Maximum number of regions that get an outline, the largest ones.
const REGIONS: usize = 256;
/// Maximum number of edges off the bounding rectangle of a region; the longest ones are kept.
const EDGES: usize = 31;
/// Minimum fraction of the length of all edges off the bounding rectangle that these edges must
/// cover.
const COVERED: f64 = 0.9;
/// Cosine of the angle between the normals of two adjacent triangles above which they belong to one
/// curved surface.
const SOFT: f64 = 0.866;
/// Error of a vertex relative to the largest coordinate, in both precisions.
const VERTEX_ERROR: f64 = 4.0 * f32::EPSILON as f64;

/// A flat region of a mesh with its outline.
pub struct Region {
    /// Indices of its triangles.
    pub triangles: Vec<u32>,
    /// Bounding rectangle.
    pub outline: Outline,
    /// A point in its plane.
    pub point: DVec3,
    /// Unit normal of its plane.
    pub normal: DVec3,
    /// Boundary edges that are not on the bounding rectangle.
    pub edges: Vec<[DVec3; 2]>,
}

/// Union-find structure over indices.
struct Sets(Vec<u32>);

impl Sets {
    fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    fn find(&mut self, i: u32) -> u32 {
        let mut i = i;
        while self.0[i as usize] != i {
            self.0[i as usize] = self.0[self.0[i as usize] as usize];
            i = self.0[i as usize];
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b) as usize] = a.min(b);
    }

    /// All sets, each with its members in ascending order.
    fn all(&mut self, members: impl Iterator<Item = u32>) -> Vec<Vec<u32>> {
        let mut number: HashMap<u32, usize> = HashMap::new();
        let mut sets: Vec<Vec<u32>> = Vec::new();
        for i in members {
            let root = self.find(i);
            let k = *number.entry(root).or_insert_with(|| {
                sets.push(Vec::new());
                sets.len() - 1
            });
            sets[k].push(i);
        }
        sets
    }
}

/// Relation of two triangles that share an edge.
#[derive(PartialEq)]
enum Meeting {
    Flat,
    Soft,
    Crease,
}

/// All triangles, with merged vertices.
struct Surface {
    corners: Vec<[DVec3; 3]>,
    /// Unit normals; zero for a triangle without area.
    normals: Vec<DVec3>,
    vertices: Vec<[u32; 3]>,
    /// True for each triangle on which photons are stored.
    rough: Vec<bool>,
}

impl Surface {
    fn new(out: &SceneTables) -> Self {
        let corners: Vec<[DVec3; 3]> =
            out.triangles.par_iter().map(|t| [t.p0, t.p1, t.p2].map(|p| p.to_double())).collect();
        let normal = |[a, b, c]: &[DVec3; 3]| (*b - *a).cross(*c - *a).normalize_or_zero();
        let mut ids: HashMap<[u64; 3], u32> = HashMap::with_capacity(corners.len());
        let mut id = |p: &DVec3| {
            let count = ids.len() as u32;
            *ids.entry((*p + DVec3::ZERO).to_array().map(f64::to_bits)).or_insert(count)
        };
        let vertices = corners.iter().map(|[a, b, c]| [id(a), id(b), id(c)]).collect();
        let specular = |m: u32| Bsdf::of(out.materials[m as usize].kind).is_specular();
        Self {
            normals: corners.par_iter().map(normal).collect(),
            rough: out.triangles.iter().map(|t| !specular(t.material)).collect(),
            corners,
            vertices,
        }
    }

    /// Error bound of a triangle's vertices, in scene units.
    fn error(&self, t: u32) -> f64 {
        let largest = self.corners[t as usize].iter().fold(DVec3::ZERO, |a, p| a.max(p.abs()));
        VERTEX_ERROR * largest.max_element()
    }

    /// Key, triangle and corner of each edge; entries of the same edge are adjacent.
    fn edges(&self) -> Vec<(u64, u32, u8)> {
        let mut edges: Vec<(u64, u32, u8)> = (0..self.corners.len() as u32)
            .into_par_iter()
            .filter(|t| self.rough[*t as usize] && self.normals[*t as usize] != DVec3::ZERO)
            .flat_map_iter(|t| {
                let v = self.vertices[t as usize];
                (0..3u8).map(move |k| {
                    let (a, b) = (v[k as usize], v[(k as usize + 1) % 3]);
                    (u64::from(a.min(b)) << 32 | u64::from(a.max(b)), t, k)
                })
            })
            .collect();
        edges.par_sort_unstable();
        edges
    }

    fn meeting(&self, (s, j): (u32, u8), (t, k): (u32, u8)) -> Meeting {
        let across = |t: u32, k: u8| self.corners[t as usize][(k as usize + 2) % 3];
        let (from, to) =
            (self.corners[s as usize][j as usize], self.corners[s as usize][(j as usize + 1) % 3]);
        let (n, m) = (self.normals[s as usize], self.normals[t as usize]);
        let (a, b) = (across(s, j) - from, across(t, k) - from);
        let inward = n.cross(to - from);
        // folded back on itself
        if (b.dot(inward) < 0.0) == (a.dot(inward) < 0.0) {
            return Meeting::Crease;
        }
        let error = 2.0 * (self.error(s) + self.error(t));
        if b.dot(n).abs() <= error && a.dot(m).abs() <= error {
            Meeting::Flat
        } else if n.dot(m).abs() > SOFT {
            Meeting::Soft
        } else {
            Meeting::Crease
        }
    }
}

/// Finds the flat regions of the meshes.
pub fn regions(out: &SceneTables) -> Vec<Region> {
    if out.triangles.is_empty() || out.triangles.len() > TRIANGLES {
        return Vec::new();
    }
    let surface = Surface::new(out);
    let edges = surface.edges();
    let count = surface.corners.len();
    let (mut sets, mut soft) = (Sets::new(count), vec![false; count]);
    let mut boundary: Vec<(u32, u8)> = Vec::new();
    for group in edges.chunk_by(|a, b| a.0 == b.0) {
        match group {
            [(_, s, j), (_, t, k)] => match surface.meeting((*s, *j), (*t, *k)) {
                Meeting::Flat => sets.join(*s, *t),
                Meeting::Soft => {
                    soft[*s as usize] = true;
                    soft[*t as usize] = true;
                }
                Meeting::Crease => boundary.extend([(*s, *j), (*t, *k)]),
            },
            _ => boundary.extend(group.iter().map(|(_, t, k)| (*t, *k))),
        }
    }
    let mut sides: HashMap<u32, Vec<(u32, u8)>> = HashMap::new();
    boundary.into_iter().for_each(|(t, k)| sides.entry(sets.find(t)).or_default().push((t, k)));
    let flat = (0..count as u32).filter(|t| surface.rough[*t as usize]);
    let mut found: Vec<(f64, Vec<u32>)> = sets
        .all(flat)
        .into_iter()
        .filter(|set| !set.iter().any(|t| soft[*t as usize]))
        .map(|set| (set.iter().map(|t| area(&surface.corners[*t as usize])).sum(), set))
        .collect();
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.truncate(REGIONS);
    let region = |(_, set): (f64, Vec<u32>)| {
        let root = sets.find(set[0]);
        region(&surface, set, sides.get(&root)?)
    };
    found.into_iter().filter_map(region).collect()
}

fn area([a, b, c]: &[DVec3; 3]) -> f64 {
    0.5 * (*b - *a).cross(*c - *a).length()
}

fn region(surface: &Surface, triangles: Vec<u32>, sides: &[(u32, u8)]) -> Option<Region> {
    let size = |t: &&u32| area(&surface.corners[**t as usize]);
    let largest = *triangles.iter().max_by(|a, b| size(a).total_cmp(&size(b)))?;
    let (point, normal) = (surface.corners[largest as usize][0], surface.normals[largest as usize]);
    let error = triangles.iter().map(|t| surface.error(*t)).fold(0.0, f64::max);
    let off = |p: &DVec3| (*p - point).dot(normal).abs() > 4.0 * error;
    if normal == DVec3::ZERO
        || triangles.iter().any(|t| surface.corners[*t as usize].iter().any(off))
    {
        return None;
    }
    let edges = joined(surface, sides, error);
    let length = |[a, b]: &[DVec3; 2]| a.distance(*b);
    let longest = edges.iter().max_by(|a, b| length(a).total_cmp(&length(b)))?;
    let u = (longest[1] - longest[0]).reject_from(normal).try_normalize()?;
    let v = normal.cross(u);
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    let place = |p: DVec3| [(p - point).dot(u), (p - point).dot(v)];
    for p in edges.iter().flatten() {
        for (i, x) in place(*p).into_iter().enumerate() {
            (low[i], high[i]) = (low[i].min(x), high[i].max(x));
        }
    }
    let (width, height) = (high[0] - low[0], high[1] - low[1]);
    let on_rectangle = |edge: &[DVec3; 2]| {
        let near = |i: usize, x: f64| edge.iter().all(|p| (place(*p)[i] - x).abs() <= 4.0 * error);
        (0..2).any(|i| near(i, low[i]) || near(i, high[i]))
    };
    let mut edges: Vec<[DVec3; 2]> = edges.into_iter().filter(|edge| !on_rectangle(edge)).collect();
    edges.sort_by(|a, b| length(b).total_cmp(&length(a)));
    let total: f64 = edges.iter().map(length).sum();
    edges.truncate(EDGES);
    if edges.iter().map(length).sum::<f64>() < COVERED * total || width.min(height) <= 16.0 * error
    {
        return None;
    }
    let outline = with_margins(Outline {
        origin: (point + u * low[0] + v * low[1]).to_real(),
        u: (u * width).to_real(),
        v: (v * height).to_real(),
        dual_u: (u / width).to_real(),
        dual_v: (v / height).to_real(),
        error: (4.0 * error) as Real,
        ..Outline::zeroed()
    });
    Some(Region { triangles, outline, point, normal, edges })
}

/// The boundary, with chains of collinear edges merged.
fn joined(surface: &Surface, sides: &[(u32, u8)], error: f64) -> Vec<[DVec3; 2]> {
    let end = |(t, k): (u32, u8), i: usize| {
        let corner = (k as usize + i) % 3;
        (surface.vertices[t as usize][corner], surface.corners[t as usize][corner])
    };
    let ends: Vec<[(u32, DVec3); 2]> =
        sides.iter().map(|side| [end(*side, 0), end(*side, 1)]).collect();
    let mut at: HashMap<u32, Vec<(u32, usize)>> = HashMap::new();
    for (i, pair) in ends.iter().enumerate() {
        (0..2).for_each(|k| at.entry(pair[k].0).or_default().push((i as u32, k)));
    }
    let straight = |chain: &[DVec3]| {
        let (from, to) = extremes(chain);
        let along = (to - from).normalize_or_zero();
        chain.iter().all(|p| (*p - from).reject_from_normalized(along).length() <= 4.0 * error)
    };
    let points = |set: &[u32]| -> Vec<DVec3> {
        set.iter().flat_map(|i| ends[*i as usize].map(|(_, p)| p)).collect()
    };
    let mut sets = Sets::new(ends.len());
    for meeting in at.values() {
        if let [(i, j), (k, l)] = meeting[..] {
            let (a, b) = (ends[i as usize], ends[k as usize]);
            // the edges continue each other and do not fold back
            let apart = (a[1 - j].1 - a[j].1).dot(b[1 - l].1 - b[l].1) < 0.0;
            if apart && straight(&points(&[i, k])) {
                sets.join(i, k);
            }
        }
    }
    let mut chains = Vec::new();
    for set in sets.all(0..ends.len() as u32) {
        let all = points(&set);
        if straight(&all) {
            let (from, to) = extremes(&all);
            chains.push([from, to]);
        } else {
            chains.extend(set.iter().map(|i| ends[*i as usize].map(|(_, p)| p)));
        }
    }
    chains
}

/// Endpoints of a chain: the point farthest from the first point, and the point farthest from that
/// one.
fn extremes(points: &[DVec3]) -> (DVec3, DVec3) {
    let farthest = |from: DVec3| {
        let far = points
            .iter()
            .max_by(|a, b| from.distance_squared(**a).total_cmp(&from.distance_squared(**b)));
        far.copied().unwrap_or(from)
    };
    let from = farthest(points.first().copied().unwrap_or_default());
    (from, farthest(from))
}

/// Adds an outline for each region, and stores its index in the attributes of the region's
/// triangles.
pub fn add_outlines(out: &mut SceneTables, regions: &[Region]) {
    for region in regions {
        let outline = out.outlines.len() as u32;
        out.outlines.push(region.outline);
        for t in &region.triangles {
            let triangle = &mut out.triangles[*t as usize];
            if triangle.attributes == NONE {
                triangle.attributes = out.attributes.len() as u32;
                out.attributes.push(Attributes { n0: Vec3::ZERO, ..Attributes::zeroed() });
            }
            let attributes = &mut out.attributes[triangle.attributes as usize];
            attributes.outline_smooth = (outline + 1) << 1 | (attributes.outline_smooth & 1);
        }
    }
}
