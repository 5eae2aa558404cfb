//! Results of a study as CSV, JSON and Markdown.

use std::fmt::Write;

use serde_json::{Value, json};

use super::analysis::Part;
use super::folder::{About, Results};
use super::words::{configured, fitted, preview_seconds, recommendations, short, theory};

/// CSV with one line per image: configuration, seed, passes and metrics, including the error of the
/// reference.
pub fn csv(results: &Results) -> String {
    let mut out = String::from(
        "config,label,lamp,method,radius_rule,alpha,radius,photons_per_pass,direct,max_bounces,revolutions,newton_tolerance,device,seed,passes,seconds,\
         photons,rays,relMSE,MSE,FLIP,mean_ratio\n",
    );
    for run in &results.runs {
        let config = &results.about.configs[run.config];
        let of = |name: &str| config.value(name);
        for p in &run.points {
            let _ = writeln!(
                out,
                "{},\"{}\",{},{},{},{},{},{},{},{},{},{},\"{}\",{},{},{:.6},{},{},{:.6e},{:.6e},{:.6e},{:.6}",
                run.config,
                configured(config).replace('"', "\"\""),
                of("lamp_area"),
                of("method"),
                of("radius_rule"),
                config.settings.alpha,
                of("radius"),
                config.settings.photons,
                of("direct"),
                config.settings.max_bounces,
                of("revolutions"),
                of("newton_tolerance"),
                run.device.replace('"', "\"\""),
                config.settings.seed.wrapping_add(u64::from(run.seed)),
                p.passes,
                p.seconds,
                p.photons,
                p.rays,
                p.rel_mse,
                p.mse,
                p.flip,
                p.mean_ratio
            );
        }
    }
    out
}

/// JSON with parameters, measurements and analysis.
pub fn json(results: &Results, parts: &[Part]) -> Value {
    let labels: Vec<String> = results.about.configs.iter().map(|config| config.label()).collect();
    let advice: Vec<_> = parts.iter().map(|part| recommendations(&results.about, part)).collect();
    json!({
        "event": "study",
        "results": results,
        "labels": labels,
        "parts": parts,
        "recommendations": advice,
    })
}

/// Rows of the table of a part: heading, then one row per configuration.
pub fn rows(about: &About, part: &Part) -> Vec<Vec<String>> {
    let (preview, goal) = (preview_seconds(about, part), part.common_error());
    let mut rows = vec![vec![
        "settings".to_owned(),
        "ms per pass".to_owned(),
        format!("relMSE in {} s", short(preview)),
        format!("relMSE in {} s", short(about.run_seconds)),
        "FLIP at the end".to_owned(),
        "mean / truth".to_owned(),
        goal.map_or("s to goal".to_owned(), |goal| format!("s to relMSE {}", short(goal))),
    ]];
    let or_dash = |value: Option<f64>| value.map_or("–".to_owned(), short);
    for curve in &part.curves {
        let Some(last) = curve.points.last() else { continue };
        let time = goal.map(|goal| match curve.time_to(goal) {
            Some(seconds) => short(seconds),
            None => curve
                .extrapolated_time_to(goal)
                .map_or("–".to_owned(), |s| format!("({})", short(s))),
        });
        rows.push(vec![
            configured(&about.configs[curve.config]),
            short(1000.0 * curve.seconds_per_pass),
            or_dash(curve.error_at(preview)),
            short(last.rel_mse.mean),
            short(last.flip.mean),
            format!("{:.4}", last.mean_ratio.mean),
            time.unwrap_or("–".to_owned()),
        ]);
    }
    rows
}

/// Rows of the table of slopes of a part.
pub fn slope_rows(about: &About, part: &Part) -> Vec<Vec<String>> {
    let head =
        ["settings", "variance", "theory", "bias²", "theory", "MSE", "theory"].map(str::to_owned);
    let mut rows = vec![head.to_vec()];
    for curve in &part.curves {
        let mut row = vec![configured(&about.configs[curve.config])];
        for slope in [&curve.variance, &curve.bias_sq, &curve.mse] {
            row.extend([fitted(slope), theory(slope)]);
        }
        rows.push(row);
    }
    rows
}

/// Formats rows as a Markdown table.
pub fn markdown(rows: &[Vec<String>]) -> String {
    let mut out = String::new();
    for (number, row) in rows.iter().enumerate() {
        let _ = writeln!(out, "| {} |", row.join(" | "));
        if number == 0 {
            let _ = writeln!(out, "|---{}|", "|---:".repeat(row.len() - 1));
        }
    }
    out
}
