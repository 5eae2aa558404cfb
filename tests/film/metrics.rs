//! Image difference metrics.
//!
//! Theory: the metrics of a constructed pair of images are known in closed form, and each must
//! change when an error is planted.

use caustica::low_level::film::blocks::{block_deviations, share_outside};
use caustica::low_level::film::heat::heat_map;
use caustica::low_level::film::metrics::{MetricsError, compare};
use caustica::low_level::film::{Picture, luminance};

fn grey(width: u32, height: u32, value: f32) -> Picture {
    Picture::from_fn(width, height, |_, _| [value; 3])
}

/// Uniform noise in [-0.5, 0.5] that depends on the seed only (SplitMix64).
fn noise(seed: u64, index: u64) -> f32 {
    let mut z = seed
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .wrapping_add(index.wrapping_mul(0xd1b5_4a32_d192_ed03));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 40) as f32 / (1u64 << 24) as f32 - 0.5
}

fn noisy(width: u32, height: u32, seed: u64, value: f32) -> Picture {
    Picture::from_fn(width, height, |x, y| {
        let v = value + 0.2 * noise(seed, u64::from(y * width + x));
        [v, v, v]
    })
}

#[test]
fn equal_pictures() {
    let picture = noisy(20, 10, 1, 0.5);
    let same = compare(&picture, &picture).unwrap();
    assert_eq!((same.mean_ratio, same.rel_mse, same.rmse), ([1.0; 3], 0.0, 0.0));
    assert_eq!((same.psnr, same.pixels_differing, same.pixels), (f64::INFINITY, 0, 200));
    assert_eq!(same.mean_error(), 0.0);
    let black = grey(4, 4, 0.0);
    assert_eq!(compare(&black, &black).unwrap().mean_ratio, [1.0; 3]);
}

/// Theory: every pixel of `a` is 0.5 and of `b` 0.25, so the ratio is 2, relMSE 0.0625 / 0.0725,
/// RMSE 0.25 and PSNR 0 dB.
#[test]
fn constant_offset() {
    let c = compare(&grey(40, 50, 0.5), &grey(40, 50, 0.25)).unwrap();
    assert_eq!((c.mean_ratio, c.median), ([2.0; 3], 1.0));
    assert_eq!(c.mean_error(), 1.0);
    assert!((c.rel_mse - 0.0625 / 0.0725).abs() < 1e-12, "{}", c.rel_mse);
    assert!((c.rmse - 0.25).abs() < 1e-12 && c.psnr.abs() < 1e-9, "{} {}", c.rmse, c.psnr);
    assert_eq!(c.pixels_differing, 2000);
    // The mean ratio names the one channel that differs.
    let tinted = Picture::from_fn(4, 4, |_, _| [0.25, 0.5, 0.25]);
    assert_eq!(compare(&tinted, &grey(4, 4, 0.25)).unwrap().mean_ratio, [1.0, 2.0, 1.0]);
}

/// Theory: relMSE drops one pixel in a thousand, so it ignores one firefly in 1000 pixels and
/// includes a second one.
#[test]
fn rel_mse_drops_the_largest_thousandth() {
    let truth = grey(50, 20, 1.0);
    let mut a = truth.clone();
    a.rgb[77] = [1000.0; 3];
    assert_eq!(compare(&a, &truth).unwrap().rel_mse, 0.0);
    a.rgb[500] = [3.0; 3];
    let expected = 4.0 / 1.01 / 999.0;
    let found = compare(&a, &truth).unwrap().rel_mse;
    assert!((found - expected).abs() < 1e-9, "{found} {expected}");
}

#[test]
fn worst_pixel_and_bits() {
    let truth = noisy(31, 17, 2, 0.5);
    let mut a = truth.clone();
    let at = 9 * 31 + 22;
    a.rgb[at][2] += 0.125;
    a.rgb[3][0] = f32::from_bits(a.rgb[3][0].to_bits() + 1);
    let c = compare(&a, &truth).unwrap();
    assert_eq!((c.worst.x, c.worst.y, c.worst.a, c.worst.b), (22, 9, a.rgb[at], truth.rgb[at]));
    assert_eq!(c.pixels_differing, 2);
    // Zero and negative zero are equal numbers with different bits.
    let minus = compare(&grey(3, 3, -0.0), &grey(3, 3, 0.0)).unwrap();
    assert_eq!((minus.pixels_differing, minus.rmse), (9, 0.0));
}

#[test]
fn what_cannot_be_compared() {
    let good = grey(4, 4, 1.0);
    assert_eq!(compare(&good, &grey(4, 5, 1.0)), Err(MetricsError::Size { a: (4, 4), b: (4, 5) }));
    let mut bad = good.clone();
    bad.rgb[5] = [f32::NAN, 0.0, f32::INFINITY];
    assert_eq!(
        compare(&good, &bad),
        Err(MetricsError::NotFinite { which: "second", count: 2, at: (1, 1) })
    );
    assert_eq!(
        compare(&bad, &good),
        Err(MetricsError::NotFinite { which: "first", count: 2, at: (1, 1) })
    );
    assert_eq!(compare(&grey(0, 0, 0.0), &grey(0, 0, 0.0)), Err(MetricsError::Empty));
}

/// Theory: for two images of the same mean and independent noise, about 1.7e-4 of 1024 blocks
/// exceed 4 sigma, so at most 2 do (more have a chance below 1e-3, and the noise is fixed). A shift
/// of 2 % of the mean in a quarter of the image (noise of a block mean: 0.2 / sqrt(12) / 8 *
/// sqrt(2) = 0.01, shift 0.1 = 10 sigma) must mark that quarter.
#[test]
fn blocks_agree_within_noise_and_show_a_shift() {
    let truth = noisy(256, 256, 3, 5.0);
    let render = noisy(256, 256, 4, 5.0);
    let blocks = block_deviations(&render, &truth, None, 0.0).unwrap();
    assert_eq!(blocks.len(), 1024);
    assert!(share_outside(&blocks) <= 2.0 / 1024.0, "{}", share_outside(&blocks));
    // The deviations have unit variance: Student's t with 63 degrees of freedom has 63/61, within 5
    // sigma of 1024 draws.
    let variance = blocks.iter().map(|block| block.deviation.powi(2)).sum::<f64>() / 1024.0;
    assert!((variance - 63.0 / 61.0).abs() < 5.0 * (2.0f64 / 1024.0).sqrt(), "{variance}");

    let shifted = Picture::from_fn(256, 256, |x, y| {
        let shift = if x < 128 && y < 128 { 0.1 } else { 0.0 };
        render.rgb[(y * 256 + x) as usize].map(|value| value + shift)
    });
    let blocks = block_deviations(&shifted, &truth, None, 0.0).unwrap();
    for block in blocks.iter().filter(|block| block.x < 128 && block.y < 128) {
        assert!(block.outside() && block.deviation > 0.0, "{block:?}");
    }
    // The same shift passes with an allowance of 3 % bias.
    assert!(share_outside(&block_deviations(&shifted, &truth, None, 0.03).unwrap()) == 0.0);
}

/// Theory: one block of constant difference d = 0.3 with standard error 0.4 in each channel of each
/// pixel. The error of the mean is lum(0.4) / 8 = 0.05, so the deviation is 6.
#[test]
fn standard_errors_enter_the_sigma() {
    let (render, truth) = (grey(8, 8, 1.3), grey(8, 8, 1.0));
    let blocks = block_deviations(&render, &truth, Some(&grey(8, 8, 0.4)), 0.0).unwrap();
    assert!((blocks[0].deviation - 6.0).abs() < 1e-5, "{blocks:?}");
    // With twice the error it is 3, within the bound.
    let blocks = block_deviations(&render, &truth, Some(&grey(8, 8, 0.8)), 0.0).unwrap();
    assert!((blocks[0].deviation - 3.0).abs() < 1e-5 && !blocks[0].outside(), "{blocks:?}");
    assert!(block_deviations(&render, &truth, Some(&grey(9, 8, 0.8)), 0.0).is_err());
    // Only whole blocks count.
    assert_eq!(block_deviations(&grey(23, 9, 1.0), &grey(23, 9, 1.0), None, 0.0).unwrap().len(), 2);
}

/// Equal pixels are black, differing ones brighter for larger differences; the top of the scale is
/// the next power of ten.
#[test]
fn heat_map_shows_where_and_how_much() {
    let truth = grey(400, 30, 0.5);
    let mut a = truth.clone();
    a.rgb[400 * 3 + 7] = [0.5, 0.502, 0.5];
    a.rgb[400 * 4 + 9] = [0.5, 0.5, 0.500_01];
    let map = heat_map(&a, &truth).unwrap();
    assert_eq!(map.width, 400);
    assert!(map.height > 30 && (map.top - 0.01).abs() < 1e-12, "{} {}", map.height, map.top);
    let brightness = |x: usize, y: usize| luminance(map.rgb[y * 400 + x].map(f32::from));
    for y in 0..30 {
        for x in 0..400 {
            let differs = (x, y) == (7, 3) || (x, y) == (9, 4);
            assert_eq!(brightness(x, y) > 0.0, differs, "{x} {y}");
        }
    }
    assert!(brightness(7, 3) > brightness(9, 4));
    // A narrow image gets a scale too, and equal images give a map.
    let narrow = heat_map(&grey(2, 2, 1.0), &grey(2, 2, 1.0)).unwrap();
    assert!(narrow.width > 300 && narrow.rgb.len() == (narrow.width * narrow.height) as usize);
    assert_eq!(narrow.top, 1.0);
}
