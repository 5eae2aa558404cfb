//! Thresholds for measures, each for the whole picture or for a named region.

use caustica::low_level::film::Measures;
use serde_json::{Value, json};

use super::Failure;

/// A bound as in `0.1`, for the whole picture, or `caustic=0.1`, for a region.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    pub region: Option<String>,
    pub limit: f64,
}

/// Bounds for every measure; each may be given several times, for several regions.
#[derive(clap::Args)]
#[command(next_help_heading = "Thresholds: exit with 3 where a figure is beyond one")]
pub struct Bounds {
    /// Most LDR-FLIP
    #[arg(long = "max-FLIP", alias = "max-flip", value_name = "[REGION=]X", value_parser = upper, allow_hyphen_values = true)]
    max_flip: Vec<Bound>,
    /// Most HDR-FLIP
    #[arg(long = "max-HDR-FLIP", alias = "max-hdr-flip", value_name = "[REGION=]X", value_parser = upper, allow_hyphen_values = true)]
    max_hdr_flip: Vec<Bound>,
    /// Most relMSE
    #[arg(long = "max-relMSE", alias = "max-relmse", value_name = "[REGION=]X", value_parser = upper, allow_hyphen_values = true)]
    max_rel_mse: Vec<Bound>,
    /// Most MSE
    #[arg(long = "max-MSE", alias = "max-mse", value_name = "[REGION=]X", value_parser = upper, allow_hyphen_values = true)]
    max_mse: Vec<Bound>,
    /// Most RMSE
    #[arg(long = "max-RMSE", alias = "max-rmse", value_name = "[REGION=]X", value_parser = upper, allow_hyphen_values = true)]
    max_rmse: Vec<Bound>,
    /// Least PSNR in dB
    #[arg(long = "min-PSNR", alias = "min-psnr", value_name = "[REGION=]X", value_parser = bound, allow_hyphen_values = true)]
    min_psnr: Vec<Bound>,
    /// Least SSIM
    #[arg(long = "min-SSIM", alias = "min-ssim", value_name = "[REGION=]X", value_parser = similarity, allow_hyphen_values = true)]
    min_ssim: Vec<Bound>,
    /// Most that a channel's mean ratio may differ from 1, as in 0.005
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
        _ => Err("expected a number, or a region's name and a number as in caustic=0.1".to_owned()),
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

/// Measures and where they were taken: a region's name, or none for the whole picture.
pub struct Measured<'a> {
    pub region: Option<&'a str>,
    pub measures: Measures,
}

/// A bound that a figure is beyond.
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

/// A measure, its side, the bounds given for it and its figure.
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

    /// Fails for a bound on a region that is none of `regions`.
    pub fn check_regions(&self, regions: &[&str]) -> Result<(), Failure> {
        let bounds = self.rules().into_iter().flat_map(|(_, _, bounds, _)| bounds);
        check_regions(bounds, regions)
    }

    /// The bounds that are passed. Fails for one on a figure that there is none of.
    pub fn passed<'a>(&self, measured: &[Measured<'a>]) -> Result<Vec<Passed<'a>>, Failure> {
        let mut passed = Vec::new();
        for (measure, side, bounds, figure) in self.rules() {
            for bound in bounds {
                for place in measured.iter().filter(|place| place.region == bound.region.as_deref())
                {
                    let value =
                        figure(&place.measures).ok_or_else(|| no_figure(measure, place.region))?;
                    // A value that is no number is beyond every bound.
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

/// Fails for a bound on a region that is none of `regions`.
pub fn check_regions<'a>(
    bounds: impl Iterator<Item = &'a Bound>,
    regions: &[&str],
) -> Result<(), Failure> {
    let mut named = bounds.filter_map(|bound| bound.region.as_deref());
    let Some(unknown) = named.find(|name| !regions.contains(name)) else {
        return Ok(());
    };
    let help = match regions {
        [] => format!("define it, as in --region {unknown}=0,0,64,64"),
        _ => format!("the regions are {}", regions.join(", ")),
    };
    Err(Failure::wrong_use(&format!("there is no region `{unknown}`"), &help))
}

fn no_figure(measure: &str, region: Option<&str>) -> Failure {
    let place = region.map_or("these pictures".to_owned(), |name| format!("the region {name}"));
    let help = match measure {
        "SSIM" => "it needs a window of 11 x 11 pixels inside the picture",
        _ => {
            "it is for radiance: .exr, .pfm or .hdr; for pictures for a display there is --max-FLIP"
        }
    };
    Failure::wrong_use(&format!("there is no {measure} of {place}"), help)
}
