//! Model of human vision in FLIP: color filtering by contrast sensitivity, and detection of edges
//! and points.

use std::f64::consts::{PI, SQRT_2};
use std::sync::LazyLock;

use glam::DVec3;
use rayon::prelude::*;

use super::PIXELS_PER_DEGREE;
use super::color::{hunt_lab, hyab, relative_luminance, rgb_from_ycxcz, ycxcz};
use crate::film::Picture;
use crate::film::plane::{Plane, gaussian, normalized};

/// Exponents of color and feature differences, and the knee of the color scale: a fraction `P_C` of
/// the largest difference maps to `P_T`.
const Q_C: f64 = 0.7;
const Q_F: f64 = 0.5;
const P_C: f64 = 0.4;
const P_T: f64 = 0.95;
/// Peak-to-trough distance of the edge detector, in degrees.
const FEATURE_WIDTH: f64 = 0.082;

/// Contrast sensitivities of the achromatic, red-green and blue-yellow channels as sums of
/// Gaussians `a sqrt(pi / b) exp(-pi^2 d^2 / b)` of the distance `d` in degrees: (a, b) of each
/// (paper, Table 1).
const SENSITIVITIES: [&[(f64, f64)]; 3] =
    [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];

/// HyAB distance between green and blue to the power of Q_C: the maximum over all colors.
static LARGEST: LazyLock<f64> =
    LazyLock::new(|| hyab(hunt_lab(DVec3::Y), hunt_lab(DVec3::Z)).powf(Q_C));

static BLURS: LazyLock<[Vec<Blur>; 3]> = LazyLock::new(|| SENSITIVITIES.map(blurs));

static FEATURES: LazyLock<FeatureFilters> = LazyLock::new(feature_filters);

/// A separable Gaussian and its weight in a filter.
struct Blur {
    share: f64,
    weights: Vec<f64>,
}

/// Gaussians of one contrast sensitivity, scaled so that the weights of the whole filter sum to
/// one.
fn blurs(sensitivity: &[(f64, f64)]) -> Vec<Blur> {
    let sigma = |b: f64| (b / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE;
    let widest =
        SENSITIVITIES.iter().copied().flatten().fold(0.0, |widest: f64, (_, b)| widest.max(*b));
    let radius = (3.0 * sigma(widest)).ceil() as usize;
    let gaussians: Vec<_> = sensitivity.iter().map(|&(_, b)| gaussian(sigma(b), radius)).collect();
    let volume = |(&(a, b), weights): (&(f64, f64), &Vec<f64>)| {
        a * (PI / b).sqrt() * weights.iter().sum::<f64>().powi(2)
    };
    let volumes: Vec<_> = sensitivity.iter().zip(&gaussians).map(volume).collect();
    let all: f64 = volumes.iter().sum();
    let blur = |(weights, volume): (&Vec<f64>, &f64)| Blur {
        share: volume / all,
        weights: normalized(weights),
    };
    gaussians.iter().zip(&volumes).map(blur).collect()
}

/// A Gaussian and its first two derivatives. The positive weights of each derivative sum to 1, the
/// negative ones to -1.
struct FeatureFilters {
    across: Vec<f64>,
    edge: Vec<f64>,
    point: Vec<f64>,
}

fn feature_filters() -> FeatureFilters {
    let sigma = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let radius = (3.0 * sigma).ceil() as usize;
    let bell = gaussian(sigma, radius);
    let times = |factor: &dyn Fn(f64) -> f64| {
        let weights: Vec<_> =
            bell.iter().enumerate().map(|(i, g)| factor(i as f64 - radius as f64) * g).collect();
        let sum = |sign: f64| weights.iter().map(|w| (sign * w).max(0.0)).sum::<f64>();
        let (positive, negative) = (sum(1.0), sum(-1.0));
        weights.iter().map(|w| if *w < 0.0 { w / negative } else { w / positive }).collect()
    };
    FeatureFilters {
        across: normalized(&bell),
        edge: times(&|x| -x),
        point: times(&|x| (x / sigma).powi(2) - 1.0),
    }
}

/// An image after the vision model.
pub struct Seen {
    width: usize,
    /// Hunt-adjusted L*a*b* after the blur.
    colors: Vec<DVec3>,
    /// Edge strength at each pixel.
    edges: Plane,
    /// Strength of points and lines at each pixel.
    points: Plane,
}

impl Seen {
    /// Applies the model. `display` maps a channel value to a linear display value in [0, 1].
    pub fn of(picture: &Picture, display: impl Fn(f64) -> f64 + Sync) -> Self {
        let width = picture.width as usize;
        let seen = |rgb: &[f32; 3]| ycxcz(DVec3::from(rgb.map(|value| display(f64::from(value)))));
        let light: Vec<DVec3> = picture.rgb.par_iter().map(seen).collect();
        let channel =
            |i: usize| Plane { width, values: light.par_iter().map(|color| color[i]).collect() };
        let [y, cx, cz] = [0, 1, 2].map(|i| blurred(&channel(i), &BLURS[i]));
        let blurred = |i: usize| {
            let rgb = rgb_from_ycxcz(DVec3::new(y.values[i], cx.values[i], cz.values[i]));
            hunt_lab(rgb.clamp(DVec3::ZERO, DVec3::ONE))
        };
        let colors = (0..light.len()).into_par_iter().map(blurred).collect();
        let values = light.par_iter().map(|color| relative_luminance(color.x)).collect();
        let (edges, points) = features(&Plane { width, values });
        Self { width, colors, edges, points }
    }

    /// FLIP of two images of equal size.
    pub fn difference(&self, other: &Self) -> Plane {
        let flip = |i: usize| {
            let color = color_difference(hyab(self.colors[i], other.colors[i]));
            let edge = (self.edges.values[i] - other.edges.values[i]).abs();
            let point = (self.points.values[i] - other.points.values[i]).abs();
            let feature = (edge.max(point) / SQRT_2).powf(Q_F);
            color.powf(1.0 - feature)
        };
        Plane {
            width: self.width,
            values: (0..self.colors.len()).into_par_iter().map(flip).collect(),
        }
    }
}

fn blurred(plane: &Plane, blurs: &[Blur]) -> Plane {
    let part = |blur: &Blur| {
        let weights: Vec<_> = blur.weights.iter().map(|weight| weight * blur.share).collect();
        plane.along_x(&blur.weights).along_y(&weights)
    };
    let first = part(&blurs[0]);
    blurs[1..].iter().fold(first, |sum, blur| sum.zip(&part(blur), |a, b| a + b))
}

/// Magnitudes of the first and second derivatives in x and y: edges and points.
fn features(luminance: &Plane) -> (Plane, Plane) {
    let FeatureFilters { across, edge, point } = &*FEATURES;
    let length = |x: Plane, y: Plane| x.zip(&y, |x, y| (x * x + y * y).sqrt());
    let flat = luminance.along_x(across);
    let derivative =
        |filter: &[f64]| length(luminance.along_x(filter).along_y(across), flat.along_y(filter));
    (derivative(edge), derivative(point))
}

/// Maps a HyAB distance to [0, 1] with a knee: the largest distances share the top 5 %.
fn color_difference(distance: f64) -> f64 {
    let (power, bend) = (distance.powf(Q_C), P_C * *LARGEST);
    if power < bend {
        P_T / bend * power
    } else {
        P_T + (power - bend) / (*LARGEST - bend) * (1.0 - P_T)
    }
}
