//! Tone mapping.
//!
//! Theory: a tone curve must rise with radiance, keep grey grey, and stay in [0, 1] for any input.
//! AgX spans 16.5 stops, and its base curve turns about middle grey, 0.18, which becomes one half
//! on a display of exponent 2.2. The sRGB curve is that of IEC 61966-2-1.

use caustica::low_level::film::Development;
use caustica::low_level::film::tonemap::Bits;
use caustica::low_level::math::srgb::srgb_from_linear;
use caustica::low_level::scene::ToneMap;

const BOTH: [ToneMap; 2] = [ToneMap::Agx, ToneMap::Srgb];

fn development(tonemap: ToneMap) -> Development {
    Development { exposure: 0.0, tonemap, bits: Bits::Eight }
}

/// Radiances from 2^-16 to 2^8 in steps of 1/32 stop.
fn ramp() -> impl Iterator<Item = f32> {
    (-16 * 32..8 * 32).map(|i| (i as f32 / 32.0).exp2())
}

fn is_rising(values: impl Iterator<Item = f64>) -> bool {
    values.fold((true, -1.0), |(rising, before), value| (rising && value >= before, value)).0
}

#[test]
fn rises_with_radiance() {
    for tonemap in BOTH {
        assert!(
            is_rising(ramp().map(|value| development(tonemap).display([value; 3])[0])),
            "{tonemap:?}"
        );
    }
    // AgX rises strictly in the visible range.
    let visible = ramp().filter(|value| (0.002..10.0).contains(value));
    let values: Vec<f64> =
        visible.map(|value| development(ToneMap::Agx).display([value; 3])[0]).collect();
    assert!(values.windows(2).all(|pair| pair[1] > pair[0]));
    assert!(!is_rising([0.1, 0.3, 0.2].into_iter()), "the check sees a fall");
}

#[test]
fn grey_stays_grey() {
    for tonemap in BOTH {
        for value in ramp() {
            let [r, g, b] = development(tonemap).display([value; 3]);
            assert!(
                (r - g).abs() < 1e-12 && (g - b).abs() < 1e-12,
                "{tonemap:?} {value}: {r} {g} {b}"
            );
        }
        let [r, g, _] = development(tonemap).display([0.2, 0.25, 0.2]);
        assert!(g - r > 0.01, "the check sees a tint");
    }
}

#[test]
fn stays_in_range() {
    let extremes =
        [0.0, -1.0, 1e-45, 0.18, 1.0, 100.0, f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
    for tonemap in BOTH {
        for r in extremes {
            for g in extremes {
                for b in extremes {
                    let shown = development(tonemap).display([r, g, b]);
                    assert!(
                        shown.iter().all(|v| (0.0..=1.0).contains(v)),
                        "{tonemap:?} {:?}: {shown:?}",
                        [r, g, b]
                    );
                }
            }
        }
    }
}

#[test]
fn known_values() {
    let agx = development(ToneMap::Agx);
    assert_eq!(agx.bytes([0.0; 3]), [0; 3]);
    assert_eq!(agx.bytes([1e6; 3]), [255; 3]);
    // Middle grey, within twice the fit's RMS error of 1.9e-3.
    let grey = agx.display([0.18; 3])[0];
    let on_display = |value: f64| srgb_from_linear(value.powf(2.2));
    assert!((on_display(0.496)..on_display(0.504)).contains(&grey), "{grey}");
    // A very bright light loses its hue, as on film.
    let [r, g, b] = agx.display([1000.0, 100.0, 100.0]);
    assert!(r > 0.95 && g > 0.9 && b > 0.9, "{r} {g} {b}");
    // The clip keeps it.
    assert_eq!(development(ToneMap::Srgb).bytes([1000.0, 0.0, 0.0]), [255, 0, 0]);
    // Points of the standard: its linear toe, 0.5 -> 188 (187.516), and one.
    let srgb = development(ToneMap::Srgb);
    assert_eq!(srgb.bytes([0.0, 0.5, 1.0]), [0, 188, 255]);
    assert!((srgb_from_linear(0.001) - 0.01292).abs() < 1e-15);
    assert!((srgb_from_linear(0.214_041_14) - 0.5).abs() < 1e-7);
}

#[test]
fn exposure_counts_in_stops() {
    for tonemap in BOTH {
        let brighter = Development { exposure: 2.0, ..development(tonemap) };
        assert_eq!(
            brighter.bytes([0.05, 0.1, 0.2]),
            development(tonemap).bytes([0.2, 0.4, 0.8]),
            "{tonemap:?}"
        );
        assert_ne!(
            brighter.bytes([0.05, 0.1, 0.2]),
            development(tonemap).bytes([0.1, 0.2, 0.4]),
            "{tonemap:?}"
        );
    }
}
