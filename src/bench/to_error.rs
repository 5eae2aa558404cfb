//! Time to error: render time until the error against a reference reaches a goal.

use serde::Serialize;

use crate::engine::{Engine, EngineError};
use crate::film::metrics::{MetricsError, compare, compare_in};
use crate::film::{Picture, Region};
use std::time::{Duration, Instant};

/// Target relMSE of the whole image or of a region.
#[derive(Clone, Debug, PartialEq)]
pub struct Goal {
    /// Region and its name; `None` for the whole image.
    pub region: Option<(String, Region)>,
    /// Target relMSE; `None` to only report the error.
    pub rel_mse: Option<f64>,
    /// relMSE of the reference against the exact image, due to noise. It is subtracted.
    pub truth_noise: f64,
}

/// Error after a number of passes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Number of passes.
    pub passes: u32,
    /// Render time in seconds, without measuring.
    pub seconds: f64,
    /// relMSE minus the noise of the reference.
    pub rel_mse: f64,
}

/// Convergence of the whole image or of a region.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Approach {
    /// Name of the region; `None` for the whole image.
    pub region: Option<String>,
    /// Target relMSE, if any.
    pub goal: Option<f64>,
    /// Time in seconds at which the target was reached; `None` if it was not.
    pub reached_seconds: Option<f64>,
    /// Measured errors, by number of passes.
    pub series: Vec<Point>,
}

/// Limits of a time-to-error run that does not reach all goals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Time limit; no pass starts after it.
    pub time: Duration,
    /// Maximum number of passes.
    pub passes: u32,
}

/// Reason why a time-to-error run failed.
#[derive(Debug, thiserror::Error)]
pub enum ToErrorError {
    /// The engine failed.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The image and the reference cannot be compared.
    #[error(transparent)]
    Metrics(#[from] MetricsError),
}

/// Time in seconds from which on the error stays at or below `goal`, interpolated by a power law
/// between the last measurement above the goal and the next one. The time of the first measurement
/// if none is above, `None` if the last is.
pub fn reached(series: &[Point], goal: f64) -> Option<f64> {
    // NaN is above every goal
    let above = |point: &Point| point.rel_mse.is_nan() || point.rel_mse > goal;
    let Some(last) = series.iter().rposition(above) else {
        return series.first().map(|first| first.seconds);
    };
    let (before, after) = (&series[last], series.get(last + 1)?);
    if !(before.rel_mse.is_finite() && after.rel_mse > 0.0 && goal > 0.0 && before.seconds > 0.0) {
        return Some(after.seconds);
    }
    let share = (before.rel_mse / goal).ln() / (before.rel_mse / after.rel_mse).ln();
    Some(before.seconds * (after.seconds / before.seconds).powf(share))
}

/// Renders passes with a new engine until all goals or a limit are reached. Measures the error
/// after each of the first sixteen passes, then whenever the number of passes has grown by an
/// eighth. `stop` is called after each pass; if it returns true, that pass is the last.
pub fn approach(
    engine: &mut dyn Engine,
    truth: &Picture,
    goals: &[Goal],
    limit: Limit,
    stop: &dyn Fn() -> bool,
) -> Result<Vec<Approach>, ToErrorError> {
    let mut approaches: Vec<Approach> = goals
        .iter()
        .map(|goal| Approach {
            region: goal.region.as_ref().map(|(name, _)| name.clone()),
            goal: goal.rel_mse,
            reached_seconds: None,
            series: Vec::new(),
        })
        .collect();
    let mut time = Duration::ZERO;
    let mut next = 1;
    for passes in 1..=limit.passes.max(1) {
        let begun = Instant::now();
        engine.pass()?;
        time += begun.elapsed();
        let last = passes >= limit.passes || time >= limit.time || stop();
        if passes < next && !last {
            continue;
        }
        next = passes + (passes / 8).max(1);
        let picture = engine.picture()?;
        for (goal, approach) in goals.iter().zip(&mut approaches) {
            let comparison = match &goal.region {
                Some((_, region)) => compare_in(&picture, truth, region)?,
                None => compare(&picture, truth)?,
            };
            let rel_mse = comparison.rel_mse - goal.truth_noise;
            approach.series.push(Point { passes, seconds: time.as_secs_f64(), rel_mse });
            approach.reached_seconds =
                goal.rel_mse.and_then(|goal| reached(&approach.series, goal));
        }
        let open = |a: &Approach| a.goal.is_some() && a.reached_seconds.is_none();
        let sought = approaches.iter().any(|a| a.goal.is_some());
        if last || sought && !approaches.iter().any(open) {
            break;
        }
    }
    Ok(approaches)
}

/// Theory: an error of `c / t` reaches `g` at `c / g`, independent of the measurement times. Noise
/// that raises it above the goal again delays the time to the last such measurement.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::scripted::Scripted;

    fn falling(times: &[f64], error: impl Fn(f64) -> f64) -> Vec<Point> {
        (1..)
            .zip(times)
            .map(|(passes, &t)| Point { passes, seconds: t, rel_mse: error(t) })
            .collect()
    }

    #[test]
    fn planted_series_are_read_right() {
        let series = falling(&[1.0, 2.0, 5.0, 11.0, 20.0], |t| 0.7 / t);
        for goal in [0.5, 0.14, 0.1, 0.0351] {
            assert!((reached(&series, goal).unwrap() - 0.7 / goal).abs() < 1e-9, "{goal}");
        }
        assert_eq!(reached(&series, 0.9), Some(1.0));
        assert_eq!(reached(&series, 0.03), None);
        assert_eq!(reached(&[], 1.0), None);
        let mut bumpy = series.clone();
        bumpy[3].rel_mse = 0.2;
        assert!(reached(&bumpy, 0.15).unwrap() > 11.0);
        bumpy[3].rel_mse = f64::NAN;
        assert_eq!(reached(&bumpy, 0.15), Some(20.0));
        bumpy[4].rel_mse = f64::NAN;
        assert_eq!(reached(&bumpy, 0.15), None);
        // the corrected error may be negative
        let past = falling(&[1.0, 2.0], |t| 1.5 - t);
        assert_eq!(reached(&past, 0.1), Some(2.0));
    }

    /// Test engine: each pass halves the difference of the image from one. The left half starts
    /// with twice the difference.
    fn halver() -> impl Engine {
        Scripted::new(|passes| {
            let difference = 0.5_f32.powi(passes as i32);
            Picture::from_fn(4, 4, |x, _| [1.0 + difference * if x < 2 { 2.0 } else { 1.0 }; 3])
        })
    }

    #[test]
    fn it_ends_where_all_goals_are_reached() {
        let truth = Picture::from_fn(4, 4, |_, _| [1.0; 3]);
        let right = Region { x0: 2, y0: 0, x1: 4, y1: 4 };
        // relMSE of the right half after p passes: 4^-p / 1.01; of the left one, four times that
        let goal = |region, rel_mse, truth_noise| Goal { region, rel_mse, truth_noise };
        let goals = [
            goal(Some(("right".to_owned(), right)), Some(0.3), 0.0),
            goal(None, Some(1.0e-3), 0.0),
            goal(None, None, 0.0),
        ];
        let endless = Limit { time: Duration::from_secs(1000), passes: 1000 };
        let found = approach(&mut halver(), &truth, &goals, endless, &|| false).unwrap();
        let passes = |a: &Approach| a.series.last().unwrap().passes;
        // the mean over both halves without the largest pixel, 36 / 15 4^-p / 1.01, is below 0.001
        // from the sixth pass on
        assert_eq!(found.iter().map(passes).collect::<Vec<_>>(), [6, 6, 6]);
        assert!((found[0].series[0].rel_mse - 0.25 / 1.01).abs() < 1e-6);
        assert_eq!(found[0].reached_seconds, Some(found[0].series[0].seconds));
        assert!(found[1].reached_seconds.unwrap() <= found[1].series[5].seconds);
        assert_eq!((found[2].goal, found[2].reached_seconds), (None, None));
        // pass limit and noise correction
        let short = Limit { passes: 3, ..endless };
        let found =
            approach(&mut halver(), &truth, &[goal(None, Some(1e-3), 0.01)], short, &|| false)
                .unwrap();
        assert_eq!((passes(&found[0]), found[0].reached_seconds), (3, None));
        let error = found[0].series[2].rel_mse;
        let stopped = approach(&mut halver(), &truth, &goals, endless, &|| true).unwrap();
        assert_eq!(passes(&stopped[0]), 1, "passes before the stop are kept");
        assert!((error - (36.0 / 15.0 / 64.0 / 1.01 - 0.01)).abs() < 1e-6, "{error}");
    }
}
