//! Every shipped scene, small, on every engine of this machine.
//!
//! Theory: random numbers are counter-based and sums have a fixed order, so the same scene,
//! settings and device give the same bits. The software Vulkan driver rounds + - * / sqrt as Rust
//! does, and the twins use nothing else, so the CPU engine and lavapipe also give the same bits as
//! each other.

use caustica::low_level::device::{self, Wanted};
use caustica::low_level::film::Picture;
use caustica::low_level::scene;
use caustica::low_level::scene::settings::{Direct, Method, RadiusRule, RenderSettings};
use std::path::{Path, PathBuf};

use crate::support::{names, passes, repository};

fn shipped() -> Vec<PathBuf> {
    let folder = repository("scenes");
    let scenes = names(&folder).into_iter().filter(|name| name.ends_with(".toml"));
    let list: Vec<PathBuf> = scenes.map(|name| folder.join(name)).collect();
    assert!(list.len() >= 6, "six scenes are shipped, found {list:?}");
    list
}

/// Renders the scene at 96 pixels across with two passes.
fn render(path: &Path, wanted: &Wanted, change: impl Fn(&mut RenderSettings)) -> Picture {
    let mut loaded = scene::load(path).unwrap_or_else(|e| panic!("{}: {e:?}", path.display()));
    let film = &mut loaded.scene.film;
    (film.width, film.height) = (96, 96 * film.height / film.width);
    let settings = &mut loaded.settings;
    settings.photons = 20_000;
    settings.eye_samples = 2;
    change(settings);
    let opened =
        device::open(wanted, &loaded.scene, settings).unwrap_or_else(|e| panic!("{wanted:?}: {e}"));
    let mut engine = opened.engine;
    passes(engine.as_mut(), 2);
    engine.picture().unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Number of values whose bits differ, and the largest difference.
fn difference(a: &Picture, b: &Picture) -> (usize, f32) {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let pairs = a.rgb.iter().flatten().zip(b.rgb.iter().flatten());
    pairs
        .filter(|(x, y)| x.to_bits() != y.to_bits())
        .fold((0, 0.0), |(n, worst), (x, y)| (n + 1, f32::max(worst, (x - y).abs())))
}

#[test]
fn the_comparator_sees_one_bit() {
    let a = Picture { width: 1, height: 2, rgb: vec![[1.0, 2.0, 3.0], [0.0, 0.5, 7.0]] };
    let mut b = a.clone();
    assert_eq!(difference(&a, &b).0, 0);
    b.rgb[1][2] = f32::from_bits(b.rgb[1][2].to_bits() + 1);
    assert_eq!(difference(&a, &b).0, 1);
}

#[test]
fn two_runs_give_the_same_bits() {
    for path in shipped() {
        let (a, b) = (render(&path, &Wanted::Cpu, |_| ()), render(&path, &Wanted::Cpu, |_| ()));
        assert!(a.rgb.iter().flatten().any(|x| *x > 0.0), "{}: black", path.display());
        assert!(a.rgb.iter().flatten().all(|x| x.is_finite() && *x >= 0.0), "{}", path.display());
        assert_eq!(difference(&a, &b), (0, 0.0), "{}", path.display());
        let other = render(&path, &Wanted::Cpu, |s| s.seed = 1);
        assert!(
            difference(&a, &other).0 > a.rgb.len(),
            "{}: the seed changes nothing",
            path.display()
        );
    }
}

#[test]
fn cpu_and_software_driver_give_the_same_bits() {
    for path in shipped() {
        let cpu = render(&path, &Wanted::Cpu, |_| ());
        let software = render(&path, &Wanted::Software, |_| ());
        let again = render(&path, &Wanted::Software, |_| ());
        assert_eq!(difference(&software, &again), (0, 0.0), "{}: two runs", path.display());
        assert_eq!(difference(&cpu, &software), (0, 0.0), "{}: cpu, software", path.display());
    }
}

#[test]
fn every_setting_gives_the_same_bits_on_both() {
    type Change = fn(&mut RenderSettings);
    let changes: [(&str, Change); 5] = [
        ("ppm", |s| s.method = Method::Ppm),
        ("local", |s| s.radius_rule = RadiusRule::Local),
        ("fixed", |s| s.radius_rule = RadiusRule::Fixed),
        ("photons", |s| s.direct = Direct::Photons),
        ("ppm, local, photons", |s| {
            (s.method, s.radius_rule, s.direct) = (Method::Ppm, RadiusRule::Local, Direct::Photons);
        }),
    ];
    let path = repository("scenes/caustics.toml");
    for (name, change) in changes {
        let cpu = render(&path, &Wanted::Cpu, change);
        let software = render(&path, &Wanted::Software, change);
        assert_eq!(difference(&cpu, &software), (0, 0.0), "{name}");
    }
}
