//! Noise for textures. It repeats at the texture's edges, so that tiled textures show no seams.

/// A number in 0..1 that depends only on its place and on `salt`. Each use of noise has a `salt` of its own, so that
/// two patterns do not follow each other.
pub(super) fn hash_noise(x: i32, y: i32, salt: u32) -> f32 {
    // Multiplications and shifts mix the bits, so that neighbouring places get unlike numbers.
    let mut n =
        (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77) ^ salt.wrapping_mul(0xc2b2_ae3d);
    n ^= n >> 15;
    n = n.wrapping_mul(0x2c1b_3c6d);
    n ^= n >> 12;
    n = n.wrapping_mul(0x297a_2d39);
    n ^= n >> 15;
    (n >> 8) as f32 / 16_777_216.0
}

/// Smooth noise in 0..1, with `cells` cells across and down the texture.
pub(super) fn smooth_noise(u: f32, v: f32, cells: (i32, i32), salt: u32) -> f32 {
    let (x, y) = (u * cells.0 as f32, v * cells.1 as f32);
    let (x0, y0) = (x.floor(), y.floor());
    let (fx, fy) = (ease_in_out(x - x0), ease_in_out(y - y0));
    let corner =
        |dx: i32, dy: i32| hash_noise((x0 as i32 + dx).rem_euclid(cells.0), (y0 as i32 + dy).rem_euclid(cells.1), salt);
    let top = corner(0, 0) + (corner(1, 0) - corner(0, 0)) * fx;
    let bottom = corner(0, 1) + (corner(1, 1) - corner(0, 1)) * fx;
    top + (bottom - top) * fy
}

/// Three octaves of smooth noise, in 0..1.
pub(super) fn cloudy_noise(u: f32, v: f32, cells: i32, salt: u32) -> f32 {
    let octave = |doubled: i32| smooth_noise(u, v, (cells * doubled, cells * doubled), salt + doubled as u32);
    (octave(1) * 4.0 + octave(2) * 2.0 + octave(4)) / 7.0
}

fn ease_in_out(t: f32) -> f32 {
    t * t * (3.0 - 2.0 * t)
}

/// From `a` to `b` as `t` goes from 0 to 1.
pub(super) fn mix_rgb(a: super::TextureRgb, b: super::TextureRgb, t: f32) -> super::TextureRgb {
    let t = t.clamp(0.0, 1.0);
    std::array::from_fn(|channel| a[channel] + (b[channel] - a[channel]) * t)
}

/// The grey with this value in every channel, 0..=255.
pub(super) fn grey_rgb(value: f32) -> super::TextureRgb {
    [value; 3]
}

/// Distance between the place (u, v) and `from`.
pub(super) fn distance_from(u: f32, v: f32, from: (f32, f32)) -> f32 {
    let (du, dv) = (u - from.0, v - from.1);
    (du * du + dv * dv).sqrt()
}
