//! Workload: the displaced sphere r = 1 + 0.1 sin 7u sin 9v of the comparison with Embree, and
//! incoherent rays from a sphere of radius 2 toward random points in a cube of half-width 0.7.

#![allow(dead_code)] // each program uses a part of this module

use caustica::low_level::pack::PackedScene;
use caustica::low_level::pilots::prepare;
use caustica::low_level::real::{ToDouble, ToReal};
use caustica::low_level::scene::{self, Mesh, ShapeKind, Triangle};
use caustica::low_level::shapes::ray::Ray;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Scene with a camera and one shape, given as TOML text.
pub fn parsed(shape: &str) -> scene::Scene {
    let text = format!(
        "version = 1\n[camera]\nposition = [0, 0, 4]\ntarget = [0, 0, 0]\nfov = 30\n\
         [materials.grey]\ntype = \"diffuse\"\nreflectance = 0.5\n\
         [[lights]]\ntype = \"point\"\nposition = [0, 3, 0]\nintensity = 1\n\
         [[shapes]]\nmaterial = \"grey\"\n{shape}\n"
    );
    match scene::parse("bench.toml".as_ref(), text.as_bytes()) {
        Ok(loaded) => loaded.scene,
        Err(errors) => panic!("{errors:?}"),
    }
}

/// Packed scene with one shape.
pub fn packed(shape: &str) -> PackedScene {
    prepare(&parsed(shape), 16, 16).unwrap_or_else(|e| panic!("{e}"))
}

/// Packed scene of the displaced sphere with 2 (`nu`) (`nv` - 1) triangles.
pub fn displaced_sphere(nu: u32, nv: u32) -> PackedScene {
    let mut scene = parsed("type = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1");
    scene.shapes[0].kind = ShapeKind::Mesh(mesh(nu, nv));
    prepare(&scene, 16, 16).unwrap_or_else(|e| panic!("{e}"))
}

fn mesh(nu: u32, nv: u32) -> Mesh {
    let pole = |y| DVec3::new(0.0, y, 0.0);
    let mut positions = vec![pole(1.0), pole(-1.0)];
    for j in 1..nv {
        for i in 0..nu {
            let (u, v) = (f64::from(i) / f64::from(nu) * TAU, f64::from(j) / f64::from(nv) * PI);
            let r = 1.0 + 0.1 * (7.0 * u).sin() * (9.0 * v).sin();
            positions.push(DVec3::new(v.sin() * u.cos(), v.cos(), v.sin() * u.sin()) * r);
        }
    }
    let at = |i: u32, j: u32| match j {
        0 => 0,
        j if j == nv => 1,
        j => 2 + (j - 1) * nu + i % nu,
    };
    let mut triangles = Vec::new();
    for i in 0..nu {
        for j in 0..nv {
            for position in [
                [at(i, j), at(i + 1, j), at(i + 1, j + 1)],
                [at(i, j), at(i + 1, j + 1), at(i, j + 1)],
            ] {
                let [a, b, c] = position;
                if a != b && b != c && c != a {
                    triangles.push(Triangle { position, normal: None, uv: None });
                }
            }
        }
    }
    Mesh { positions, normals: vec![], uvs: vec![], triangles }
}

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    /// Uniform in [-1, 1).
    pub fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 * (2.0f64).powi(-52) - 1.0
    }

    fn point(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }
}

/// `count` rays from a sphere of radius 2 around the scene's center toward its inner cube, in the
/// units of `packed`.
pub fn incoherent_rays(packed: &PackedScene, count: usize) -> Vec<Ray> {
    let mut random = Random(5);
    let middle =
        0.5 * (packed.tables.world.bounds_min + packed.tables.world.bounds_max).to_double();
    let ray = |_| {
        let origin = loop {
            let p = random.point();
            if (0.01..1.0).contains(&p.length_squared()) {
                break p.normalize() * 2.0;
            }
        };
        let direction = (random.point() * 0.7 - origin).normalize();
        Ray {
            origin: (middle + origin / packed.unit).to_real(),
            t_min: 0.0,
            direction: direction.to_real(),
            t_max: 1e30,
        }
    };
    (0..count).map(ray).collect()
}
