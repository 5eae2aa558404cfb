//! Sentences and number formats of reports.

use super::analysis::{Curve, Part, Slope};
use super::folder::About;
use super::grid::Config;
use super::statistics::Spread;

/// Label of a configuration without its lamp size.
pub fn configured(config: &Config) -> String {
    config.label_without(&["lamp_area"])
}

/// Formats a number with three significant digits, or fewer for small ones.
pub fn short(value: f64) -> String {
    match value {
        0.0 => "0".to_owned(),
        v if v.abs() < 0.001 => format!("{v:.2e}"),
        v if v.abs() < 0.1 => format!("{v:.4}"),
        v if v.abs() < 1.0 => format!("{v:.3}"),
        v if v.abs() < 10.0 => format!("{v:.2}"),
        v if v.abs() < 100.0 => format!("{v:.1}"),
        v => format!("{v:.0}"),
    }
}

/// Formats a fitted slope with its confidence interval, or a dash.
pub fn fitted(slope: &Slope) -> String {
    match slope.fitted {
        Some(law) => match law.half_width {
            Some(half) => format!("{:.2} ± {:.2}", law.slope, half),
            None => format!("{:.2}", law.slope),
        },
        None => "–".to_owned(),
    }
}

/// Formats the theoretical range of a slope.
pub fn theory(slope: &Slope) -> String {
    match slope.theory {
        Some((least, greatest)) if (least - greatest).abs() < 1e-9 => format!("{least:.2}"),
        Some((least, greatest)) => format!("{least:.2} to {greatest:.2}"),
        None => "none".to_owned(),
    }
}

/// Time in seconds at which previews are compared: two, or a quarter of the render time if it is
/// below four, but not before half of the configurations have an image.
pub fn preview_seconds(about: &About, part: &Part) -> f64 {
    let wanted = if about.run_seconds >= 4.0 { 2.0 } else { about.run_seconds / 4.0 };
    let firsts = part.curves.iter().filter_map(|curve| Some(curve.points.first()?.seconds));
    let mut firsts: Vec<f64> = firsts.collect();
    firsts.sort_by(f64::total_cmp);
    firsts.get(firsts.len() / 2).map_or(wanted, |half| wanted.max(*half))
}

/// Recommendations in plain sentences: the best and worst settings for a preview and for a final
/// image.
pub fn recommendations(about: &About, part: &Part) -> Vec<String> {
    let (preview, end) = (preview_seconds(about, part), about.run_seconds);
    let name = |curve: &Curve| configured(&about.configs[curve.config]);
    let mut sentences = Vec::new();
    let mut advise = |what: &str, seconds: f64| {
        let ranking = part.ranking(seconds);
        let Some((best, error)) = ranking.first() else { return };
        let mut text =
            format!("{what} {} s: {} (relMSE {}", short(seconds), name(best), short(*error));
        if let Some(range) = range_at(best, seconds) {
            text += &format!(", {} to {} over the seeds", short(range.low), short(range.high));
        }
        text += ").";
        let as_good = ranking[1..]
            .iter()
            .filter(|(curve, _)| overlap(best, curve, seconds))
            .map(|(c, _)| name(c));
        let as_good: Vec<String> = as_good.collect();
        if !as_good.is_empty() {
            text += &format!(" Equal within the scatter of the seeds: {}.", as_good.join("; "));
        }
        if let [.., (worst, error_of_worst)] = ranking.as_slice()
            && ranking.len() > 1
        {
            text += &format!(
                " Worst: {} ({} times the error).",
                name(worst),
                short(error_of_worst / error)
            );
        }
        sentences.push(text);
    };
    advise("For a preview in", preview);
    advise("For a final image after", end);
    if let Some((best, error)) = part.ranking(end).first() {
        let goal = error / 4.0;
        // the extrapolated curve that reaches the goal first need not be the current leader
        let soonest = part.curves.iter().filter_map(|c| Some((c, c.extrapolated_time_to(goal)?)));
        if let Some((curve, seconds)) = soonest.min_by(|a, b| a.1.total_cmp(&b.1)) {
            sentences.push(format!(
                "A quarter of that error takes {} about {} s (extrapolated{}).",
                name(curve),
                short(seconds),
                if curve.config == best.config { "" } else { "; it takes the lead by then" }
            ));
        }
    }
    let (width, height) = about.size;
    let share = f64::from(about.own_size.0) * f64::from(about.own_size.1)
        / (f64::from(width) * f64::from(height));
    if share > 1.01 {
        sentences.push(format!(
            "Times are for {width} x {height} pixels; {} x {} with photons in proportion takes \
             about {} times as long.",
            about.own_size.0,
            about.own_size.1,
            short(share)
        ));
    }
    sentences
}

/// Range over the seeds after `seconds`: that of the last image by then, scaled to the interpolated
/// error.
fn range_at(curve: &Curve, seconds: f64) -> Option<Spread> {
    let mean = curve.error_at(seconds)?;
    let Spread { mean: own, low, high } =
        curve.points.iter().rev().find(|point| point.seconds <= seconds * 1.001)?.rel_mse;
    Some(Spread { mean, low: mean * low / own, high: mean * high / own })
}

/// Returns true if the ranges over the seeds of two curves overlap, so that neither is better.
fn overlap(best: &Curve, other: &Curve, seconds: f64) -> bool {
    let ranges = range_at(best, seconds).zip(range_at(other, seconds));
    ranges.is_some_and(|(best, other)| best.high >= other.low)
}

/// Sentences about lamp sizes between which the best configuration changes.
pub fn crossings(about: &About, parts: &[Part]) -> Vec<String> {
    let mut sentences = Vec::new();
    let best = |part: &Part| {
        part.ranking(about.run_seconds)
            .first()
            .map(|(curve, _)| configured(&about.configs[curve.config]))
    };
    for pair in parts.windows(2) {
        if let ([Some(from), Some(to)], [Some(a), Some(b)]) =
            ([best(&pair[0]), best(&pair[1])], [pair[0].lamp(), pair[1].lamp()])
            && from != to
        {
            sentences.push(format!(
                "Between lamp areas {a} and {b}, the best setting changes from {from} to {to}."
            ));
        }
    }
    sentences
}
