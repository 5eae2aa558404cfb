//! Ray tracing part of the comparison with Embree (`benches/embree.py`). Writes the mesh and the
//! rays as raw f32 to a folder. For each line on standard input, traces all rays on one thread, one
//! by one and side by side, and prints the seconds of both. Finally writes the distances; fails
//! unless both ways give the same bits.

#[path = "../benches/workload/mod.rs"]
mod workload;

use caustica::low_level::geometry::intersect::{intersect_scene, intersect_scene_many};
use caustica::low_level::shapes::kdtree_stream::STREAM;
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
    let corners: Vec<_> = packed.tables.triangles.iter().flat_map(|t| [t.p0, t.p1, t.p2]).collect();
    std::fs::write(folder.join("triangles.f32"), bytemuck::cast_slice(&corners))?;
    std::fs::write(folder.join("rays.f32"), bytemuck::cast_slice(&rays))?;
    println!("{} triangles, {:?}", packed.tables.triangles.len(), packed.tree);
    let mut one_by_one = vec![0f32; rays.len()];
    let mut side_by_side = one_by_one.clone();
    for line in io::stdin().lock().lines() {
        line?;
        let start = Instant::now();
        for (distance, ray) in one_by_one.iter_mut().zip(&rays) {
            *distance = intersect_scene(&packed.tables, ray).t;
        }
        let middle = Instant::now();
        let mut places = [0; STREAM];
        let mut waiting = rays.iter().enumerate();
        intersect_scene_many(&packed.tables, |lane, last| {
            if let Some(hit) = last {
                side_by_side[places[lane]] = hit.t;
            }
            let (place, ray) = waiting.next()?;
            places[lane] = place;
            Some(*ray)
        });
        println!("{} {}", (middle - start).as_secs_f64(), middle.elapsed().as_secs_f64());
        io::stdout().flush()?;
    }
    if one_by_one != side_by_side {
        return Err(io::Error::other("hits of rays side by side and one by one differ"));
    }
    std::fs::write(folder.join("distances.f32"), bytemuck::cast_slice(&one_by_one))
}
