//! Thresholds for metrics, for the whole image or for a named region.

use caustica::low_level::film::Measures;
use serde_json::{Value, json};

use super::Failure;

/// A bound such as `0.1` for the whole image, or `caustic=0.1` for a region.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    pub region: Option<String>,
    pub limit: f64,
}

/// Bounds for all metrics; each may be given several times, for several regions.
#[derive(clap::Args)]
#[command(next_help_heading = "Thresholds: exit with code 3 if one is exceeded")]
pub struct Bounds {
    /// Maximum LDR-FLIP
    #[arg(long = "max-FLIP", alias = "max-flip", value_name = "[REGION=]X", value_parser = upper, allow_hyphen_values = true)]
    max_flip: Vec<Bound>,
    /// Maximum HDR-FLIP
    #[arg(long = "max-HDR-FLIP", alias = "max-hdr-flip", value_name = "[REGION=]X", value_parser = upper, allow_hyphen_values = true)]
    max_hdr_flip: Vec<Bound>,
    /// Maximum relMSE
    #[arg(long = "max-relMSE", alias = "max-relmse", value_name = "[REGION=]X", value_parser = upper, allow_hyphen_values = true)]
    max_rel_mse: Vec<Bound>,
    /// Maximum MSE
    #[arg(long = "max-MSE", alias = "max-mse", value_name = "[REGION=]X", value_parser = upper, allow_hyphen_values = true)]
    max_mse: Vec<Bound>,
    /// Maximum RMSE
    #[arg(long = "max-RMSE", alias = "max-rmse", value_name = "[REGION=]X", value_parser = upper, allow_hyphen_values = true)]
    max_rmse: Vec<Bound>,
    /// Minimum PSNR in dB
    #[arg(long = "min-PSNR", alias = "min-psnr", value_name = "[REGION=]X", value_parser = bound, allow_hyphen_values = true)]
    min_psnr: Vec<Bound>,
    /// Minimum SSIM
    #[arg(long = "min-SSIM", alias = "min-ssim", value_name = "[REGION=]X", value_parser = similarity, allow_hyphen_values = true)]
    min_ssim: Vec<Bound>,
    /// Maximum difference of a channel's mean ratio from 1, e.g. 0.005
    #[arg(long, value_name = "[REGION=]X", value_parser = upper, allow_hyphen_values = true)]
    max_mean_ratio: Vec<Bound>,
}

fn bound(text: &str) -> Result<Bound, String> {
    let (region, number) = match text.rsplit_once('=') {
        Some((region, number)) => (Some(region.to_owned()), number),
        None => (None, text),
    };
    match number.parse::<f64>() {
        Ok(limit) if limit.is_finite() => Ok(Bound { region, limit }),
        _ => Err("expected a number, or a region and a number, e.g. caustic=0.1".to_owned()),
    }
}

pub fn upper(text: &str) -> Result<Bound, String> {
    bound(text).and_then(|bound| match bound.limit >= 0.0 {
        true => Ok(bound),
        false => Err("expected a number of zero or more".to_owned()),
    })
}

fn similarity(text: &str) -> Result<Bound, String> {
    bound(text).and_then(|bound| match (-1.0..=1.0).contains(&bound.limit) {
        true => Ok(bound),
        false => Err("expected a number from -1 to 1".to_owned()),
    })
}

/// Metrics of a named region, or of the whole image.
pub struct Measured<'a> {
    pub region: Option<&'a str>,
    pub measures: Measures,
}

/// An exceeded bound.
pub struct Passed<'a> {
    measure: &'static str,
    region: Option<&'a str>,
    value: f64,
    /// "at most" or "at least".
    side: &'static str,
    limit: f64,
}

impl Passed<'_> {
    pub fn as_text(&self) -> String {
        let region = self.region.map(|name| format!(" of {name}")).unwrap_or_default();
        format!("{}{region} {:.4e}, {} {:.4e}", self.measure, self.value, self.side, self.limit)
    }

    pub fn as_json(&self) -> Value {
        let Self { measure, region, value, side, limit } = self;
        json!({ "measure": measure, "region": region, "value": value, "side": side, "limit": limit })
    }
}

/// Name of a metric, its direction, its bounds and its value.
type Rule<'a> = (&'static str, &'static str, &'a [Bound], fn(&Measures) -> Option<f64>);

impl Bounds {
    fn rules(&self) -> [Rule<'_>; 8] {
        [
            ("LDR-FLIP", "at most", &self.max_flip, |m| Some(m.ldr_flip)),
            ("HDR-FLIP", "at most", &self.max_hdr_flip, |m| m.hdr_flip),
            ("relMSE", "at most", &self.max_rel_mse, |m| Some(m.pixels.rel_mse)),
            ("MSE", "at most", &self.max_mse, |m| Some(m.pixels.mse)),
            ("RMSE", "at most", &self.max_rmse, |m| Some(m.pixels.rmse)),
            ("PSNR", "at least", &self.min_psnr, |m| Some(m.pixels.psnr)),
            ("SSIM", "at least", &self.min_ssim, |m| m.ssim),
            ("difference of the means", "at most", &self.max_mean_ratio, |m| {
                Some(m.pixels.mean_error())
            }),
        ]
    }

    /// Fails if a bound names a region that is not in `regions`.
    pub fn check_regions(&self, regions: &[&str]) -> Result<(), Failure> {
        let bounds = self.rules().into_iter().flat_map(|(_, _, bounds, _)| bounds);
        check_regions(bounds, regions)
    }

    /// Returns the exceeded bounds. Fails if a bounded metric does not exist for these images.
    pub fn passed<'a>(&self, measured: &[Measured<'a>]) -> Result<Vec<Passed<'a>>, Failure> {
        let mut passed = Vec::new();
        for (measure, side, bounds, figure) in self.rules() {
            for bound in bounds {
                for place in measured.iter().filter(|place| place.region == bound.region.as_deref())
                {
                    let value =
                        figure(&place.measures).ok_or_else(|| no_figure(measure, place.region))?;
                    // NaN exceeds every bound
                    let within =
                        if side == "at most" { value <= bound.limit } else { value >= bound.limit };
                    if !within {
                        passed.push(Passed {
                            measure,
                            region: place.region,
                            value,
                            side,
                            limit: bound.limit,
                        });
                    }
                }
            }
        }
        Ok(passed)
    }
}

/// Fails if a bound names a region that is not in `regions`.
pub fn check_regions<'a>(
    bounds: impl Iterator<Item = &'a Bound>,
    regions: &[&str],
) -> Result<(), Failure> {
    let mut named = bounds.filter_map(|bound| bound.region.as_deref());
    let Some(unknown) = named.find(|name| !regions.contains(name)) else {
        return Ok(());
    };
    let help = match regions {
        [] => format!("define it, e.g. --region {unknown}=0,0,64,64"),
        _ => format!("the regions are {}", regions.join(", ")),
    };
    Err(Failure::wrong_use(&format!("the region `{unknown}` is not defined"), &help))
}

fn no_figure(measure: &str, region: Option<&str>) -> Failure {
    let place = region.map_or("these images".to_owned(), |name| format!("the region {name}"));
    let help = match measure {
        "SSIM" => "it needs a window of 11 x 11 pixels inside the image",
        _ => "it needs radiance (.exr, .pfm or .hdr); use --max-FLIP for display values",
    };
    Failure::wrong_use(&format!("{measure} is not defined for {place}"), help)
}
