//! Lists of numbers, and values that are not used.

use super::header::{Broken, Element, Kind, Number, Property};
use super::values::{Values, scalar};

/// Reads the length of a list, or reports one that is negative, has a fraction or exceeds the file.
pub(super) fn length<V: Values>(
    values: &mut V,
    (count, item): (Number, Number),
    element: &Element,
    property: &Property,
    bytes: &[u8],
) -> Result<usize, Broken> {
    let at = values.at();
    let length = scalar(values, count, element, property, bytes)?;
    if length < 0.0 || length.fract() != 0.0 || !length.is_finite() {
        let message = format!("a list of {length} numbers");
        let expected = format!("expected the length of `{}`", property.name);
        return Err(values.place(at).broken(property, message, expected));
    }
    // Text takes two bytes for each number but the last.
    let size = values.item_size(item) as f64;
    if length * size > values.left() as f64 + 1.0 {
        let message = format!("a list of {length} numbers, more than the file has");
        let expected = format!("expected the length of `{}`", property.name);
        return Err(values.place(at).broken(property, message, expected));
    }
    Ok(length as usize)
}

/// Reads a value and drops it.
pub(super) fn skip<V: Values>(
    values: &mut V,
    element: &Element,
    property: &Property,
    bytes: &[u8],
) -> Result<(), Broken> {
    match property.kind {
        Kind::Scalar(number) => drop(scalar(values, number, element, property, bytes)?),
        Kind::List { count, item } => {
            for _ in 0..length(values, (count, item), element, property, bytes)? {
                scalar(values, item, element, property, bytes)?;
            }
        }
    }
    Ok(())
}

/// Reads the rows of an element that is not used.
pub(super) fn skip_rows<V: Values>(
    values: &mut V,
    element: &Element,
    bytes: &[u8],
) -> Result<(), Broken> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            skip(values, element, property, bytes)?;
        }
        values.end_row();
    }
    Ok(())
}
