//! Image metrics as JSON and as a table.

use caustica::low_level::film::Measures;
use caustica::low_level::film::metrics::Comparison;
use serde_json::{Value, json};

use super::bounds::Measured;

/// Per-pixel metrics as JSON; infinite values are null.
pub fn comparison_json(comparison: &Comparison) -> Value {
    let worst = &comparison.worst;
    json!({
        "mean_ratio": comparison.mean_ratio,
        "rel_mse": comparison.rel_mse,
        "median_difference": comparison.median,
        "mse": comparison.mse,
        "rmse": comparison.rmse,
        "psnr": comparison.psnr,
        "pixels_differing": comparison.pixels_differing,
        "pixels": comparison.pixels,
        "worst": { "x": worst.x, "y": worst.y, "a": worst.a, "b": worst.b },
    })
}

/// All metrics as JSON; infinite or undefined values are null.
pub fn measures_json(measures: &Measures) -> Value {
    let mut figures = comparison_json(&measures.pixels);
    figures["ssim"] = json!(measures.ssim);
    figures["ldr_flip"] = json!(measures.ldr_flip);
    figures["hdr_flip"] = json!(measures.hdr_flip);
    figures
}

/// Table with a row for each metric and a column for the image and each region.
pub fn table(measured: &[Measured]) -> String {
    type Row = (&'static str, fn(&Measures) -> String);
    const ROWS: [Row; 11] = [
        ("MSE", |m| format!("{:.4e}", m.pixels.mse)),
        ("relMSE", |m| format!("{:.4e}", m.pixels.rel_mse)),
        ("RMSE", |m| format!("{:.4e}", m.pixels.rmse)),
        ("PSNR", |m| format!("{:.2} dB", m.pixels.psnr)),
        ("SSIM", |m| or_dash(m.ssim)),
        ("mean ratio, red", |m| format!("{:.6}", m.pixels.mean_ratio[0])),
        ("mean ratio, green", |m| format!("{:.6}", m.pixels.mean_ratio[1])),
        ("mean ratio, blue", |m| format!("{:.6}", m.pixels.mean_ratio[2])),
        ("LDR-FLIP", |m| or_dash(Some(m.ldr_flip))),
        ("HDR-FLIP", |m| or_dash(m.hdr_flip)),
        ("pixels that differ", |m| format!("{} of {}", m.pixels.pixels_differing, m.pixels.pixels)),
    ];
    let heading = measured.iter().map(|place| place.region.unwrap_or("image").to_owned());
    let mut rows = vec![(String::new(), heading.collect::<Vec<_>>())];
    rows.extend(ROWS.iter().map(|(name, figure)| {
        ((*name).to_owned(), measured.iter().map(|place| figure(&place.measures)).collect())
    }));
    let width = |column: usize| {
        rows.iter().map(|(_, cells)| cells[column].chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<_> = (0..measured.len()).map(width).collect();
    let line = |(name, cells): &(String, Vec<String>)| {
        let cells = cells.iter().zip(&widths).map(|(cell, &width)| format!("  {cell:>width$}"));
        format!("{name:<18}{}", cells.collect::<String>())
    };
    rows.iter().map(line).collect::<Vec<_>>().join("\n")
}

fn or_dash(figure: Option<f64>) -> String {
    figure.map_or("-".to_owned(), |figure| format!("{figure:.6}"))
}
