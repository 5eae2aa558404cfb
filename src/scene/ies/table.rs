//! Tables of intensity over angles.

use std::f64::consts::PI;

use glam::{DQuat, DVec3};

use super::LUMENS_PER_WATT;

/// Width in texels of the image of a table: one degree.
pub(super) const WIDTH: u32 = 360;
/// Height in texels of the image of a table.
pub(super) const HEIGHT: u32 = 180;
/// Number of samples along each side of a texel.
const SAMPLES: u32 = 2;

/// Symmetry of a table by the range of its horizontal angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Symmetry {
    /// One horizontal angle: symmetric about the axis.
    Axis,
    /// 0 to 90 degrees: four equal quadrants.
    Quadrants,
    /// 0 to 180 degrees: symmetric about the plane 0-180.
    Halves,
    /// 90 to 270 degrees: symmetric about the plane 90-270.
    OtherHalves,
    /// 0 to 360 degrees.
    None,
}

/// Intensities of a luminaire in candela.
#[derive(Debug)]
pub(super) struct Table {
    /// Angles from the nadir in degrees, ascending.
    pub vertical: Vec<f64>,
    /// Angles about the axis in degrees, ascending.
    pub horizontal: Vec<f64>,
    /// Intensity for each vertical angle, for each horizontal one.
    pub candela: Vec<f64>,
    /// Meaning of the horizontal angles.
    pub symmetry: Symmetry,
}

/// The interval of ascending values that contains `x`, and the position in it; `None` outside.
fn interval(values: &[f64], x: f64) -> Option<(usize, f64)> {
    let (first, last) = (values.first()?, values.last()?);
    if x < *first || x > *last {
        return None;
    }
    let k = values.partition_point(|value| *value <= x).clamp(1, values.len() - 1) - 1;
    Some((k, (x - values[k]) / (values[k + 1] - values[k])))
}

impl Table {
    /// Intensity in candela in a direction given by its angles in degrees, linear in both; zero
    /// outside the vertical angles.
    fn intensity(&self, vertical: f64, horizontal: f64) -> f64 {
        let Some((i, s)) = interval(&self.vertical, vertical) else { return 0.0 };
        let column = |k: usize| {
            let at = k * self.vertical.len() + i;
            self.candela[at] * (1.0 - s) + self.candela[at + 1] * s
        };
        let h = horizontal.rem_euclid(360.0);
        let folded = match self.symmetry {
            Symmetry::Axis => return column(0),
            Symmetry::Quadrants => (h % 180.0).min(180.0 - h % 180.0),
            Symmetry::Halves => h.min(360.0 - h),
            Symmetry::OtherHalves if h < 90.0 => 180.0 - h,
            Symmetry::OtherHalves if h > 270.0 => 540.0 - h,
            Symmetry::OtherHalves | Symmetry::None => h,
        };
        let last = self.horizontal.len() - 1;
        let folded = folded.clamp(self.horizontal[0], self.horizontal[last]);
        interval(&self.horizontal, folded)
            .map_or(0.0, |(k, t)| column(k) * (1.0 - t) + column(k + 1) * t)
    }

    /// Equirectangular image of the radiant intensity in W/sr, row 0 towards +y, of the luminaire
    /// turned by `turn`.
    pub fn image(&self, turn: DQuat) -> Vec<[f32; 3]> {
        let back = turn.inverse();
        let at = |x: f64, y: f64| {
            let (sin_phi, cos_phi) = ((0.5 - x / f64::from(WIDTH)) * 2.0 * PI).sin_cos();
            let (sin, cos) = (y / f64::from(HEIGHT) * PI).sin_cos();
            let d = back * DVec3::new(sin * cos_phi, cos, sin * sin_phi);
            let vertical = DVec3::new(d.x, 0.0, d.z).length().atan2(-d.y).to_degrees();
            // counterclockwise seen from above
            let horizontal = (-d.z).atan2(d.x).to_degrees();
            self.intensity(vertical, horizontal)
        };
        let fine = |k: u32| (f64::from(k) + 0.5) / f64::from(SAMPLES);
        let texel = |k: u32| {
            let (x, y) = (f64::from(k % WIDTH), f64::from(k / WIDTH));
            let samples =
                (0..SAMPLES * SAMPLES).map(|s| at(x + fine(s % SAMPLES), y + fine(s / SAMPLES)));
            let mean = samples.sum::<f64>() / f64::from(SAMPLES * SAMPLES);
            [(mean / LUMENS_PER_WATT) as f32; 3]
        };
        (0..WIDTH * HEIGHT).map(texel).collect()
    }
}

/// Theory: the image holds candela / 683; a table of four quadrants repeats each, and one of a half
/// is mirrored at its plane; angle 90 of a luminaire that points down lies towards -z.
#[cfg(test)]
mod tests {
    use super::*;

    fn table(horizontal: &[f64], values: &[f64], symmetry: Symmetry) -> Table {
        let candela = values.iter().flat_map(|value| [*value, *value]).collect();
        Table { vertical: vec![0.0, 180.0], horizontal: horizontal.to_vec(), candela, symmetry }
    }

    #[test]
    fn symmetries() {
        let quadrants = table(&[0.0, 90.0], &[0.0, 90.0], Symmetry::Quadrants);
        let halves = table(&[0.0, 180.0], &[0.0, 180.0], Symmetry::Halves);
        let others = table(&[90.0, 270.0], &[90.0, 270.0], Symmetry::OtherHalves);
        let whole = table(&[0.0, 360.0], &[0.0, 360.0], Symmetry::None);
        for (h, q, s, o) in [
            (30.0, 30.0, 30.0, 150.0),
            (120.0, 60.0, 120.0, 120.0),
            (200.0, 20.0, 160.0, 200.0),
            (350.0, 10.0, 10.0, 190.0),
        ] {
            let found = [&quadrants, &halves, &others, &whole].map(|t| t.intensity(70.0, h));
            let expected = [q, s, o, h];
            let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9, "{h}: {found:?} and {expected:?}");
        }
        let narrow = Table { vertical: vec![0.0, 60.0], ..table(&[0.0], &[5.0], Symmetry::Axis) };
        assert_eq!([narrow.intensity(59.0, 3.0), narrow.intensity(61.0, 3.0)], [5.0, 0.0]);
    }

    #[test]
    fn images() {
        let whole = table(&[0.0, 360.0], &[0.0, 360.0], Symmetry::None);
        let image = whole.image(DQuat::IDENTITY);
        // towards -z: phi = -90 degrees, u = 0.75
        let at = image[(90 * WIDTH + 270) as usize][0];
        assert!((f64::from(at) * LUMENS_PER_WATT - 90.0).abs() < 1.0, "{at}");
    }
}
