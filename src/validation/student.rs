//! Tail probabilities of the Student t and Poisson distributions, for false-positive rates.

use std::f64::consts::FRAC_PI_2;

/// Number of intervals of Simpson's rule; the integrand is smooth.
const INTERVALS: usize = 2000;

/// `P(|t| > limit)` for Student's t with `degrees` degrees of freedom. With
/// `t = sqrt(degrees) tan a`, the density of `a` is proportional to `cos^(degrees - 1) a`.
pub fn two_sided_tail(limit: f64, degrees: u32) -> f64 {
    let density = |a: f64| a.cos().max(0.0).powi(degrees as i32 - 1);
    let from = (limit / f64::from(degrees).sqrt()).atan();
    simpson(density, from, FRAC_PI_2) / simpson(density, 0.0, FRAC_PI_2)
}

/// Smallest count that a Poisson variable of this mean exceeds with probability at most `chance`.
pub fn poisson_limit(mean: f64, chance: f64) -> usize {
    let mut term = (-mean).exp();
    let mut below = term;
    let mut count = 0;
    while 1.0 - below > chance {
        count += 1;
        term *= mean / count as f64;
        below += term;
    }
    count
}

fn simpson(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let step = (to - from) / INTERVALS as f64;
    let weight = |i: usize| if i == 0 || i == INTERVALS { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
    (0..=INTERVALS).map(|i| weight(i) * f(from + step * i as f64)).sum::<f64>() * step / 3.0
}

/// Theory: closed forms and tables.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tails() {
        // Cauchy distribution for one degree of freedom, 1 - t / sqrt(2 + t^2) for two
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
        close(two_sided_tail(4.0, 1), 1.0 - 4.0_f64.atan() / FRAC_PI_2);
        close(two_sided_tail(4.0, 2), 1.0 - 4.0 / 18.0_f64.sqrt());
        // t table: P(|t| > 3.733) = 0.002 for 15 and P(|t| > 1.984) = 0.05 for 100.
        assert!((two_sided_tail(3.733, 15) - 0.002).abs() < 1e-5);
        assert!((two_sided_tail(1.984, 100) - 0.05).abs() < 1e-5);
    }

    #[test]
    fn poisson_counts() {
        // P(X > 0) = 1 - e^-0.01 = 0.00995; for mean 1, P(X > 5) = 5.9e-4 and P(X > 6) = 8.3e-5.
        assert_eq!(poisson_limit(0.01, 0.01), 0);
        assert_eq!(poisson_limit(1.0, 1e-3), 5);
        assert_eq!(poisson_limit(1.0, 1e-4), 6);
    }
}
