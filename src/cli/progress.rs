//! Render progress: a bar or lines on standard error, or JSON on standard output.

use std::io::IsTerminal;
use std::time::Duration;

use caustica::low_level::render::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;

use super::log;
use super::output::{message, result};

/// Form of the progress output.
pub enum Reporter {
    /// No output.
    Silent,
    /// Progress bar on a terminal.
    Bar(ProgressBar),
    /// Occasional lines.
    Lines(Pace),
    /// Occasional JSON objects on standard output, one per line.
    Json(Pace),
}

/// Number of positions of the bar.
const BAR_LENGTH: u64 = 1000;

impl Reporter {
    /// Selects the form by the user's options and the type of standard error.
    pub fn new(quiet: bool, json: bool) -> Self {
        if json {
            Self::Json(Pace::new(Duration::from_millis(200), 0.0))
        } else if quiet {
            Self::Silent
        } else if std::io::stderr().is_terminal() && !log::is_on() {
            let bar = ProgressBar::with_draw_target(Some(BAR_LENGTH), ProgressDrawTarget::stderr());
            let style = ProgressStyle::with_template("{bar:16} {wide_msg}")
                .unwrap_or(ProgressStyle::default_bar());
            bar.set_style(style);
            Self::Bar(bar)
        } else {
            Self::Lines(Pace::new(Duration::from_secs(2), 0.05))
        }
    }

    /// Shows the progress, if an update is due.
    pub fn show(&mut self, progress: &Progress) {
        match self {
            Self::Silent => (),
            Self::Bar(bar) => {
                bar.set_position((progress.share() * BAR_LENGTH as f64) as u64);
                bar.set_message(line(progress));
            }
            Self::Lines(pace) => {
                if pace.due(progress) {
                    message(format_args!("{:3.0} %  {}", 100.0 * progress.share(), line(progress)));
                }
            }
            Self::Json(pace) => {
                if pace.due(progress) {
                    // a failure of standard output is reported with the results at the end
                    let _ = result(event("progress", progress));
                }
            }
        }
    }

    /// Removes the bar.
    pub fn finish(&mut self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }

    /// Prints a line above the progress, if that is shown as text.
    pub fn note(&self, text: &str) {
        if let Self::Bar(_) | Self::Lines(_) = self {
            message(text);
        }
    }
}

/// Progress as a JSON event; times in seconds, radius in scene units, relative errors (null without
/// an estimate).
pub fn event(name: &str, progress: &Progress) -> serde_json::Value {
    json!({
        "event": name,
        "passes": progress.passes,
        "photons": progress.photons,
        "eye_paths": progress.eye_paths,
        "rays": progress.rays,
        "photons_escaped": progress.ends.escaped,
        "photons_absorbed": progress.ends.absorbed,
        "photons_cut": progress.ends.cut,
        "rays_per_second": progress.rays_per_second(),
        "radius": progress.radius,
        "error": progress.error.map(|error| error.stated),
        "error_noise": progress.error.map(|error| error.noise),
        "error_bias": progress.error.map(|error| error.bias),
        "share": progress.share(),
        "elapsed": progress.elapsed.as_secs_f64(),
        "remaining": progress.remaining().as_secs_f64(),
    })
}

/// Selects the passes that get a line: the first, the last, one per tenth of the work, and those at
/// least `every` after the previous line. In long renders, the interval grows to the fraction
/// `growth` of the elapsed time, to keep logs readable.
pub struct Pace {
    every: Duration,
    growth: f64,
    last: Option<(Duration, f64)>,
}

impl Pace {
    fn new(every: Duration, growth: f64) -> Self {
        Self { every, growth, last: None }
    }

    fn due(&mut self, progress: &Progress) -> bool {
        let (now, share) = (progress.elapsed, progress.share());
        let due = self.last.is_none_or(|(then, share_then)| {
            let gap = self.every.max(now.mul_f64(self.growth));
            let tenth = (10.0 * share).floor() > (10.0 * share_then).floor();
            now >= then + gap || share >= 1.0 || (self.growth > 0.0 && tenth)
        });
        if due {
            self.last = Some((now, share));
        }
        due
    }
}

fn line(progress: &Progress) -> String {
    let passes = match progress.stop.passes {
        u32::MAX => format!("{} passes", progress.passes),
        wanted => format!("{}/{wanted} passes", progress.passes),
    };
    let mut parts = vec![passes];
    if progress.photons > 0 {
        parts.push(format!("{} photons", count(progress.photons as f64)));
    }
    parts.push(format!("{} rays/s", count(progress.rays_per_second())));
    if progress.radius > 0.0 {
        parts.push(format!("radius {:.3e}", progress.radius));
    }
    if let Some(error) = progress.error {
        parts.push(format!("error {}", percent(error.stated)));
    }
    parts.push(format!("{} left", time(progress.remaining())));
    parts.join(", ")
}

/// Formats a fraction as a percentage with three digits.
pub fn percent(share: f64) -> String {
    let number = 100.0 * share;
    let decimals = if number < 9.995 { 2 } else { usize::from(number < 99.95) };
    format!("{number:.decimals$} %")
}

/// Formats a number with three digits and a unit prefix.
pub fn count(number: f64) -> String {
    let prefixes = [(1e12, " T"), (1e9, " G"), (1e6, " M"), (1e3, " k")];
    match prefixes.iter().find(|(unit, _)| number >= *unit) {
        Some((unit, prefix)) => {
            let scaled = number / unit;
            let decimals = if scaled < 9.995 { 2 } else { usize::from(scaled < 99.95) };
            format!("{scaled:.decimals$}{prefix}")
        }
        None => format!("{number:.0}"),
    }
}

/// Formats a duration: 3.2 s, 2 min 05 s, 1 h 20 min.
pub fn time(duration: Duration) -> String {
    let seconds = duration.as_secs();
    match seconds {
        0..60 => format!("{:.1} s", duration.as_secs_f64()),
        60..3600 => format!("{} min {:02} s", seconds / 60, seconds % 60),
        _ => format!("{} h {:02} min", seconds / 3600, seconds / 60 % 60),
    }
}

/// Theory: a log has a line every two seconds or tenth of the work, but no more than some dozens of
/// lines per hour.
#[cfg(test)]
mod tests {
    use super::*;
    use caustica::low_level::film::RelativeError;
    use caustica::low_level::render::Stop;

    fn at(passes: u32, of: u32, seconds: f64) -> Progress {
        Progress {
            stop: Stop { passes: of, time: None, target_error: None },
            passes,
            photons: 1_234_567 * u64::from(passes),
            eye_paths: 0,
            rays: 5_000_000,
            ends: Default::default(),
            radius: 0.012_34,
            elapsed: Duration::from_secs_f64(seconds),
            error: Some(RelativeError { noise: 0.02, bias: 0.01, stated: 0.0234 }),
        }
    }

    /// Passes with a line in a render of `passes` passes of `seconds` each.
    fn lines(passes: u32, seconds: f64) -> Vec<u32> {
        let mut pace = Pace::new(Duration::from_secs(2), 0.05);
        (1..=passes)
            .filter(|&pass| pace.due(&at(pass, passes, f64::from(pass) * seconds)))
            .collect()
    }

    #[test]
    fn lines_come_at_their_pace() {
        assert_eq!(lines(4, 1.9), [1, 2, 3, 4]);
        assert_eq!(lines(40, 0.001), [1, 4, 8, 12, 16, 20, 24, 28, 32, 36, 40]);
        assert_eq!(lines(20, 1.0)[..4], [1, 2, 4, 6]);
        let hour = lines(36_000, 0.1).len();
        assert!((50..200).contains(&hour), "{hour}");
    }

    #[test]
    fn a_line_has_all_its_parts() {
        let line = line(&at(16, 64, 10.0));
        assert_eq!(
            line,
            "16/64 passes, 19.8 M photons, 500 k rays/s, radius 1.234e-2, error 2.34 %, 30.0 s left"
        );
    }

    #[test]
    fn numbers_for_people() {
        assert_eq!(count(999.4), "999");
        assert_eq!(count(1000.0), "1.00 k");
        assert_eq!(count(99_940.0), "99.9 k");
        assert_eq!(count(2.5e9), "2.50 G");
        assert_eq!(
            [0.000_12, 0.0234, 0.123, 1.5].map(percent),
            ["0.01 %", "2.34 %", "12.3 %", "150 %"]
        );
        assert_eq!(time(Duration::from_millis(3210)), "3.2 s");
        assert_eq!(time(Duration::from_secs(125)), "2 min 05 s");
        assert_eq!(time(Duration::from_secs(4800)), "1 h 20 min");
    }
}
