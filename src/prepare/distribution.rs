//! Discrete distributions in the resolution of the random numbers.

/// Cumulative fractions of `weights` in steps of 2^-24, the resolution of the random numbers, so
/// that a probability is exactly the difference of two of them. Each weight above zero gets at
/// least one step.
pub fn cumulative(weights: &[f64]) -> impl Iterator<Item = f64> {
    const STEPS: f64 = 16777216.0;
    let total: f64 = weights.iter().sum();
    let used = weights.iter().filter(|w| **w > 0.0).count() as f64;
    // reserve one step for each
    let free = (STEPS - used).max(0.0);
    let mut ends: Vec<f64> = Vec::with_capacity(weights.len());
    let (mut sum, mut count) = (0.0, 0.0);
    for weight in weights {
        sum += weight;
        count += if *weight > 0.0 { 1.0 } else { 0.0 };
        ends.push((count + (sum / total * free).floor()).min(STEPS) / STEPS);
    }
    if let Some(last) = ends.last_mut() {
        *last = 1.0;
    }
    ends.into_iter()
}

/// Theory: every weight above zero gets a step, and all ends are multiples of 2^-24.
#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_weight_has_a_step() {
        let ends: Vec<f64> = cumulative(&[1.0, 0.0, 1e-30, 5.0, 0.0]).collect();
        let steps: Vec<f64> =
            (0..5).map(|i| ends[i] - if i > 0 { ends[i - 1] } else { 0.0 }).collect();
        assert!(
            steps[0] > 0.16 && steps[1] == 0.0 && steps[2] > 0.0 && steps[3] > 0.83,
            "{steps:?}"
        );
        assert!(ends.iter().all(|x| (x * 16777216.0).fract() == 0.0) && ends[4] == 1.0);
    }
}
