//! Output files of a study: an HTML page, tables and charts.

use std::fmt::Write;

use super::StudyError;
use super::analysis::{Part, analyse};
use super::chart::{Chart, Format, escape};
use super::conduct::{Conducted, crop_name};
use super::folder::{About, Folder, Results};
use super::lamps::Lamp;
use super::palette::style;
use super::panels::{lamp_chart, overview, panels};
use super::tables::{csv, json, markdown, rows, slope_rows};
use super::words::{configured, crossings, recommendations, short};
use crate::film::file::write_whole;
use crate::memory;
use crate::storage;

/// Writes `report.html`, `study.csv`, `study.json`, `study.md` and `charts/*.svg`. Returns the
/// analysis.
pub fn write(conducted: &Conducted, folder: &Folder) -> Result<Vec<Part>, StudyError> {
    let results = &conducted.results;
    let parts = analyse(results);
    for (name, chart) in named_charts(&results.about, &parts) {
        write_whole(
            &folder.file(format!("charts/{name}.svg")),
            chart.svg(Format::File).as_bytes(),
        )?;
    }
    write_whole(&folder.file("study.csv"), csv(results).as_bytes())?;
    write_whole(&folder.file("study.json"), format!("{:#}\n", json(results, &parts)).as_bytes())?;
    write_whole(&folder.file("study.md"), tables(&results.about, &parts).as_bytes())?;
    write_whole(&folder.file("report.html"), page(conducted, &parts, folder).as_bytes())?;
    Ok(parts)
}

fn named_charts(about: &About, parts: &[Part]) -> Vec<(String, Chart)> {
    let mut charts: Vec<(String, Chart)> = lamp_chart(about, parts, about.run_seconds)
        .into_iter()
        .map(|chart| ("lamps".to_owned(), chart))
        .collect();
    for (number, part) in parts.iter().enumerate() {
        let name = |rest: String| if parts.len() > 1 { format!("{number}-{rest}") } else { rest };
        charts.push((name("overview".to_owned()), overview(about, part)));
        for panel in panels(about, part) {
            let key = panel.key.clone();
            charts.extend(
                panel
                    .charts
                    .into_iter()
                    .map(|(what, chart)| (name(format!("{key}-{what}")), chart)),
            );
        }
    }
    charts
}

fn heading(lamp: Option<Lamp>) -> String {
    match lamp {
        None => String::new(),
        Some(Lamp::Point) => "Point lamp".to_owned(),
        Some(Lamp::Area(area)) => format!("Lamp of area {}", super::axis::number(area)),
    }
}

/// Recommendations and tables as Markdown.
fn tables(about: &About, parts: &[Part]) -> String {
    let mut out = String::new();
    for sentence in crossings(about, parts) {
        let _ = writeln!(out, "- {sentence}");
    }
    for part in parts {
        let heading = heading(part.lamp());
        if !heading.is_empty() {
            let _ = writeln!(out, "\n### {heading}\n");
        }
        for sentence in recommendations(about, part) {
            let _ = writeln!(out, "- {sentence}");
        }
        let _ = write!(
            out,
            "\n{}\n{}",
            markdown(&rows(about, part)),
            markdown(&slope_rows(about, part))
        );
    }
    out
}

const LAYOUT: &str = "*{box-sizing:border-box}html{color-scheme:light dark}body{margin:0;background:var(--ground);\
    color:var(--ink);font:16px/1.5 system-ui,sans-serif}main{max-width:76rem;margin:auto;padding:1rem}\
    h1{font-size:1.6rem;margin:.5rem 0}h2{font-size:1.25rem;margin:2.2rem 0 .4rem;border-top:1px solid var(--line);\
    padding-top:1rem}h3{font-size:1.05rem;margin:1.4rem 0 .3rem}p,li{max-width:46rem}.soft,figcaption,summary{\
    color:var(--soft)}.advice{border-left:4px solid var(--s0);padding:.2rem 1rem;margin:1rem 0}.scroll{overflow-x:auto}\
    table{border-collapse:collapse;font-size:.9rem;font-variant-numeric:tabular-nums}th,td{padding:.25rem .7rem;\
    text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}th:first-child,td:first-child{text-align:left}\
    .charts{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,20rem),1fr));gap:1rem}figure{\
    margin:0}figcaption{font-size:.9rem}svg{display:block;width:100%;height:auto}.narrow{display:none}\
    .one{max-width:52rem}.crops{display:grid;grid-template-columns:repeat(auto-fill,minmax(9.5rem,1fr));gap:.8rem}\
    .crops figure{margin:0}.crops img{width:100%;display:block;image-rendering:pixelated}.crops figcaption{\
    overflow-wrap:anywhere}code{overflow-wrap:anywhere}pre{overflow-x:auto;font-size:.85rem}\
    @media(max-width:40rem){.wide{display:none}.narrow{display:block}main{padding:.7rem}}";

/// Self-contained HTML page.
fn page(conducted: &Conducted, parts: &[Part], folder: &Folder) -> String {
    let results = &conducted.results;
    let about = &results.about;
    let title = format!("{}: speed against accuracy", escape(&about.scene));
    let mut out = format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" \
         content=\"width=device-width,initial-scale=1\"><title>{title}</title><style>{}{LAYOUT}</style></head>\
         <body><main><h1>{title}</h1>",
        style()
    );
    introduction(results, conducted.complete, &mut out);
    if let Some(chart) = lamp_chart(about, parts, about.run_seconds) {
        out.push_str("<h2>Effect of the lamp area</h2>");
        for sentence in crossings(about, parts) {
            let _ = write!(out, "<p>{}</p>", escape(&sentence));
        }
        out.push_str("<div class=\"one\">");
        figure(&chart, "Lamps have equal power. The band is the range over the seeds.", &mut out);
        out.push_str("</div>");
    }
    for (number, part) in parts.iter().enumerate() {
        section(conducted, part, number, folder, &mut out);
    }
    reading(&mut out);
    out.push_str("</main></body></html>\n");
    out
}

fn introduction(results: &Results, complete: bool, out: &mut String) {
    let about = &results.about;
    let mut devices: Vec<&str> = results.runs.iter().map(|run| run.device.as_str()).collect();
    devices.sort_unstable();
    devices.dedup();
    let of = about.configs.len() * about.seeds as usize;
    let (width, height) = about.size;
    let _ = write!(
        out,
        "<p>{} settings, {} seeds each, {} s per render, {width} × {height} pixels, on {}. \
         caustica {}.{}</p>",
        about.configs.len(),
        about.seeds,
        short(about.run_seconds),
        escape(&devices.join(" and ")),
        escape(&about.version),
        if complete {
            String::new()
        } else {
            format!(
                " <strong>Interrupted after {} of {of} renders; repeat the command to \
                 continue.</strong>",
                results.runs.len()
            )
        }
    );
    let mut radii: Vec<(usize, f64)> =
        results.runs.iter().filter_map(|run| Some((run.config, run.automatic_radius?))).collect();
    radii.sort_by_key(|(config, _)| *config);
    radii.dedup();
    if !radii.is_empty() {
        let radii = radii.iter().map(|(config, radius)| {
            format!("{}: {radius} px", configured(&about.configs[*config]))
        });
        let radii: Vec<String> = radii.collect();
        let _ = write!(out, "<p>Automatic start radii: {}.</p>", escape(&radii.join("; ")));
    }
    let failed = results.runs.iter().filter_map(|run| Some((run.config, run.failed.as_ref()?)));
    let mut failed: Vec<_> = failed.collect();
    failed.dedup();
    for (config, why) in failed {
        let _ = write!(
            out,
            "<p>Not rendered: {}: {}</p>",
            escape(&about.configs[config].label()),
            escape(why)
        );
    }
}

/// Section of the page about all renders that were compared with one reference.
fn section(conducted: &Conducted, part: &Part, number: usize, folder: &Folder, out: &mut String) {
    let about = &conducted.results.about;
    let heading = match heading(part.lamp()).as_str() {
        "" => "Recommendations".to_owned(),
        lamp => lamp.to_owned(),
    };
    let _ = write!(out, "<h2>{heading}</h2><div class=\"advice\">");
    for sentence in recommendations(about, part) {
        let _ = write!(out, "<p>{}</p>", escape(&sentence));
    }
    let own = |value: Option<f64>| value.map_or("(unknown, taken as zero)".to_owned(), short);
    let _ = write!(
        out,
        "</div><p class=\"soft\">Truth: {}; its relMSE {} is subtracted.</p><div class=\"one\">",
        escape(&part.truth.source),
        own(part.truth.rel_mse)
    );
    let overview = overview(about, part);
    let all = part.curves.len() <= super::palette::SERIES;
    let caption = if all {
        "All settings."
    } else {
        "All settings. Settings that lead at some time are colored."
    };
    figure(&overview, caption, out);
    out.push_str(
        "</div><h3>Figures</h3><p class=\"soft\">Times in parentheses are extrapolated by the \
         fitted slope.</p>",
    );
    table(&rows(about, part), out);
    front(about, part, out);
    crops(conducted, part, number, folder, out);
    for panel in panels(about, part) {
        let _ = write!(out, "<h3>{}</h3><div class=\"charts\">", escape(&panel.title));
        for (what, chart) in &panel.charts {
            let caption = match *what {
                "error" => "relMSE minus that of the truth. The band is the range over the seeds.",
                "flip" => "Visible difference, including the truth's noise.",
                _ => "Solid: variance. Dashed: squared bias, if it exceeds its standard error.",
            };
            small_figure(chart, caption, out);
        }
        out.push_str("</div>");
    }
    out.push_str(
        "<h3>Slopes over passes, and theory</h3><p class=\"soft\">Exponents of power laws fitted \
         to all but the first passes, with 95 % intervals that assume independent points.</p>",
    );
    table(&slope_rows(about, part), out);
}

fn front(about: &About, part: &Part, out: &mut String) {
    out.push_str(
        "<details><summary>Pareto front: no other point is both faster and more accurate</summary>",
    );
    let head = ["seconds", "settings", "passes", "relMSE"].map(str::to_owned).to_vec();
    let row = |point: &super::analysis::FrontPoint| {
        let name = configured(&about.configs[point.config]);
        vec![short(point.seconds), name, point.passes.to_string(), short(point.rel_mse)]
    };
    table(&[head].into_iter().chain(part.front.iter().map(row)).collect::<Vec<_>>(), out);
    out.push_str("</details>");
}

/// Crops of images at equal time, then at equal error.
fn crops(conducted: &Conducted, part: &Part, number: usize, folder: &Folder, out: &mut String) {
    let about = &conducted.results.about;
    let truth = || picture(folder, &format!("crops/truth-{number}.png"), "truth", "", out_of(part));
    let _ = write!(
        out,
        "<h3>Equal time: {} s</h3><div class=\"crops\">{}",
        short(about.run_seconds),
        truth()
    );
    for curve in &part.curves {
        let Some(last) = curve.points.last() else { continue };
        let name = configured(&about.configs[curve.config]);
        let figures =
            format!("relMSE {}, FLIP {}", short(last.rel_mse.mean), short(last.flip.mean));
        let file = crop_name(curve.config, last.passes);
        out.push_str(&picture(folder, &file, &name, &figures, String::new()));
    }
    out.push_str("</div>");
    let Some(goal) = part.common_error() else { return };
    let _ = write!(
        out,
        "<h3>Equal error: relMSE {} or less</h3><div class=\"crops\">{}",
        short(goal),
        truth()
    );
    let mut missed = Vec::new();
    let mut order: Vec<_> = part.curves.iter().map(|curve| (curve, curve.time_to(goal))).collect();
    order.sort_by(|a, b| a.1.unwrap_or(f64::MAX).total_cmp(&b.1.unwrap_or(f64::MAX)));
    for (curve, seconds) in order {
        let name = configured(&about.configs[curve.config]);
        match (seconds, curve.passes_to(goal)) {
            (Some(seconds), Some(passes)) => {
                let figures = format!("after {} s; shown: pass {passes}", short(seconds));
                out.push_str(&picture(
                    folder,
                    &crop_name(curve.config, passes),
                    &name,
                    &figures,
                    String::new(),
                ));
            }
            _ => missed.push(name),
        }
    }
    out.push_str("</div>");
    if !missed.is_empty() {
        let _ = write!(
            out,
            "<p class=\"soft\">Not reached in time by: {}.</p>",
            escape(&missed.join("; "))
        );
    }
}

fn out_of(part: &Part) -> String {
    format!("reference for the other images: {}", part.truth.source)
}

/// Figure with an embedded image of the folder; empty if the file is missing.
fn picture(folder: &Folder, file: &str, name: &str, figures: &str, title: String) -> String {
    let Ok(bytes) = storage::read(&folder.file(file), memory::readable()) else {
        return String::new();
    };
    format!(
        "<figure title=\"{}\"><img alt=\"{}\" src=\"data:image/png;base64,{}\"><figcaption><strong>{}</strong> {}\
         </figcaption></figure>",
        escape(&title),
        escape(name),
        base64(&bytes),
        escape(name),
        escape(figures)
    )
}

fn figure(chart: &Chart, caption: &str, out: &mut String) {
    if chart.is_empty() {
        return;
    }
    let _ = write!(
        out,
        "<figure><div class=\"wide\">{}</div><div class=\"narrow\">{}</div><figcaption>{}</figcaption></figure>",
        chart.svg(Format::Wide),
        chart.svg(Format::Narrow),
        escape(caption)
    );
}

/// One of several figures in a row, which has room for narrow charts only.
fn small_figure(chart: &Chart, caption: &str, out: &mut String) {
    if !chart.is_empty() {
        let svg = chart.svg(Format::Narrow);
        let _ = write!(out, "<figure>{svg}<figcaption>{}</figcaption></figure>", escape(caption));
    }
}

fn table(rows: &[Vec<String>], out: &mut String) {
    out.push_str("<div class=\"scroll\" tabindex=\"0\"><table>");
    for (number, row) in rows.iter().enumerate() {
        let cell = if number == 0 { "th" } else { "td" };
        let cells: String =
            row.iter().map(|text| format!("<{cell}>{}</{cell}>", escape(text))).collect();
        let _ = write!(out, "<tr>{cells}</tr>");
    }
    out.push_str("</table></div>");
}

fn reading(out: &mut String) {
    out.push_str(
        "<h2>How to read this</h2>\
         <p>relMSE is the mean of (L − T)² / (T² + 0.01) over pixels, without the largest 0.1 %. \
         L is the luminance of a pixel, T that of the truth. Each curve is a progressive render \
         after 1, 2, 4, 8, … passes, averaged over seeds. Times are render times without reading, \
         compiling and measuring.</p>\
         <p>The mean squared error is the sum of variance, which averages out over passes, and \
         squared bias, which is blur from light gathered over a disc. In theory (Knaus &amp; \
         Zwicker 2011), the variance falls as N^−alpha and the squared bias as N^−2(1 − alpha); \
         both fall as N^−2/3 at alpha = 2/3. Sampled direct light has no bias and its variance \
         falls as 1/N, so an image lies in between. With path tracing or a fixed radius, the \
         variance falls as 1/N; with a fixed radius, the bias remains.</p>\
         <p>The bias is the error that all seeds share, minus the truth's variance. Light that no \
         seed has found counts as bias, for example caustics of small lamps in path tracing. \
         relMSE omits the worst 0.1 % of the pixels, the variance does not: if it is a hundred \
         times relMSE, a few bright dots carry the light.</p>",
    );
}

/// Base64 encoding with padding (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let word = chunk.iter().fold(0u32, |word, byte| word << 8 | u32::from(*byte))
            << (8 * (3 - chunk.len()));
        for place in 0..4 {
            let digit = DIGITS[(word >> (18 - 6 * place)) as usize & 63];
            out.push(if place <= chunk.len() { char::from(digit) } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Test vectors of RFC 4648, section 10.
    #[test]
    fn base64_of_the_standard() {
        let pairs = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("foobar", "Zm9vYmFy"),
        ];
        for (text, coded) in pairs {
            assert_eq!(base64(text.as_bytes()), coded);
        }
        assert_eq!(base64(&[0xff, 0xfe, 0x00]), "//4A");
    }
}
