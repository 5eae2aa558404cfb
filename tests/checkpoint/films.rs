//! Checkpoints of cropped images and of layers.
//!
//! Theory: the pixels of a window do not depend on those around it, and layers are means over
//! passes like the image. So a resumed render has the bits of an uninterrupted one for both, and
//! merged ranges agree up to rounding.

use caustica::low_level::checkpoint::{Checkpoint, merge, read, write};
use caustica::low_level::device::Wanted;
use caustica::low_level::engine::State;
use caustica::low_level::film::file::read_exr;
use caustica::low_level::scene::settings::{Direct, Method, RadiusRule, RenderSettings};
use caustica::low_level::scene::{Aovs, Film};

use super::{checkpoint_on, fails, folder, good, open_on};
use crate::support::passes;

type Change = fn(&mut RenderSettings);

const CHANGES: [(&str, Change); 5] = [
    ("sppm", |_| ()),
    ("sppm local, photons", |s| (s.radius_rule, s.direct) = (RadiusRule::Local, Direct::Photons)),
    ("ppm", |s| (s.method, s.eye_samples) = (Method::Ppm, 3)),
    ("ppm local", |s| (s.method, s.radius_rule) = (Method::Ppm, RadiusRule::Local)),
    ("path", |s| s.method = Method::Path),
];

/// Sets a window of 15 x 11 of 24 x 16 pixels, with all layers.
fn part(film: &mut Film) {
    (film.width, film.height, film.window) = (24, 16, Some([5, 3, 20, 14]));
    film.aovs = Aovs::parse("all").unwrap();
}

#[test]
fn go_on_with_the_same_bits() {
    for (name, change) in CHANGES {
        let other = if name == "path" { Wanted::Cpu } else { Wanted::Software };
        let mut whole = open_on(&Wanted::Cpu, part, change);
        passes(whole.engine.as_mut(), 5);
        let state = whole.engine.save().unwrap();
        let layers = whole.engine.layers().unwrap();
        assert!(
            layers.len() > 15 && layers.iter().all(|layer| layer.plane.values.len() == 165),
            "{name}"
        );
        for devices in [[&Wanted::Cpu, &other], [&other, &Wanted::Cpu]] {
            let file = folder(&format!("films {name}")).join("a.checkpoint");
            let mut held = State::before(0);
            for (device, count) in [(devices[0], 2), (devices[1], 3)] {
                let mut opened = open_on(device, part, change);
                opened.engine.restore(&held).unwrap();
                assert!(
                    held.passes == 0 || opened.engine.save().unwrap() == held,
                    "{name}: in and out"
                );
                passes(opened.engine.as_mut(), count);
                let saved = opened.engine.save().unwrap();
                let made = checkpoint_on(&opened, part, saved);
                write(&file, &made).unwrap();
                let after = read(&file).unwrap();
                assert!(after == made, "{name}: what is read is not what was written");
                held = after.state;
            }
            assert!(held == state, "{name}: {devices:?}");
        }
        // layers are also available when no pass is left to render
        let mut again = open_on(&other, part, change);
        again.engine.restore(&state).unwrap();
        assert!(again.engine.layers().unwrap() == layers, "{name}");
        // a developed checkpoint equals the engine's own result
        let made = checkpoint_on(&whole, part, state);
        assert!(made.develop().0 == whole.engine.picture().unwrap(), "{name}");
        for (developed, layer) in made.layers().iter().zip(&layers) {
            assert!(developed == layer, "{name}: {}", layer.name);
        }
        assert_eq!(made.layers().len(), layers.len());
    }
}

#[test]
fn the_f64_engine_too() {
    let change: Change = |s| s.radius_rule = RadiusRule::Local;
    let mut whole = open_on(&Wanted::CpuDouble, part, change);
    passes(whole.engine.as_mut(), 3);
    let half_way = whole.engine.save().unwrap();
    passes(whole.engine.as_mut(), 2);
    let mut next = open_on(&Wanted::CpuDouble, part, change);
    next.engine.restore(&half_way).unwrap();
    passes(next.engine.as_mut(), 2);
    let state = next.engine.save().unwrap();
    assert!(state == whole.engine.save().unwrap());
    assert!(checkpoint_on(&next, part, state).layers() == whole.engine.layers().unwrap());
}

/// The comparison detects every kind of lost state.
#[test]
fn nothing_may_be_left_behind() {
    let mut opened = open_on(&Wanted::Cpu, part, |_| ());
    passes(opened.engine.as_mut(), 3);
    let state = opened.engine.save().unwrap();
    for device in [Wanted::Cpu, Wanted::Software] {
        let after = |count: u32, spoil: &dyn Fn(&mut State)| {
            let mut state = state.clone();
            spoil(&mut state);
            let mut next = open_on(&device, part, |_| ());
            next.engine.restore(&state).unwrap();
            passes(next.engine.as_mut(), count);
            next.engine.layers().unwrap()
        };
        for count in [0, 1] {
            let sound = after(count, &|_| ());
            assert!(after(count, &|state| state.layers.aovs.fill(0)) != sound, "{device:?}: aovs");
            assert!(
                after(count, &|state| state.layers.parts.fill(0)) != sound,
                "{device:?}: parts"
            );
            let spoilt = after(count, &|state| state.layers.counts.fill(0)) != sound;
            assert_eq!(spoilt, count == 0, "{device:?}: photons of the last pass");
        }
        let lacks = |spoil: &dyn Fn(&mut State)| {
            let mut state = state.clone();
            spoil(&mut state);
            open_on(&device, part, |_| ()).engine.restore(&state).is_err()
        };
        assert!(
            lacks(&|state| state.layers.aovs.clear()) && lacks(&|state| state.layers.parts.clear())
        );
        assert!(lacks(&|state| state.layers.counts.clear()) && !lacks(&|_| ()));
    }
}

fn range(first: u32, end: u32, change: Change) -> Checkpoint {
    let mut opened = open_on(&Wanted::Cpu, part, change);
    opened.engine.restore(&State::before(first)).unwrap();
    passes(opened.engine.as_mut(), end - first);
    let state = opened.engine.save().unwrap();
    checkpoint_on(&opened, part, state)
}

fn merged(parts: &[Checkpoint]) -> Checkpoint {
    let named =
        parts.iter().enumerate().map(|(i, part)| (format!("{i}.checkpoint").into(), part.clone()));
    merge(named.collect()).unwrap()
}

/// Returns the layer that differs most, and its difference relative to its largest value.
fn distance(a: &Checkpoint, b: &Checkpoint) -> (f64, &'static str) {
    let (a, b) = (a.layers(), b.layers());
    assert_eq!(a.len(), b.len());
    let far = a.iter().zip(&b).map(|(a, b)| {
        assert_eq!(a.name, b.name);
        let size = |x: f64| if x.abs() < 1e9 { x.abs() } else { 0.0 };
        let largest = b.plane.values.iter().fold(1e-30, |m: f64, x| m.max(size(*x)));
        let pairs = a.plane.values.iter().zip(&b.plane.values);
        (pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest, a.name)
    });
    far.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
}

/// Bound for the rounding of a mean in f32 over a few passes.
const BOUND: f64 = 1e-6;

#[test]
fn ranges_give_the_layers_of_all() {
    for (name, change) in [CHANGES[0], CHANGES[2], CHANGES[4]] {
        let whole = range(0, 24, change);
        for cuts in [&[0, 12, 24][..], &[0, 1, 24], &[0, 5, 6, 19, 24]] {
            let parts: Vec<_> = cuts.windows(2).map(|cut| range(cut[0], cut[1], change)).collect();
            let (far, layer) = distance(&merged(&parts), &whole);
            println!("{name} {cuts:?}: {far:.1e}, {layer}");
            assert!(far <= BOUND, "{name} {cuts:?}: {layer} {far:e}");
        }
        // the comparison detects one pass of 24 that replaces another, except where visible points
        // are fixed
        let mut other = range(11, 23, change);
        other.state.first_pass = 12;
        let (far, layer) = distance(&merged(&[range(0, 12, change), other]), &whole);
        assert!(far > 10.0 * BOUND, "{name}: {layer} {far:e}");
    }
}

/// The command line resumes and merges crops, and reports a different crop or missing layers.
#[test]
fn the_program_keeps_crops_and_layers() {
    let folder = folder("crops");
    let line = "render ball.toml --device cpu --quiet --crop 5,3,20,14 --aov albedo,depth,indirect,photons";
    let channels = |file: &str| read_exr(&folder.join(file)).unwrap();
    good(&folder, &format!("{line} --passes 9 --checkpoint whole.checkpoint -o whole.exr"));
    good(&folder, &format!("{line} --passes 4 --checkpoint a.checkpoint -o a.exr"));
    good(&folder, &format!("{line} --passes 4..9 --checkpoint b.checkpoint -o b.exr"));
    good(&folder, &format!("{line} --passes 9 --resume a.checkpoint -o gone-on.exr"));
    let [whole, gone_on] = ["whole.exr", "gone-on.exr"].map(channels);
    assert!(whole.channels == gone_on.channels && whole.frame == gone_on.frame);
    assert_eq!((whole.width, whole.height, whole.channels.len()), (15, 11, 3 + 2 + 3 + 1 + 3 + 1));
    assert_eq!(
        (whole.frame.x, whole.frame.y, whole.frame.width, whole.frame.height),
        (5, 3, 24, 16)
    );
    // one checkpoint gives its own file's channels; two give those of the whole up to rounding
    good(&folder, "merge whole.checkpoint -o same.exr");
    let same = channels("same.exr");
    assert!(same.channels == whole.channels && same.frame == whole.frame);
    for (name, value) in &same.attributes {
        assert_eq!(Some(value), whole.attributes.get(name), "{name}");
    }
    good(&folder, "merge b.checkpoint a.checkpoint -o ab.exr -o ab.checkpoint -o ab.png");
    let ab = channels("ab.exr");
    assert!(ab.frame == whole.frame && ab.channels.keys().eq(whole.channels.keys()));
    for (name, values) in &whole.channels {
        let largest = values.iter().fold(0f32, |m, x| m.max(x.abs()));
        let far =
            values.iter().zip(&ab.channels[name]).map(|(x, y)| (x - y).abs()).fold(0f32, f32::max);
        assert!(far <= 1e-5 * largest, "{name}: {far} of {largest}");
    }
    // fewer layers may be requested, but not others
    let fewer = line.replace("albedo,depth,indirect,photons", "depth");
    good(&folder, &format!("{fewer} --passes 9 --resume a.checkpoint -o depth.exr"));
    assert_eq!(channels("depth.exr").channels["depth.Z"], whole.channels["depth.Z"]);
    let refused = |options: &str, words: &[&str]| {
        let words =
            [&["a.checkpoint: the checkpoint belongs to a different render"], words].concat();
        let line = format!(
            "render ball.toml --device cpu --quiet --resume a.checkpoint -o x.exr {options}"
        );
        fails(&folder, &line, 1, &words);
    };
    refused("", &["crop: expected the whole image, found 5,3,20,14"]);
    refused("--crop 5,3,20,15", &["crop: expected 5,3,20,15, found 5,3,20,14"]);
    let crop = "--crop 5,3,20,14";
    refused(
        &format!("{crop} --aov normal,depth"),
        &["layers: expected normal,depth, found albedo,depth,indirect,photons"],
    );
    let range = |options: &str, name: &str| {
        let line = "render ball.toml --device cpu --quiet --passes 4..9";
        good(&folder, &format!("{line} {options} --checkpoint {name} -o x.exr"));
        fails(&folder, &format!("merge a.checkpoint {name} -o y.exr"), 1, &[name, "expected"]);
    };
    range("--crop 5,3,20,13 --aov albedo,depth,indirect,photons", "window.checkpoint");
    range(crop, "bare.checkpoint");
}
