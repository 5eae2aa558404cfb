//! The element `vertex` of a PLY file.

use std::collections::HashMap;

use glam::{DVec2, DVec3};

use super::header::{Broken, Element, Kind, Number};
use super::lists::skip;
use super::values::{Values, is_usable, scalar, unusable};

/// Vertices of a PLY file. Attributes that the file lacks are empty.
#[derive(Debug, Default)]
pub(super) struct Vertices {
    pub positions: Vec<DVec3>,
    pub normals: Vec<DVec3>,
    pub uvs: Vec<DVec2>,
    /// Vertices with a number that cannot be used, each with the error that a face reports which
    /// uses it.
    pub bad: HashMap<u32, Broken>,
}

/// Names of the texture coordinates in the files of various programs.
const UVS: [[&str; 2]; 4] =
    [["s", "t"], ["u", "v"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];

/// First slots of the attributes in a row.
const NORMAL: usize = 3;
const UV: usize = 6;
const SLOTS: usize = 8;

/// Slot of each property in a row, and whether the rows have normals and texture coordinates.
struct Layout {
    slots: Vec<Option<(usize, Number)>>,
    normals: bool,
    uvs: bool,
}

impl Layout {
    fn of(element: &Element) -> Result<Self, Broken> {
        let mut layout =
            Self { slots: vec![None; element.properties.len()], normals: false, uvs: false };
        for name in ["x", "y", "z"] {
            if layout.find(element, name).is_none() {
                let message = format!("`vertex` has no `{name}` that is a number");
                let expected = "expected x, y and z";
                return Err(Broken::new(element.line.clone(), message, expected));
            }
        }
        layout.add(element, &["x", "y", "z"], 0);
        layout.normals = layout.add(element, &["nx", "ny", "nz"], NORMAL);
        layout.uvs = UVS.iter().any(|names| layout.add(element, names, UV));
        Ok(layout)
    }

    fn find(&self, element: &Element, name: &str) -> Option<(usize, Number)> {
        let at = element.properties.iter().position(|property| property.name == name)?;
        match element.properties[at].kind {
            Kind::Scalar(number) => Some((at, number)),
            Kind::List { .. } => None,
        }
    }

    /// Reads the properties of these names, if the element has all of them, into the slots from
    /// `first` on.
    fn add(&mut self, element: &Element, names: &[&str], first: usize) -> bool {
        let found: Option<Vec<_>> = names.iter().map(|name| self.find(element, name)).collect();
        for (slot, (at, number)) in found.iter().flatten().enumerate() {
            self.slots[*at] = Some((first + slot, *number));
        }
        found.is_some()
    }
}

/// Reads the rows of the element.
pub(super) fn vertices<V: Values>(
    values: &mut V,
    element: &Element,
    bytes: &[u8],
) -> Result<Vertices, Broken> {
    let layout = Layout::of(element)?;
    let mut vertices = Vertices::default();
    let mut row = [0.0; SLOTS];
    for index in 0..element.count {
        for (property, slot) in element.properties.iter().zip(&layout.slots) {
            let Some((slot, number)) = *slot else {
                skip(values, element, property, bytes)?;
                continue;
            };
            let at = values.at();
            row[slot] = scalar(values, number, element, property, bytes)?;
            let usable = is_usable(row[slot]) || (NORMAL..UV).contains(&slot);
            if !usable && let Ok(index) = u32::try_from(index) {
                let fault = || unusable(values.place(at), property, row[slot]);
                vertices.bad.entry(index).or_insert_with(fault);
            }
        }
        values.end_row();
        vertices.positions.push(DVec3::new(row[0], row[1], row[2]));
        if layout.normals {
            vertices.normals.push(DVec3::new(row[NORMAL], row[NORMAL + 1], row[NORMAL + 2]));
        }
        if layout.uvs {
            vertices.uvs.push(DVec2::new(row[UV], row[UV + 1]));
        }
    }
    Ok(vertices)
}
