//! Analysis of a study: curves averaged over seeds, slopes compared with theory, Pareto front.

use serde::Serialize;

use super::folder::{Point, Results, TruthRecord};
use super::grid::Config;
use super::lamps::Lamp;
use super::statistics::{PowerLaw, Split, Spread, fit, spread};
use crate::scene::settings::{Method, RadiusRule};

/// Statistics of a configuration at a number of passes, over its seeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Number of passes.
    pub passes: u32,
    /// Render time in seconds: the minimum over the seeds, which do the same work, since longer
    /// times are due to other load on the machine.
    pub seconds: f64,
    /// relMSE, corrected for the reference's error.
    pub rel_mse: Spread,
    /// Mean LDR-FLIP, including the reference's noise.
    pub flip: Spread,
    /// Mean luminance divided by that of the reference.
    pub mean_ratio: Spread,
    /// Variance and squared bias, if all seeds are complete.
    pub split: Option<Split>,
}

/// A fitted slope and its asymptotic value by theory.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Slope {
    /// Fit; `None` if there are too few points above the noise.
    pub fitted: Option<PowerLaw>,
    /// Minimum and maximum exponent by theory; `None` if the quantity is zero by theory.
    pub theory: Option<(f64, f64)>,
}

/// Convergence of a configuration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// Index into the study's configurations.
    pub config: usize,
    /// Points in order of passes.
    pub points: Vec<CurvePoint>,
    /// Variance over passes.
    pub variance: Slope,
    /// Squared bias over passes.
    pub bias_sq: Slope,
    /// Mean squared relative error over passes.
    pub mse: Slope,
    /// relMSE over seconds.
    pub rel_mse_by_time: Option<PowerLaw>,
    /// Seconds per pass.
    pub seconds_per_pass: f64,
}

/// A point on the Pareto front: no other point is both faster and more accurate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FrontPoint {
    /// Index into the study's configurations.
    pub config: usize,
    /// Number of passes.
    pub passes: u32,
    /// Render time in seconds.
    pub seconds: f64,
    /// Mean relMSE over the seeds.
    pub rel_mse: f64,
}

/// Figures of all renders that were compared with the same reference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Part {
    /// Reference.
    pub truth: TruthRecord,
    /// Curves of the configurations.
    pub curves: Vec<Curve>,
    /// Pareto front in order of time.
    pub front: Vec<FrontPoint>,
}

impl Part {
    /// Size of the lamps.
    pub fn lamp(&self) -> Option<Lamp> {
        self.truth.lamp
    }

    /// Curves with their relMSE after `seconds`, best first. Omits curves without an image by then.
    pub fn ranking(&self, seconds: f64) -> Vec<(&Curve, f64)> {
        let with = self.curves.iter().filter_map(|curve| Some((curve, curve.error_at(seconds)?)));
        let mut ranking: Vec<_> = with.collect();
        ranking.sort_by(|a, b| a.1.total_cmp(&b.1));
        ranking
    }

    /// Median of the final errors of all configurations.
    pub fn common_error(&self) -> Option<f64> {
        let mut ends: Vec<f64> =
            self.curves.iter().filter_map(|c| Some(c.points.last()?.rel_mse.mean)).collect();
        ends.sort_by(f64::total_cmp);
        ends.get(ends.len() / 2).copied()
    }
}

impl Curve {
    /// relMSE after `seconds`, interpolated between images by a power law; `None` before the first
    /// image, constant after the last.
    pub fn error_at(&self, seconds: f64) -> Option<f64> {
        let last = self.points.last()?;
        if seconds >= last.seconds {
            return Some(last.rel_mse.mean);
        }
        let pair = self
            .points
            .windows(2)
            .find(|pair| (pair[0].seconds..=pair[1].seconds).contains(&seconds))?;
        let points = [0, 1].map(|i| (pair[i].seconds, pair[i].rel_mse.mean));
        Some(fit(&points).map_or(pair[1].rel_mse.mean, |law| law.at(seconds)))
    }

    /// Time in seconds from which on relMSE stays at or below a value, interpolated between images
    /// by a power law; `None` if the last image is above.
    pub fn time_to(&self, rel_mse: f64) -> Option<f64> {
        let above = self.points.iter().rposition(|point| point.rel_mse.mean > rel_mse);
        let Some(above) = above else { return Some(self.points.first()?.seconds) };
        let (from, to) = (self.points[above], self.points.get(above + 1)?);
        let points = [from, *to].map(|point| (point.seconds, point.rel_mse.mean));
        Some(fit(&points).and_then(|law| law.reaches(rel_mse)).unwrap_or(to.seconds))
    }

    /// Number of passes of the first image at or after [`Curve::time_to`].
    pub fn passes_to(&self, rel_mse: f64) -> Option<u32> {
        let above = self.points.iter().rposition(|point| point.rel_mse.mean > rel_mse);
        self.points.get(above.map_or(0, |above| above + 1)).map(|point| point.passes)
    }

    /// Time in seconds to a relMSE that was not reached, extrapolated by the fitted slope.
    pub fn extrapolated_time_to(&self, rel_mse: f64) -> Option<f64> {
        let last = self.points.last()?;
        let law = self.rel_mse_by_time?;
        let slope = law.slope;
        let seconds = last.seconds * (rel_mse / last.rel_mse.mean).powf(1.0 / slope);
        // two points are not enough: they always lie on a line
        (law.half_width.is_some() && slope < -0.05 && seconds.is_finite()).then_some(seconds)
    }
}

/// Analyzes the results of a study, with one part for each reference.
pub fn analyse(results: &Results) -> Vec<Part> {
    let part = |truth: &TruthRecord| {
        let configs = results.about.configs.iter().enumerate();
        let of_truth = configs.filter(|(_, config)| config.variant.lamp == truth.lamp);
        let curves: Vec<Curve> =
            of_truth.filter_map(|(number, config)| curve(results, number, config, truth)).collect();
        Part { truth: truth.clone(), front: front(&curves), curves }
    };
    results.truths.iter().map(part).collect()
}

fn curve(results: &Results, config: usize, setting: &Config, truth: &TruthRecord) -> Option<Curve> {
    let runs: Vec<&[Point]> = results
        .runs
        .iter()
        .filter(|run| run.config == config)
        .map(|run| run.points.as_slice())
        .collect();
    let longest = runs.iter().max_by_key(|points| points.len())?;
    let mut points = Vec::new();
    for passes in longest.iter().map(|point| point.passes) {
        let at =
            || runs.iter().filter_map(move |run| run.iter().find(|point| point.passes == passes));
        let of = |value: fn(&Point) -> f64| spread(&at().map(value).collect::<Vec<_>>());
        let products = results.products.iter().find(|p| (p.config, p.passes) == (config, passes));
        let rel_mse = of(|point| point.rel_mse)?;
        points.push(CurvePoint {
            passes,
            seconds: of(|point| point.seconds)?.low,
            rel_mse: without(rel_mse, truth.rel_mse.unwrap_or(0.0)),
            flip: of(|point| point.flip)?,
            mean_ratio: of(|point| point.mean_ratio)?,
            split: products.and_then(|p| p.products.split(truth.variance.unwrap_or(0.0))),
        });
    }
    let last = points.last()?;
    let (alpha, settings) = (setting.settings.alpha, &setting.settings);
    let (path, fixed) =
        (settings.method == Method::Path, settings.radius_rule == RadiusRule::Fixed);
    let noise_only = path || fixed;
    let by_passes = |value: &dyn Fn(&CurvePoint) -> Option<f64>| {
        let pairs = settled(&points).iter().filter_map(|p| Some((f64::from(p.passes), value(p)?)));
        fit(&pairs.collect::<Vec<_>>())
    };
    let bias = |p: &CurvePoint| {
        let split = p.split?;
        // only significant bias contributes to the slope
        (split.bias_sq > 2.0 * split.bias_sq_error.unwrap_or(0.0)).then_some(split.bias_sq)
    };
    let bias_theory = (-2.0 * (1.0 - alpha), -2.0 * (1.0 - alpha));
    let variance_theory = if noise_only { (-1.0, -1.0) } else { (-1.0, -alpha) };
    let slowest = bias_theory.0.max(-alpha);
    Some(Curve {
        config,
        seconds_per_pass: last.seconds / f64::from(last.passes),
        variance: Slope {
            fitted: by_passes(&|p| Some(p.split?.variance)),
            theory: Some(variance_theory),
        },
        bias_sq: Slope {
            fitted: by_passes(&bias),
            theory: match (path, fixed) {
                (true, _) => None,
                (_, true) => Some((0.0, 0.0)),
                _ => Some(bias_theory),
            },
        },
        mse: Slope {
            fitted: by_passes(&|p| Some(p.split?.mse)),
            theory: match (path, fixed) {
                (true, _) => Some((-1.0, -1.0)),
                (_, true) => Some((-1.0, 0.0)),
                _ => Some((-1.0, slowest)),
            },
        },
        rel_mse_by_time: fit(&settled(&points)
            .iter()
            .map(|p| (p.seconds, p.rel_mse.mean))
            .collect::<Vec<_>>()),
        points,
    })
}

/// Skips the first passes, in which the image has gaps rather than noise, if enough points remain.
fn settled(points: &[CurvePoint]) -> &[CurvePoint] {
    match points.len() {
        0..4 => points,
        4..6 => &points[1..],
        _ => &points[2..],
    }
}

/// Subtracts the reference's error, which is known to about 10 %, so the result is at least 10 % of
/// it.
fn without(values: Spread, own: f64) -> Spread {
    let less = |value: f64| (value - own).max(0.1 * own);
    Spread { mean: less(values.mean), low: less(values.low), high: less(values.high) }
}

fn front(curves: &[Curve]) -> Vec<FrontPoint> {
    let all = curves.iter().flat_map(|curve| {
        curve.points.iter().map(|point| FrontPoint {
            config: curve.config,
            passes: point.passes,
            seconds: point.seconds,
            rel_mse: point.rel_mse.mean,
        })
    });
    let mut all: Vec<FrontPoint> = all.collect();
    all.sort_by(|a, b| a.seconds.total_cmp(&b.seconds).then(a.rel_mse.total_cmp(&b.rel_mse)));
    let mut front: Vec<FrontPoint> = Vec::new();
    for point in all {
        if front.last().is_none_or(|best| point.rel_mse < best.rel_mse) {
            front.push(point);
        }
    }
    front
}

/// Theory: for exact power laws, all results have closed forms.
#[cfg(test)]
mod tests {
    use super::*;

    fn power_law(config: usize, at_one_second: f64, slope: f64, seconds_per_pass: f64) -> Curve {
        let flat = |value| Spread { mean: value, low: value, high: value };
        let point = |i: u32| {
            let seconds = seconds_per_pass * f64::from(1u32 << i);
            CurvePoint {
                passes: 1 << i,
                seconds,
                rel_mse: flat(at_one_second * seconds.powf(slope)),
                flip: flat(0.1),
                mean_ratio: flat(1.0),
                split: None,
            }
        };
        let points: Vec<_> = (0..6).map(point).collect();
        let none = Slope { fitted: None, theory: None };
        let pairs: Vec<_> = points.iter().map(|p| (p.seconds, p.rel_mse.mean)).collect();
        Curve {
            config,
            points,
            variance: none,
            bias_sq: none,
            mse: none,
            rel_mse_by_time: fit(&pairs),
            seconds_per_pass,
        }
    }

    #[test]
    fn times_and_errors_lie_on_the_curve() {
        let curve = power_law(0, 0.01, -1.0, 0.1);
        assert!((curve.error_at(1.0).unwrap() - 0.01).abs() < 1e-12);
        assert!((curve.time_to(0.02).unwrap() - 0.5).abs() < 1e-12);
        assert_eq!(curve.error_at(0.05), None, "no image yet");
        assert_eq!(curve.time_to(0.001), None, "not reached");
        assert_eq!(curve.time_to(1.0), Some(0.1), "the first image is better");
        assert_eq!((curve.passes_to(0.02), curve.passes_to(0.001)), (Some(8), None));
        assert!((curve.extrapolated_time_to(0.001).unwrap() - 10.0).abs() < 1e-9);
    }

    #[test]
    fn the_front_is_what_nothing_beats() {
        // configuration 0 leads until the curves cross at 1 s, then configuration 1
        let curves = vec![power_law(0, 0.01, -0.5, 0.1), power_law(1, 0.01, -1.0, 0.15)];
        let front = front(&curves);
        assert!(
            front.windows(2).all(|p| p[0].seconds < p[1].seconds && p[0].rel_mse > p[1].rel_mse)
        );
        assert!(
            front.iter().all(|p| if p.config == 0 { p.seconds < 1.7 } else { p.seconds > 0.9 }),
            "{front:?}"
        );
        let part = Part {
            truth: TruthRecord { lamp: None, source: String::new(), variance: None, rel_mse: None },
            curves,
            front,
        };
        assert_eq!(part.ranking(0.5)[0].0.config, 0);
        assert_eq!(part.ranking(2.0)[0].0.config, 1);
        assert_eq!(part.ranking(0.12).len(), 1);
    }
}
