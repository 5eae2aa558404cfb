//! Primitives, rays, and the exhaustive search that tests compare the kd-tree with.

use caustica::low_level::accel::kdtree::Primitive;
use caustica::low_level::shapes::aabb::Aabb;
use caustica::low_level::shapes::kdtree::{Tree, traverse_any, traverse_closest};
use caustica::low_level::shapes::kdtree_stream::{Rays, STREAM, traverse_closest_many};
use caustica::low_level::shapes::ray::{Hit, Ray};
use caustica::low_level::shapes::triangle::{RayShear, Triangle, intersect_triangle};
use glam::Vec3;

/// SplitMix64.
pub struct Rng(pub u64);

impl Rng {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    /// In [-1, 1).
    pub fn signed(&mut self) -> f32 {
        (self.next() >> 40) as f32 * (2.0 / 16_777_216.0) - 1.0
    }

    pub fn point(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }

    pub fn direction(&mut self) -> Vec3 {
        loop {
            let p = self.point();
            let n = p.length_squared();
            if n > 0.01 && n <= 1.0 {
                return p / n.sqrt();
            }
        }
    }
}

pub fn triangle(p: [Vec3; 3]) -> Triangle {
    Triangle { p0: p[0], material: 0, p1: p[1], light: 0, p2: p[2], attributes: 0 }
}

/// Solid box by slabs: where the ray enters it, or leaves it from inside.
fn intersect_box(bounds: &Aabb, reference: u32, ray: &Ray, hit: &mut Hit) {
    let (mut near, mut far) = (-1e30f32, 1e30f32);
    for axis in 0..3 {
        let a = bounds.min[axis] - ray.origin[axis];
        let b = bounds.max[axis] - ray.origin[axis];
        let d = ray.direction[axis];
        if d == 0.0 {
            if a > 0.0 || b < 0.0 {
                return;
            }
        } else {
            near = near.max((a / d).min(b / d));
            far = far.min((a / d).max(b / d));
        }
    }
    let t = if near > ray.t_min { near } else { far };
    if near <= far && t > ray.t_min && t < hit.t {
        *hit = Hit { t, reference, u: 0.0, v: 0.0, ..*hit };
    }
}

pub fn intersect(prims: &[Primitive], shear: &RayShear, reference: u32, ray: &Ray, hit: &mut Hit) {
    match &prims[reference as usize] {
        Primitive::Triangle(p) => intersect_triangle(&triangle(*p), reference, shear, ray, hit),
        Primitive::Box(bounds) => intersect_box(bounds, reference, ray, hit),
    }
}

pub fn closest(prims: &[Primitive], tree: &Tree, ray: &Ray) -> Hit {
    let mut hit = Hit::none(ray);
    let shear = RayShear::new(ray);
    traverse_closest(tree, ray, &mut hit, |leaf: &[u32], ray: &Ray, hit: &mut Hit| {
        leaf.iter().for_each(|&r| intersect(prims, &shear, r, ray, hit));
    });
    hit
}

/// [`closest`] for a stream of rays.
pub fn closest_many(prims: &[Primitive], tree: &Tree, rays: &[Ray]) -> Vec<Hit> {
    struct Source<'a> {
        rays: &'a [Ray],
        hits: Vec<Hit>,
        /// The ray in each lane.
        places: [usize; STREAM],
        taken: usize,
    }
    impl Rays for Source<'_> {
        fn next(&mut self, lane: usize, last: Option<&Hit>) -> Option<(Ray, Hit)> {
            if let Some(hit) = last {
                self.hits[self.places[lane]] = *hit;
            }
            let ray = self.rays.get(self.taken)?;
            self.places[lane] = self.taken;
            self.taken += 1;
            Some((*ray, Hit::none(ray)))
        }
    }
    let hits = vec![Hit { t: -1.0, reference: 0, u: 0.0, v: 0.0, member: 0 }; rays.len()];
    let mut source = Source { rays, hits, places: [0; STREAM], taken: 0 };
    traverse_closest_many(tree, &mut source, |ray: &Ray| {
        let shear = RayShear::new(ray);
        move |leaf: &[u32], ray: &Ray, hit: &mut Hit| {
            leaf.iter().for_each(|&r| intersect(prims, &shear, r, ray, hit));
        }
    });
    source.hits
}

pub fn any(prims: &[Primitive], tree: &Tree, ray: &Ray) -> Hit {
    let mut hit = Hit::none(ray);
    let shear = RayShear::new(ray);
    traverse_any(tree, ray, &mut hit, |leaf: &[u32], ray: &Ray, hit: &mut Hit| {
        leaf.iter().for_each(|&r| intersect(prims, &shear, r, ray, hit));
    });
    hit
}

pub fn exhaustive(prims: &[Primitive], ray: &Ray) -> Hit {
    let mut hit = Hit::none(ray);
    let shear = RayShear::new(ray);
    (0..prims.len() as u32).for_each(|r| intersect(prims, &shear, r, ray, &mut hit));
    hit
}

/// A closed surface over a (u, v) grid, periodic in u and, if `torus`, in v.
pub fn grid_mesh(nu: usize, nv: usize, at: impl Fn(f64, f64) -> [f64; 3]) -> Vec<[Vec3; 3]> {
    let p = |i: usize, j: usize| {
        let [x, y, z] = at((i % nu) as f64 / nu as f64, j as f64 / nv as f64);
        Vec3::new(x as f32, y as f32, z as f32)
    };
    let mut out = Vec::new();
    for i in 0..nu {
        for j in 0..nv {
            out.push([p(i, j), p(i + 1, j), p(i + 1, j + 1)]);
            out.push([p(i, j), p(i + 1, j + 1), p(i, j + 1)]);
        }
    }
    out
}

/// r = 1 + 0.1 sin 7u sin 9v.
pub fn displaced_sphere(nu: usize, nv: usize) -> Vec<[Vec3; 3]> {
    use std::f64::consts::{PI, TAU};
    grid_mesh(nu, nv, |a, b| {
        // The poles exactly, so that the mesh is closed.
        let (u, v) = (a * TAU, b * PI);
        let (r, s) = if b == 0.0 || b == 1.0 {
            (1.0, 0.0)
        } else {
            (1.0 + 0.1 * (7.0 * u).sin() * (9.0 * v).sin(), v.sin())
        };
        [r * s * u.cos(), r * v.cos(), r * s * u.sin()]
    })
}

/// Tube of radius 0.3 (1 + 0.2 sin 5u sin 6v) about a circle of radius 1.
pub fn displaced_torus(nu: usize, nv: usize) -> Vec<[Vec3; 3]> {
    use std::f64::consts::TAU;
    grid_mesh(nu, nv, |a, b| {
        let (u, v) = (a * TAU, b % 1.0 * TAU);
        let r = 0.3 * (1.0 + 0.2 * (5.0 * u).sin() * (6.0 * v).sin());
        [(1.0 + r * v.cos()) * u.cos(), r * v.sin(), (1.0 + r * v.cos()) * u.sin()]
    })
}

pub fn prims(mesh: &[[Vec3; 3]]) -> Vec<Primitive> {
    mesh.iter().map(|t| Primitive::Triangle(*t)).collect()
}

/// Scenes that are known to expose errors of kd-trees, by name.
pub fn scenes() -> Vec<(&'static str, Vec<Primitive>)> {
    let mut rng = Rng(1);
    let tri = |rng: &mut Rng, size: f32| {
        let p = rng.point();
        [p, p + rng.point() * size, p + rng.point() * size]
    };
    let sizes = |rng: &mut Rng, n: usize| -> Vec<[Vec3; 3]> {
        (0..n)
            .map(|_| {
                let size = 10f32.powf(2.0 * rng.signed() - 2.0);
                tri(rng, size)
            })
            .collect()
    };
    let mut out = vec![("nothing", vec![]), ("one triangle", prims(&sizes(&mut rng, 1)))];
    out.push(("every size", prims(&sizes(&mut rng, 1500))));
    let slivers: Vec<_> = (0..800)
        .map(|_| {
            let (p, d) = (rng.point(), rng.point());
            [p, p + d, p + d * 0.5 + rng.point() * 10f32.powf(-4.0 + 3.0 * rng.signed())]
        })
        .collect();
    out.push(("slivers", prims(&slivers)));
    let boxes: Vec<_> = (0..700)
        .map(|_| {
            let (p, s) = (rng.point(), 0.1 * rng.signed().abs());
            Primitive::Box(Aabb::of_points(&[p - s * rng.point().abs(), p + s * rng.point().abs()]))
        })
        .collect();
    out.push(("boxes", boxes.clone()));
    let mut mixed = prims(&sizes(&mut rng, 500));
    mixed.extend(boxes.iter().take(300));
    mixed.push(Primitive::Box(Aabb {
        min: Vec3::new(-3.0, -0.5, -3.0),
        max: Vec3::new(3.0, -0.5, 3.0),
    }));
    out.push(("triangles and boxes", mixed));
    let mut lattice = Vec::new();
    for level in 0..3 {
        for i in 0..12 {
            for j in 0..12 {
                let at = |i: i32, j: i32| {
                    Vec3::new(i as f32 / 6.0 - 1.0, level as f32 / 3.0, j as f32 / 6.0 - 1.0)
                };
                lattice.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                lattice.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    let upright = lattice.iter().map(|t| t.map(|p| Vec3::new(p.y, p.x, p.z))).collect::<Vec<_>>();
    lattice.extend(upright);
    out.push(("lattice of coplanar grids", prims(&lattice)));
    let flat: Vec<_> =
        sizes(&mut rng, 500).iter().map(|t| t.map(|p| Vec3::new(p.x, 0.3, p.z))).collect();
    out.push(("all in the plane y = 0.3", prims(&flat)));
    let tilted: Vec<_> = sizes(&mut rng, 500)
        .iter()
        .map(|t| t.map(|p| Vec3::new(p.x, 0.5 * p.x + 0.25 * p.z, p.z)))
        .collect();
    out.push(("all in a tilted plane", prims(&tilted)));
    let mut same = vec![tri(&mut rng, 0.5); 60];
    same.extend(sizes(&mut rng, 200));
    same.extend(same.clone());
    out.push(("duplicates", prims(&same)));
    let line: Vec<_> =
        (0..40).map(|_| [0.0; 3].map(|_: f32| Vec3::new(rng.signed(), 0.0, 0.0))).collect();
    out.push(("degenerate, on a line", prims(&line)));
    let mut range =
        prims(&sizes(&mut rng, 300).iter().map(|t| t.map(|p| p * 1e-3)).collect::<Vec<_>>());
    range.extend(prims(
        &sizes(&mut rng, 20).iter().map(|t| t.map(|p| p * 100.0)).collect::<Vec<_>>(),
    ));
    out.push(("a speck in a hall", range));
    out.push(("mesh past the sweep's limit", prims(&displaced_torus(150, 60))));
    out
}

/// Unit-size meshes with distant geometry, by name.
pub fn far_scenes() -> Vec<(&'static str, Vec<[Vec3; 3]>)> {
    let mesh = displaced_torus(60, 30);
    let with_vertex = |far: Vec3| {
        let moved = mesh[700][1];
        mesh.iter().map(|t| t.map(|p| if p == moved { far } else { p })).collect::<Vec<_>>()
    };
    let with_ground = |half: f32, height: f32, slope: f32| {
        let at = |x: f32, z: f32| Vec3::new(x * half, height + slope * x * half, z * half);
        let (a, b, c, d) = (at(-1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0), at(1.0, -1.0));
        [mesh.clone(), vec![[a, b, c], [a, c, d]]].concat()
    };
    let mut rng = Rng(8);
    let sizes = (0..600).map(|_| {
        let size = 10f32.powf(4.5 * rng.signed() + 1.5);
        let p = rng.point() * 10f32.powf(3.0 * rng.signed() + 3.0);
        [p, p + rng.point() * size, p + rng.point() * size]
    });
    let small = mesh.iter().map(|t| t.map(|p| p * 0.2 + Vec3::new(0.0, 0.0, -2000.0)));
    vec![
        ("a vertex at 4e9", with_vertex(Vec3::new(4e9, 3e9, -2e9))),
        ("a vertex at 1e5 along x", with_vertex(Vec3::new(1e5, 0.0, 0.0))),
        ("a ground of 1e4", with_ground(1e4, -0.45, 0.0)),
        ("a ground of 1e6", with_ground(1e6, -0.45, 0.0)),
        ("a tilted ground of 1e5", with_ground(1e5, -0.45, 0.3)),
        ("a mesh at a distance of 2000", mesh.iter().copied().chain(small).collect()),
        ("sizes of 1e-3 to 1e6", mesh.iter().copied().chain(sizes).collect()),
        // computed hits on it are off by more than a cell's width, before or behind those on the
        // mesh
        ("a ground of 1e7 through the mesh", with_ground(1e7, 0.1, 0.0)),
    ]
}

/// Rays that expose rounding: random, axis-parallel, within splitting planes and through corners,
/// from far away, with tiny direction components and with either zero.
pub fn rays(prims: &[Primitive], tree: &Tree, count: usize, rng: &mut Rng) -> Vec<Ray> {
    let bounds = Aabb { min: tree.bounds_min, max: tree.bounds_max };
    rays_about(bounds, prims, tree, count, rng)
}

/// Like [`rays`], for rays that start and aim in `bounds`.
pub fn rays_about(
    bounds: Aabb,
    prims: &[Primitive],
    tree: &Tree,
    count: usize,
    rng: &mut Rng,
) -> Vec<Ray> {
    let corner = |rng: &mut Rng| match prims.get(rng.below(prims.len().max(1))) {
        Some(Primitive::Triangle(p)) => p[rng.below(3)],
        Some(Primitive::Box(b)) => b.min,
        None => Vec3::ZERO,
    };
    let size = (bounds.max - bounds.min).max_element().max(1.0);
    let middle = (bounds.max + bounds.min) * 0.5;
    (0..count)
        .map(|i| {
            let mut origin = middle + rng.point() * size;
            let mut d = middle + rng.point() * (0.5 * size) - origin;
            let axis = rng.below(3);
            match i % 8 {
                0 => {}
                1 => {
                    d = Vec3::ZERO.with_component(axis, if rng.below(2) == 0 { -1.0 } else { 1.0 })
                }
                2 => {
                    // In a splitting plane, zero of either sign.
                    if let Some(node) =
                        tree.nodes.get(rng.below(tree.nodes.len())).filter(|n| !n.is_leaf())
                    {
                        let (axis, position, _) = node.plane();
                        origin[axis] = position;
                        d[axis] = if rng.below(2) == 0 { 0.0 } else { -0.0 };
                    }
                }
                3 => d = corner(rng) - origin,
                4 => {
                    origin = corner(rng);
                    d = corner(rng) - origin;
                }
                5 => {
                    origin = middle + rng.direction() * (100.0 * size);
                    d = corner(rng) - origin;
                }
                6 => d[axis] = 10f32.powf(-22.0 + 20.0 * rng.signed()),
                _ => {
                    // Axis-parallel through a corner: along edges and planes.
                    origin = corner(rng);
                    d = Vec3::splat(-0.0).with_component(axis, 1.0);
                    origin[axis] -= size * rng.signed().abs();
                }
            }
            if d.length_squared() == 0.0 {
                d = Vec3::X;
            }
            let d = d / d.length();
            let t_min = if i % 5 == 0 { 0.1 * size } else { 0.0 };
            Ray { origin, t_min, direction: d, t_max: if i % 7 == 0 { 0.7 * size } else { 1e30 } }
        })
        .collect()
}

trait WithComponent {
    fn with_component(self, axis: usize, value: f32) -> Self;
}

impl WithComponent for Vec3 {
    fn with_component(mut self, axis: usize, value: f32) -> Vec3 {
        self[axis] = value;
        self
    }
}
