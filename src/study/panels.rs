//! Charts of a study, and the grouping of curves into charts.

use super::analysis::{Curve, CurvePoint, Part};
use super::chart::{Chart, Series, Value};
use super::folder::About;
use super::grid::{Config, label};
use super::lamps::Lamp;
use super::palette::SERIES;
use super::words::configured;

/// Charts of a group of configurations.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Name of the setting that varies, or of the group.
    pub title: String,
    /// Key for file names.
    pub key: String,
    /// Charts of error over time, FLIP over time, and variance and bias over passes.
    pub charts: [(&'static str, Chart); 3],
}

/// A group of configurations with their labels within the group.
struct Group {
    title: String,
    key: String,
    members: Vec<(usize, String)>,
}

/// Panels of a part: one for each varied setting of a star, or one for each value of the first
/// setting of a large product.
pub fn panels(about: &About, part: &Part) -> Vec<Panel> {
    let groups = groups(about, part);
    groups.into_iter().map(|group| panel(part, &group)).collect()
}

fn groups(about: &About, part: &Part) -> Vec<Group> {
    let members: Vec<(usize, &Config)> =
        part.curves.iter().map(|c| (c.config, &about.configs[c.config])).collect();
    let choices = |config: &Config| -> Vec<(String, String)> {
        config.choices.iter().filter(|(name, _)| name != "lamp_area").cloned().collect()
    };
    let base = members.iter().find(|(_, config)| choices(config).is_empty());
    let mut axes: Vec<(String, String)> = Vec::new();
    for choice in members.iter().flat_map(|(_, config)| choices(config).into_iter().take(1)) {
        if !axes
            .iter()
            .any(|(name, value)| (name, base.is_some() || *value == choice.1) == (&choice.0, true))
        {
            axes.push(choice);
        }
    }
    let named = |config: &Config, left_out: &[&str]| config.label_without(left_out);
    if let Some((own, base)) = base.filter(|_| members.len() > 1) {
        let group = |name: &str| {
            let mut group = vec![(*own, format!("{} (base)", label(name, &base.value(name))))];
            let others = members.iter().filter(|(_, config)| config.choice(name).is_some());
            group.extend(others.map(|(number, config)| (*number, named(config, &["lamp_area"]))));
            Group { title: title(name).to_owned(), key: name.to_owned(), members: group }
        };
        return axes.iter().map(|(name, _)| group(name)).collect();
    }
    if members.len() <= SERIES || axes.len() < 2 {
        let all = members.iter().map(|(number, config)| (*number, named(config, &["lamp_area"])));
        return vec![Group {
            title: "All settings".to_owned(),
            key: "all".to_owned(),
            members: all.collect(),
        }];
    }
    let group = |(name, value): &(String, String)| {
        let of_value = members.iter().filter(|(_, config)| config.choice(name) == Some(value));
        Group {
            title: label(name, value),
            key: format!("{name}-{value}"),
            members: of_value
                .map(|(number, config)| (*number, named(config, &["lamp_area", name])))
                .collect(),
        }
    };
    axes.iter().map(group).collect()
}

fn title(name: &str) -> &str {
    match name {
        "method" => "Method",
        "radius_rule" => "Radius rule",
        "alpha" => "Alpha",
        "radius" => "Start radius",
        "indirect_radius" => "Indirect radius",
        "photons" => "Photons per pass",
        "direct" => "Direct light",
        "max_bounces" => "Maximum bounces",
        "eye_samples" => "Eye samples",
        "device" => "Device",
        "revolutions" => "Surfaces of revolution",
        "newton_tolerance" => "Newton tolerance",
        _ => name,
    }
}

fn panel(part: &Part, group: &Group) -> Panel {
    let curves = |value: fn(&CurvePoint) -> Value, dashed: bool| -> Vec<Series> {
        let members = group.members.iter().enumerate();
        let series = members.filter_map(|(color, (number, name))| {
            let curve = part.curves.iter().find(|curve| curve.config == *number)?;
            Some(Series {
                label: if dashed { String::new() } else { name.clone() },
                color: Some(color),
                dashed,
                points: curve.points.iter().map(value).collect(),
            })
        });
        series.collect()
    };
    let chart = |what: &str, x: &str, y: &str, series: Vec<Series>, guides: &[f64]| Chart {
        title: format!("{}: {what}", group.title),
        x_name: x.to_owned(),
        y_name: y.to_owned(),
        series,
        guides: guides.iter().map(|slope| (*slope, slope_name(*slope))).collect(),
        x_ticks: None,
    };
    let time = "render time in s";
    let error =
        curves(|p| (p.seconds, p.rel_mse.mean, Some((p.rel_mse.low, p.rel_mse.high))), false);
    let flip = curves(|p| (p.seconds, p.flip.mean, Some((p.flip.low, p.flip.high))), false);
    let mut parts =
        curves(|p| (f64::from(p.passes), p.split.map_or(0.0, |s| s.variance), None), false);
    parts.extend(curves(
        |p| (f64::from(p.passes), p.split.map_or(0.0, significant_bias), None),
        true,
    ));
    Panel {
        title: group.title.clone(),
        key: group.key.clone(),
        charts: [
            ("error", chart("relMSE over time", time, "relMSE", error, &[-1.0, -2.0 / 3.0])),
            ("flip", chart("FLIP over time", time, "LDR-FLIP", flip, &[])),
            ("parts", chart("variance and squared bias", "passes", "variance, bias²", parts, &[])),
        ],
    }
}

/// Squared bias if it exceeds its standard error, otherwise zero.
fn significant_bias(split: super::statistics::Split) -> f64 {
    if split.bias_sq > split.bias_sq_error.unwrap_or(0.0) { split.bias_sq } else { 0.0 }
}

fn slope_name(slope: f64) -> String {
    match slope {
        s if (s + 2.0 / 3.0).abs() < 1e-9 => "−2/3".to_owned(),
        s => format!("{s}").replace('-', "−"),
    }
}

/// Chart of all curves of a part: those on the Pareto front in color, the others faint.
pub fn overview(about: &About, part: &Part) -> Chart {
    let mut ahead: Vec<usize> = Vec::new();
    for point in &part.front {
        if !ahead.contains(&point.config) {
            ahead.push(point.config);
        }
    }
    // sort by number of points on the front, since the number of colors is limited
    let count = |config: &usize| part.front.iter().filter(|point| point.config == *config).count();
    ahead.sort_by_key(|config| std::cmp::Reverse(count(config)));
    ahead.truncate(SERIES);
    let all = part.curves.len() <= SERIES;
    let series = |curve: &Curve| {
        let color = match all {
            true => part.curves.iter().position(|c| c.config == curve.config),
            false => ahead.iter().position(|config| *config == curve.config),
        };
        let label = color.map_or(String::new(), |_| configured(&about.configs[curve.config]));
        let points = curve.points.iter().map(|p| (p.seconds, p.rel_mse.mean, None)).collect();
        Series { label, color, dashed: false, points }
    };
    let mut series: Vec<Series> = part.curves.iter().map(series).collect();
    // draw faint curves first
    series.sort_by_key(|series| series.color.is_some());
    Chart {
        title: "relMSE over time, all settings".to_owned(),
        x_name: "render time in s".to_owned(),
        y_name: "relMSE".to_owned(),
        series,
        guides: vec![(-1.0, slope_name(-1.0)), (-2.0 / 3.0, slope_name(-2.0 / 3.0))],
        x_ticks: None,
    }
}

/// Chart of relMSE after equal time over the lamp area; `None` if there is only one size.
pub fn lamp_chart(about: &About, parts: &[Part], seconds: f64) -> Option<Chart> {
    let areas: Vec<f64> = parts.iter().filter_map(|part| area(part.lamp()?)).collect();
    let least = areas.iter().copied().reduce(f64::min)?;
    let place = |lamp: Lamp| area(lamp).unwrap_or(least / 30.0);
    let mut names: Vec<String> = Vec::new();
    for curve in parts.iter().flat_map(|part| &part.curves) {
        let name = about.configs[curve.config].label_without(&["lamp_area"]);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let series = names.iter().enumerate().map(|(color, name)| {
        let points = parts.iter().filter_map(|part| {
            let of_name =
                |curve: &&Curve| about.configs[curve.config].label_without(&["lamp_area"]) == *name;
            let curve = part.curves.iter().find(of_name)?;
            let end = curve.points.iter().rev().find(|p| p.seconds <= 1.25 * seconds)?;
            let range = Some((end.rel_mse.low, end.rel_mse.high));
            Some((place(part.lamp()?), curve.error_at(seconds)?, range))
        });
        let mut points: Vec<Value> = points.collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Series { label: name.clone(), color: Some(color), dashed: false, points }
    });
    let mut ticks: Vec<(f64, String)> = parts
        .iter()
        .filter_map(|part| part.lamp())
        .map(|lamp| (place(lamp), area(lamp).map_or("point".to_owned(), super::axis::number)))
        .collect();
    ticks.sort_by(|a, b| a.0.total_cmp(&b.0));
    (parts.len() > 1).then(|| Chart {
        title: "relMSE after equal time over the lamp's area".to_owned(),
        x_name: "area of the lamp".to_owned(),
        y_name: format!("relMSE after {} s", super::words::short(seconds)),
        series: series.collect(),
        guides: Vec::new(),
        x_ticks: Some(ticks),
    })
}

fn area(lamp: Lamp) -> Option<f64> {
    match lamp {
        Lamp::Area(area) => Some(area),
        Lamp::Point => None,
    }
}
