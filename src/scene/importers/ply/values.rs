//! Numbers after the header of a PLY file, as text or in binary.

use std::ops::Range;

use super::header::{Broken, Element, Format, Number, Property, shortened};
use crate::scene::numbers::LARGEST;

/// Reads numbers one after another.
pub(super) trait Values {
    /// Reads a number of the type that the header states; text may have a fraction or an exponent
    /// in either case.
    fn number(&mut self, number: Number) -> Option<f64>;

    /// Number of bytes that are left, and so an upper bound on the numbers.
    fn left(&self) -> usize;

    /// Least number of bytes of an item of a list.
    fn item_size(&self, number: Number) -> usize;

    /// Offset in the file of the blanks or the byte where the next number begins.
    fn at(&self) -> usize;

    /// Position of the number at an offset.
    fn place(&self, at: usize) -> Place;

    /// Notes that a row of an element ends here.
    fn end_row(&mut self);

    /// The first number behind a row that does not end together with a line of text.
    fn ragged(&self) -> Option<Range<usize>>;

    /// Returns whether only blanks are left.
    fn is_at_end(&self) -> bool;
}

/// Position of a number.
#[derive(Clone, Debug)]
pub(super) enum Place {
    /// Byte range in a file that is text.
    Text(Range<usize>),
    /// Offset in a binary file.
    Byte(usize),
}

impl Place {
    /// An error about the number here, which belongs to `property`.
    pub fn broken(self, property: &Property, message: String, expected: String) -> Broken {
        match self {
            Self::Text(span) => Broken { span, message, expected },
            Self::Byte(at) => {
                let message = format!("{message}, at byte {at}");
                Broken { span: property.line.clone(), message, expected }
            }
        }
    }
}

/// Numbers in text, separated by blanks and line ends.
pub(super) struct Text<'b> {
    bytes: &'b [u8],
    at: usize,
    /// The first number behind a row that does not end together with a line.
    ragged: Option<Range<usize>>,
}

impl<'b> Text<'b> {
    pub fn new(bytes: &'b [u8], at: usize) -> Self {
        Self { bytes, at, ragged: None }
    }

    /// The word at or behind an offset; empty at the end of the file.
    fn word(&self, at: usize) -> Range<usize> {
        let rest = &self.bytes[at..];
        let start = at + rest.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let word = &self.bytes[start..];
        let length = word.iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
        start..start + length
    }
}

impl Values for Text<'_> {
    fn number(&mut self, _: Number) -> Option<f64> {
        let word = self.word(self.at);
        let text = std::str::from_utf8(self.bytes.get(word.clone())?).ok()?;
        let value = text.parse().ok()?;
        self.at = word.end;
        Some(value)
    }

    fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn item_size(&self, _: Number) -> usize {
        2
    }

    fn at(&self) -> usize {
        self.at
    }

    fn place(&self, at: usize) -> Place {
        Place::Text(self.word(at))
    }

    fn end_row(&mut self) {
        if self.ragged.is_none() {
            let word = self.word(self.at);
            let blanks = &self.bytes[self.at..word.start];
            let ends = word.is_empty() || blanks.iter().any(|blank| matches!(blank, b'\n' | b'\r'));
            self.ragged = (!ends).then_some(word);
        }
    }

    fn ragged(&self) -> Option<Range<usize>> {
        self.ragged.clone()
    }

    fn is_at_end(&self) -> bool {
        self.word(self.at).is_empty()
    }
}

/// Numbers in binary.
pub(super) struct Binary<'b, const BIG_ENDIAN: bool> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b, const BIG_ENDIAN: bool> Binary<'b, BIG_ENDIAN> {
    pub fn new(bytes: &'b [u8], at: usize) -> Self {
        Self { bytes, at }
    }

    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let mut bytes: [u8; N] = self.bytes.get(self.at..self.at + N)?.try_into().ok()?;
        self.at += N;
        if BIG_ENDIAN {
            bytes.reverse();
        }
        Some(bytes)
    }
}

impl<const BIG_ENDIAN: bool> Values for Binary<'_, BIG_ENDIAN> {
    fn number(&mut self, number: Number) -> Option<f64> {
        Some(match number {
            Number::Int8 => f64::from(i8::from_le_bytes(self.take()?)),
            Number::Uint8 => f64::from(u8::from_le_bytes(self.take()?)),
            Number::Int16 => f64::from(i16::from_le_bytes(self.take()?)),
            Number::Uint16 => f64::from(u16::from_le_bytes(self.take()?)),
            Number::Int32 => f64::from(i32::from_le_bytes(self.take()?)),
            Number::Uint32 => f64::from(u32::from_le_bytes(self.take()?)),
            Number::Float32 => f64::from(f32::from_le_bytes(self.take()?)),
            Number::Float64 => f64::from_le_bytes(self.take()?),
        })
    }

    fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn item_size(&self, number: Number) -> usize {
        number.size()
    }

    fn at(&self) -> usize {
        self.at
    }

    fn place(&self, at: usize) -> Place {
        Place::Byte(at)
    }

    fn end_row(&mut self) {}

    fn ragged(&self) -> Option<Range<usize>> {
        None
    }

    fn is_at_end(&self) -> bool {
        self.at == self.bytes.len()
    }
}

/// Reads a scalar, or reports a file that ends early and a word that is not a number.
pub(super) fn scalar<V: Values>(
    values: &mut V,
    number: Number,
    element: &Element,
    property: &Property,
    bytes: &[u8],
) -> Result<f64, Broken> {
    if let Some(value) = values.number(number) {
        return Ok(value);
    }
    let place = values.place(values.at());
    let word = match &place {
        Place::Text(span) => String::from_utf8_lossy(&bytes[span.clone()]).into_owned(),
        Place::Byte(_) => String::new(),
    };
    if word.is_empty() {
        return Err(short(element, bytes.len()));
    }
    let message = format!("`{}` is not a number", shortened(&word));
    let expected = format!("expected `{}` of an element `{}`", property.name, element.name);
    Err(place.broken(property, message, expected))
}

/// The error about a file that ends before its last row.
pub(super) fn short(element: &Element, length: usize) -> Broken {
    let Element { name, count, line, .. } = element;
    let rows = if *count == 1 { "row" } else { "rows" };
    let message = format!("the file ends at byte {length}, before the end of `{name}`");
    Broken::new(line.clone(), message, format!("expected {count} {rows}"))
}

/// Checks that the rows of an element fit in the bytes that are left, before memory is allocated.
pub(super) fn fits(
    element: &Element,
    format: Format,
    left: usize,
    length: usize,
) -> Result<(), Broken> {
    let row = element.least_size(format);
    // The last number in text needs no blank behind it.
    let last = u64::from(format == Format::Ascii && row > 0);
    let needed = element.count.checked_mul(row).map(|needed| needed.saturating_sub(last));
    match needed {
        Some(needed) if needed <= left as u64 => Ok(()),
        _ => Err(short(element, length)),
    }
}

/// Returns whether a position or a texture coordinate is finite and not too large.
pub(super) fn is_usable(value: f64) -> bool {
    value.abs() <= LARGEST
}

/// The error about a number that is not finite or too large.
pub(super) fn unusable(place: Place, property: &Property, value: f64) -> Broken {
    let name = &property.name;
    if value.is_finite() {
        let message = format!("`{name}` = {value:e} is too large for single precision");
        place.broken(property, message, format!("expected at most {LARGEST:e} in magnitude"))
    } else {
        let message = format!("`{name}` is not a finite number");
        place.broken(property, message, "expected a number".to_owned())
    }
}
