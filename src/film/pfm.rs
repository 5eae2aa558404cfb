//! Portable float maps (PFM): a short text header, then 32-bit floats, bottom row first.

use super::Picture;

/// Encodes a little-endian color PFM file.
pub fn encode(picture: &Picture) -> Vec<u8> {
    let mut bytes = format!("PF\n{} {}\n-1.0\n", picture.width, picture.height).into_bytes();
    for row in picture.rgb.chunks(picture.width as usize).rev() {
        for value in row.as_flattened() {
            bytes.extend(value.to_le_bytes());
        }
    }
    bytes
}

/// Decodes a color or grayscale PFM file of either byte order. Values are multiplied by the
/// absolute scale in the header.
pub fn decode(bytes: &[u8]) -> Result<Picture, String> {
    let mut rest = bytes;
    let mut word = || -> Result<&str, String> {
        let end = rest.iter().position(u8::is_ascii_whitespace).ok_or("the header is truncated")?;
        let (word, tail) = rest.split_at(end);
        rest = &tail[1..];
        str::from_utf8(word).map_err(|_| "the header is not text".to_owned())
    };
    let channels = match word()? {
        "PF" => 3,
        "Pf" => 1,
        other => return Err(format!("it starts with `{other}`, but expected `PF` or `Pf`")),
    };
    let size = |text: &str| match text.parse::<u32>() {
        Ok(size) if size > 0 => Ok(size),
        _ => Err(format!("`{text}` is not a valid width or height")),
    };
    let (width, height) = (size(word()?)?, size(word()?)?);
    let scale = word()?;
    let scale = scale.parse::<f32>().ok().filter(|s| s.is_finite() && *s != 0.0);
    let scale = scale.ok_or("the scale is not a finite nonzero number")?;
    let values = u64::from(width) * u64::from(height) * channels;
    if rest.len() as u64 != 4 * values {
        return Err(format!(
            "{width} x {height} pixels take {} bytes, but the file contains {}",
            4 * values,
            rest.len()
        ));
    }
    let value = |four: &[u8]| {
        let four = [four[0], four[1], four[2], four[3]];
        let value = if scale < 0.0 { f32::from_le_bytes(four) } else { f32::from_be_bytes(four) };
        value * scale.abs()
    };
    let pixel_bytes = 4 * channels as usize;
    let pixel = |bytes: &[u8]| match channels {
        1 => [value(bytes); 3],
        _ => [value(bytes), value(&bytes[4..]), value(&bytes[8..])],
    };
    let rows = rest.chunks(pixel_bytes * width as usize).rev();
    let rgb = rows.flat_map(|row| row.chunks(pixel_bytes).map(pixel)).collect();
    Ok(Picture { width, height, rgb })
}
