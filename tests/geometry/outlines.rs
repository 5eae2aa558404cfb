//! Gather discs near the outline of a flat shape.

use crate::support::software;
use bytemuck::{Zeroable, cast_slice, pod_collect_to_vec};
use caustica::low_level::gpu::Gpu;
use caustica::low_level::gpu::compose::compose;
use caustica::low_level::gpu::layout::SceneLayout;
use caustica::low_level::gpu::program::Program;
use caustica::low_level::gpu::recorder::Recorder;
use caustica::low_level::kernels::gather::gather;
use caustica::low_level::kernels::grid_build::{build_grid, record_bucket, record_code};
use caustica::low_level::kernels::records::{Dispatch, Gathered, PhotonRecord, VisiblePoint};
use caustica::low_level::math::rng::{STREAM_PHOTON, rng_new, rng_next};
use caustica::low_level::math::{basis, oct_decode, oct_encode};
use caustica::low_level::plan::features::{Feature, Features};
use caustica::low_level::plan::{Buffer, Kernel};
use caustica::low_level::shapes::outline::{WALL_BITS, clip_at, in_outline, outline_share};
use caustica::low_level::tables::{NONE, Outline};
use glam::{DVec2, Vec3, Vec4};
use std::f64::consts::PI;

/// The `i`-th four uniform random numbers.
fn random(i: u32) -> Vec4 {
    rng_next(&mut rng_new(i, 0, STREAM_PHOTON, 9))
}

fn parallelogram(origin: Vec3, u: Vec3, v: Vec3) -> Outline {
    let normal = u.cross(v);
    let area_sq = normal.length_squared();
    let (dual_u, dual_v) = (v.cross(normal) / area_sq, normal.cross(u) / area_sq);
    Outline { origin, u, v, dual_u, dual_v, error: 1e-6, ..Outline::zeroed() }
}

/// Share of a disc inside an outline, counted on a sunflower of points.
fn counted(outline: &Outline, position: Vec3, normal: Vec3, radius: f32) -> f64 {
    const POINTS: u32 = 100_000;
    let (t, b) = basis(normal);
    let inside = (0..POINTS).filter(|i| {
        let r = ((f64::from(*i) + 0.5) / f64::from(POINTS)).sqrt();
        let turn = f64::from(*i) * PI * (3.0 - 5f64.sqrt());
        let p = DVec2::from_angle(turn) * r;
        in_outline(outline, position + (t * p.x as f32 + b * p.y as f32) * radius)
    });
    inside.count() as f64 / f64::from(POINTS)
}

/// A random outline in some plane, a point on it, its normal and a radius.
fn case(i: u32) -> (Outline, Vec3, Vec3, f32) {
    let (a, b, c) = (random(3 * i), random(3 * i + 1), random(3 * i + 2));
    let normal = Vec3::new(a.x - 0.5, a.y - 0.5, a.z - 0.5).normalize();
    let (t, s) = basis(normal);
    let radius = 2f32.powf(6.0 * a.w - 4.0);
    if i.is_multiple_of(3) {
        let outline =
            Outline { origin: Vec3::new(b.x, b.y, b.z), radius: 0.5 + b.w, ..Outline::zeroed() };
        let turn = c.x * 6.0;
        let place = (t * turn.cos() + s * turn.sin()) * (0.999 * c.y.sqrt() * outline.radius);
        return (outline, outline.origin + place, normal, radius);
    }
    // skewed, some of them slim
    let (u, v) = (t * (0.05 + 2.0 * b.x) + s * b.y, s * (0.3 + b.z) + t * (b.w - 0.5));
    let origin = Vec3::new(c.z, c.w, 0.3);
    (parallelogram(origin, u, v), origin + u * c.x + v * c.y, normal, radius)
}

/// Theory: the share is the common area of disc and outline over the area of the disc. Counting
/// points that are spread evenly over the disc gives it up to a few times their spacing times the
/// outline's length, below 0.004 here. The test rejects an outline with an edge that is 0.05
/// longer.
#[test]
fn shares_are_areas() {
    let mut noticed = 0;
    for i in 0..300 {
        let (outline, position, normal, radius) = case(i);
        let exact = counted(&outline, position, normal, radius);
        for side in [normal, -normal] {
            let share = f64::from(outline_share(&outline, position, side, radius));
            assert!(
                (share - exact).abs() < 0.004,
                "{i}: {share} and {exact} of {outline:?}, radius {radius}"
            );
        }
        let u = outline.u * 1.05;
        let longer = parallelogram(outline.origin, u, outline.v);
        let longer = if outline.radius > 0.0 {
            Outline { radius: 1.05 * outline.radius, ..outline }
        } else {
            longer
        };
        let wrong = f64::from(outline_share(&longer, position, normal, radius));
        noticed += u32::from((wrong - exact).abs() >= 0.004);
    }
    assert!(noticed > 100, "{noticed}");
}

/// Theory: at a corner of a rectangle a quarter of the disc is covered, at an edge a half, at a
/// distance of x radii from an edge 1 - (acos x - x sqrt(1 - x^2)) / pi, and of an outline that
/// contains the disc all of it. Near the edge of a circle far larger than the disc the edge is a
/// parabola, which subtracts 1 / (3 pi R) from the half.
#[test]
fn shares_in_closed_form() {
    let square = parallelogram(Vec3::ZERO, 2.0 * Vec3::X, 2.0 * Vec3::Y);
    let share = |x: f32, y: f32, r: f32| {
        f64::from(outline_share(&square, Vec3::new(x, y, 0.0), Vec3::Z, r))
    };
    for r in [1e-5, 1e-3, 0.5] {
        assert!((share(0.0, 0.0, r) - 0.25).abs() < 1e-6);
        assert!((share(1.0, 2.0, r) - 0.5).abs() < 1e-6);
        assert_eq!(share(1.0, 1.0, r), 1.0);
    }
    let beyond = |x: f64| (x.acos() - x * (1.0 - x * x).sqrt()) / PI;
    for x in [0.01, 0.3, 0.7, 0.99] {
        assert!((share(0.5 * x as f32, 1.0, 0.5) - (1.0 - beyond(x))).abs() < 1e-6);
    }
    assert!((share(0.2, 1.7, 50.0) / (4.0 / (PI * 2500.0)) - 1.0).abs() < 1e-4);
    for size in [20f32, 29.0, 31.0, 1e3, 1e5] {
        let circle = Outline { radius: size, ..Outline::zeroed() };
        let at = f64::from(outline_share(&circle, Vec3::X * size, Vec3::Z, 1.0));
        let exact = 0.5 - 1.0 / (3.0 * PI * f64::from(size));
        assert!((at - exact).abs() < 0.01 / f64::from(size) + 2e-6, "{size}: {at} and {exact}");
    }
}

/// Floor and wall of a room, and the light that reaches a point of the floor.
struct Room {
    outlines: Vec<Outline>,
    records: Vec<PhotonRecord>,
    radius: f32,
}

impl Room {
    /// Photons of irradiance one on the floor [0, 1]^2 and of five on the wall x = 0 and on a floor
    /// beyond z = 1.
    fn new(radius: f32, photons: u32) -> Self {
        let floor = parallelogram(Vec3::ZERO, Vec3::Z, Vec3::X);
        let share = 4.0 / photons as f32;
        let records = (0..photons).map(|key| {
            let u = random(key);
            let towards = oct_encode(Vec3::new(1.0, 1.0, 0.3).normalize());
            let (position, flux) = match key % 4 {
                0 | 1 => (Vec3::new(u.x, 0.0, u.y), 0.5 * share),
                2 => (Vec3::new(0.0, 0.3 * u.x, u.y), 5.0 * 0.3 * share),
                _ => (Vec3::new(u.x, 0.0, 1.0 + 0.3 * u.y), 5.0 * 0.3 * share),
            };
            PhotonRecord { position, key, flux: Vec3::splat(flux), direction: towards }
        });
        let skewed = parallelogram(Vec3::ZERO, Vec3::new(0.3, 0.0, 0.9), Vec3::new(0.8, 0.0, 0.1));
        let circles = [0.5, 0.05, 4.0].map(|radius| Outline {
            origin: Vec3::new(0.4, 0.0, 0.5),
            radius,
            error: 1e-6,
            ..Outline::zeroed()
        });
        let outlines = [floor, skewed].into_iter().chain(circles).collect();
        Self { outlines, records: records.collect(), radius }
    }

    fn dispatch(&self) -> Dispatch {
        let inv_cell = 0.5 / self.radius;
        Dispatch { mask: 4095, inv_cell, scale_sq: 1.0, eye_samples: 1, ..Dispatch::zeroed() }
    }

    fn point(&self, x: f32, z: f32, outline: u32) -> VisiblePoint {
        let up = oct_encode(Vec3::Y);
        let position = Vec3::new(x, 0.0, z);
        let weight = Vec3::ONE;
        VisiblePoint {
            position,
            weight,
            outline,
            radius: self.radius,
            normal: up,
            shading: up,
            ..VisiblePoint::zeroed()
        }
    }

    fn gather(&self, points: &[VisiblePoint]) -> Vec<Gathered> {
        let (starts, sorted) = build_grid(&self.dispatch(), self.records.clone());
        let one = |point: &VisiblePoint| {
            let mut gathered = Gathered::zeroed();
            gather(
                &[],
                &self.outlines,
                &self.dispatch(),
                point,
                1.0,
                &starts,
                &sorted,
                &mut gathered,
            );
            gathered
        };
        points.iter().map(one).collect()
    }
}

/// Theory: with the photons inside the outline, over the covered area, every point of the floor
/// receives irradiance one, within 3 deviations of the count, and its bias probe is zero. Without
/// the outline a corner receives a quarter of it, plus light from beyond.
#[test]
fn edges_see_even_light() {
    let room = Room::new(0.1, 400_000);
    let places = [(0.0, 0.0), (0.0, 1.0), (0.001, 0.5), (0.03, 0.97), (0.5, 0.5), (1.0, 0.3)];
    let points = |outline| places.map(|(x, z)| room.point(x, z, outline));
    let area = PI * 0.01;
    for (gathered, (x, z)) in room.gather(&points(0)).iter().zip(places) {
        let irradiance = f64::from(gathered.flux.x) / area;
        let deviation = 1.0 / f64::from(gathered.count).sqrt();
        assert!(
            (irradiance - 1.0).abs() < 3.0 * deviation,
            "({x}, {z}): {irradiance} +- {deviation}"
        );
        let ring = f64::from(gathered.bias_probe) / area;
        assert!(ring.abs() < 4.0 * deviation, "({x}, {z}): ring {ring}, deviation {deviation}");
    }
    let unclipped = room.gather(&points(NONE));
    assert!((f64::from(unclipped[0].flux.x) / area - 1.0).abs() > 0.3);
    let deviation = 1.0 / f64::from(unclipped[3].count).sqrt();
    assert!(
        (f64::from(unclipped[3].bias_probe) / area).abs() > 8.0 * deviation,
        "{:?}",
        unclipped[3]
    );
}

/// Theory: where a wall stands on the floor, a point receives the even light of its side,
/// whatever lies on the other side and on the wall, whether the disc meets the wall alone, a corner
/// of two walls, or the outline as well. Its bias probe is zero. A wall on the other side of the
/// floor has no effect.
#[test]
fn walls_part_the_light() {
    let mut room = Room::new(0.1, 0);
    let photons = 400_000u32;
    let towards = oct_encode(Vec3::new(0.3, 1.0, 0.3).normalize());
    let record = |key: u32| {
        let u = random(key);
        let on_wall = key % 5 == 4;
        let position =
            if on_wall { Vec3::new(0.5, 0.1 * u.x, u.y) } else { Vec3::new(u.x, 0.0, u.y) };
        // irradiances one, two and four in the parts of the floor between the walls x = 0.5 and z =
        // 0.5
        let irradiance = match (on_wall, position.x < 0.5, position.z < 0.5) {
            (true, _, _) => 9.0,
            (_, true, _) => 1.0,
            (_, false, true) => 2.0,
            (_, false, false) => 4.0,
        };
        let flux = Vec3::splat(irradiance * 1.25 / photons as f32);
        PhotonRecord { position, key, flux, direction: towards }
    };
    room.records = (0..photons).map(record).collect();
    let wall = |origin, u, v| Outline { origin, u, v, ..Outline::zeroed() };
    let walls = room.outlines.len() as u32;
    room.outlines.push(wall(Vec3::new(0.5, 0.0, 0.0), Vec3::Z, Vec3::Y));
    room.outlines.push(wall(Vec3::new(0.5, 0.0, 0.5), Vec3::X * 0.5, Vec3::Y));
    room.outlines.push(wall(Vec3::new(0.0, 0.0, 0.25), Vec3::X, -Vec3::Y));
    room.outlines[0].walls = walls << WALL_BITS | 3;
    let places = [
        ((0.49, 0.3), 1.0),
        ((0.51, 0.3), 2.0),
        ((0.51, 0.49), 2.0),
        ((0.51, 0.51), 4.0),
        ((0.55, 0.02), 2.0),
        ((0.99, 0.53), 4.0),
        ((0.2, 0.25), 1.0),
    ];
    let points = places.map(|((x, z), _)| room.point(x, z, 0));
    let area = PI * 0.01;
    for (gathered, ((x, z), expected)) in room.gather(&points).iter().zip(places) {
        let irradiance = f64::from(gathered.flux.x) / area / expected;
        let deviation = 1.0 / f64::from(gathered.count).sqrt();
        assert!(
            (irradiance - 1.0).abs() < 3.5 * deviation,
            "({x}, {z}): {irradiance} +- {deviation}"
        );
        let ring = f64::from(gathered.bias_probe) / area / expected;
        assert!(ring.abs() < 4.0 * deviation, "({x}, {z}): ring {ring}, deviation {deviation}");
    }
    room.outlines[0].walls = 0;
    let open = f64::from(room.gather(&points)[0].flux.x) / area;
    assert!(open > 1.3, "without walls: {open}");
}

/// Theory: the driver forms the same sums in the same order, so it gives the same bits. A differing
/// depth would be detected.
#[test]
fn the_driver_gathers_the_same() {
    // few enough that the driver stops no loop
    let mut room = Room::new(0.1, 40_000);
    let wall = |origin, u| Outline { origin, u, v: Vec3::Y, ..Outline::zeroed() };
    let walls = room.outlines.len() as u32 + 1;
    room.outlines.push(Outline { walls: walls << WALL_BITS | 2, ..room.outlines[0] });
    room.outlines.push(wall(Vec3::new(0.05, 0.0, 0.0), Vec3::new(0.1, 0.0, 0.9)));
    room.outlines.push(wall(Vec3::new(0.0, 0.0, 0.3), Vec3::new(0.7, 0.0, 0.1)));
    let points: Vec<VisiblePoint> = (0..4096)
        .map(|i| {
            let u = random(i);
            room.point(u.x * u.x, u.y * u.y, if u.z < 0.9 { i % 6 } else { NONE })
        })
        .collect();
    let gpu = Gpu::open(&software()).unwrap();
    let mut recorder = Recorder::new(&gpu).unwrap();
    let features =
        [Feature::Photons, Feature::Outlines, Feature::Disc].into_iter().collect::<Features>();
    let shader = compose(Kernel::Gather, &features, &SceneLayout::default()).unwrap();
    let program = Program::of_shader(&gpu, Kernel::Gather, &features, shader).unwrap();
    let (starts, _) = build_grid(&room.dispatch(), room.records.clone());
    let d = Dispatch { end: points.len() as u32, ..room.dispatch() };
    let coded = |record: &PhotonRecord| PhotonRecord { key: record_code(&d, record), ..*record };
    let mut ordered = room.records.clone();
    ordered.sort_by_key(|record| record_bucket(&d, record));
    let sorted: Vec<PhotonRecord> = ordered.iter().map(coded).collect();
    let upload = |buffer: Buffer, bytes: &[u8]| (buffer, gpu.upload(buffer.name(), bytes).unwrap());
    let buffers = [
        upload(Buffer::VisiblePoints, cast_slice(&points)),
        upload(Buffer::Counters, &[0; 32]),
        upload(Buffer::Starts, cast_slice(&starts)),
        upload(Buffer::Sorted, cast_slice(&sorted)),
        upload(Buffer::Outlines, cast_slice(&room.outlines)),
        upload(Buffer::Gathered, cast_slice(&vec![Gathered::zeroed(); points.len()])),
    ];
    let find = |which: Buffer| buffers.iter().find(|(buffer, _)| *buffer == which).map(|(_, b)| b);
    let group = program.bind(&gpu, &recorder.dispatches, find).unwrap();
    recorder.dispatch(&gpu, &program, &group, &d);
    recorder.finish(&gpu).unwrap();
    let bytes = gpu.read(&buffers[5].1, (points.len() * size_of::<Gathered>()) as u64).unwrap();
    let found: Vec<Gathered> = pod_collect_to_vec(&bytes);
    let (mut crossed, mut cut) = (0, 0);
    for ((point, ours), theirs) in points.iter().zip(room.gather(&points)).zip(found) {
        let clip = clip_at(
            &room.outlines,
            point.outline,
            point.position,
            oct_decode(point.normal),
            point.radius,
        );
        crossed += u32::from(clip.crossed);
        cut += u32::from(clip.count > 1);
        assert_eq!(ours, theirs, "{point:?}, {clip:?}");
    }
    assert!(crossed > 1000 && cut > 20, "{crossed}, {cut}");
}
