//! FLIP and SSIM against reference implementations, and all metrics together.
//!
//! Theory: images defined by formulas of exact binary fractions are identical here and in Python.
//! `tests/data/measures.py` computed their metrics with flip-evaluator 1.7, the FLIP authors'
//! program, which works in f32 (hence a tolerance of 5e-6), and with scikit-image 0.26.0 in f64.

use caustica::low_level::film::colors::magma;
use caustica::low_level::film::flip::{Exposures, PIXELS_PER_DEGREE, hdr_flip, ldr_flip};
use caustica::low_level::film::metrics::MetricsError;
use caustica::low_level::film::ssim::Similarity;
use caustica::low_level::film::{Coding, Difference, Measures, Picture, Region, luminance};

const WIDTH: u32 = 96;
const HEIGHT: u32 = 64;

/// A multiple of 1/256 in [0, 1).
fn unit(x: u32, y: u32, seed: u32) -> f32 {
    let mut h = x
        .wrapping_mul(0x9e37_79b1)
        .wrapping_add(y.wrapping_mul(0x85eb_ca77))
        .wrapping_add(seed.wrapping_mul(0xc2b2_ae3d));
    for (shift, factor) in [(15, 0x2c1b_3c6d), (12, 0x297a_2d39), (15, 1)] {
        h = (h ^ (h >> shift)).wrapping_mul(factor);
    }
    (h >> 24) as f32 / 256.0
}

fn picture(rgb: impl Fn(u32, u32) -> [f32; 3]) -> Picture {
    Picture::from_fn(WIDTH, HEIGHT, rgb)
}

/// Ramps in red and green, and a checkerboard in blue that is shifted by `shift` pixels.
fn ramps(x: u32, y: u32, shift: u32) -> [f32; 3] {
    let checker = if ((x + shift) / 8 + y / 8) % 2 == 1 { 0.75 } else { 0.125 };
    [x as f32 / 128.0, y as f32 / 64.0, checker]
}

fn plain() -> Picture {
    picture(|x, y| ramps(x, y, 0))
}

/// Noise of amplitude 1/4 around zero.
fn noisy() -> Picture {
    picture(|x, y| {
        let rgb = ramps(x, y, 0);
        [0, 1, 2].map(|c| (rgb[c] + (unit(x, y, c as u32 + 1) - 0.5) / 4.0).clamp(0.0, 1.0))
    })
}

fn tinted() -> Picture {
    picture(|x, y| {
        let [r, g, b] = ramps(x, y, 0);
        [r, g / 2.0, b]
    })
}

fn moved() -> Picture {
    picture(|x, y| ramps(x, y, 3))
}

fn turned() -> Picture {
    picture(|x, y| ramps(x, HEIGHT - 1 - y, 0))
}

/// Steps from 1/64 to 32.
fn bright() -> Picture {
    picture(|x, y| {
        let step = ((x / 8) as f32 - 6.0).exp2();
        [step, step * (0.5 + y as f32 / 128.0), step * 0.25]
    })
}

fn speck() -> Picture {
    let bright = bright();
    picture(|x, y| {
        let rgb = bright.rgb[(y * WIDTH + x) as usize];
        [0, 1, 2].map(|c| rgb[c] * (0.75 + unit(x, y, c as u32 + 4) / 2.0))
    })
}

/// Results of the reference implementations.
struct Expected {
    name: &'static str,
    test: Picture,
    truth: Picture,
    ssim: f64,
    ldr: f64,
    /// LDR-FLIP at (0, 0), (40, 20) and (95, 63).
    pixels: [f64; 3],
    hdr: f64,
    exposures: Exposures,
}

#[rustfmt::skip]
fn expected() -> [Expected; 5] {
    let plain_exposures = Exposures { start: 1.23102, stop: 2.19865, count: 2 };
    let steps = Exposures { start: -3.82784, stop: 1.84880, count: 6 };
    let new = |name, test, truth, (ssim, ldr, pixels, hdr), exposures| {
        Expected { name, test, truth, ssim, ldr, pixels, hdr, exposures }
    };
    [
        new("noisy", noisy(), plain(), (0.482_073_935_6, 0.125_859, [0.369_114, 0.108_732, 0.219_975], 0.189_331), plain_exposures),
        new("tinted", tinted(), plain(), (0.968_435_512_8, 0.679_497, [0.116_196, 0.584_984, 0.956_911], 0.565_021), plain_exposures),
        new("moved", moved(), plain(), (0.798_222_072_0, 0.271_826, [0.132_829, 0.318_969, 0.895_962], 0.237_665), plain_exposures),
        new("turned", turned(), plain(), (0.155_538_071_1, 0.822_349, [0.978_363, 0.946_125, 0.987_209], 0.739_054), plain_exposures),
        new("speck", speck(), bright(), (0.912_984_343_9, 0.065_043, [0.038_004, 0.111_436, 0.0], 0.090_065), steps),
    ]
}

fn ssim(a: &Picture, b: &Picture) -> f64 {
    Similarity::of(a, b).unwrap().mean(&Region::whole(b)).unwrap()
}

fn ldr(a: &Picture, b: &Picture) -> f64 {
    ldr_flip(a, b).unwrap().mean(&Region::whole(b))
}

fn hdr(a: &Picture, b: &Picture) -> f64 {
    hdr_flip(a, b).unwrap().map.mean(&Region::whole(b))
}

#[track_caller]
fn assert_close(what: &str, found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{what}: {found}, expected {expected}");
}

#[test]
fn flip_is_that_of_its_authors_program() {
    assert_close("pixels per degree", PIXELS_PER_DEGREE, 67.020_645, 1e-5);
    for Expected { name, test, truth, ldr: mean, pixels, hdr: hdr_mean, exposures, .. } in
        expected()
    {
        let map = ldr_flip(&test, &truth).unwrap();
        assert_close(name, map.mean(&Region::whole(&truth)), mean, 5e-6);
        for ((x, y), value) in [(0, 0), (40, 20), (95, 63)].into_iter().zip(pixels) {
            assert_close(
                &format!("{name} at {x}, {y}"),
                map.values[y * WIDTH as usize + x],
                value,
                5e-6,
            );
        }
        let hdr = hdr_flip(&test, &truth).unwrap();
        assert_close(name, hdr.map.mean(&Region::whole(&truth)), hdr_mean, 5e-6);
        assert_close(name, hdr.exposures.start, exposures.start, 1e-5);
        assert_close(name, hdr.exposures.stop, exposures.stop, 1e-5);
        assert_eq!(hdr.exposures.count, exposures.count, "{name}");
    }
}

#[test]
fn ssim_is_that_of_scikit_image() {
    for Expected { name, test, truth, ssim: mean, .. } in expected() {
        assert_close(name, ssim(&test, &truth), mean, 1e-9);
    }
}

/// Planted errors larger than the noise change each metric further, so the tests above would detect
/// them.
#[test]
fn planted_errors_are_seen() {
    let (plain, noisy) = (plain(), noisy());
    let mut spot = noisy.clone();
    for (x, y) in [(30, 30), (31, 30), (30, 31), (31, 31)] {
        spot.rgb[y * WIDTH as usize + x] = [1.0, 0.0, 1.0];
    }
    assert!(ldr(&spot, &plain) > ldr(&noisy, &plain) + 1e-3);
    assert!(hdr(&spot, &plain) > hdr(&noisy, &plain) + 1e-3);
    assert!(ssim(&spot, &plain) < ssim(&noisy, &plain) - 1e-4);
    // A shift by one pixel keeps the set of values.
    let shifted = picture(|x, y| ramps(x, y, 1));
    assert!(
        ldr(&shifted, &plain) > 0.05
            && hdr(&shifted, &plain) > 0.05
            && ssim(&shifted, &plain) < 0.99
    );
    // HDR-FLIP detects differences that LDR-FLIP clips.
    let brighter = picture(|x, y| {
        bright().rgb[(y * WIDTH + x) as usize].map(|v| if v > 4.0 { 1.5 * v } else { v })
    });
    assert_eq!(ldr(&brighter, &bright()), 0.0);
    assert!(hdr(&brighter, &bright()) > 0.01);
}

/// Theory: equal images differ by exactly zero in every metric. LDR-FLIP and SSIM are symmetric by
/// definition.
#[test]
fn equality_and_symmetry_are_exact() {
    let plain = plain();
    assert_eq!((ldr(&plain, &plain), hdr(&plain, &plain), ssim(&plain, &plain)), (0.0, 0.0, 1.0));
    let difference = Difference::new(&plain, &plain, Coding::Radiance).unwrap();
    let same = difference.measures(None).unwrap();
    assert_eq!((same.ldr_flip, same.hdr_flip, same.ssim), (0.0, Some(0.0), Some(1.0)));
    assert_eq!((same.pixels.mse, same.pixels.psnr), (0.0, f64::INFINITY));
    assert_eq!(ldr_flip(&noisy(), &plain), ldr_flip(&plain, &noisy()));
    assert_eq!(ssim(&noisy(), &plain), ssim(&plain, &noisy()));
    let [a, b] = [(&noisy(), &plain), (&plain, &noisy())].map(|(a, b)| {
        Difference::new(a, b, Coding::Radiance).unwrap().measures(None).unwrap().pixels
    });
    assert_eq!((a.mse, a.rmse), (b.mse, b.rmse));
    assert!(a.rel_mse != b.rel_mse, "relMSE divides by the truth");
}

/// FLIP and SSIM stay in their ranges for extreme inputs: black against white, and random pixels.
#[test]
fn extremes() {
    let flat = |value| picture(move |_, _| [value; 3]);
    let dots = |seed| {
        picture(move |x, y| {
            [0_u32, 1, 2].map(|c| if unit(x, y, seed + c) < 0.5 { 0.0 } else { 1.0 })
        })
    };
    for (a, b) in [(flat(0.0), flat(1.0)), (flat(1e30), flat(-1.0)), (dots(1), dots(5))] {
        let found = ldr_flip(&a, &b).unwrap();
        assert!(found.values.iter().all(|value| (0.0..=1.0).contains(value)));
        assert!(
            hdr_flip(&a, &b).unwrap().map.values.iter().all(|value| (0.0..=1.0).contains(value))
        );
        assert!(ldr(&a, &b) > 0.5 && (-1.0..0.5).contains(&ssim(&a, &b)));
    }
    // Exposures of images that are half or entirely dark.
    let half = picture(|x, _| if x < 60 { [0.0; 3] } else { [1.0; 3] });
    let exposures = Exposures::of(&half);
    assert_eq!((exposures.start > 1.0, exposures.count), (true, 23), "log2 of 2^23");
    assert_eq!(Exposures::of(&flat(0.0)).stops().collect::<Vec<_>>(), [0.0, 0.0]);
    assert_eq!(Exposures::of(&flat(1e-20)).count, 2);
    // One pixel, and one row.
    let tiny = |width, height, value| Picture::from_fn(width, height, |_, _| [value; 3]);
    for (width, height) in [(1, 1), (40, 1), (1, 40)] {
        let (a, b) = (tiny(width, height, 0.25), tiny(width, height, 0.5));
        let found = Difference::new(&a, &b, Coding::Radiance).unwrap().measures(None).unwrap();
        assert!(found.ssim.is_none() && found.ldr_flip > 0.1, "{found:?}");
    }
}

/// An error in one region changes the metrics of that region and not those of a distant one.
#[test]
fn regions_look_at_their_own_pixels() {
    let plain = plain();
    let wrong = picture(|x, y| if x < 32 { [0.5; 3] } else { ramps(x, y, 0) });
    let difference = Difference::new(&wrong, &plain, Coding::Radiance).unwrap();
    let at = |x0, y0, x1, y1| difference.measures(Some(Region { x0, y0, x1, y1 }));
    let (left, right): (Measures, Measures) =
        (at(0, 0, 32, 64).unwrap(), at(64, 0, 96, 64).unwrap());
    assert_eq!(
        (right.pixels.mse, right.ldr_flip, right.hdr_flip, right.ssim),
        (0.0, 0.0, Some(0.0), Some(1.0))
    );
    assert!(
        left.pixels.mse > 0.01
            && left.ldr_flip > 0.1
            && left.hdr_flip > Some(0.1)
            && left.ssim < Some(0.9)
    );
    assert_eq!((left.pixels.pixels, left.pixels.pixels_differing), (32 * 64, 32 * 64));
    // Metrics of the whole image are means of those of its parts, weighted by pixels.
    let whole = difference.measures(None).unwrap();
    let rest = at(32, 0, 96, 64).unwrap();
    let weighted = |of: &dyn Fn(&Measures) -> f64| (of(&left) + 2.0 * of(&rest)) / 3.0;
    assert_close("MSE", whole.pixels.mse, weighted(&|m| m.pixels.mse), 1e-12);
    assert_close("FLIP", whole.ldr_flip, weighted(&|m| m.ldr_flip), 1e-12);
    assert_eq!(at(0, 0, 96, 64).unwrap(), whole);
    // The worst pixel of a region is given by its place in the image.
    let worst = at(8, 50, 32, 64).unwrap().pixels.worst;
    assert!((8..32).contains(&worst.x) && (50..64).contains(&worst.y), "{worst:?}");
    // SSIM windows are centred on pixels 5 to 90, so a region on the border has none.
    assert_eq!(at(0, 0, 5, 64).unwrap().ssim, None);
    assert!(at(0, 0, 6, 64).unwrap().ssim.is_some());
    for (x0, y0, x1, y1) in [(0, 0, 97, 64), (0, 0, 96, 65), (5, 5, 5, 9), (9, 9, 5, 12)] {
        assert!(matches!(at(x0, y0, x1, y1), Err(MetricsError::Region { .. })));
    }
}

/// Entries of matplotlib 3's magma table, most of them between the stops stored here; lightness
/// rises.
#[test]
fn magma_is_magma() {
    for (entry, expected) in [
        (0, [0, 0, 4]),
        (25, [20, 14, 54]),
        (60, [74, 16, 121]),
        (100, [137, 40, 129]),
        (128, [183, 55, 121]),
        (180, [247, 114, 92]),
        (222, [254, 193, 133]),
        (255, [252, 253, 191]),
    ] {
        let found = magma(f64::from(entry) / 255.0);
        let near = found.iter().zip(expected).all(|(a, b): (&u8, u8)| a.abs_diff(b) <= 3);
        assert!(near, "{entry}: {found:?}, expected {expected:?}");
    }
    let light = |entry: u32| luminance(magma(f64::from(entry) / 255.0).map(f32::from));
    assert!((0..248).all(|entry| light(entry) < light(entry + 8)), "more is lighter");
    assert_eq!((magma(-1.0), magma(2.0)), (magma(0.0), magma(1.0)));
}
