//! Statistics of repeated renders: separation of variance and bias, fitted slopes with confidence
//! intervals.

use serde::{Deserialize, Serialize};

use crate::film::{Picture, luminance};

/// A power law, fitted as `ln y = intercept + slope ln x` by least squares.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PowerLaw {
    /// Exponent.
    pub slope: f64,
    /// `ln y` at `x = 1`.
    pub intercept: f64,
    /// Half the width of the slope's 95 % confidence interval (Student's t), assuming independent
    /// points; `None` for two points, which have no residuals.
    pub half_width: Option<f64>,
}

impl PowerLaw {
    /// Value of `y` at `x`.
    pub fn at(&self, x: f64) -> f64 {
        (self.intercept + self.slope * x.ln()).exp()
    }

    /// Value of `x` at which the law reaches `y`; `None` for a slope of zero.
    pub fn reaches(&self, y: f64) -> Option<f64> {
        let x = ((y.ln() - self.intercept) / self.slope).exp();
        (self.slope != 0.0 && x.is_finite()).then_some(x)
    }
}

/// Fits a power law to the points with positive coordinates. Returns `None` if there are fewer than
/// two distinct `x`.
pub fn fit(points: &[(f64, f64)]) -> Option<PowerLaw> {
    let logs: Vec<(f64, f64)> = points
        .iter()
        .filter(|(x, y)| *x > 0.0 && *y > 0.0)
        .map(|(x, y)| (x.ln(), y.ln()))
        .collect();
    let n = logs.len() as f64;
    let mean_x = logs.iter().map(|(x, _)| x).sum::<f64>() / n;
    let mean_y = logs.iter().map(|(_, y)| y).sum::<f64>() / n;
    let sxx: f64 = logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
    if logs.len() < 2 || sxx <= 0.0 {
        return None;
    }
    let sxy: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let slope = sxy / sxx;
    let intercept = mean_y - slope * mean_x;
    let residual: f64 = logs.iter().map(|(x, y)| (y - intercept - slope * x).powi(2)).sum();
    let freedom = logs.len() - 2;
    let half_width =
        (freedom > 0).then(|| student_t_95(freedom) * (residual / freedom as f64 / sxx).sqrt());
    Some(PowerLaw { slope, intercept, half_width })
}

/// Two-sided 95 % quantile of Student's t with `freedom` >= 1 degrees of freedom: tabulated up to
/// ten, then the Cornish-Fisher expansion (Abramowitz & Stegun 26.7.5), accurate to 1e-4 there.
pub fn student_t_95(freedom: usize) -> f64 {
    const TABLE: [f64; 10] =
        [12.7062, 4.3027, 3.1824, 2.7764, 2.5706, 2.4469, 2.3646, 2.3060, 2.2622, 2.2281];
    if let Some(quantile) = freedom.checked_sub(1).and_then(|i| TABLE.get(i)) {
        return *quantile;
    }
    let (z, f) = (1.959_964_f64, freedom as f64);
    let first = (z.powi(3) + z) / 4.0;
    let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
    let third = (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / 384.0;
    z + first / f + second / f.powi(2) + third / f.powi(3)
}

/// Matrix of mean products of the relative errors of renders with different seeds: entry (j, k) is
/// the mean over pixels of `e_j e_k`, where `e = (L - T) / sqrt(T^2 + 0.01)`, L is the luminance
/// and T that of the reference. So entry (k, k) is relMSE over all pixels. Variance and bias follow
/// from this matrix.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Products(pub Vec<Vec<f64>>);

/// Mean squared error of renders with different seeds, split into variance and squared bias.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Split {
    /// Mean squared relative error of one render, minus the reference's variance.
    pub mse: f64,
    /// Variance: mean over the K seeds of the squared distance from their mean, times
    /// `K / (K - 1)`.
    pub variance: f64,
    /// Squared bias: squared error of the seeds' mean minus `variance / K` and the reference's
    /// variance. The estimate may be negative if it is smaller than the noise.
    pub bias_sq: f64,
    /// Standard error of `bias_sq` by the jackknife over seeds; `None` for two seeds.
    pub bias_sq_error: Option<f64>,
}

impl Products {
    /// Computes the products for images and a reference of equal size.
    pub fn of(pictures: &[Picture], truth: &Picture) -> Self {
        let errors: Vec<Vec<f64>> =
            pictures.iter().map(|picture| relative_errors(picture, truth)).collect();
        let product = |a: &[f64], b: &[f64]| {
            a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / a.len().max(1) as f64
        };
        Self(errors.iter().map(|a| errors.iter().map(|b| product(a, b)).collect()).collect())
    }

    /// Splits the error into variance and squared bias; `None` for fewer than two seeds.
    /// `truth_variance` is the mean squared relative error of the reference.
    pub fn split(&self, truth_variance: f64) -> Option<Split> {
        let all: Vec<usize> = (0..self.0.len()).collect();
        let (mse, bias_sq) = self.parts(&all)?;
        let without = |left_out: usize| {
            let others: Vec<usize> = all.iter().copied().filter(|k| *k != left_out).collect();
            self.parts(&others).map(|(_, bias_sq)| bias_sq)
        };
        let pseudo: Option<Vec<f64>> = all.iter().map(|k| without(*k)).collect();
        let bias_sq_error = pseudo.map(|values| {
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            ((n - 1.0) / n * values.iter().map(|v| (v - mean).powi(2)).sum::<f64>()).sqrt()
        });
        Some(Split {
            mse: mse - truth_variance,
            variance: mse - bias_sq,
            bias_sq: bias_sq - truth_variance,
            bias_sq_error,
        })
    }

    /// Mean squared error of one render, and the part that all renders share, i.e. the mean product
    /// of two different ones. Their difference is the sample variance.
    fn parts(&self, seeds: &[usize]) -> Option<(f64, f64)> {
        let n = seeds.len() as f64;
        if seeds.len() < 2 {
            return None;
        }
        let own: f64 = seeds.iter().map(|k| self.0[*k][*k]).sum();
        let all: f64 = seeds.iter().flat_map(|j| seeds.iter().map(|k| self.0[*j][*k])).sum();
        Some((own / n, (all - own) / (n * (n - 1.0))))
    }
}

/// Relative error `(L - T) / sqrt(T^2 + 0.01)` of each pixel's luminance.
pub fn relative_errors(picture: &Picture, truth: &Picture) -> Vec<f64> {
    let pairs = picture.rgb.iter().zip(&truth.rgb).map(|(a, t)| (luminance(*a), luminance(*t)));
    pairs.map(|(a, t)| (a - t) / (t * t + 0.01).sqrt()).collect()
}

/// Mean and range of some values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Minimum.
    pub low: f64,
    /// Maximum.
    pub high: f64,
}

/// Mean and range of `values`; `None` if there are none.
pub fn spread(values: &[f64]) -> Option<Spread> {
    let low = values.iter().copied().reduce(f64::min)?;
    let high = values.iter().copied().reduce(f64::max)?;
    Some(Spread { mean: values.iter().sum::<f64>() / values.len() as f64, low, high })
}

/// Theory: a power law is a line in log-log space; planted variance and bias are recovered within
/// their sampling error, and the identities of the definitions hold up to rounding.
#[cfg(test)]
mod tests {
    use super::*;

    /// Uniform in [-1, 1), variance 1/3.
    fn noise(state: &mut u64) -> f64 {
        *state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Renders of a gray reference with relative noise of amplitude `a` (variance a^2 / 3) and the
    /// relative bias `bias`.
    fn renders(seeds: u64, a: f64, bias: f64) -> (Vec<Picture>, Picture) {
        let truth = Picture::from_fn(64, 64, |x, y| [0.3 + (x + y) as f32 / 128.0; 3]);
        let one = |seed: u64| {
            let mut state = seed * 7919 + 17;
            Picture::from_fn(64, 64, |x, y| {
                let at = truth.rgb[(y * 64 + x) as usize];
                let weight = (f64::from(at[0]).powi(2) + 0.01).sqrt();
                let error = weight * (bias + a * noise(&mut state));
                at.map(|t| t + error as f32)
            })
        };
        ((0..seeds).map(one).collect(), truth)
    }

    #[test]
    fn exact_power_laws_are_found() {
        for slope in [-1.0, -2.0 / 3.0, 0.0, 0.5] {
            let points: Vec<_> =
                (0..7).map(|i| f64::from(1 << i)).map(|x| (x, 3.0 * x.powf(slope))).collect();
            let law = fit(&points).unwrap();
            assert!(
                (law.slope - slope).abs() < 1e-12 && (law.at(1.0) - 3.0).abs() < 1e-12,
                "{law:?}"
            );
            assert!(law.half_width.unwrap() < 1e-10);
        }
        let law = fit(&[(1.0, 8.0), (4.0, 2.0)]).unwrap();
        assert_eq!(law.half_width, None);
        assert!((law.reaches(1.0).unwrap() - 8.0).abs() < 1e-9);
        assert_eq!(fit(&[(2.0, 1.0), (2.0, 3.0)]), None, "no distinct x");
        assert_eq!(fit(&[(1.0, 1.0), (2.0, -1.0)]), None, "a negative value has no logarithm");
    }

    /// Closed form of a small regression: x = 0, 1, 2, 3, y = 0, 2, 1, 3 (logarithms) has slope
    /// 0.8, residual sum of squares 1.8, so the interval is 4.3027 sqrt(0.9 / 5).
    #[test]
    fn the_interval_is_students() {
        let points = [(0.0, 0.0), (1.0, 2.0), (2.0, 1.0), (3.0, 3.0)]
            .map(|(x, y): (f64, f64)| (x.exp(), y.exp()));
        let law = fit(&points).unwrap();
        assert!((law.slope - 0.8).abs() < 1e-12, "{law:?}");
        assert!((law.half_width.unwrap() - 4.3027 * (0.9_f64 / 5.0).sqrt()).abs() < 1e-9);
        // 95 % of the intervals of noisy lines contain the true slope; intervals of half the width
        // would contain it in 75 %
        let mut state = 5;
        let held = |width: f64, state: &mut u64| {
            let hits = (0..2000).filter(|_| {
                let normal = |state: &mut u64| (0..12).map(|_| noise(state)).sum::<f64>() / 2.0;
                let points: Vec<_> = (0..6)
                    .map(|i| {
                        (f64::from(i).exp(), (-0.7 * f64::from(i) + 0.1 * normal(state)).exp())
                    })
                    .collect();
                let law = fit(&points).unwrap();
                (law.slope + 0.7).abs() <= width * law.half_width.unwrap()
            });
            hits.count() as f64 / 2000.0
        };
        let (whole, half) = (held(1.0, &mut state), held(0.5, &mut state));
        assert!((whole - 0.95).abs() < 0.02, "{whole}");
        assert!(half < 0.85, "{half}");
    }

    /// Quantiles of the t table (11: 2.2010, 20: 2.0860, 60: 2.0003).
    #[test]
    fn quantiles_of_the_table() {
        for (freedom, quantile) in
            [(1, 12.7062), (4, 2.7764), (11, 2.2010), (20, 2.0860), (60, 2.0003)]
        {
            assert!((student_t_95(freedom) - quantile).abs() < 2e-4, "{freedom}");
        }
    }

    #[test]
    fn the_split_is_that_of_the_definitions() {
        let (pictures, truth) = renders(5, 0.3, 0.1);
        let split = Products::of(&pictures, &truth).split(0.002).unwrap();
        let mean = Picture::from_fn(64, 64, |x, y| {
            let at = (y * 64 + x) as usize;
            [0, 1, 2].map(|c| {
                (pictures.iter().map(|p| f64::from(p.rgb[at][c])).sum::<f64>() / 5.0) as f32
            })
        });
        let distance = |a: &Picture, b: &Picture| {
            let pairs = a.rgb.iter().zip(&b.rgb).zip(&truth.rgb);
            let squares = pairs.map(|((a, b), t)| {
                (f64::from(a[1]) - f64::from(b[1])).powi(2) / (f64::from(t[1]).powi(2) + 0.01)
            });
            squares.sum::<f64>() / (64.0 * 64.0)
        };
        let variance = pictures.iter().map(|p| distance(p, &mean)).sum::<f64>() / 5.0 * 5.0 / 4.0;
        let bias_sq = distance(&mean, &truth) - variance / 5.0 - 0.002;
        assert!((split.variance - variance).abs() < 1e-8, "{} {variance}", split.variance);
        assert!((split.bias_sq - bias_sq).abs() < 1e-8, "{} {bias_sq}", split.bias_sq);
        assert!((split.variance + split.bias_sq - split.mse).abs() < 1e-12);
    }

    #[test]
    fn planted_noise_and_bias_come_back() {
        let (pictures, truth) = renders(4, 0.3, 0.1);
        let split = Products::of(&pictures, &truth).split(0.0).unwrap();
        // 16384 values determine the variance to about 1 %
        assert!((split.variance / 0.03 - 1.0).abs() < 0.03, "{split:?}");
        assert!((split.bias_sq / 0.01 - 1.0).abs() < 0.06, "{split:?}");
        let (pictures, truth) = renders(4, 0.3, 0.0);
        let split = Products::of(&pictures, &truth).split(0.0).unwrap();
        assert!(split.bias_sq.abs() < 6.0 * split.bias_sq_error.unwrap().max(5e-5), "{split:?}");
        assert!(split.bias_sq.abs() < 4e-4, "{split:?}");
        // one render has no variance, and neither have two identical ones
        assert_eq!(Products::of(&pictures[..1], &truth).split(0.0), None);
        let twice = [pictures[0].clone(), pictures[0].clone()];
        assert!(Products::of(&twice, &truth).split(0.0).unwrap().variance.abs() < 1e-12);
    }

    /// Noise of the reference appears as bias of all renders unless its variance is subtracted.
    #[test]
    fn the_truths_own_noise_is_taken_away() {
        let (pictures, truth) = renders(4, 0.05, 0.0);
        let mut state = 99;
        let noisy = Picture::from_fn(64, 64, |x, y| {
            let at = truth.rgb[(y * 64 + x) as usize];
            let error = 0.05 * (f64::from(at[0]).powi(2) + 0.01).sqrt() * noise(&mut state);
            at.map(|t| t + error as f32)
        });
        let products = Products::of(&pictures, &noisy);
        let own = 0.0025 / 3.0;
        assert!(products.split(0.0).unwrap().bias_sq > 0.9 * own);
        assert!(
            products.split(own).unwrap().bias_sq.abs() < 0.1 * own,
            "{:?}",
            products.split(own)
        );
    }
}
