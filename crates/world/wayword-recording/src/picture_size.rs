//! Limits for the size of a camera's picture: a file that claims a larger one is broken or malicious.

/// Longest side that a picture may have, pixels.
const MAX_SIDE_PX: u32 = 12_288;
/// Most pixels that a picture may have.
pub(crate) const MAX_PIXELS: u32 = 64_000_000;

/// Whether a camera's picture can have this size.
pub(crate) fn is_possible(width_px: u32, height_px: u32) -> bool {
    width_px.max(height_px) <= MAX_SIDE_PX && width_px.saturating_mul(height_px) <= MAX_PIXELS
}
