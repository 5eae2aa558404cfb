//! Charts with logarithmic axes as SVG, with labels next to the curves or in a legend below.

use std::fmt::Write;

use super::axis::Range;
use super::palette::{SERIES, style};

/// x, y and optionally the range of y.
pub type Value = (f64, f64, Option<(f64, f64)>);

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Label; not shown if empty.
    pub label: String,
    /// Index of the color and marker; `None` draws a faint curve.
    pub color: Option<usize>,
    /// If true, the curve is dashed, with hollow markers.
    pub dashed: bool,
    /// Points in order of x. Points that are not positive are not drawn.
    pub points: Vec<Value>,
}

/// A chart with two logarithmic axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Description for screen readers.
    pub title: String,
    /// Name of the horizontal axis.
    pub x_name: String,
    /// Name of the vertical axis.
    pub y_name: String,
    /// Curves.
    pub series: Vec<Series>,
    /// Slopes to draw as guides, with labels.
    pub guides: Vec<(f64, String)>,
    /// Ticks of the horizontal axis; `None` for automatic ticks.
    pub x_ticks: Option<Vec<(f64, String)>>,
}

/// Layout of a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Inline in a page, 680 px wide, with labels at the ends of the curves.
    Wide,
    /// Inline in a page on a phone, 350 px wide, with a legend below.
    Narrow,
    /// Standalone file with the wide layout and embedded styles.
    File,
}

/// Height of a line of text in px.
const LINE: f64 = 15.0;
/// Average width of a letter in px.
const LETTER: f64 = 6.6;

impl Chart {
    /// Returns true if there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.values().next().is_none()
    }

    fn values(&self) -> impl Iterator<Item = Value> + '_ {
        self.series
            .iter()
            .flat_map(|series| series.points.iter().copied())
            .filter(|(x, y, _)| *x > 0.0 && *y > 0.0)
    }

    /// Renders the chart as SVG.
    pub fn svg(&self, format: Format) -> String {
        let labels: Vec<&Series> =
            self.series.iter().filter(|s| !s.label.is_empty() && has_values(s)).collect();
        let longest = labels.iter().map(|s| s.label.chars().count()).max().unwrap_or(0) as f64;
        let narrow = format == Format::Narrow;
        let width = if narrow { 350.0 } else { 680.0 };
        let right = if narrow { 12.0 } else { (longest * LETTER + 34.0).clamp(20.0, 300.0) };
        let plot = Plot {
            left: 54.0,
            top: 26.0,
            right: width - right,
            bottom: 26.0 + if narrow { 250.0 } else { 300.0 },
            x: Range::of(self.values().map(|(x, _, _)| x).chain(self.tick_places())),
            y: Range::of(self.values().map(|(_, y, _)| y)),
        };
        let legend = if narrow { labels.len() as f64 * (LINE + 3.0) + 8.0 } else { 0.0 };
        let height = plot.bottom + 44.0 + legend;
        let mut out = String::new();
        let xmlns =
            if format == Format::File { " xmlns=\"http://www.w3.org/2000/svg\"" } else { "" };
        let _ = write!(
            out,
            "<svg{xmlns} class=\"chart\" viewBox=\"0 0 {width} {height:.0}\" \
             role=\"img\" aria-label=\"{}\">",
            escape(&self.title)
        );
        if format == Format::File {
            let _ = write!(
                out,
                "<style>{}</style><rect width=\"100%\" height=\"100%\" fill=\"var(--ground)\"/>",
                style()
            );
        }
        self.axes(&plot, &mut out);
        self.guides(&plot, &mut out);
        for series in &self.series {
            curve(series, &plot, &mut out);
        }
        match narrow {
            true => legend_below(&labels, plot.bottom + 52.0, &mut out),
            false => labels_beside(&labels, &plot, &mut out),
        }
        out.push_str("</svg>");
        out
    }

    fn tick_places(&self) -> impl Iterator<Item = f64> + '_ {
        self.x_ticks.iter().flatten().map(|(x, _)| *x)
    }

    fn axes(&self, plot: &Plot, out: &mut String) {
        let own = self.x_ticks.clone();
        for (x, text) in own.unwrap_or_else(|| plot.x.ticks((plot.right - plot.left) / 46.0)) {
            let at = plot.at_x(x);
            let _ = write!(
                out,
                "<path class=\"grid\" d=\"M{at:.1} {:.1}V{:.1}\"/><text class=\"soft\" x=\"{at:.1}\" y=\"{:.1}\" \
                 text-anchor=\"middle\">{}</text>",
                plot.top,
                plot.bottom,
                plot.bottom + 16.0,
                escape(&text)
            );
        }
        for (y, text) in plot.y.ticks((plot.bottom - plot.top) / 24.0) {
            let at = plot.at_y(y);
            let _ = write!(
                out,
                "<path class=\"grid\" d=\"M{:.1} {at:.1}H{:.1}\"/><text class=\"soft\" x=\"{:.1}\" y=\"{:.1}\" \
                 text-anchor=\"end\">{}</text>",
                plot.left,
                plot.right,
                plot.left - 6.0,
                at + 4.0,
                escape(&text)
            );
        }
        let _ = write!(
            out,
            "<path class=\"frame\" d=\"M{0:.1} {1:.1}V{2:.1}H{3:.1}\"/><text x=\"4\" y=\"15\">{4}</text>\
             <text x=\"{3:.1}\" y=\"{5:.1}\" text-anchor=\"end\">{6}</text>",
            plot.left,
            plot.top,
            plot.bottom,
            plot.right,
            escape(&self.y_name),
            plot.bottom + 34.0,
            escape(&self.x_name)
        );
    }

    /// Draws a fan of guide slopes in the lower left, where decreasing curves leave room.
    fn guides(&self, plot: &Plot, out: &mut String) {
        let (x0, x1) = (plot.left + 10.0, plot.left + 0.16 * (plot.right - plot.left));
        let decades_x = (x1 - x0) / plot.per_decade_x();
        let fall = |slope: f64| -slope * decades_x * plot.per_decade_y();
        let deepest = self.guides.iter().map(|(slope, _)| fall(*slope)).fold(0.0, f64::max);
        let y0 = plot.bottom - 10.0 - deepest;
        if y0 < plot.top + 0.4 * (plot.bottom - plot.top) {
            return;
        }
        let mut taken = f64::NEG_INFINITY;
        let mut guides = self.guides.clone();
        guides.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (slope, name) in &guides {
            let y1 = y0 + fall(*slope);
            if y1 - taken < LINE {
                continue;
            }
            taken = y1;
            let _ = write!(
                out,
                "<path class=\"guide\" d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\"/><text class=\"soft\" x=\"{:.1}\" \
                 y=\"{:.1}\">{}</text>",
                x1 + 4.0,
                y1 + 4.0,
                escape(name)
            );
        }
    }
}

/// Plot area inside the axes, in px, and its value ranges.
struct Plot {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
    x: Range,
    y: Range,
}

impl Plot {
    fn per_decade_x(&self) -> f64 {
        (self.right - self.left) / self.x.decades()
    }

    fn per_decade_y(&self) -> f64 {
        (self.bottom - self.top) / self.y.decades()
    }

    fn at_x(&self, x: f64) -> f64 {
        self.left + (x / self.x.low).log10() * self.per_decade_x()
    }

    fn at_y(&self, y: f64) -> f64 {
        (self.bottom - (y / self.y.low).log10() * self.per_decade_y()).clamp(self.top, self.bottom)
    }
}

/// Escapes text for XML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn has_values(series: &Series) -> bool {
    series.points.iter().any(|(x, y, _)| *x > 0.0 && *y > 0.0)
}

fn curve(series: &Series, plot: &Plot, out: &mut String) {
    let points = series.points.iter().filter(|(x, y, _)| *x > 0.0 && *y > 0.0);
    let places: Vec<Value> = points
        .map(|(x, y, range)| {
            let range = range.map(|(low, high)| (plot.at_y(low.max(1e-300)), plot.at_y(high)));
            (plot.at_x(*x), plot.at_y(*y), range)
        })
        .collect();
    let path = |places: &mut dyn Iterator<Item = (f64, f64)>| {
        let steps = places
            .enumerate()
            .map(|(i, (x, y))| format!("{}{x:.1} {y:.1}", if i == 0 { 'M' } else { 'L' }));
        steps.collect::<String>()
    };
    let line = path(&mut places.iter().map(|(x, y, _)| (*x, *y)));
    let Some(color) = series.color else {
        let _ = write!(out, "<path class=\"faint\" d=\"{line}\"/>");
        return;
    };
    let _ = write!(out, "<g class=\"s{}\">", color % SERIES);
    let ranges =
        || places.iter().filter_map(|(x, _, range)| range.map(|(low, high)| (*x, low, high)));
    if ranges().count() > 1 {
        let around = ranges().map(|(x, low, _)| (x, low)).collect::<Vec<_>>();
        let back = ranges().map(|(x, _, high)| (x, high)).collect::<Vec<_>>();
        let _ = write!(
            out,
            "<path class=\"band\" d=\"{}Z\"/>",
            path(&mut around.into_iter().chain(back.into_iter().rev()))
        );
    }
    let dashed = if series.dashed { " dashed" } else { "" };
    let _ = write!(out, "<path class=\"curve{dashed}\" d=\"{line}\"/>");
    for (x, y, _) in &places {
        out.push_str(&mark(color, series.dashed, *x, *y));
    }
    out.push_str("</g>");
}

/// Marker of a series. Shapes differ as well as colors.
fn mark(color: usize, hollow: bool, x: f64, y: f64) -> String {
    let class = if hollow { "hollow" } else { "mark" };
    match color % 4 {
        0 => format!("<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.6\"/>"),
        1 => format!(
            "<rect class=\"{class}\" x=\"{:.1}\" y=\"{:.1}\" width=\"6.4\" height=\"6.4\"/>",
            x - 3.2,
            y - 3.2
        ),
        2 => format!("<path class=\"{class}\" d=\"M{x:.1} {:.1}l4.2 7.2h-8.4z\"/>", y - 4.6),
        _ => format!(
            "<path class=\"{class}\" d=\"M{x:.1} {:.1}l4.4 4.4l-4.4 4.4l-4.4-4.4z\"/>",
            y - 4.4
        ),
    }
}

/// Draws labels on the right, as close to the ends of the curves as they fit, with leader lines.
fn labels_beside(labels: &[&Series], plot: &Plot, out: &mut String) {
    let end = |series: &Series| {
        let last = series.points.iter().rev().find(|(x, y, _)| *x > 0.0 && *y > 0.0);
        last.map(|(x, y, _)| (plot.at_x(*x), plot.at_y(*y)))
    };
    let mut ends: Vec<(&Series, (f64, f64))> =
        labels.iter().filter_map(|s| Some((*s, end(s)?))).collect();
    ends.sort_by(|a, b| a.1.1.total_cmp(&b.1.1));
    let wanted: Vec<f64> = ends.iter().map(|(_, (_, y))| *y).collect();
    let places =
        spaced(&wanted, LINE, plot.top, plot.bottom.max(plot.top + LINE * wanted.len() as f64));
    for ((series, (x, y)), place) in ends.iter().zip(places) {
        let _ = write!(
            out,
            "<g class=\"s{}\"><path class=\"leader\" d=\"M{:.1} {y:.1}L{:.1} {place:.1}\" fill=\"none\"/>\
             <text class=\"name\" x=\"{:.1}\" y=\"{:.1}\">{}</text></g>",
            series.color.unwrap_or(0) % SERIES,
            x + 5.0,
            plot.right + 12.0,
            plot.right + 15.0,
            place + 4.0,
            escape(&series.label)
        );
    }
}

/// Positions near the sorted positions `wanted`, at least `gap` apart and within the bounds if they
/// fit.
fn spaced(wanted: &[f64], gap: f64, low: f64, high: f64) -> Vec<f64> {
    let mut places = Vec::with_capacity(wanted.len());
    let mut next = low;
    for want in wanted {
        let place = want.max(next);
        places.push(place);
        next = place + gap;
    }
    let mut limit = high;
    for place in places.iter_mut().rev() {
        *place = place.min(limit);
        limit = *place - gap;
    }
    places
}

fn legend_below(labels: &[&Series], top: f64, out: &mut String) {
    for (row, series) in labels.iter().enumerate() {
        let y = top + row as f64 * (LINE + 3.0) + 6.0;
        let color = series.color.unwrap_or(0);
        let dashed = if series.dashed { " dashed" } else { "" };
        let _ = write!(
            out,
            "<g class=\"s{}\"><path class=\"curve{dashed}\" d=\"M12 {y:.1}H40\"/>{}<text class=\"name\" x=\"48\" \
             y=\"{:.1}\">{}</text></g>",
            color % SERIES,
            mark(color, series.dashed, 26.0, y),
            y + 4.0,
            escape(&series.label)
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Labels keep their spacing, order and bounds, and do not move if there is room.
    #[test]
    fn labels_do_not_overlap() {
        for wanted in [
            vec![50.0, 51.0, 52.0, 53.0],
            vec![0.0, 0.0, 0.0],
            vec![290.0, 299.0, 300.0],
            vec![10.0],
        ] {
            let places = spaced(&wanted, 15.0, 20.0, 300.0);
            assert!(places.windows(2).all(|p| p[1] - p[0] >= 15.0 - 1e-9), "{places:?}");
            assert!(places.iter().all(|p| (20.0 - 1e-9..=300.0).contains(p)), "{places:?}");
        }
        assert_eq!(spaced(&[30.0, 60.0, 90.0], 15.0, 20.0, 300.0), [30.0, 60.0, 90.0]);
    }

    /// Values without a logarithm are not drawn, and labels are escaped.
    #[test]
    fn a_chart_is_xml_with_its_points() {
        let series = |label: &str, color, points: &[(f64, f64)]| Series {
            label: label.to_owned(),
            color,
            dashed: false,
            points: points.iter().map(|(x, y)| (*x, *y, Some((y * 0.5, y * 2.0)))).collect(),
        };
        let chart = Chart {
            title: "a < b".to_owned(),
            x_name: "seconds".to_owned(),
            y_name: "relMSE".to_owned(),
            series: vec![
                series("a & b", Some(0), &[(1.0, 1.0), (10.0, 0.1), (20.0, -1.0)]),
                series("", None, &[(1.0, 0.5), (10.0, 0.2)]),
            ],
            guides: vec![(-1.0, "-1".to_owned())],
            x_ticks: None,
        };
        for format in [Format::Wide, Format::Narrow, Format::File] {
            let svg = chart.svg(format);
            assert_eq!(
                svg.matches("<circle").count(),
                if format == Format::Narrow { 3 } else { 2 }
            );
            assert!(
                svg.contains("a &amp; b") && !svg.contains("a & b") && svg.contains("a &lt; b")
            );
            assert_eq!(svg.matches("class=\"faint\"").count(), 1);
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
            assert_eq!(svg.matches("<g").count(), svg.matches("</g>").count());
        }
    }
}
