//! OpenEXR files: 32-bit float channels, and text attributes.

use std::collections::BTreeMap;
use std::io::Cursor;

use exr::prelude::*;

use super::{Picture, Plane};
use crate::memory;

/// Content of the first layer of an EXR file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExrFile {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Position of the data window in the display window.
    pub frame: Frame,
    /// Values of each channel, row 0 on top.
    pub channels: BTreeMap<String, Vec<f32>>,
    /// Text attributes.
    pub attributes: BTreeMap<String, String>,
}

impl ExrFile {
    /// The channels `<prefix>R`, `<prefix>G` and `<prefix>B` as an image, or `None` if one is
    /// missing. The prefix is empty for radiance and `SE.` for the standard errors of reference
    /// images.
    pub fn picture(&self, prefix: &str) -> Option<Picture> {
        let channel = |name| self.channels.get(&format!("{prefix}{name}"));
        let (r, g, b) = (channel("R")?, channel("G")?, channel("B")?);
        let rgb = r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b]).collect();
        Some(Picture { width: self.width, height: self.height, rgb })
    }
}

/// A channel other than R, G and B.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Full name, such as `Variance.Y`.
    pub name: &'static str,
    /// Values, one per pixel.
    pub plane: Plane,
    /// Sample type in the file.
    pub numbers: Numbers,
}

/// Sample type of a channel in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Numbers {
    /// 32-bit floats.
    Float,
    /// 32-bit unsigned integers.
    Whole,
}

impl Channel {
    /// Creates a channel that is stored as 32-bit floats.
    pub fn float(name: &'static str, plane: Plane) -> Self {
        Self { name, plane, numbers: Numbers::Float }
    }
}

/// Position of a crop window in the whole image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Frame {
    /// The window's first column.
    pub x: u32,
    /// Its first row.
    pub y: u32,
    /// Pixels per row of the whole image.
    pub width: u32,
    /// Rows of the whole image.
    pub height: u32,
}

impl Frame {
    /// Frame of an image that is not cropped.
    pub fn of(picture: &Picture) -> Self {
        Self { x: 0, y: 0, width: picture.width, height: picture.height }
    }
}

/// Encodes a losslessly compressed EXR file with the channels R, G, B and those in `layers`. The
/// image is the data window, the frame is the display window. Equal arguments give equal bytes.
pub fn encode(
    picture: &Picture,
    frame: Frame,
    layers: &[Channel],
    attributes: &BTreeMap<String, String>,
) -> std::result::Result<Vec<u8>, String> {
    let channel = |name: &str, values| AnyChannel::new(Text::from(name), values);
    let colors = ["R", "G", "B"].into_iter().enumerate();
    let mut channels: SmallVec<[_; 4]> = colors
        .map(|(c, name)| {
            channel(name, FlatSamples::F32(picture.rgb.iter().map(|rgb| rgb[c]).collect()))
        })
        .collect();
    // clamp to the range of f32
    let held = |x: &f64| x.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32;
    let samples = |layer: &Channel| match layer.numbers {
        Numbers::Float => FlatSamples::F32(layer.plane.values.iter().map(held).collect()),
        Numbers::Whole => FlatSamples::U32(layer.plane.values.iter().map(|x| *x as u32).collect()),
    };
    channels.extend(layers.iter().map(|layer| channel(layer.name, samples(layer))));
    let mut layer = LayerAttributes {
        software_name: Some(Text::from(concat!("caustica ", env!("CARGO_PKG_VERSION")))),
        layer_position: Vec2(frame.x as i32, frame.y as i32),
        ..LayerAttributes::default()
    };
    for (name, value) in attributes {
        let value = AttributeValue::Text(Text::from_slice_unchecked(value.as_bytes()));
        layer.other.insert(Text::from_slice_unchecked(name.as_bytes()), value);
    }
    let layer = Layer::new(
        (picture.width as usize, picture.height as usize),
        layer,
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels),
    );
    let mut image = Image::from_layer(layer);
    image.attributes.display_window =
        IntegerBounds::new((0, 0), (frame.width as usize, frame.height as usize));
    let mut bytes = Vec::new();
    image
        .write()
        .non_parallel()
        .to_buffered(Cursor::new(&mut bytes))
        .map_err(|error| error.to_string())?;
    sort_attributes(&mut bytes).ok_or("the header is not terminated")?;
    Ok(bytes)
}

/// Reads all channels and text attributes of the first layer.
pub fn decode(bytes: &[u8]) -> std::result::Result<ExrFile, String> {
    check_size(bytes)?;
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| error.to_string())?;
    let layer = image.layer_data;
    let (whole, corner) = (image.attributes.display_window, layer.attributes.layer_position);
    let offset = |data: i32, display: i32| data.saturating_sub(display).max(0) as u32;
    let frame = Frame {
        x: offset(corner.x(), whole.position.x()),
        y: offset(corner.y(), whole.position.y()),
        width: whole.size.width() as u32,
        height: whole.size.height() as u32,
    };
    let text = |text: &Text| String::from_utf8_lossy(text.bytes()).into_owned();
    let attributes = layer.attributes.other.iter().filter_map(|(name, value)| match value {
        AttributeValue::Text(value) => Some((text(name), text(value))),
        _ => None,
    });
    let channels = layer
        .channel_data
        .list
        .iter()
        .map(|c| (text(&c.name), c.sample_data.values_as_f32().collect()));
    Ok(ExrFile {
        width: layer.size.width() as u32,
        height: layer.size.height() as u32,
        frame,
        channels: channels.collect(),
        attributes: attributes.collect(),
    })
}

/// Fails if decoding would exceed the available memory, since a short file can declare any size.
fn check_size(bytes: &[u8]) -> std::result::Result<(), String> {
    /// Bytes per value: the file's sample and the decoded float.
    const BYTES_OF_SAMPLE: u64 = 8;
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false)
        .map_err(|error| error.to_string())?;
    meta.headers.iter().try_for_each(|header| {
        let [width, height] =
            [header.layer_size.width(), header.layer_size.height()].map(|n| n as u64);
        let each = BYTES_OF_SAMPLE * header.channels.list.len() as u64;
        memory::check_pixels(width, height, each)
    })
}

/// Sorts the header attributes of a single-part file by name. The `exr` crate stores them in a hash
/// map, whose order differs between runs, but equal images must give equal files. Returns `None` if
/// the header is truncated.
fn sort_attributes(file: &mut [u8]) -> Option<()> {
    const MAGIC_AND_VERSION: usize = 8;
    let mut attributes = Vec::new();
    let mut at = MAGIC_AND_VERSION;
    while *file.get(at)? != 0 {
        let after_zero =
            |from: usize| Some(from + 1 + file.get(from..)?.iter().position(|&byte| byte == 0)?);
        let size_at = after_zero(after_zero(at)?)?;
        let size = i32::from_le_bytes(file.get(size_at..size_at + 4)?.try_into().ok()?);
        let end = size_at + 4 + usize::try_from(size).ok()?;
        attributes.push(file.get(at..end)?.to_vec());
        at = end;
    }
    attributes.sort();
    file[MAGIC_AND_VERSION..at].copy_from_slice(&attributes.concat());
    Some(())
}
