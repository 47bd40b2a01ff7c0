//! Paints the paintings, each with its own main colour. `u` runs to the right and `v` down, each from 0 to 1.

use super::{
    TextureRgb,
    noise::{cloudy_noise, distance_from, hash_noise, mix_rgb, smooth_noise},
    prints,
};

/// The painting with this number.
pub(super) fn painting_texel(which: u8, u: f32, v: f32) -> TextureRgb {
    let canvas = (hash_noise((u * 128.0) as i32, (v * 128.0) as i32, 60) - 0.5) * 6.0;
    let colour = match which {
        0 => seascape_texel(u, v),
        1 => sunset_texel(u, v),
        2 => meadow_painting_texel(u, v),
        3 => poppies_texel(u, v),
        4 => wheat_texel(u, v),
        5 => dusk_texel(u, v),
        6 => prints::discs_texel(u, v),
        7 => prints::branch_texel(u, v),
        8 => prints::skyline_texel(u, v),
        _ => prints::still_life_texel(u, v),
    };
    colour.map(|channel| channel + canvas)
}

/// Blue: a sailing boat on the sea.
fn seascape_texel(u: f32, v: f32) -> TextureRgb {
    let sail = (0.3..0.56).contains(&v) && (u - 0.56).abs() < (v - 0.3) * 0.42 && (u - 0.54).abs() > 0.008;
    if sail {
        return [246.0, 242.0, 230.0];
    }
    if (0.57..0.62).contains(&v) && (u - 0.55).abs() < 0.14 - (v - 0.57) {
        return [120.0, 60.0, 40.0];
    }
    if v < 0.55 {
        return mix_rgb([96.0, 150.0, 214.0], [214.0, 230.0, 240.0], v * 1.6 + (cloudy_noise(u, v, 4, 61) - 0.5));
    }
    mix_rgb([40.0, 96.0, 160.0], [110.0, 170.0, 206.0], smooth_noise(u, v, (6, 40), 62))
}

/// Orange: the sun over mountains.
fn sunset_texel(u: f32, v: f32) -> TextureRgb {
    let ridge = 0.62 + 0.16 * (smooth_noise(u, 0.0, (5, 1), 63) - 0.5) * 2.0;
    if v > ridge {
        return mix_rgb([74.0, 44.0, 66.0], [30.0, 20.0, 34.0], (v - ridge) * 3.0);
    }
    if distance_from(u, v, (0.62, 0.44)) < 0.11 {
        return [255.0, 236.0, 170.0];
    }
    mix_rgb([222.0, 92.0, 40.0], [250.0, 176.0, 80.0], v * 1.4)
}

/// Green: hills with trees.
fn meadow_painting_texel(u: f32, v: f32) -> TextureRgb {
    let trees = [(0.25, 0.5, 0.13), (0.68, 0.46, 0.16)];
    if trees.iter().any(|(x, y, r)| distance_from(u, v, (*x, *y)) < r * (0.8 + 0.4 * smooth_noise(u, v, (24, 24), 64)))
    {
        return mix_rgb([34.0, 84.0, 42.0], [90.0, 142.0, 60.0], smooth_noise(u, v, (20, 20), 65));
    }
    if trees.iter().any(|(x, y, _)| (u - x).abs() < 0.015 && v > *y && v < 0.72) {
        return [84.0, 60.0, 40.0];
    }
    let hill = 0.56 + 0.08 * (smooth_noise(u, 0.0, (3, 1), 66) - 0.5);
    if v > hill { mix_rgb([120.0, 168.0, 70.0], [60.0, 112.0, 50.0], (v - hill) * 2.2) } else { [196.0, 220.0, 214.0] }
}

/// Red: flowers in a field.
fn poppies_texel(u: f32, v: f32) -> TextureRgb {
    for flower in 0..22 {
        let at = (hash_noise(flower, 0, 67), 0.18 + 0.74 * hash_noise(flower, 1, 67));
        let radius = 0.03 + 0.05 * at.1;
        let distance = distance_from(u, v, at);
        if distance < radius * 0.28 {
            return [36.0, 24.0, 28.0];
        }
        if distance < radius {
            return mix_rgb([214.0, 44.0, 36.0], [168.0, 24.0, 30.0], distance / radius);
        }
    }
    mix_rgb([222.0, 120.0, 96.0], [150.0, 74.0, 58.0], v + (smooth_noise(u, v, (30, 8), 68) - 0.5) * 0.4)
}

/// Yellow: a field of wheat under a bright sky.
fn wheat_texel(u: f32, v: f32) -> TextureRgb {
    if v < 0.42 {
        return mix_rgb([240.0, 214.0, 120.0], [250.0, 238.0, 190.0], v * 2.0);
    }
    mix_rgb([230.0, 184.0, 62.0], [180.0, 130.0, 40.0], smooth_noise(u, v, (60, 5), 69) * 0.8)
}

/// Purple: mountains one behind the other.
fn dusk_texel(u: f32, v: f32) -> TextureRgb {
    let layers = [(0.78, 5, [58.0, 38.0, 86.0]), (0.62, 4, [96.0, 66.0, 130.0]), (0.46, 3, [142.0, 108.0, 170.0])];
    let ridge = |height: f32, cells: i32| height + 0.2 * (smooth_noise(u, 0.0, (cells, 1), 70 + cells as u32) - 0.5);
    let near = layers.iter().find(|(height, cells, _)| v > ridge(*height, *cells));
    near.map_or_else(|| mix_rgb([186.0, 150.0, 204.0], [240.0, 200.0, 196.0], v * 2.0), |(_, _, colour)| *colour)
}
