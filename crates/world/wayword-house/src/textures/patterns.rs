//! Paints the patterns of materials, which repeat over a surface. `u` runs to the right and `v` down, each from 0 to 1.

use super::{
    TextureRgb,
    noise::{cloudy_noise, distance_from, grey_rgb, hash_noise, mix_rgb, smooth_noise},
};

/// Grain along v.
pub(super) fn wood_texel(u: f32, v: f32) -> TextureRgb {
    let bend = smooth_noise(u, v, (4, 2), 1) * 0.06;
    let grain = smooth_noise(u + bend, v, (48, 3), 2) * 22.0 + smooth_noise(u + bend, v, (12, 2), 3) * 20.0;
    grey_rgb(255.0 - grain)
}

/// Boards along u, twelve rows to a texture, each board with its own tone, with dark joints.
pub(super) fn planks_texel(u: f32, v: f32) -> TextureRgb {
    let row = (v * 12.0).floor();
    let shifted = u + hash_noise(0, row as i32, 5);
    let column = (shifted * 2.0).floor();
    let (across, along) = (v * 12.0 - row, shifted * 2.0 - column);
    if !(0.04..=0.96).contains(&across) || along < 0.008 {
        return grey_rgb(150.0);
    }
    let tone = hash_noise((column as i32).rem_euclid(2), row as i32, 6) * 42.0;
    let grain = smooth_noise(shifted.fract(), v, (4, 96), 7) * 24.0;
    grey_rgb(255.0 - tone - grain)
}

/// Four by four tiles of 30 cm with joints.
pub(super) fn tiles_texel(u: f32, v: f32) -> TextureRgb {
    let (x, y) = (u * 4.0, v * 4.0);
    let (fx, fy) = (x.fract(), y.fract());
    if fx < 0.025 || fy < 0.025 {
        return grey_rgb(172.0);
    }
    grey_rgb(252.0 - hash_noise(x as i32, y as i32, 9) * 14.0 - cloudy_noise(u, v, 8, 10) * 12.0)
}

pub(super) fn carpet_texel(u: f32, v: f32) -> TextureRgb {
    let fibre = hash_noise((u * 256.0) as i32, (v * 256.0) as i32, 11) * 44.0;
    grey_rgb(252.0 - fibre - cloudy_noise(u, v, 4, 12) * 20.0)
}

pub(super) fn concrete_texel(u: f32, v: f32) -> TextureRgb {
    grey_rgb(246.0 - cloudy_noise(u, v, 6, 13) * 50.0 - hash_noise((u * 256.0) as i32, (v * 256.0) as i32, 14) * 10.0)
}

pub(super) fn plaster_texel(u: f32, v: f32) -> TextureRgb {
    grey_rgb(254.0 - cloudy_noise(u, v, 10, 15) * 9.0 - hash_noise((u * 256.0) as i32, (v * 256.0) as i32, 16) * 4.0)
}

/// Threads over and under.
pub(super) fn fabric_texel(u: f32, v: f32) -> TextureRgb {
    let (x, y) = ((u * 64.0) as i32, (v * 64.0) as i32);
    let weave = if (x + y) % 2 == 0 { 0.0 } else { 16.0 };
    grey_rgb(252.0 - weave - hash_noise(x, y, 17) * 22.0)
}

pub(super) fn marble_texel(u: f32, v: f32) -> TextureRgb {
    let vein = (cloudy_noise(u, v, 4, 18) - 0.5).abs();
    let dark = (1.0 - vein * 14.0).max(0.0) * 46.0;
    grey_rgb(252.0 - dark - cloudy_noise(u, v, 8, 19) * 12.0)
}

pub(super) fn brushed_texel(u: f32, v: f32) -> TextureRgb {
    grey_rgb(250.0 - smooth_noise(u, v, (96, 2), 20) * 9.0 - smooth_noise(u, v, (2, 3), 21) * 14.0)
}

/// One leaf with its veins fills the texture.
pub(super) fn leaves_texel(u: f32, v: f32) -> TextureRgb {
    let middle = (u - 0.5).abs();
    let vein = ((v * 9.0 + middle * 6.0).fract() - 0.5).abs();
    let base = mix_rgb([48.0, 112.0, 52.0], [104.0, 168.0, 76.0], smooth_noise(u, v, (6, 6), 22));
    if middle < 0.03 || vein < 0.05 { mix_rgb(base, [180.0, 206.0, 130.0], 0.5) } else { base }
}

pub(super) fn brick_texel(u: f32, v: f32) -> TextureRgb {
    let row = (v * 12.0).floor();
    let x = u * 4.0 + if row as i32 % 2 == 0 { 0.0 } else { 0.5 };
    if v * 12.0 - row < 0.14 || x.fract() < 0.05 {
        return [206.0, 198.0, 188.0];
    }
    let tone = hash_noise((x.floor() as i32).rem_euclid(4), row as i32, 23);
    mix_rgb([150.0, 66.0, 50.0], [188.0, 96.0, 70.0], tone * 0.7 + cloudy_noise(u, v, 16, 24) * 0.3)
}

/// A rug: borders, and a medallion in the middle.
pub(super) fn ornament_texel(u: f32, v: f32) -> TextureRgb {
    let edge = u.min(1.0 - u).min(v.min(1.0 - v));
    let thread = hash_noise((u * 128.0) as i32, (v * 128.0) as i32, 25) * 18.0;
    let lozenge = (u - 0.5).abs() + (v - 0.5).abs();
    let tone = if edge < 0.025 || (0.07..0.085).contains(&edge) {
        250.0
    } else if edge < 0.07 {
        if ((u + v) * 24.0).fract() < 0.5 { 150.0 } else { 205.0 }
    } else if lozenge < 0.1 || (0.17..0.2).contains(&lozenge) || (0.3..0.315).contains(&lozenge) {
        252.0
    } else if lozenge < 0.3 {
        175.0
    } else if (u * 10.0).fract() < 0.22 && (v * 10.0).fract() < 0.22 {
        246.0
    } else {
        214.0
    };
    grey_rgb(tone - thread)
}

pub(super) fn wicker_texel(u: f32, v: f32) -> TextureRgb {
    let row = (v * 12.0).floor();
    let x = u * 12.0 + if row as i32 % 2 == 0 { 0.0 } else { 0.5 };
    let (fx, fy) = ((x.fract() - 0.5).abs(), (v * 12.0 - row - 0.5).abs());
    grey_rgb(252.0 - (fx * fx + fy * fy) * 190.0)
}

/// Rings of a hot plate.
pub(super) fn coils_texel(u: f32, v: f32) -> TextureRgb {
    let ring = (distance_from(u, v, (0.5, 0.5)) * 16.0).fract();
    if ring < 0.5 { [70.0, 68.0, 70.0] } else { [26.0, 25.0, 27.0] }
}
