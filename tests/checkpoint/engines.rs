//! Engines that resume from a state saved by another engine.
//!
//! Theory: the saved state, the scene, the settings and the pass number determine every later pass,
//! so a resumed render has the bits of an uninterrupted one on any device.

use caustica::low_level::checkpoint::{read, write};
use caustica::low_level::device::Wanted;
use caustica::low_level::engine::{EngineError, LayerState, State};
use caustica::low_level::kernels::bytes::{AOV_BYTES, PARTS_BYTES};
use caustica::low_level::scene::settings::{Direct, Method, Radius, RadiusRule, RenderSettings};
use caustica::low_level::scene::{Aovs, Film};

use super::{checkpoint, folder, open, open_on};
use crate::support::passes;

const SIZE: (u32, u32) = (24, 16);

type Change = fn(&mut RenderSettings);

const CHANGES: [(&str, Change); 7] = [
    ("sppm global", |_| ()),
    ("sppm local", |s| s.radius_rule = RadiusRule::Local),
    ("sppm fixed, photons", |s| (s.radius_rule, s.direct) = (RadiusRule::Fixed, Direct::Photons)),
    ("ppm global", |s| s.method = Method::Ppm),
    ("ppm local, photons", |s| {
        (s.method, s.radius_rule, s.direct) = (Method::Ppm, RadiusRule::Local, Direct::Photons);
    }),
    ("path", |s| s.method = Method::Path),
    ("path local", |s| (s.method, s.radius_rule) = (Method::Path, RadiusRule::Local)),
];

/// Returns the state of a six-pass render that starts on the first device, resumes from a file on
/// the second device after two passes, and on the first again after five.
fn broken(devices: [&Wanted; 2], name: &str, change: Change) -> State {
    let file = folder(&format!("engines {name}")).join("a.checkpoint");
    let mut state = State::before(0);
    for (device, count) in [(devices[0], 2), (devices[1], 3), (devices[0], 1)] {
        let mut opened = open(device, SIZE, change);
        opened.engine.restore(&state).unwrap();
        passes(opened.engine.as_mut(), count);
        let saved = opened.engine.save().unwrap();
        let before = checkpoint(&opened, SIZE, saved);
        write(&file, &before).unwrap();
        let after = read(&file).unwrap();
        assert!(after == before, "{name}: what is read is not what was written");
        state = after.state;
    }
    state
}

#[test]
fn go_on_with_the_same_bits() {
    for (name, change) in CHANGES {
        let path = name.starts_with("path");
        let mut whole = open(&Wanted::Cpu, SIZE, change);
        passes(whole.engine.as_mut(), 6);
        let state = whole.engine.save().unwrap();
        assert_eq!((state.first_pass, state.passes, state.bits), (0, 6, 32));
        assert_eq!(state.statistics.is_empty(), path || !name.contains("local"), "{name}");
        let other = if path { &Wanted::Cpu } else { &Wanted::Software };
        assert!(
            broken([&Wanted::Cpu, other], name, change) == state,
            "{name}: cpu, {other:?}, cpu"
        );
        if !path {
            assert!(
                broken([other, &Wanted::Cpu], name, change) == state,
                "{name}: {other:?}, cpu, {other:?}"
            );
        }
        // a developed checkpoint equals the engine's own result
        let (picture, errors, rejections) = checkpoint(&whole, SIZE, state).develop();
        assert!(picture == whole.engine.picture().unwrap(), "{name}");
        assert!(errors == whole.engine.errors().unwrap(), "{name}");
        assert_eq!(rejections, whole.engine.rejections().unwrap(), "{name}");
    }
}

#[test]
fn the_f64_engine_too() {
    for (name, change) in [CHANGES[1], CHANGES[3]] {
        let mut whole = open(&Wanted::CpuDouble, SIZE, change);
        passes(whole.engine.as_mut(), 6);
        let state = whole.engine.save().unwrap();
        assert_eq!(state.bits, 64);
        assert!(broken([&Wanted::CpuDouble; 2], &format!("f64 {name}"), change) == state, "{name}");
        let (picture, errors, _) = checkpoint(&whole, SIZE, state).develop();
        assert!(
            picture == whole.engine.picture().unwrap() && errors == whole.engine.errors().unwrap()
        );
    }
}

/// The comparison detects every kind of lost state: statistics, the film, the number of passes, and
/// the pass of fixed visible points.
#[test]
fn nothing_may_be_left_behind() {
    let change: Change = |s| (s.method, s.radius_rule) = (Method::Ppm, RadiusRule::Local);
    for device in [Wanted::Cpu, Wanted::Software] {
        let after = |spoil: &dyn Fn(&mut State)| {
            let mut opened = open(&device, SIZE, change);
            passes(opened.engine.as_mut(), 3);
            let mut state = opened.engine.save().unwrap();
            spoil(&mut state);
            let mut next = open(&device, SIZE, change);
            next.engine.restore(&state).unwrap();
            passes(next.engine.as_mut(), 3);
            next.engine.save().unwrap().film
        };
        let sound = after(&|_| ());
        assert!(after(&|state| state.statistics.fill(0)) != sound, "{device:?}: statistics");
        assert!(after(&|state| state.film.fill(0)) != sound, "{device:?}: film");
        assert!(after(&|state| state.passes -= 1) != sound, "{device:?}: passes");
        assert!(after(&|state| state.film[0] ^= 1) != sound, "{device:?}: a bit");
    }
    // passes from 3 on use the visible points of pass 0
    let fixed: Change = |s| s.method = Method::Ppm;
    let picture = |first: u32| {
        let mut opened = open(&Wanted::Cpu, SIZE, |s| {
            fixed(s);
            s.photons = 1;
        });
        opened.engine.restore(&State::before(first)).unwrap();
        opened.engine.pass().unwrap();
        opened.engine.picture().unwrap()
    };
    let same = picture(0).rgb.iter().zip(&picture(3).rgb).filter(|(a, b)| a == b).count();
    assert!(same > 24 * 16 * 9 / 10, "all but what one photon lights: {same}");
}

/// With more visible points than one chunk holds, buffers of several chunks are written to the file
/// and restored from it, including those of layers.
#[test]
fn chunks_are_put_together() {
    let film = |film: &mut Film| {
        (film.width, film.height, film.aovs) = (513, 512, Aovs::parse("all").unwrap());
    };
    let change: Change = |s| {
        (s.method, s.radius_rule, s.photons) = (Method::Ppm, RadiusRule::Local, 3000);
        (s.direct, s.radius) = (Direct::Photons, Radius::Units(0.2));
    };
    let mut cpu = open_on(&Wanted::Cpu, film, change);
    passes(cpu.engine.as_mut(), 1);
    let half_way = cpu.engine.save().unwrap();
    // the last chunk, one row, differs from the start of the first chunk
    let LayerState { aovs, parts, counts, .. } = &half_way.layers;
    assert!(parts[..512 * PARTS_BYTES] != parts[parts.len() - 512 * PARTS_BYTES..]);
    assert!(aovs[..512 * AOV_BYTES] != aovs[aovs.len() - 512 * AOV_BYTES..]);
    assert!(counts[..2048] != counts[counts.len() - 2048..]);
    passes(cpu.engine.as_mut(), 1);
    let mut software = open_on(&Wanted::Software, film, change);
    software.engine.restore(&half_way).unwrap();
    assert!(software.engine.save().unwrap() == half_way, "in and out");
    passes(software.engine.as_mut(), 1);
    assert!(software.engine.save().unwrap() == cpu.engine.save().unwrap());
}

#[test]
fn what_does_not_fit_is_refused() {
    for device in [Wanted::Cpu, Wanted::Software] {
        let mut opened = open(&device, SIZE, |_| ());
        passes(opened.engine.as_mut(), 1);
        let state = opened.engine.save().unwrap();
        let refused = |size, change: Change, state: &State| {
            let error = open(&device, size, change).engine.restore(state);
            matches!(error, Err(EngineError::Unsupported(_)))
        };
        assert!(!refused(SIZE, |_| (), &state));
        assert!(refused((24, 17), |_| (), &state), "{device:?}: another size");
        assert!(
            refused(SIZE, |s| s.radius_rule = RadiusRule::Local, &state),
            "{device:?}: no statistics"
        );
        assert!(
            refused(SIZE, |_| (), &State { bits: 64, ..state.clone() }),
            "{device:?}: precision"
        );
        let local: Change = |s| s.radius_rule = RadiusRule::Local;
        assert!(
            refused(SIZE, local, &State::before(1)),
            "{device:?}: a range under the local rule"
        );
        assert!(!refused(SIZE, local, &State::before(0)));
    }
}
