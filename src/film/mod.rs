//! Pictures: files, tone mapping and measures.

/// Linear Rec. 709 radiance, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `width * height` pixels, row by row, in W sr^-1 m^-2.
    pub rgb: Vec<[f32; 3]>,
}
