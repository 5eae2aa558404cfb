//! The preview's window under Xvfb, drawn and rendered by the software Vulkan driver, with input
//! from xdotool.
//!
//! Theory: user input shows in the files that the preview saves: the rotated camera, the changed
//! setting, and an image that a plain render reproduces bit for bit.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::LazyLock;
use std::thread::sleep;
use std::time::{Duration, Instant};

use crate::support::{
    LAMP, PLANE, Running, ball, bits, command, folder_with, good, shipped, software,
};
use caustica::low_level::film::{file::read_exr, read};
use caustica::low_level::scene;

/// The scene, with comments that saving must preserve.
static SCENE: LazyLock<String> = LazyLock::new(|| {
    let scene = ball((96, 64), "passes = 4\nphotons = 2000 # few", &[PLANE, LAMP]);
    format!("# A ball of glass.\n{}", scene.replace("5.0]\ntarget", "5.0] # before it\ntarget"))
});

const PATIENCE: Duration = Duration::from_secs(120);

fn folder(name: &str) -> PathBuf {
    folder_with(name, &[("ball.toml", &SCENE)])
}

fn preview(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = command(folder, &[&["preview"], arguments].concat());
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(name);
    }
    command.env("NODEVICE_SELECT", "1");
    command
}

/// Columns of the screen.
const COLUMNS: usize = 1100;

/// Starts an X server without a screen and returns its display. The screen's content is in the file
/// `Xvfb_screen0` of `folder`.
fn server(folder: &Path) -> (Running, String) {
    let screen =
        ["-displayfd", "1", "-screen", "0", &format!("{COLUMNS}x760x24"), "-nolisten", "tcp"];
    let mut command = Command::new("Xvfb");
    command.args(screen).arg("-fbdir").arg(folder).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut server = Running::from(command.spawn().unwrap_or_else(|error| {
        panic!(
            "Xvfb does not start ({error}): install it \
             (Debian and Ubuntu: apt install xvfb xdotool)"
        )
    }));
    let mut line = String::new();
    BufReader::new(server.stdout.take().unwrap()).read_line(&mut line).unwrap();
    (server, format!(":{}", line.trim()))
}

/// Runs xdotool with these arguments and returns its output.
fn hand(display: &str, words: &[&str]) -> String {
    let output = Command::new("xdotool").args(words).env("DISPLAY", display).output();
    let output = output.unwrap_or_else(|error| {
        panic!(
            "xdotool does not start ({error}): install it \
             (Debian and Ubuntu: apt install xvfb xdotool)"
        )
    });
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Repeats `act` until `came` holds.
fn until(what: &str, mut act: impl FnMut(), came: impl Fn() -> bool) {
    let begun = Instant::now();
    while !came() {
        assert!(begun.elapsed() < PATIENCE, "{what} does not come about");
        act();
        sleep(Duration::from_millis(250));
    }
}

fn photons(file: &Path) -> Option<String> {
    read_exr(file).ok()?.attributes.get("caustica.photons").cloned()
}

#[test]
fn a_hand_turns_changes_saves_and_closes() {
    software();
    let folder = folder("hand");
    let (_server, display) = server(&folder);
    let mut window = opened(
        &folder,
        &display,
        "ball",
        &["ball.toml", "--device", "software", "-o", "picture.exr"],
    );
    let key = |key: &str| {
        hand(&display, &["key", key]);
    };
    let picture = folder.join("picture.exr");
    until("the first picture", || key("s"), || picture.exists());
    assert_eq!(photons(&picture).as_deref(), Some("2000"));

    // a drag to the right and down from the middle of the image
    let steps =
        ["mousemove", "280", "280", "mousedown", "1", "sleep", "0.1", "mousemove", "310", "290"];
    hand(
        &display,
        &[&steps[..], &["sleep", "0.1", "mousemove", "340", "300", "sleep", "0.1", "mouseup", "1"]]
            .concat(),
    );
    key("comma");
    key("ctrl+s");
    let file = folder.join("ball.toml");
    until("a saved scene", || (), || fs::read_to_string(&file).unwrap() != *SCENE);
    let text = fs::read_to_string(&file).unwrap();
    let differ: Vec<_> = text.lines().zip(SCENE.lines()).filter(|(a, b)| a != b).collect();
    assert_eq!(text.lines().count(), SCENE.lines().count());
    assert!(
        matches!(differ[..], [(position, _), (photons, _)]
        if position.starts_with("position = [") && position.ends_with("] # before it") && photons == "photons = 1000 # few"),
        "{differ:?}"
    );
    let camera = scene::load(&file).unwrap().scene.camera;
    let turned = camera.position - camera.target;
    assert!((turned.length() - 25.25f64.sqrt()).abs() < 1e-3, "an orbit keeps the distance");
    // the scene follows the mouse: the camera moves left and up
    assert!(turned.x < -0.1 && turned.y > 0.6, "{turned}");

    until("the picture turned", || key("s"), || photons(&picture).as_deref() == Some("1000"));
    key("ctrl+q");
    let ended = wait(&mut window);
    assert!(ended.success(), "{ended}");

    // a plain render of the saved scene has the same bits
    good(&folder, &["render", "--quiet", "--like", "picture.exr", "-o", "again.exr"]);
    let bits = |name: &str| bits(&read(&folder.join(name)).unwrap());
    assert!(bits("again.exr") == bits("picture.exr"));
}

/// Starts a preview and waits until its window is open and has the keyboard focus.
fn opened(folder: &Path, display: &str, scene: &str, arguments: &[&str]) -> Running {
    let mut command = preview(folder, arguments);
    let mut window = Running::start(command.env("DISPLAY", display).stderr(Stdio::piped()));
    let mut ids = String::new();
    let begun = Instant::now();
    while ids.is_empty() {
        ids = found(display, scene);
        if let Some(status) = window.try_wait().unwrap() {
            let mut error = String::new();
            window.stderr.take().unwrap().read_to_string(&mut error).unwrap();
            panic!("there is no window: {status} {error}");
        }
        assert!(begun.elapsed() < PATIENCE, "there is no window");
        sleep(Duration::from_millis(50));
    }
    hand(display, &["windowfocus", "--sync", ids.trim()]);
    window
}

/// Content of the screen in the upper part of the image: rows 150 to 250 of columns 150 to 450.
fn seen(folder: &Path) -> Vec<u8> {
    use std::os::unix::fs::FileExt;
    // the pixels follow a header, whose length is its first word (little-endian), and a colour map:
    // rows of 4 bytes a pixel
    let file = fs::File::open(folder.join("Xvfb_screen0")).unwrap();
    let length = file.metadata().unwrap().len();
    let row = 4 * COLUMNS as u64;
    let first = length - 760 * row;
    let mut rows = vec![0; 100 * row as usize];
    file.read_exact_at(&mut rows, first + 150 * row).unwrap();
    rows.chunks(row as usize).flat_map(|row| row[4 * 150..4 * 450].to_vec()).collect()
}

/// Counts the images that the screen shows while the mouse drags for 3 s at 60 Hz.
fn pictures_of_a_drag(folder: &Path, display: &str) -> u32 {
    let mut words: Vec<String> =
        ["mousemove", "150", "450", "mousedown", "1"].map(str::to_owned).to_vec();
    for step in 0..180 {
        let place = [150 + step, 450 + step / 9].map(|at| at.to_string());
        words.extend(
            [
                ["mousemove".to_owned()].as_slice(),
                &place,
                &["sleep".to_owned(), "0.016".to_owned()],
            ]
            .concat(),
        );
    }
    words.extend(["mouseup".to_owned(), "1".to_owned()]);
    let begun = Instant::now();
    let mut mouse = Running::start(Command::new("xdotool").args(&words).env("DISPLAY", display));
    let (mut pictures, mut last) = (0, seen(folder));
    while mouse.try_wait().unwrap().is_none() {
        let now = seen(folder);
        pictures += u32::from(now != last);
        last = now;
        sleep(Duration::from_millis(5));
    }
    println!("{pictures} pictures in {:.2} s", begun.elapsed().as_secs_f64());
    assert!(begun.elapsed() > Duration::from_millis(2500));
    pictures
}

/// Theory: the image follows a mouse drag. While the mouse moves at 60 Hz, without a pause for a
/// whole image, small images follow one another. Two idle cores, which also draw the window, show
/// more than 20; if only images of the mouse's final place were shown there would be one or two.
/// Other programs on these cores slow a drag down, so the best of three counts.
#[test]
fn a_drag_shows_many_pictures() {
    software();
    let folder = folder("drag");
    let (_server, display) = server(&folder);
    let _window =
        opened(&folder, &display, "cornell", &[&shipped("cornell.toml"), "--device", "cpu"]);
    // the scene and its first image are visible
    let blank = seen(&folder);
    until("a picture", || (), || seen(&folder) != blank);
    let mut drags = (0..3).map(|_| {
        sleep(Duration::from_millis(500));
        pictures_of_a_drag(&folder, &display)
    });
    assert!(drags.any(|pictures| pictures >= 6), "a drag shows too few pictures");
}

/// Theory: a window closes on request whatever is being rendered: passes of a hundred million
/// photons, which take a minute or more, are cancelled.
#[test]
fn a_window_closes_while_a_long_pass_runs() {
    software();
    let folder = folder("close");
    // the whole image begins a quarter of a second after the small one, and first compiles
    for (device, wait_ms) in [("cpu", 500), ("cpu", 8000), ("software", 8000)] {
        let (_server, display) = server(&folder);
        let scene = shipped("cornell.toml");
        let line = [&scene, "--device", device, "--photons", "100000000", "--passes", "100"];
        let mut window = opened(&folder, &display, "cornell", &line);
        sleep(Duration::from_millis(wait_ms));
        let begun = Instant::now();
        hand(&display, &["key", "ctrl+q"]);
        let ended = wait(&mut window);
        println!("{device} after {wait_ms} ms: {:?}", begun.elapsed());
        assert!(ended.success(), "{device}: {ended}");
        assert!(begun.elapsed() < Duration::from_secs(3), "{device}: {:?}", begun.elapsed());
    }
}

/// The window's number; empty if there is none yet, which xdotool reports as a failure.
fn found(display: &str, scene: &str) -> String {
    let words = ["search", "--onlyvisible", "--name", &format!("{scene} - caustica")];
    let output = Command::new("xdotool").args(words).env("DISPLAY", display).output();
    let output = output.unwrap_or_else(|error| {
        panic!(
            "xdotool does not start ({error}): install it \
             (Debian and Ubuntu: apt install xvfb xdotool)"
        )
    });
    String::from_utf8_lossy(&output.stdout).trim().to_owned()
}

fn wait(child: &mut Child) -> std::process::ExitStatus {
    let begun = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        assert!(begun.elapsed() < PATIENCE, "the window does not close");
        sleep(Duration::from_millis(20));
    }
}

#[test]
fn without_a_desktop_the_reason_is_told() {
    let folder = folder("nowhere");
    fs::create_dir(folder.join("elsewhere")).unwrap();
    for (display, arguments, code, words) in [
        (None, &["ball.toml", "--device", "cpu"][..], 1, "DISPLAY"),
        (Some(":4999"), &["ball.toml", "--device", "cpu"], 1, "no window can be opened"),
        (None, &["ball.toml", "--device", "nonesuch"], 4, "no device `nonesuch`"),
        (None, &["gone.toml"], 1, "gone.toml"),
        (None, &["ball.toml", "-o", "picture.gif"], 2, ".exr"),
        (None, &["ball.toml", "--device", "cpu", "--root", "."], 1, "DISPLAY"),
        (None, &["ball.toml", "--root", "elsewhere"], 1, "lies outside of elsewhere"),
        (None, &["ball.toml", "--root", "nowhere"], 2, "the folder does not exist"),
        (None, &["ball.toml", "--limit", "shapes=1"], 1, "`shapes`"),
    ] {
        let mut command = preview(&folder, arguments);
        display.into_iter().for_each(|display| {
            command.env("DISPLAY", display);
        });
        let output = command.output().unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {error}");
        assert!(error.contains(words), "{error}");
    }
}
