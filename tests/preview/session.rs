//! The preview session: reloaded files, saved images and scenes, and comparisons.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use caustica::low_level::device::Wanted;
use caustica::low_level::film::read;
use caustica::low_level::preview::frame::Frame;
use caustica::low_level::preview::session::{Action, Session, Start};
use caustica::low_level::preview::view::{View, show};
use caustica::low_level::scene::Allowance;
use glam::DVec3;

use super::worker::{SCENE, folder, loaded, wait};
use crate::support::{FLOOR, bits, caustica, data, error, software};

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
    let own = ticked(&mut session, "the picture turned", |s| {
        done(s).filter(|f| f.number != first.number)
    });

    // an error is reported, and the image stays
    fs::write(&file, SCENE.replace("ior = 1.5", "ior = -1.5")).unwrap();
    let trouble = ticked(&mut session, "trouble", |s| s.trouble.clone());
    assert!(trouble.contains("ball.toml:") && trouble.contains("ior"), "{trouble}");
    assert!(Arc::ptr_eq(&session.frame().unwrap(), &own));

    // a missing mesh, which then appears
    fs::write(&file, SCENE.replace("floor.obj", "ground.obj")).unwrap();
    ticked(&mut session, "other trouble", |s| {
        s.trouble.clone().filter(|t| t.contains("ground.obj"))
    });
    fs::write(folder.join("ground.obj"), FLOOR.replace("3 0 3", "3 0 4")).unwrap();
    let mended =
        ticked(&mut session, "the mended picture", |s| done(s).filter(|f| f.number != own.number));
    assert_eq!(session.trouble, None);
    assert_eq!(session.now.camera, turned, "which the file has not changed");
    assert!(bits(&mended.picture) != bits(&own.picture));

    // the mesh changes
    fs::write(folder.join("ground.obj"), FLOOR).unwrap();
    let same =
        ticked(&mut session, "another mesh", |s| done(s).filter(|f| f.number != mended.number));
    assert!(bits(&same.picture) == bits(&own.picture), "the same scene by another file name");

    // camera and settings that change in the file take effect
    let text = SCENE.replace("floor.obj", "ground.obj").replace("photons = 2000", "photons = 500");
    fs::write(&file, text.replace("[0.0, 1.0, 5.0]", "[0.0, 2.0, 5.0]")).unwrap();
    ticked(&mut session, "new settings", |s| (s.now.settings.photons == 500).then_some(()));
    assert_eq!(session.now.camera.position, DVec3::new(0.0, 2.0, 5.0));
}

/// Theory: a reload obeys the root and the limits of the first load, and so does the check whether
/// an edited file is a scene. Without restrictions the same files load.
#[test]
fn files_that_change_keep_to_the_root_and_the_limits() {
    let outer = folder("confined");
    let root = outer.join("root");
    fs::create_dir(&root).unwrap();
    fs::write(root.join("floor.obj"), FLOOR).unwrap();
    let file = root.join("ball.toml");
    fs::write(&file, SCENE.as_str()).unwrap();
    let data = data("reference/grid.png");
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
    // a texture outside the root: the error with its place, and the previous image
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
    let trouble =
        ticked(&mut session, "other trouble", |s| s.trouble.clone().filter(|t| *t != trouble));
    assert!(trouble.contains("`triangles`"), "{trouble}");
    // the same texture inside
    fs::write(root.join("floor.obj"), FLOOR).unwrap();
    fs::write(&file, textured("grid.png")).unwrap();
    let inside = ticked(&mut session, "the textured picture", |s| {
        done(s).filter(|f| s.trouble.is_none() && f.number != own.number)
    });
    assert!(bits(&inside.picture) != bits(&own.picture));
    // without restrictions
    let mut session = session_within(&root, Allowance::default());
    ticked(&mut session, "the picture", done);
    fs::write(&file, textured("../grid.png")).unwrap();
    ticked(&mut session, "the scene", |s| (s.notice == "the scene was reloaded").then_some(()));
    assert_eq!(session.trouble, None);
}

#[test]
fn pictures_and_scenes_are_saved() {
    let folder = folder("saving");
    let mut session = session(&folder);
    session.act(Action::SavePicture);
    assert!(session.notice.contains("not ready yet") && !folder.join("picture.exr").exists());
    ticked(&mut session, "the picture", done);
    session.act(Action::Orbit(0.3, 0.1));
    session.act(Action::Photons(0.5));
    session.act(Action::Rule);
    session.act(Action::Focus(0.5, 0.5));
    let focus = ticked(&mut session, "a focus", |s| {
        s.notice.contains("focus at").then_some(s.now.camera.focus)
    });
    assert!((3.0..5.2).contains(&focus), "{focus}");
    session.act(Action::Aperture(1.25));
    let frame = ticked(&mut session, "the picture", |s| {
        done(s).filter(|f| f.setup.settings.photons == 1000)
    });
    assert!(session.is_edited());
    session.act(Action::SaveScene);
    session.act(Action::SavePicture);
    assert!(session.notice.starts_with("saved"), "{}", session.notice);
    assert!(!session.is_edited());
    let text = fs::read_to_string(folder.join("ball.toml")).unwrap();
    assert!(text.starts_with("# A ball of glass.\n") && text.contains("] # before it\n"), "{text}");
    assert!(bits(&read(&folder.join("picture.exr")).unwrap()) == bits(&frame.picture));
    // saving does not restart the render, although the file has changed
    std::thread::sleep(Duration::from_millis(800));
    session.tick();
    assert_eq!(session.whole().map(|f| f.number), Some(frame.number));

    // the saved file renders the same image
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
    // another camera only requests the visible view
    session.act(Action::View(View::Picture));
    session.act(Action::Orbit(0.1, 0.0));
    let turned = ticked(&mut session, "the picture turned", |s| {
        done(s).filter(|f| f.number != depth.number)
    });
    assert!(turned.layers.is_empty() && !depth.layers.is_empty());
}

#[test]
fn pictures_are_held_against_others() {
    let folder = folder("comparison");
    let mut session = session(&folder);
    ticked(&mut session, "the picture", done);
    session.act(Action::Keep);
    session.act(Action::Expose(1.0));
    session.act(Action::Orbit(0.3, 0.0));
    let development = session.development();
    let comparison =
        session.comparison.as_ref().unwrap().show(View::Picture, &development, None).unwrap();
    let own = ticked(&mut session, "the picture turned", done);
    let own = show(&own, View::Picture, &development, None).unwrap();
    assert!(session.split == Some(0.5) && own.rgb != comparison.rgb);
    session.act(Action::Keep);
    assert!(session.comparison.is_none() && session.split.is_none());
    // the same bits on another engine
    software();
    session.beside_device("software", || ());
    session.act(Action::Home);
    let equal = ticked(&mut session, "both pictures", |s| {
        let (a, b) = (done(s)?, s.comparison.as_ref()?.frame()?);
        (!b.quick && b.passes == a.passes && b.number > 1)
            .then(|| bits(&a.picture) == bits(&b.picture))
    });
    assert!(equal);
}
