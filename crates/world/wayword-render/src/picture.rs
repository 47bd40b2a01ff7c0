//! The result of drawing (colours, depths and ids), and the errors of drawing.

/// The longest side a picture may have.
pub const MAX_SIDE_PX: u32 = 8192;

/// A drawn view: colour, depth and ids, all row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderedPicture {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Gamma-encoded sRGB, three bytes per pixel; empty if the picture was drawn without colours.
    pub rgb: Vec<u8>,
    /// Distance along the camera's forward axis at the pixel's centre; `f32::INFINITY` in the background.
    pub depth_m: Vec<f32>,
    /// The id of the visible mesh; 0 in the background.
    pub ids: Vec<u32>,
}

/// Why a view cannot be drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// A side is zero or too long.
    #[error("picture of {width}x{height} pixels: each side must be from 1 to {MAX_SIDE_PX}")]
    Size {
        /// Pixels per row.
        width: u64,
        /// Rows.
        height: u64,
    },
    /// A number of the camera or the map is not usable.
    #[error("{field} is {value}: it must be {wanted}")]
    Number {
        /// The field.
        field: &'static str,
        /// Its value.
        value: f64,
        /// What it should be.
        wanted: &'static str,
    },
}

/// Refuses sides that would give no pixels, or more than memory should hold.
pub(crate) fn check_size(width: u64, height: u64) -> Result<(), RenderError> {
    let sides = 1..=u64::from(MAX_SIDE_PX);
    if sides.contains(&width) && sides.contains(&height) { Ok(()) } else { Err(RenderError::Size { width, height }) }
}

/// Refuses NaN and infinities.
pub(crate) fn check_finite(field: &'static str, value: f64) -> Result<(), RenderError> {
    if value.is_finite() { Ok(()) } else { Err(RenderError::Number { field, value, wanted: "finite" }) }
}
