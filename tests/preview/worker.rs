//! The preview's worker, without a window.
//!
//! Theory: passes do not depend on earlier requests, so whatever led to a scene, camera and
//! settings, the image has the bits of a plain render of these. A small image precedes the whole
//! one. An error in a file or a device removes no image.

use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};

use crate::support::{FLOOR, LAMP, MESH, ball, bits, folder_with, render_on, software};
use caustica::low_level::device::Wanted;
use caustica::low_level::film::Picture;
use caustica::low_level::preview::frame::{Frame, RenderRequest};
use caustica::low_level::preview::orbit;
use caustica::low_level::preview::view::{Scale, View, show};
use caustica::low_level::preview::worker::Worker;
use caustica::low_level::scene::settings::{Direct, Method, Radius, RadiusRule};
use caustica::low_level::scene::{self, Aov, Loaded};

/// The scene, with comments that saving must preserve.
pub static SCENE: LazyLock<String> = LazyLock::new(|| {
    let scene = ball((48, 32), "passes = 4\nphotons = 2000", &[BALL, MESH, LAMP]);
    format!("# A ball of glass.\n{}", scene.replace("5.0]\ntarget", "5.0] # before it\ntarget"))
});

const BALL: &str = r#"
[[shapes]]
type = "sphere"
center = [1.2, 0.5, -0.5]
radius = 0.5
material = "white"
"#;

const PATIENCE: Duration = Duration::from_secs(120);

pub fn folder(name: &str) -> PathBuf {
    folder_with(name, &[("ball.toml", &SCENE), ("floor.obj", FLOOR)])
}

pub fn loaded(folder: &Path) -> Loaded {
    scene::load(&folder.join("ball.toml")).unwrap()
}

/// Repeats `of` until it returns a value.
pub fn wait<T>(what: &str, mut of: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    loop {
        if let Some(found) = of() {
            return found;
        }
        assert!(begun.elapsed() < PATIENCE, "{what} does not come");
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn whole(worker: &Worker, number: u64, passes: u32) -> Arc<Frame> {
    wait("the whole picture", || {
        if let Some(failure) = worker.slot().failure() {
            panic!("{failure}");
        }
        worker.frame().filter(|f| f.number == number && !f.quick && f.passes == passes)
    })
}

fn rendered(request: &RenderRequest, scene: &scene::Scene) -> Picture {
    let mut scene = scene.clone();
    (scene.camera, scene.film) = (request.camera, request.film);
    render_on(&request.device, &scene, &request.settings)
}

fn converges(folder: &Path, device: Wanted) {
    let Loaded { scene, settings, .. } = loaded(folder);
    let mut request = RenderRequest { camera: scene.camera, film: scene.film, settings, device };
    let mut worker = Worker::start(|| ());
    let mut number = worker.scene(Arc::new(scene.clone()), request.clone());
    let mut before = None;
    for change in 0..5 {
        match change {
            // like a user's drag: many cameras, of which the last one counts
            1 => (0..12).for_each(|_| {
                request.camera = orbit::orbit(&request.camera, 0.1, 0.02);
                number = worker.change(request.clone());
                std::thread::sleep(Duration::from_millis(5));
            }),
            2 => {
                request.settings.radius_rule = RadiusRule::Local;
                request.settings.radius = Radius::Pixels(3.0);
                number = worker.change(request.clone());
            }
            3 => {
                (request.settings.direct, request.camera.aperture) = (Direct::Photons, 0.05);
                number = worker.change(request.clone());
            }
            4 => {
                // further passes of the same render
                request.settings.passes = 7;
                assert_eq!(worker.change(request.clone()), number);
            }
            _ => (),
        }
        let frame = whole(&worker, number, request.settings.passes);
        let truth = rendered(&request, &scene);
        assert!(bits(&frame.picture) == bits(&truth), "change {change}");
        if let Some(before) = before.replace(truth) {
            assert!(bits(&frame.picture) != bits(&before), "change {change} changes nothing");
        }
    }
}

#[test]
fn the_cpu_engine_converges_to_the_bits_of_a_render() {
    converges(&folder("cpu"), Wanted::Cpu);
}

#[test]
fn the_gpu_engine_converges_to_the_bits_of_a_render() {
    software();
    converges(&folder("software"), Wanted::Software);
}

#[test]
fn a_small_picture_comes_first() {
    let Loaded { scene, settings, .. } = loaded(&folder("small"));
    let mut film = scene.film;
    (film.width, film.height) = (256, 192);
    let mut request = RenderRequest { camera: scene.camera, film, settings, device: Wanted::Cpu };
    let mut worker = Worker::start(|| ());
    let number = worker.scene(Arc::new(scene), request.clone());
    whole(&worker, number, 4);
    request.camera = orbit::dolly(&request.camera, 0.9);
    let number = worker.change(request.clone());
    let first = wait("a picture", || worker.frame().filter(|frame| frame.number == number));
    assert!(
        first.quick
            && first.picture.width < 256
            && first.picture.width * 3 == first.picture.height * 4
    );
    let last = whole(&worker, number, 4);
    assert_eq!((last.picture.width, last.picture.height), (256, 192));
    // while halted, small images arrive and the whole one does not
    worker.pause(true);
    request.camera = orbit::dolly(&request.camera, 0.9);
    let number = worker.change(request.clone());
    wait("a picture", || worker.frame().filter(|frame| frame.number == number));
    std::thread::sleep(Duration::from_millis(600));
    assert!(worker.frame().unwrap().quick);
    worker.pause(false);
    whole(&worker, number, 4);
}

#[test]
fn what_cannot_be_rendered_takes_no_picture_away() {
    let Loaded { scene, settings, .. } = loaded(&folder("failing"));
    let mut request =
        RenderRequest { camera: scene.camera, film: scene.film, settings, device: Wanted::Cpu };
    let mut worker = Worker::start(|| ());
    let number = worker.scene(Arc::new(scene), request.clone());
    whole(&worker, number, 4);
    for (device, words) in
        [(Wanted::Named("nonesuch".into()), "available: "), (Wanted::Software, "--device cpu")]
    {
        request.device = device;
        // which the GPU engine does not support
        request.settings.method = Method::Path;
        worker.change(request.clone());
        wait("the failure", || worker.slot().failure().filter(|failure| failure.contains(words)));
        assert!(worker.frame().is_some());
    }
    request.device = Wanted::Auto;
    let number = worker.change(request.clone());
    assert_eq!(whole(&worker, number, 4).setup.device, "cpu", "path tracing runs there");
    assert_eq!(worker.slot().failure(), None);
}

#[test]
fn every_view_shows_something() {
    let Loaded { scene, settings, .. } = loaded(&folder("views"));
    let mut worker = Worker::start(|| ());
    let mut request =
        RenderRequest { camera: scene.camera, film: scene.film, settings, device: Wanted::Cpu };
    worker.scene(Arc::new(scene), request.clone());
    let mut seen = Vec::new();
    for view in View::ALL {
        request.film.aovs = view.aovs();
        let number = worker.change(request.clone());
        let frame = whole(&worker, number, 4);
        let shown = show(&frame, view, &Default::default(), None).unwrap();
        assert_eq!((shown.width, shown.height, shown.rgb.len()), (48, 32, 48 * 32), "{view:?}");
        assert!(shown.rgb.iter().any(|rgb| *rgb != shown.rgb[0]), "{view:?} is of one color");
        assert!(!seen.contains(&shown.rgb), "{view:?} is another view");
        if view.aov().is_some_and(|aov| aov != Aov::Variance) {
            let bare = Frame { layers: Vec::new(), ..Frame::clone(&frame) };
            assert_eq!(
                show(&bare, view, &Default::default(), None),
                None,
                "{view:?} without its layer"
            );
        }
        if let Some(scale) = shown.scale {
            let wide = Scale { high: 2.0 * scale.high, ..scale };
            let other = show(&frame, view, &Default::default(), Some(wide)).unwrap();
            assert!(
                other.scale == Some(wide) && other.rgb != shown.rgb,
                "{view:?} by another scale"
            );
        }
        seen.push(shown.rgb);
    }
}
