#[path = "../tests/kdtree/scenes.rs"]
#[allow(dead_code)]
mod scenes;
use caustica::build::kdtree::build;
use caustica::shapes::kdtree::traverse_closest;
use caustica::shapes::ray::{Hit, NONE, Ray};
use caustica::shapes::triangle::{RayShear, intersect_triangle};
use scenes::*;
use std::cell::Cell;
use std::time::Instant;
fn cpu() -> f64 {
    let s = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap();
    s.split(' ').next().unwrap().parse::<f64>().unwrap() * 1e-9
}
fn cpu_all() -> f64 {
    let s = std::fs::read_to_string("/proc/self/stat").unwrap();
    let f: Vec<&str> = s.rsplit(')').next().unwrap().split_whitespace().collect();
    (f[11].parse::<f64>().unwrap() + f[12].parse::<f64>().unwrap()) / 100.0
}
fn main() {
    let arg: Vec<String> = std::env::args().collect();
    let mesh = displaced_sphere(316, 158);
    let small = prims(&mesh);
    let (c, start) = (cpu_all(), Instant::now());
    let tree = build(&small);
    println!(
        "build 100k: wall {:.3} cpu {:.3} {:?} refs {}",
        start.elapsed().as_secs_f64(),
        cpu_all() - c,
        tree.stats,
        tree.refs.len()
    );
    let mut rng = Rng(5);
    let rays: Vec<Ray> = (0..1 << 19)
        .map(|_| {
            let origin = rng.direction() * 2.0;
            let d = rng.point() * 0.7 - origin;
            Ray { origin, t_min: 0.0, direction: d / d.length(), t_max: 1e30 }
        })
        .collect();
    let triangles: Vec<_> = mesh.iter().map(|t| triangle(*t)).collect();
    for _ in 0..3 {
        let c = cpu();
        let mut hits = 0;
        for ray in &rays {
            let shear = RayShear::new(ray);
            let mut hit = Hit::none(ray);
            traverse_closest(&tree.view(), ray, &mut hit, |r, ray, hit| {
                intersect_triangle(&triangles[r as usize], r, &shear, ray, hit)
            });
            hits += usize::from(hit.reference != NONE);
        }
        println!("{:.3} M rays/s cpu, {hits}", rays.len() as f64 / (cpu() - c) * 1e-6);
    }
    let tests = Cell::new(0u64);
    for ray in &rays {
        let shear = RayShear::new(ray);
        let mut hit = Hit::none(ray);
        traverse_closest(&tree.view(), ray, &mut hit, |r, ray, hit| {
            tests.set(tests.get() + 1);
            intersect_triangle(&triangles[r as usize], r, &shear, ray, hit)
        });
    }
    println!("tests/ray {:.2}", tests.get() as f64 / rays.len() as f64);
    if arg.len() > 1 {
        let large = prims(&displaced_sphere(1000, 500));
        let (c, start) = (cpu_all(), Instant::now());
        let tree = build(&large);
        println!(
            "build 1M: wall {:.3} cpu {:.3} {:?} refs {}",
            start.elapsed().as_secs_f64(),
            cpu_all() - c,
            tree.stats,
            tree.refs.len()
        );
    }
}
