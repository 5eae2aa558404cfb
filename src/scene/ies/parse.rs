//! Parser of IES files.

use super::table::{Symmetry, Table};
use crate::scene::numbers::BRIGHTEST;

/// Largest number of intensities in a file.
const MOST: usize = 1 << 20;
/// Largest deviation of an angle from a multiple of 90 degrees at the end of a range.
const ANGLE_ERROR: f64 = 0.01;

/// Reason why a file cannot be used.
#[derive(Debug)]
pub(super) struct Fault {
    /// Line, from 1.
    pub line: usize,
    /// What is wrong.
    pub message: String,
    /// What was expected.
    pub expected: String,
}

fn fault<T>(
    line: usize,
    message: impl Into<String>,
    expected: impl Into<String>,
) -> Result<T, Fault> {
    Err(Fault { line, message: message.into(), expected: expected.into() })
}

/// The numbers of a file, with their lines.
struct Words<'t> {
    words: std::vec::IntoIter<(usize, &'t str)>,
    last: usize,
}

impl Words<'_> {
    fn number(&mut self, what: &str) -> Result<f64, Fault> {
        let Some((line, word)) = self.words.next() else {
            return fault(self.last, "the file ends too early", format!("expected {what}"));
        };
        self.last = line;
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            Ok(_) | Err(_) => {
                fault(line, format!("`{word}` is not a number"), format!("expected {what}"))
            }
        }
    }

    fn numbers(&mut self, count: usize, what: &str) -> Result<Vec<f64>, Fault> {
        (0..count).map(|_| self.number(what)).collect()
    }

    fn count(&mut self, what: &str) -> Result<usize, Fault> {
        let number = self.number(what)?;
        let valid = number >= 1.0 && number <= MOST as f64 && number.fract() == 0.0;
        if valid {
            return Ok(number as usize);
        }
        fault(self.last, format!("{number} is out of range"), format!("expected {what}, from 1"))
    }
}

/// Reads a file.
///
/// # Errors
/// The first fault.
pub(super) fn parse(text: &str) -> Result<Table, Fault> {
    let lines: Vec<&str> = text.lines().collect();
    let tilt = |line: &&str| line.trim_start().to_ascii_uppercase().starts_with("TILT");
    let Some(at) = lines.iter().position(tilt) else {
        return fault(1, "there is no line with TILT", "expected an LM-63 file");
    };
    let words: Vec<_> = (at + 2..)
        .zip(&lines[at + 1..])
        .flat_map(|(line, text)| {
            let words = text.split(|c: char| c.is_whitespace() || c == ',');
            words.filter(|word| !word.is_empty()).map(move |word| (line, word))
        })
        .collect();
    let mut words = Words { words: words.into_iter(), last: lines.len().max(1) };
    let value = lines[at].split_once('=').map_or("", |(_, value)| value.trim());
    match value.to_ascii_uppercase().as_str() {
        "NONE" => {}
        // the factors apply to a luminaire that hangs aslant
        "INCLUDE" => {
            words.number("the geometry of the lamp")?;
            let count = words.count("a number of tilt angles")?;
            words.numbers(2 * count, "tilt angles and factors")?;
        }
        _ => {
            let message = format!("`{value}` is not supported");
            return fault(at + 1, message, "expected TILT=NONE or TILT=INCLUDE");
        }
    }
    words.numbers(2, "the number of lamps and their lumens")?;
    let multiplier = words.number("the candela multiplier")?;
    let vertical = words.count("a number of vertical angles")?;
    let horizontal = words.count("a number of horizontal angles")?;
    if vertical < 2 || vertical.saturating_mul(horizontal) > MOST {
        let message = format!("{vertical} x {horizontal} angles are out of range");
        return fault(words.last, message, format!("expected 2 vertical angles, at most {MOST}"));
    }
    let kind = words.number("the photometric type")?;
    if kind != 1.0 {
        let message = format!("photometric type {kind} is not supported");
        return fault(words.last, message, "expected 1 (type C)");
    }
    words.numbers(4, "the unit and the size of the luminaire")?;
    let ballast = words.number("the ballast factor")?;
    let lamp = words.number("the ballast-lamp factor, 1 in newer files")?;
    words.number("the input watts")?;
    let factor = multiplier * ballast * lamp;
    if !(factor > 0.0 && factor <= BRIGHTEST) {
        let message = format!("multiplier and ballast factors are {factor} together");
        return fault(words.last, message, "expected a number above 0");
    }
    let vertical = angles(&mut words, vertical, "a vertical angle")?;
    if vertical[0] < -ANGLE_ERROR || vertical[vertical.len() - 1] > 180.0 + ANGLE_ERROR {
        return fault(words.last, "vertical angles out of range", "expected 0 to 180 degrees");
    }
    let horizontal = angles(&mut words, horizontal, "a horizontal angle")?;
    let (first, last) = (horizontal[0], horizontal[horizontal.len() - 1]);
    let near = |a: f64, b: f64| (a - b).abs() <= ANGLE_ERROR;
    let symmetry = match horizontal.len() {
        1 => Symmetry::Axis,
        _ if near(first, 0.0) && near(last, 90.0) => Symmetry::Quadrants,
        _ if near(first, 0.0) && near(last, 180.0) => Symmetry::Halves,
        _ if near(first, 90.0) && near(last, 270.0) => Symmetry::OtherHalves,
        _ if near(first, 0.0) && near(last, 360.0) => Symmetry::None,
        _ => {
            let message = format!("horizontal angles from {first} to {last} degrees");
            return fault(words.last, message, "expected 0 to 90, 180 or 360, or 90 to 270");
        }
    };
    let mut candela = words.numbers(vertical.len() * horizontal.len(), "an intensity")?;
    for value in &mut candela {
        *value *= factor;
        if !(*value >= 0.0 && *value <= BRIGHTEST) {
            return fault(words.last, "an intensity is out of range", "expected 0 or more candela");
        }
    }
    Ok(Table { vertical, horizontal, candela, symmetry })
}

/// Reads angles in ascending order.
fn angles(words: &mut Words, count: usize, what: &str) -> Result<Vec<f64>, Fault> {
    let angles = words.numbers(count, what)?;
    if angles.windows(2).any(|pair| pair[0] >= pair[1]) {
        return fault(
            words.last,
            "the angles do not ascend",
            format!("expected {what} above the last"),
        );
    }
    Ok(angles)
}

/// Theory: files of each version and symmetry are read, and each kind of fault is found at its
/// line.
#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str = "IESNA:LM-63-2002\n[TEST] none\nTILT=NONE\n1 1000 2.0 3 1 1 2 0 0 0\n\
                         0.5 1 10\n0 45, 90\n0\n100 50\n0\n";

    #[test]
    fn factors_apply() {
        let table = parse(SMALL).unwrap();
        assert_eq!(table.candela, [100.0, 50.0, 0.0]);
        assert_eq!(table.vertical, [0.0, 45.0, 90.0]);
        let included = SMALL.replace("TILT=NONE", "TILT = INCLUDE\n1\n2\n0 90\n1 1");
        assert_eq!(parse(&included).unwrap().candela, table.candela);
    }

    #[test]
    fn faults_have_lines() {
        let found = |from: &str, to: &str| {
            let fault = parse(&SMALL.replacen(from, to, 1)).err().unwrap();
            (fault.line, format!("{} | {}", fault.message, fault.expected))
        };
        for (from, to, line, part) in [
            ("TILT", "TLIT", 1, "no line with TILT"),
            ("TILT=NONE", "TILT=lamp.tlt", 3, "expected TILT=NONE"),
            ("2.0 3 1 1", "2.0 3 1 2", 4, "expected 1 (type C)"),
            ("2.0 3 1 1", "2.0 3 0 1", 4, "out of range"),
            ("2.0 3", "-2.0 3", 5, "above 0"),
            ("2.0 3", "2.0 1e9", 4, "out of range"),
            ("45", "x45", 6, "`x45` is not a number"),
            ("45", "95", 6, "do not ascend"),
            ("90\n", "190\n", 6, "0 to 180"),
            ("100 50", "100 -50", 9, "0 or more candela"),
            ("50\n0", "50\n", 8, "ends too early"),
            ("100", "nan", 8, "not a number"),
        ] {
            let (at, text) = found(from, to);
            assert!(at == line && text.contains(part), "{to}: line {at}, {text}");
        }
        let two = SMALL.replace("3 1 1 2", "3 2 1 2").replace("90\n0\n100", "90\n0 120\n1 1 1 100");
        assert!(parse(&two).err().unwrap().message.contains("from 0 to 120"));
    }
}
