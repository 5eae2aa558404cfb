//! Headers of PLY files: format, elements and their properties (Turk, "The PLY Polygon File
//! Format", 1994).

use std::ops::Range;

/// An error in a PLY file.
#[derive(Debug)]
pub(super) struct Broken {
    /// Byte range in the file, or, for binary data, the line of the header that describes it.
    pub span: Range<usize>,
    pub message: String,
    pub expected: String,
}

impl Broken {
    pub fn new(
        span: Range<usize>,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self { span, message: message.into(), expected: expected.into() }
    }
}

/// Encoding of the numbers after the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    Int8,
    Uint8,
    Int16,
    Uint16,
    Int32,
    Uint32,
    Float32,
    Float64,
}

impl Number {
    /// The type with this name, in the words of the format or those of later programs.
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::Int8,
            "uchar" | "uint8" => Self::Uint8,
            "short" | "int16" => Self::Int16,
            "ushort" | "uint16" => Self::Uint16,
            "int" | "int32" => Self::Int32,
            "uint" | "uint32" => Self::Uint32,
            "float" | "float32" => Self::Float32,
            "double" | "float64" => Self::Float64,
            _ => return None,
        })
    }

    /// Bytes in binary files.
    pub fn size(self) -> usize {
        match self {
            Self::Int8 | Self::Uint8 => 1,
            Self::Int16 | Self::Uint16 => 2,
            Self::Int32 | Self::Uint32 | Self::Float32 => 4,
            Self::Float64 => 8,
        }
    }

    pub fn is_integer(self) -> bool {
        !matches!(self, Self::Float32 | Self::Float64)
    }
}

/// Type of a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Number),
    List { count: Number, item: Number },
}

impl Kind {
    /// Least number of bytes of a value; a number in text takes a digit and a blank.
    fn least_size(self, format: Format) -> u64 {
        let (Self::Scalar(number) | Self::List { count: number, .. }) = self;
        if format == Format::Ascii { 2 } else { number.size() as u64 }
    }
}

/// A property of an element.
#[derive(Debug)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
    /// Its line in the header.
    pub line: Range<usize>,
}

/// A table of the file: its rows have a value for each property.
#[derive(Debug)]
pub(super) struct Element {
    pub name: String,
    /// Number of rows.
    pub count: u64,
    pub properties: Vec<Property>,
    /// Its line in the header.
    pub line: Range<usize>,
}

impl Element {
    /// Least number of bytes of a row.
    pub fn least_size(&self, format: Format) -> u64 {
        self.properties.iter().map(|property| property.kind.least_size(format)).sum()
    }
}

/// Header of a PLY file.
#[derive(Debug)]
pub(super) struct Header {
    pub format: Format,
    pub elements: Vec<Element>,
    /// Offset of the first byte after the header.
    pub body: usize,
}

/// Number of bytes of a file that are text: all of them, or the header if the rest is binary.
pub(super) fn text_length(bytes: &[u8]) -> usize {
    let mut lines = Lines::new(bytes);
    let is_text = |line: &[u8]| line.starts_with(b"format ascii");
    match lines.find(|(line, ..)| line.starts_with(b"format ") || *line == b"end_header") {
        Some((line, ..)) if is_text(line) => bytes.len(),
        Some((b"end_header", _, end)) => end,
        Some(_) => lines.find(|(line, ..)| *line == b"end_header").map_or(bytes.len(), |l| l.2),
        None => bytes.len(),
    }
}

/// Lines of a header: text without the line end, offset, and offset of the next line.
struct Lines<'b> {
    bytes: &'b [u8],
    at: usize,
}

impl<'b> Lines<'b> {
    fn new(bytes: &'b [u8]) -> Self {
        Self { bytes, at: 0 }
    }
}

impl<'b> Iterator for Lines<'b> {
    type Item = (&'b [u8], usize, usize);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let length = length.unwrap_or(rest.len());
        // The first byte of binary data may be a line feed too, so a line that ends in a carriage
        // return takes one only if the first line does.
        let pair = rest[length..].starts_with(b"\r\n")
            && (self.at == 0 || self.bytes.starts_with(b"ply\r\n"));
        let end = self.at + length + usize::from(length < rest.len()) + usize::from(pair);
        let start = std::mem::replace(&mut self.at, end);
        Some((rest[..length].trim_ascii_end(), start, end))
    }
}

/// Reads the header of a file.
pub(super) fn header(bytes: &[u8]) -> Result<Header, Broken> {
    let mut lines = Lines::new(bytes);
    match lines.next() {
        Some((b"ply", ..)) => {}
        first => {
            let end = first.map_or(0, |(line, ..)| line.len().min(80));
            return Err(Broken::new(0..end, "not a PLY file", "expected `ply` in the first line"));
        }
    }
    let (mut format, mut elements) = (None, Vec::<Element>::new());
    for (line, start, end) in lines {
        let span = start..start + line.len();
        let text = String::from_utf8_lossy(line);
        let words: Vec<_> = text.split_ascii_whitespace().collect();
        match words[..] {
            ["comment" | "obj_info", ..] | [] => {}
            ["format", ..] if format.is_some() => {
                return Err(Broken::new(span, "a second `format`", "expected one"));
            }
            ["format", ref rest @ ..] => format = Some(format_of(rest, &span)?),
            ["element", ref rest @ ..] => elements.push(element(rest, &span, &elements)?),
            ["property", ref rest @ ..] => match elements.last_mut() {
                Some(element) => element.properties.push(property(rest, &span, element)?),
                None => {
                    let expected = "expected an `element` above";
                    return Err(Broken::new(span, "a property without an element", expected));
                }
            },
            ["end_header"] => {
                let expected = "expected `format ascii 1.0` or another format above";
                let format = format.ok_or_else(|| Broken::new(span, "no `format`", expected))?;
                return Ok(Header { format, elements, body: end });
            }
            [keyword, ..] => {
                let message = format!("`{}` is no line of a PLY header", shortened(keyword));
                let expected = "expected format, element, property, comment or end_header";
                return Err(Broken::new(span, message, expected));
            }
        }
    }
    let end = bytes.len();
    Err(Broken::new(end..end, "the header does not end", "expected `end_header`"))
}

fn format_of(words: &[&str], span: &Range<usize>) -> Result<Format, Broken> {
    match words {
        ["ascii", "1.0"] => Ok(Format::Ascii),
        ["binary_little_endian", "1.0"] => Ok(Format::LittleEndian),
        ["binary_big_endian", "1.0"] => Ok(Format::BigEndian),
        _ => {
            let expected = "expected ascii, binary_little_endian or binary_big_endian, and 1.0";
            Err(Broken::new(span.clone(), "an unknown format", expected))
        }
    }
}

fn element(words: &[&str], span: &Range<usize>, known: &[Element]) -> Result<Element, Broken> {
    let [name, count] = words else {
        let expected = "expected `element NAME COUNT`";
        return Err(Broken::new(span.clone(), "not an element", expected));
    };
    let Ok(count) = count.parse() else {
        let message = format!("`{}` is not a number of rows", shortened(count));
        return Err(Broken::new(span.clone(), message, "expected a whole number"));
    };
    if known.iter().any(|element| element.name == *name) {
        let message = format!("a second element `{}`", shortened(name));
        return Err(Broken::new(span.clone(), message, "expected another name"));
    }
    let name = (*name).to_owned();
    Ok(Element { name, count, properties: Vec::new(), line: span.clone() })
}

fn property(words: &[&str], span: &Range<usize>, element: &Element) -> Result<Property, Broken> {
    let number = |name: &str| {
        Number::of(name).ok_or_else(|| {
            let message = format!("`{}` is no type of numbers", shortened(name));
            let expected = "expected char, uchar, short, ushort, int, uint, float or double";
            Broken::new(span.clone(), message, expected)
        })
    };
    let (name, kind) = match words {
        ["list", count, item, name] => {
            let kind = Kind::List { count: number(count)?, item: number(item)? };
            if !number(count)?.is_integer() {
                let message = "the length of a list is not an integer type";
                return Err(Broken::new(span.clone(), message, "expected uchar, int or another"));
            }
            (name, kind)
        }
        [kind, name] if *kind != "list" => (name, Kind::Scalar(number(kind)?)),
        _ => {
            let expected = "expected `property TYPE NAME` or `property list TYPE TYPE NAME`";
            return Err(Broken::new(span.clone(), "not a property", expected));
        }
    };
    if element.properties.iter().any(|property| property.name == **name) {
        let message = format!("a second property `{}`", shortened(name));
        return Err(Broken::new(span.clone(), message, "expected another name"));
    }
    Ok(Property { name: (*name).to_owned(), kind, line: span.clone() })
}

/// The start of a word, for messages.
pub(super) fn shortened(word: &str) -> String {
    const MOST: usize = 40;
    if word.chars().count() <= MOST {
        return word.to_owned();
    }
    word.chars().take(MOST).chain("...".chars()).collect()
}
