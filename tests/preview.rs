//! The preview without its window.
//!
//! Theory: passes are independent of what was asked for before them, so that after any way to a scene, camera and settings the
//! picture has the bits of a plain render of these; a small picture is there before the whole one; what is wrong with a file or
//! a device takes no picture away.
#![cfg(feature = "preview")]

mod software;
mod support;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};
use std::time::{Duration, Instant};

use caustica::device::{self, Wanted};
use caustica::film::{Picture, read};
use caustica::preview::frame::{Frame, Wish};
use caustica::preview::orbit;
use caustica::preview::session::{Action, Session, Start};
use caustica::preview::view::{Scale, View, show};
use caustica::preview::worker::Worker;
use caustica::scene::{self, Allowance, Aov, Loaded};
use caustica::settings::{Direct, Method, Radius, RadiusRule};
use glam::DVec3;
use support::{FLOOR, LAMP, MESH, ball, caustica, error, folder_with};

/// With comments, which no saving takes away.
static SCENE: LazyLock<String> = LazyLock::new(|| {
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

fn folder(name: &str) -> PathBuf {
    folder_with(name, &[("ball.toml", &SCENE), ("floor.obj", FLOOR)])
}

fn loaded(folder: &Path) -> Loaded {
    scene::load(&folder.join("ball.toml")).unwrap()
}

/// What `of` finds, as soon as it finds something.
fn wait<T>(what: &str, mut of: impl FnMut() -> Option<T>) -> T {
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
        if let Some(failure) = worker.board().failure() {
            panic!("{failure}");
        }
        worker.frame().filter(|f| f.number == number && !f.quick && f.passes == passes)
    })
}

fn rendered(wish: &Wish, scene: &scene::Scene) -> Picture {
    let mut scene = scene.clone();
    (scene.camera, scene.film) = (wish.camera, wish.film);
    let mut engine = device::open(&wish.device, &scene, &wish.settings).unwrap().engine;
    for _ in 0..wish.settings.passes {
        engine.pass().unwrap();
    }
    engine.picture().unwrap()
}

fn bits(picture: &Picture) -> (u32, Vec<[u32; 3]>) {
    (picture.width, picture.rgb.iter().map(|rgb| rgb.map(f32::to_bits)).collect())
}

fn converges(folder: &Path, device: Wanted) {
    let Loaded { scene, settings, .. } = loaded(folder);
    let mut wish = Wish { camera: scene.camera, film: scene.film, settings, device };
    let mut worker = Worker::start(|| ());
    let mut number = worker.scene(Arc::new(scene.clone()), wish.clone());
    let mut before = None;
    for change in 0..5 {
        match change {
            // as a hand would: many cameras, of which the last one counts
            1 => (0..12).for_each(|_| {
                wish.camera = orbit::orbit(&wish.camera, 0.1, 0.02);
                number = worker.change(wish.clone());
                std::thread::sleep(Duration::from_millis(5));
            }),
            2 => {
                wish.settings.radius_rule = RadiusRule::Local;
                wish.settings.radius = Radius::Pixels(3.0);
                number = worker.change(wish.clone());
            }
            3 => {
                (wish.settings.direct, wish.camera.aperture) = (Direct::Photons, 0.05);
                number = worker.change(wish.clone());
            }
            4 => {
                // further passes of the same render
                wish.settings.passes = 7;
                assert_eq!(worker.change(wish.clone()), number);
            }
            _ => (),
        }
        let frame = whole(&worker, number, wish.settings.passes);
        let truth = rendered(&wish, &scene);
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
    software::software();
    converges(&folder("software"), Wanted::Software);
}

#[test]
fn a_small_picture_comes_first() {
    let Loaded { scene, settings, .. } = loaded(&folder("small"));
    let mut film = scene.film;
    (film.width, film.height) = (256, 192);
    let mut wish = Wish { camera: scene.camera, film, settings, device: Wanted::Cpu };
    let mut worker = Worker::start(|| ());
    let number = worker.scene(Arc::new(scene), wish.clone());
    whole(&worker, number, 4);
    wish.camera = orbit::dolly(&wish.camera, 0.9);
    let number = worker.change(wish.clone());
    let first = wait("a picture", || worker.frame().filter(|frame| frame.number == number));
    assert!(first.quick && first.picture.width < 256 && first.picture.width * 3 == first.picture.height * 4);
    let last = whole(&worker, number, 4);
    assert_eq!((last.picture.width, last.picture.height), (256, 192));
    // halted, small pictures come and the whole one does not
    worker.pause(true);
    wish.camera = orbit::dolly(&wish.camera, 0.9);
    let number = worker.change(wish.clone());
    wait("a picture", || worker.frame().filter(|frame| frame.number == number));
    std::thread::sleep(Duration::from_millis(600));
    assert!(worker.frame().unwrap().quick);
    worker.pause(false);
    whole(&worker, number, 4);
}

#[test]
fn what_cannot_be_rendered_takes_no_picture_away() {
    let Loaded { scene, settings, .. } = loaded(&folder("failing"));
    let mut wish = Wish { camera: scene.camera, film: scene.film, settings, device: Wanted::Cpu };
    let mut worker = Worker::start(|| ());
    let number = worker.scene(Arc::new(scene), wish.clone());
    whole(&worker, number, 4);
    for (device, words) in
        [(Wanted::Named("nonesuch".into()), "there is: "), (Wanted::Software, "--device cpu")]
    {
        wish.device = device;
        // which the GPU engine does not have
        wish.settings.method = Method::Path;
        worker.change(wish.clone());
        wait("the failure", || worker.board().failure().filter(|failure| failure.contains(words)));
        assert!(worker.frame().is_some());
    }
    wish.device = Wanted::Auto;
    let number = worker.change(wish.clone());
    assert_eq!(whole(&worker, number, 4).setup.device, "cpu", "path tracing runs there");
    assert_eq!(worker.board().failure(), None);
}

#[test]
fn every_view_shows_something() {
    let Loaded { scene, settings, .. } = loaded(&folder("views"));
    let mut worker = Worker::start(|| ());
    let mut wish = Wish { camera: scene.camera, film: scene.film, settings, device: Wanted::Cpu };
    worker.scene(Arc::new(scene), wish.clone());
    let mut seen = Vec::new();
    for view in View::ALL {
        wish.film.aovs = view.aovs();
        let number = worker.change(wish.clone());
        let frame = whole(&worker, number, 4);
        let shown = show(&frame, view, &Default::default(), None).unwrap();
        assert_eq!((shown.width, shown.height, shown.rgb.len()), (48, 32, 48 * 32), "{view:?}");
        assert!(shown.rgb.iter().any(|rgb| *rgb != shown.rgb[0]), "{view:?} is of one color");
        assert!(!seen.contains(&shown.rgb), "{view:?} is another view");
        if view.aov().is_some_and(|aov| aov != Aov::Variance) {
            let bare = Frame { layers: Vec::new(), ..Frame::clone(&frame) };
            assert_eq!(show(&bare, view, &Default::default(), None), None, "{view:?} without its layer");
        }
        if let Some(scale) = shown.scale {
            let wide = Scale { high: 2.0 * scale.high, ..scale };
            let other = show(&frame, view, &Default::default(), Some(wide)).unwrap();
            assert!(other.scale == Some(wide) && other.rgb != shown.rgb, "{view:?} by another scale");
        }
        seen.push(shown.rgb);
    }
}

fn session(folder: &Path) -> Session {
    session_within(folder, Allowance::default())
}

fn session_within(folder: &Path, allowance: Allowance) -> Session {
    let start = Start {
        file: folder.join("ball.toml"),
        loaded: loaded(folder),
        allowance,
        adjust: Box::new(|_| ()),
        outputs: vec![folder.join("picture.exr")],
        device: Wanted::Cpu,
    };
    Session::start(start, || ())
}

fn ticked<T>(session: &mut Session, what: &str, mut of: impl FnMut(&Session) -> Option<T>) -> T {
    wait(what, || {
        session.tick();
        of(session)
    })
}

fn done(session: &Session) -> Option<Arc<Frame>> {
    session.whole().filter(|frame| frame.passes == session.now.settings.passes)
}

#[test]
fn files_that_change_are_read_anew() {
    let folder = folder("reload");
    let file = folder.join("ball.toml");
    let mut session = session(&folder);
    let first = ticked(&mut session, "the picture", done);
    session.act(Action::Orbit(0.3, 0.0));
    let turned = session.now.camera;
    let own = ticked(&mut session, "the picture turned", |s| done(s).filter(|f| f.number != first.number));

    // a fault: it is told, and the picture stays
    fs::write(&file, SCENE.replace("ior = 1.5", "ior = -1.5")).unwrap();
    let trouble = ticked(&mut session, "trouble", |s| s.trouble.clone());
    assert!(trouble.contains("ball.toml:") && trouble.contains("ior"), "{trouble}");
    assert!(Arc::ptr_eq(&session.frame().unwrap(), &own));

    // a mesh that is not there, then is
    fs::write(&file, SCENE.replace("floor.obj", "ground.obj")).unwrap();
    ticked(&mut session, "other trouble", |s| s.trouble.clone().filter(|t| t.contains("ground.obj")));
    fs::write(folder.join("ground.obj"), FLOOR.replace("3 0 3", "3 0 4")).unwrap();
    let mended = ticked(&mut session, "the mended picture", |s| done(s).filter(|f| f.number != own.number));
    assert_eq!(session.trouble, None);
    assert_eq!(session.now.camera, turned, "which the file has not changed");
    assert!(bits(&mended.picture) != bits(&own.picture));

    // the mesh changes
    fs::write(folder.join("ground.obj"), FLOOR).unwrap();
    let same = ticked(&mut session, "another mesh", |s| done(s).filter(|f| f.number != mended.number));
    assert!(bits(&same.picture) == bits(&own.picture), "the same scene by another file name");

    // what the file changes of camera and settings counts
    let text = SCENE.replace("floor.obj", "ground.obj").replace("photons = 2000", "photons = 500");
    fs::write(&file, text.replace("[0.0, 1.0, 5.0]", "[0.0, 2.0, 5.0]")).unwrap();
    ticked(&mut session, "new settings", |s| (s.now.settings.photons == 500).then_some(()));
    assert_eq!(session.now.camera.position, DVec3::new(0.0, 2.0, 5.0));
}

/// Theory: what is read anew obeys what the first reading did. So does what is read to find out whether a file to be saved is a
/// scene. With nothing confined the same files are read.
#[test]
fn files_that_change_keep_to_the_root_and_the_limits() {
    let outer = folder("confined");
    let root = outer.join("root");
    fs::create_dir(&root).unwrap();
    fs::write(root.join("floor.obj"), FLOOR).unwrap();
    let file = root.join("ball.toml");
    fs::write(&file, SCENE.as_str()).unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/reference/grid.png");
    let textured = |name: &str| {
        let texture = format!("[textures.t]\ntype = \"image\"\nfile = {name:?}\n");
        SCENE.replace("reflectance = 0.5", "reflectance = \"t\"") + &texture
    };
    for place in [&outer, &root] {
        fs::copy(&data, place.join("grid.png")).unwrap();
    }
    let allowance = Allowance { root: Some(root.clone()), triangles: 2, ..Allowance::default() };
    let mut session = session_within(&root, allowance);
    let own = ticked(&mut session, "the picture", done);
    // a texture outside: the error, at its place, and the picture that was there
    fs::write(&file, textured("../grid.png")).unwrap();
    let trouble = ticked(&mut session, "trouble", |s| s.trouble.clone());
    assert!(trouble.contains("ball.toml:") && trouble.contains("lies outside of"), "{trouble}");
    assert!(Arc::ptr_eq(&session.frame().unwrap(), &own));
    session.act(Action::Photons(0.5));
    session.act(Action::SaveScene);
    assert!(session.notice.contains("lies outside of"), "{}", session.notice);
    assert_eq!(fs::read_to_string(&file).unwrap(), textured("../grid.png"), "nothing is saved");
    // more triangles than the limit
    fs::write(&file, SCENE.as_str()).unwrap();
    fs::write(root.join("floor.obj"), format!("{FLOOR}f 1 2 3\n")).unwrap();
    let trouble = ticked(&mut session, "other trouble", |s| s.trouble.clone().filter(|t| *t != trouble));
    assert!(trouble.contains("`triangles`"), "{trouble}");
    // the same texture inside
    fs::write(root.join("floor.obj"), FLOOR).unwrap();
    fs::write(&file, textured("grid.png")).unwrap();
    let inside = ticked(&mut session, "the textured picture", |s| {
        done(s).filter(|f| s.trouble.is_none() && f.number != own.number)
    });
    assert!(bits(&inside.picture) != bits(&own.picture));
    // where nothing is confined
    let mut session = session_within(&root, Allowance::default());
    ticked(&mut session, "the picture", done);
    fs::write(&file, textured("../grid.png")).unwrap();
    ticked(&mut session, "the scene", |s| (s.notice == "the scene was read anew").then_some(()));
    assert_eq!(session.trouble, None);
}

#[test]
fn pictures_and_scenes_are_saved() {
    let folder = folder("saving");
    let mut session = session(&folder);
    session.act(Action::SavePicture);
    assert!(session.notice.contains("still to come") && !folder.join("picture.exr").exists());
    ticked(&mut session, "the picture", done);
    session.act(Action::Orbit(0.3, 0.1));
    session.act(Action::Photons(0.5));
    session.act(Action::Rule);
    session.act(Action::Focus(0.5, 0.5));
    let focus =
        ticked(&mut session, "a focus", |s| s.notice.contains("focus at").then_some(s.now.camera.focus));
    assert!((3.0..5.2).contains(&focus), "{focus}");
    session.act(Action::Aperture(1.25));
    let frame = ticked(&mut session, "the picture", |s| done(s).filter(|f| f.setup.settings.photons == 1000));
    assert!(session.is_edited());
    session.act(Action::SaveScene);
    session.act(Action::SavePicture);
    assert!(session.notice.starts_with("saved"), "{}", session.notice);
    assert!(!session.is_edited());
    let text = fs::read_to_string(folder.join("ball.toml")).unwrap();
    assert!(text.starts_with("# A ball of glass.\n") && text.contains("] # before it\n"), "{text}");
    assert!(bits(&read(&folder.join("picture.exr")).unwrap()) == bits(&frame.picture));
    // what is saved does not begin anything anew, though the file has changed
    std::thread::sleep(Duration::from_millis(800));
    session.tick();
    assert_eq!(session.whole().map(|f| f.number), Some(frame.number));

    // and the file makes the same picture again
    let words = ["render", "ball.toml", "--quiet", "--like", "picture.exr", "-o", "again.exr"];
    let output = caustica(&folder, &words);
    let error = error(&output);
    assert!(output.status.success() && !error.contains("warning"), "{error}");
    assert!(bits(&read(&folder.join("again.exr")).unwrap()) == bits(&frame.picture));
}

#[test]
fn views_that_were_there_before_begin_nothing_anew() {
    let mut session = session(&folder("again"));
    let first = ticked(&mut session, "the picture", done);
    session.act(Action::View(View::Depth));
    let depth = ticked(&mut session, "the depth", |s| done(s).filter(|f| f.number != first.number));
    for view in [View::Picture, View::Variance, View::Depth] {
        session.act(Action::View(view));
        session.tick();
        assert!(Arc::ptr_eq(&session.whole().unwrap(), &depth), "{view:?}");
        assert!(show(&depth, view, &session.development(), None).is_some());
    }
    assert!(bits(&depth.picture) == bits(&first.picture), "layers change no bit");
    // another camera asks for what is looked at alone
    session.act(Action::View(View::Picture));
    session.act(Action::Orbit(0.1, 0.0));
    let turned = ticked(&mut session, "the picture turned", |s| done(s).filter(|f| f.number != depth.number));
    assert!(turned.layers.is_empty() && !depth.layers.is_empty());
}

#[test]
fn pictures_are_held_against_others() {
    let folder = folder("beside");
    let mut session = session(&folder);
    ticked(&mut session, "the picture", done);
    session.act(Action::Keep);
    session.act(Action::Expose(1.0));
    session.act(Action::Orbit(0.3, 0.0));
    let development = session.development();
    let beside = session.beside.as_ref().unwrap().show(View::Picture, &development, None).unwrap();
    let own = ticked(&mut session, "the picture turned", done);
    let own = show(&own, View::Picture, &development, None).unwrap();
    assert!(session.split == Some(0.5) && own.rgb != beside.rgb);
    session.act(Action::Keep);
    assert!(session.beside.is_none() && session.split.is_none());
    // the same bits on another engine
    software::software();
    session.beside_device("software", || ());
    session.act(Action::Home);
    let equal = ticked(&mut session, "both pictures", |s| {
        let (a, b) = (done(s)?, s.beside.as_ref()?.frame()?);
        (!b.quick && b.passes == a.passes && b.number > 1).then(|| bits(&a.picture) == bits(&b.picture))
    });
    assert!(equal);
}
