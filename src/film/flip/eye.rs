//! What an eye makes of a picture: colors blurred by its contrast sensitivity, and the edges and
//! points it finds.

use std::f64::consts::{PI, SQRT_2};
use std::sync::LazyLock;

use glam::DVec3;
use rayon::prelude::*;

use super::PIXELS_PER_DEGREE;
use super::color::{hunt_lab, hyab, relative_luminance, rgb_from_ycxcz, ycxcz};
use crate::film::Picture;
use crate::film::plane::{Plane, gaussian, normalized};

/// Exponents of color and feature differences, and the bend of the color scale: a share `P_C` of
/// the largest difference becomes `P_T`.
const Q_C: f64 = 0.7;
const Q_F: f64 = 0.5;
const P_C: f64 = 0.4;
const P_T: f64 = 0.95;
/// Distance in degrees of the peak from the trough of the eye's edge detector.
const FEATURE_WIDTH: f64 = 0.082;

/// Contrast sensitivities of achromatic, red-green and blue-yellow as Gaussians `a sqrt(pi / b)
/// exp(-pi^2 d^2 / b)` of the distance `d` in degrees: (a, b) of each (Table 1 of the paper).
const SENSITIVITIES: [&[(f64, f64)]; 3] =
    [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];

/// The HyAB distance of green and blue, to the power of Q_C: the largest there is.
static LARGEST: LazyLock<f64> =
    LazyLock::new(|| hyab(hunt_lab(DVec3::Y), hunt_lab(DVec3::Z)).powf(Q_C));

static BLURS: LazyLock<[Vec<Blur>; 3]> = LazyLock::new(|| SENSITIVITIES.map(blurs));

static FEATURES: LazyLock<FeatureFilters> = LazyLock::new(feature_filters);

/// A separable Gaussian and its share of a filter.
struct Blur {
    share: f64,
    weights: Vec<f64>,
}

/// The Gaussians of one sensitivity, scaled so that the weights of all sum to one over the square
/// they cover.
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

/// A Gaussian and its first two derivatives, whose positive weights sum to 1 and negative ones to
/// -1.
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

/// A picture as it is seen.
pub struct Seen {
    width: usize,
    /// Hunt-adjusted L*a*b* after the blur.
    colors: Vec<DVec3>,
    /// How strong an edge is at each pixel, and how strong a point or line.
    edges: Plane,
    points: Plane,
}

impl Seen {
    /// `display` makes linear display values in [0, 1] of a channel's values.
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

    /// FLIP of two pictures of one size.
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

/// Lengths of the first and the second derivative in x and y.
fn features(luminance: &Plane) -> (Plane, Plane) {
    let FeatureFilters { across, edge, point } = &*FEATURES;
    let length = |x: Plane, y: Plane| x.zip(&y, |x, y| (x * x + y * y).sqrt());
    let flat = luminance.along_x(across);
    let derivative =
        |filter: &[f64]| length(luminance.along_x(filter).along_y(across), flat.along_y(filter));
    (derivative(edge), derivative(point))
}

/// A HyAB distance on a scale from 0 to 1, on which only a twentieth is left to the largest ones.
fn color_difference(distance: f64) -> f64 {
    let (power, bend) = (distance.powf(Q_C), P_C * *LARGEST);
    if power < bend {
        P_T / bend * power
    } else {
        P_T + (power - bend) / (*LARGEST - bend) * (1.0 - P_T)
    }
}
