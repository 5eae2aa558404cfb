//! OpenEXR files: 32-bit float channels, and text attributes.

use std::collections::BTreeMap;
use std::io::Cursor;

use exr::prelude::*;

use super::Picture;

/// What an EXR file's first layer holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExrFile {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Values of each channel, row 0 on top.
    pub channels: BTreeMap<String, Vec<f32>>,
    /// Text attributes.
    pub attributes: BTreeMap<String, String>,
}

impl ExrFile {
    /// The channels `<prefix>R`, `<prefix>G` and `<prefix>B` as a picture; none when one is missing. The prefix is
    /// empty for radiance and `SE.` for the standard errors in reference pictures.
    pub fn picture(&self, prefix: &str) -> Option<Picture> {
        let channel = |name| self.channels.get(&format!("{prefix}{name}"));
        let (r, g, b) = (channel("R")?, channel("G")?, channel("B")?);
        let rgb = r.iter().zip(g).zip(b).map(|((&r, &g), &b)| [r, g, b]).collect();
        Some(Picture { width: self.width, height: self.height, rgb })
    }
}

/// The bytes of a losslessly compressed EXR file. Equal arguments give equal bytes.
pub fn encode(
    picture: &Picture,
    attributes: &BTreeMap<String, String>,
) -> std::result::Result<Vec<u8>, String> {
    let width = picture.width as usize;
    let pixel = |at: Vec2<usize>| {
        let [r, g, b] = picture.rgb[at.y() * width + at.x()];
        (r, g, b)
    };
    let mut layer = LayerAttributes {
        software_name: Some(Text::from(concat!("caustica ", env!("CARGO_PKG_VERSION")))),
        ..LayerAttributes::default()
    };
    for (name, value) in attributes {
        let value = AttributeValue::Text(Text::from_slice_unchecked(value.as_bytes()));
        layer.other.insert(Text::from_slice_unchecked(name.as_bytes()), value);
    }
    let layer = Layer::new(
        (width, picture.height as usize),
        layer,
        Encoding::SMALL_LOSSLESS,
        SpecificChannels::rgb(pixel),
    );
    let mut bytes = Vec::new();
    Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(Cursor::new(&mut bytes))
        .map_err(|error| error.to_string())?;
    sort_attributes(&mut bytes).ok_or("the header's attributes do not end")?;
    Ok(bytes)
}

/// Reads all channels and text attributes of the first layer.
pub fn decode(bytes: &[u8]) -> std::result::Result<ExrFile, String> {
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
    let text = |text: &Text| String::from_utf8_lossy(text.bytes()).into_owned();
    let attributes = layer.attributes.other.iter().filter_map(|(name, value)| match value {
        AttributeValue::Text(value) => Some((text(name), text(value))),
        _ => None,
    });
    let channels =
        layer.channel_data.list.iter().map(|c| (text(&c.name), c.sample_data.values_as_f32().collect()));
    Ok(ExrFile {
        width: layer.size.width() as u32,
        height: layer.size.height() as u32,
        channels: channels.collect(),
        attributes: attributes.collect(),
    })
}

/// Puts a single-part file's attributes into the order of their names. The `exr` crate keeps them in a hash map
/// whose order changes from run to run, and the same picture must give the same file. None when the header is cut
/// short.
fn sort_attributes(file: &mut [u8]) -> Option<()> {
    const MAGIC_AND_VERSION: usize = 8;
    let mut attributes = Vec::new();
    let mut at = MAGIC_AND_VERSION;
    while *file.get(at)? != 0 {
        let after_zero = |from: usize| Some(from + 1 + file.get(from..)?.iter().position(|&byte| byte == 0)?);
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
