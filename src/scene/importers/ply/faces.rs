//! The element `face` of a PLY file.

use glam::DVec2;

use super::header::{Broken, Element, Kind, Number, Property};
use super::lists::{length, skip};
use super::values::{Values, is_usable, scalar, unusable};
use crate::scene::diagnostics::Faults;

/// Faces of a PLY file: corners one after another, and the end of each face among them.
#[derive(Debug, Default)]
pub(super) struct Faces {
    /// Vertex of each corner.
    pub corners: Vec<u32>,
    pub ends: Vec<usize>,
    /// Texture coordinates of each corner, NaN where a face has none; empty if the file has none.
    pub uvs: Vec<DVec2>,
}

impl Faces {
    /// Ranges of the corners of each face.
    pub fn ranges(&self) -> impl Iterator<Item = std::ops::Range<usize>> + '_ {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| start..end)
    }

    /// Number of triangles after triangulation.
    pub fn triangles(&self) -> u64 {
        self.ranges().map(|range| range.len().saturating_sub(2) as u64).sum()
    }
}

/// Names of the list of vertices.
const INDICES: [&str; 2] = ["vertex_indices", "vertex_index"];
/// Name of the list of texture coordinates of the corners.
const UVS: &str = "texcoord";

/// Reads the rows of the element. The file has `count` vertices; indices of others are reported to
/// `faults`.
pub(super) fn faces<V: Values>(
    values: &mut V,
    element: &Element,
    count: u64,
    bytes: &[u8],
    faults: &mut Faults,
) -> Result<Faces, Broken> {
    let list = |name: &str| {
        let at = element.properties.iter().position(|property| property.name == name)?;
        match element.properties[at].kind {
            Kind::List { count, item } => Some((at, count, item)),
            Kind::Scalar(_) => None,
        }
    };
    let indices = INDICES.into_iter().find_map(list).filter(|(_, _, item)| item.is_integer());
    let Some((indices, ..)) = indices else {
        let message = "`face` has no list of whole numbers called `vertex_indices`";
        let expected = "expected `property list uchar int vertex_indices`";
        return Err(Broken::new(element.line.clone(), message, expected));
    };
    let uvs = list(UVS).map(|(at, ..)| at);
    let mut faces = Faces::default();
    let mut row = Row::default();
    for _ in 0..element.count {
        row.uvs.clear();
        for (at, property) in element.properties.iter().enumerate() {
            match property.kind {
                Kind::List { count: size, item } if at == indices => {
                    let list = List { size, item, element, property, bytes };
                    row.corners(values, &list, count, faults)?;
                }
                Kind::List { count: size, item } if Some(at) == uvs => {
                    row.uvs(values, &List { size, item, element, property, bytes })?;
                }
                Kind::List { .. } | Kind::Scalar(_) => skip(values, element, property, bytes)?,
            }
        }
        let (given, corners) = (row.uvs.len(), row.corners.len());
        if let Some(property) = uvs.map(|at| &element.properties[at])
            && given != 0
            && given != 2 * corners
        {
            let message = format!("{given} texture coordinates of a face of {corners} corners");
            let expected = "expected two for each corner, or none".to_owned();
            return Err(values.place(row.uvs_at).broken(property, message, expected));
        }
        values.end_row();
        faces.corners.extend(&row.corners);
        faces.ends.push(faces.corners.len());
        if uvs.is_some() {
            let given = row.uvs.chunks_exact(2).map(|uv| DVec2::new(uv[0], uv[1]));
            let none = std::iter::repeat(DVec2::NAN);
            faces.uvs.extend(given.chain(none).take(row.corners.len()));
        }
    }
    Ok(faces)
}

/// A list that a row contains.
struct List<'f> {
    size: Number,
    item: Number,
    element: &'f Element,
    property: &'f Property,
    bytes: &'f [u8],
}

/// The lists of a face.
#[derive(Default)]
struct Row {
    corners: Vec<u32>,
    uvs: Vec<f64>,
    uvs_at: usize,
}

impl Row {
    fn corners<V: Values>(
        &mut self,
        values: &mut V,
        list: &List,
        count: u64,
        faults: &mut Faults,
    ) -> Result<(), Broken> {
        let List { size, item, element, property, bytes } = *list;
        self.corners.clear();
        let mut fault = |broken: Broken| faults.push(broken.span, broken.message, broken.expected);
        let start = values.at();
        let corners = length(values, (size, item), element, property, bytes)?;
        if corners < 3 {
            let message = format!("a face of {corners} corners");
            let expected = "expected at least 3 corners".to_owned();
            fault(values.place(start).broken(property, message, expected));
        }
        for _ in 0..corners {
            let at = values.at();
            let index = scalar(values, item, element, property, bytes)?;
            if index >= 0.0 && index < count as f64 && index.fract() == 0.0 {
                self.corners.push(index as u32);
                continue;
            }
            let message = format!("{index} is no index of a vertex");
            let expected = match count {
                0 => "expected no faces: the file has no vertices".to_owned(),
                _ => format!("expected 0 to {}", count - 1),
            };
            fault(values.place(at).broken(property, message, expected));
        }
        Ok(())
    }

    fn uvs<V: Values>(&mut self, values: &mut V, list: &List) -> Result<(), Broken> {
        let List { size, item, element, property, bytes } = *list;
        self.uvs_at = values.at();
        for _ in 0..length(values, (size, item), element, property, bytes)? {
            let at = values.at();
            let uv = scalar(values, item, element, property, bytes)?;
            if !is_usable(uv) {
                return Err(unusable(values.place(at), property, uv));
            }
            self.uvs.push(uv);
        }
        Ok(())
    }
}
