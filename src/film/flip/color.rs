//! Color spaces of FLIP: YCxCz for spatial filters, Hunt-adjusted L*a*b* for color differences.

use std::sync::LazyLock;

use glam::{DMat3, DVec3};

/// Matrix from linear sRGB to CIE XYZ, as exact fractions derived from the chromaticities of the
/// primaries and D65, as in the authors' implementation.
static XYZ_FROM_RGB: LazyLock<DMat3> = LazyLock::new(|| {
    let columns = [
        DVec3::new(
            10_135_552.0 / 24_577_794.0,
            2_613_072.0 / 12_288_897.0,
            1_425_312.0 / 73_733_382.0,
        ),
        DVec3::new(
            8_788_810.0 / 24_577_794.0,
            8_788_810.0 / 12_288_897.0,
            8_788_810.0 / 73_733_382.0,
        ),
        DVec3::new(
            4_435_075.0 / 24_577_794.0,
            887_015.0 / 12_288_897.0,
            70_074_185.0 / 73_733_382.0,
        ),
    ];
    DMat3::from_cols_array_2d(&columns.map(|column| column.to_array()))
});

/// Matrix from linear sRGB to XYZ relative to the white point.
static RELATIVE_FROM_RGB: LazyLock<DMat3> = LazyLock::new(|| {
    let white = *XYZ_FROM_RGB * DVec3::ONE;
    DMat3::from_diagonal(DVec3::ONE / white) * *XYZ_FROM_RGB
});

static RGB_FROM_RELATIVE: LazyLock<DMat3> = LazyLock::new(|| RELATIVE_FROM_RGB.inverse());

/// Converts linear sRGB to YCxCz: luminance, red-green, blue-yellow. The conversion is affine.
pub fn ycxcz(rgb: DVec3) -> DVec3 {
    opponents(*RELATIVE_FROM_RGB * rgb)
}

/// Converts the Y of YCxCz to relative luminance in [0, 1].
pub fn relative_luminance(y: f64) -> f64 {
    (y + 16.0) / 116.0
}

/// Converts YCxCz to linear sRGB.
pub fn rgb_from_ycxcz(color: DVec3) -> DVec3 {
    let y = relative_luminance(color.x);
    *RGB_FROM_RELATIVE * DVec3::new(y + color.y / 500.0, y, y - color.z / 200.0)
}

/// Converts linear sRGB in [0, 1] to L*a*b* with a* and b* multiplied by L* / 100, since colors
/// appear less saturated at low luminance (Hunt 1952).
pub fn hunt_lab(rgb: DVec3) -> DVec3 {
    const DELTA: f64 = 6.0 / 29.0;
    let root = |t: f64| {
        if t > DELTA.powi(3) { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    };
    let relative = *RELATIVE_FROM_RGB * rgb;
    let lab = opponents(DVec3::new(root(relative.x), root(relative.y), root(relative.z)));
    DVec3::new(lab.x, 0.01 * lab.x * lab.y, 0.01 * lab.x * lab.z)
}

/// HyAB distance (Abasi, Tehran & Fairchild 2019): absolute lightness difference plus Euclidean
/// chroma difference.
pub fn hyab(a: DVec3, b: DVec3) -> f64 {
    let d = a - b;
    d.x.abs() + (d.y * d.y + d.z * d.z).sqrt()
}

fn opponents(v: DVec3) -> DVec3 {
    DVec3::new(116.0 * v.y - 16.0, 500.0 * (v.x - v.y), 200.0 * (v.y - v.z))
}
