//! Channel selection in EXR files: R, G, B; or Y as gray. They come from the only layer that has
//! them, or from the unnamed layer.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{BufRead, Seek};

use exr::math::Vec2;
use exr::meta::MetaData;
use exr::meta::header::Header;
use exr::prelude::{ReadChannels, ReadLayers, ReadSpecificChannel, Text};

use super::exr_subsampled;

/// A decoded image: size in pixels, texels row by row, and whether alpha is below 1 anywhere.
pub(super) struct Picture {
    pub width: usize,
    pub height: usize,
    pub texels: Vec<[f32; 3]>,
    pub transparent: bool,
}

/// Names of the channels to read.
#[derive(Debug)]
pub(super) struct Chosen {
    colors: Colors,
    alpha: Text,
    /// Part of the file that contains the channel, if other channels in it have a lower resolution.
    subsampled: Option<usize>,
    /// Names of chroma channels that are ignored.
    pub unread: Vec<String>,
}

#[derive(Debug)]
enum Colors {
    Rgb([Text; 3]),
    Gray(Text),
}

/// Most channel names in an error message.
const MOST_LISTED: usize = 40;

/// Chooses the channels to read.
///
/// # Errors
/// No usable channels, several layers with colors but no unnamed one, or colors of reduced
/// resolution. The message lists the channels.
pub(super) fn choose(meta: &MetaData) -> Result<Chosen, String> {
    let mut found = BTreeMap::new();
    for (part, header) in meta.headers.iter().enumerate().filter(|(_, header)| !header.deep) {
        let channels = channels(header);
        let layers: BTreeSet<_> = channels.keys().map(|name| layer_of(name)).collect();
        for layer in layers {
            let Some(chosen) = chosen(&channels, layer) else { continue };
            // The first part that has the layer wins, but colors take precedence over gray.
            let is_gray = |known: &(Chosen, usize)| matches!(known.0.colors, Colors::Gray(_));
            let has_colors = matches!(chosen.colors, Colors::Rgb(_));
            if found.get(layer).is_none_or(|known| has_colors && is_gray(known)) {
                found.insert(layer.to_owned(), (chosen, part));
            }
        }
    }
    let only = (found.len() == 1).then(|| found.pop_first()).flatten().map(|(_, chosen)| chosen);
    let Some((mut chosen, part)) = only.or_else(|| found.remove("")) else {
        let why = if found.is_empty() {
            "no channels R, G, B and no Y"
        } else {
            "several layers with colors"
        };
        return Err(format!("it has {why}; its channels are {}", listed(meta)));
    };
    let channels = &meta.headers[part].channels.list;
    if let Some(channel) = channels.iter().find(|channel| channel.sampling != Vec2(1, 1)) {
        let is_read = |name: &Text| {
            channels.iter().any(|one| one.name == *name && one.sampling == Vec2(1, 1))
        };
        if !matches!(&chosen.colors, Colors::Gray(y) if is_read(y)) {
            let (name, Vec2(x, y)) = (&channel.name, channel.sampling);
            let what = format!("its channel `{name}` has one value for {x} x {y} pixels");
            return Err(format!(
                "{what}, which is not supported; its channels are {}",
                listed(meta)
            ));
        }
        chosen.subsampled = Some(part);
    }
    Ok(chosen)
}

fn channels(header: &Header) -> BTreeMap<String, &Text> {
    header.channels.list.iter().map(|channel| (channel.name.to_string(), &channel.name)).collect()
}

fn layer_of(channel: &str) -> &str {
    channel.rsplit_once('.').map_or("", |(layer, _)| layer)
}

fn listed(meta: &MetaData) -> String {
    let all: BTreeSet<_> =
        meta.headers.iter().flat_map(|header| channels(header).into_keys()).collect();
    let names: Vec<_> = all.iter().take(MOST_LISTED).map(|name| format!("`{name}`")).collect();
    match all.len() - names.len() {
        0 => names.join(", "),
        more => format!("{} and {more} more", names.join(", ")),
    }
}

/// The color channels of a layer, if it has any.
fn chosen(channels: &BTreeMap<String, &Text>, layer: &str) -> Option<Chosen> {
    let find = |channel: &str| {
        let name = if layer.is_empty() { channel.to_owned() } else { format!("{layer}.{channel}") };
        channels.get(&name).map(|&name| name.clone())
    };
    let colors = match ["R", "G", "B"].map(find) {
        [Some(r), Some(g), Some(b)] => Colors::Rgb([r, g, b]),
        _ => Colors::Gray(find("Y")?),
    };
    let is_gray = matches!(colors, Colors::Gray(_));
    let chroma = ["BY", "RY"].into_iter().filter(|_| is_gray).filter_map(find);
    let unread = chroma.map(|name| name.to_string()).collect();
    // A missing alpha channel reads as 1; no channel of the layer has the name used here.
    let alpha = find("A").or_else(|| Text::new_or_none("no alpha"))?;
    Some(Chosen { colors, alpha, subsampled: None, unread })
}

/// Reads the chosen channels. `file` has been read up to the end of its headers, `meta`.
///
/// # Errors
/// A damaged file, or chroma of lower resolution with tiles or an unsupported compression.
pub(super) fn read(
    mut file: impl BufRead + Seek + Send,
    meta: &MetaData,
    chosen: Chosen,
) -> exr::error::Result<Picture> {
    type Store = (usize, Vec<[f32; 3]>, bool);
    let create =
        |size: Vec2<usize>| -> Store { (size.width(), vec![[0.0; 3]; size.area()], false) };
    let set = |(width, texels, transparent): &mut Store, at: Vec2<usize>, texel, alpha: f32| {
        texels[at.y() * *width + at.x()] = texel;
        *transparent |= alpha < 1.0;
    };
    if let (Colors::Gray(y), Some(part)) = (&chosen.colors, chosen.subsampled) {
        return exr_subsampled::read(file, meta, part, y);
    }
    file.rewind()?;
    let reader = exr::prelude::read().no_deep_data().largest_resolution_level().specific_channels();
    let (size, (_, texels, transparent)) = match chosen.colors {
        Colors::Rgb([r, g, b]) => {
            let channels =
                reader.required(r).required(g).required(b).optional(chosen.alpha, 1.0f32);
            let image = channels
                .collect_pixels(
                    move |size, _: &_| create(size),
                    move |store: &mut Store, at, (r, g, b, a): (f32, f32, f32, f32)| {
                        set(store, at, [r, g, b], a)
                    },
                )
                .first_valid_layer()
                .all_attributes()
                .from_buffered(file)?;
            (image.layer_data.size, image.layer_data.channel_data.pixels)
        }
        Colors::Gray(y) => {
            let channels = reader.required(y).optional(chosen.alpha, 1.0f32);
            let image = channels
                .collect_pixels(
                    move |size, _: &_| create(size),
                    move |store: &mut Store, at, (y, a): (f32, f32)| set(store, at, [y; 3], a),
                )
                .first_valid_layer()
                .all_attributes()
                .from_buffered(file)?;
            (image.layer_data.size, image.layer_data.channel_data.pixels)
        }
    };
    Ok(Picture { width: size.width(), height: size.height(), texels, transparent })
}
