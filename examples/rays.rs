//! Our side of the comparison with Embree (`benches/embree.py`): writes the mesh and the rays as raw f32 to a folder, then
//! traces all rays on one thread for every line that it reads and prints the seconds; at the end it writes the distances.

#[path = "../benches/workload/mod.rs"]
mod workload;

use caustica::shapes::intersect::intersect_scene;
use std::io::{self, BufRead, Write};
use std::path::Path;
use std::time::Instant;

fn main() -> io::Result<()> {
    let Some(folder) = std::env::args().nth(1) else {
        eprintln!("usage: rays FOLDER [NU NV]");
        std::process::exit(2);
    };
    let size = |n, default| std::env::args().nth(n).and_then(|s| s.parse().ok()).unwrap_or(default);
    let folder = Path::new(&folder);
    let packed = workload::displaced_sphere(size(2, 316), size(3, 159));
    let rays = workload::incoherent_rays(&packed, 1 << 19);
    let corners: Vec<_> = packed.scene.triangles.iter().flat_map(|t| [t.p0, t.p1, t.p2]).collect();
    std::fs::write(folder.join("triangles.f32"), bytemuck::cast_slice(&corners))?;
    std::fs::write(folder.join("rays.f32"), bytemuck::cast_slice(&rays))?;
    println!("{} triangles, {:?}", packed.scene.triangles.len(), packed.tree);
    let mut distances = vec![0f32; rays.len()];
    for line in io::stdin().lock().lines() {
        line?;
        let start = Instant::now();
        for (distance, ray) in distances.iter_mut().zip(&rays) {
            *distance = intersect_scene(&packed.scene, ray).t;
        }
        println!("{}", start.elapsed().as_secs_f64());
        io::stdout().flush()?;
    }
    std::fs::write(folder.join("distances.f32"), bytemuck::cast_slice(&distances))
}
