//! Paints four pictures for walls in addition to those of `paintings.rs`: flat shapes, a plant, a skyline, a still life.

use super::{
    TextureRgb,
    noise::{distance_from, hash_noise, mix_rgb, smooth_noise},
};

/// Teal: overlapping discs.
pub(super) fn discs_texel(u: f32, v: f32) -> TextureRgb {
    let discs = [
        (0.36, 0.38, 0.25, [38.0, 110.0, 112.0]),
        (0.62, 0.56, 0.22, [226.0, 146.0, 84.0]),
        (0.38, 0.72, 0.14, [240.0, 214.0, 150.0]),
    ];
    let within = discs.iter().rev().find(|(x, y, r, _)| distance_from(u, v, (*x, *y)) < *r);
    within.map_or([178.0, 214.0, 206.0], |(.., colour)| *colour)
}

/// White: one green branch on paper.
pub(super) fn branch_texel(u: f32, v: f32) -> TextureRgb {
    let stem = 0.5 + 0.05 * (smooth_noise(v, 0.0, (4, 1), 81) - 0.5);
    if (u - stem).abs() < 0.008 && (0.12..0.9).contains(&v) {
        return [92.0, 112.0, 70.0];
    }
    for leaf in 0..12 {
        let (side, height) = (if leaf % 2 == 0 { 1.0 } else { -1.0 }, 0.16 + 0.058 * leaf as f32);
        // A leaf is where two discs overlap.
        let (x, y) = (stem + side * 0.12, height);
        if distance_from(u, v, (x, y - 0.06)) < 0.1 && distance_from(u, v, (x + side * 0.03, y + 0.07)) < 0.1 {
            return mix_rgb([70.0, 124.0, 76.0], [128.0, 168.0, 112.0], hash_noise(leaf, 3, 82));
        }
    }
    [244.0, 241.0, 232.0]
}

/// Black: a city at night.
pub(super) fn skyline_texel(u: f32, v: f32) -> TextureRgb {
    let column = (u * 14.0).floor() as i32;
    let roof = 0.34 + 0.4 * hash_noise(column, 0, 83);
    if v < roof {
        let moon = distance_from(u, v, (0.74, 0.16)) < 0.075;
        return if moon { [246.0, 240.0, 214.0] } else { mix_rgb([20.0, 22.0, 40.0], [58.0, 60.0, 92.0], v) };
    }
    let (x, y) = ((u * 14.0).fract(), (v * 26.0).fract());
    let is_lit = hash_noise((u * 42.0) as i32, (v * 26.0) as i32, 84) > 0.62;
    let is_pane = (0.12..0.88).contains(&x) && (0.25..0.75).contains(&y);
    if is_lit && is_pane {
        [250.0, 216.0, 120.0]
    } else {
        mix_rgb([26.0, 26.0, 32.0], [50.0, 50.0, 58.0], hash_noise(column, 1, 85))
    }
}

/// Pink: a jug with tulips on a table.
pub(super) fn still_life_texel(u: f32, v: f32) -> TextureRgb {
    for flower in 0..6 {
        let at = (0.28 + 0.088 * flower as f32, 0.22 + 0.12 * hash_noise(flower, 0, 86));
        if distance_from(u, v * 0.8, (at.0, at.1 * 0.8)) < 0.055 {
            return mix_rgb([212.0, 60.0, 92.0], [240.0, 130.0, 130.0], hash_noise(flower, 1, 86));
        }
        let lean = at.0 + (0.5 - at.0) * ((v - at.1) / (0.52 - at.1)).clamp(0.0, 1.0);
        if (u - lean).abs() < 0.009 && (at.1..0.54).contains(&v) {
            return [88.0, 136.0, 78.0];
        }
    }
    let half = 0.1 + 0.07 * (1.0 - ((v - 0.68) * 5.0).abs()).max(0.0);
    if (0.5..0.84).contains(&v) && (u - 0.5).abs() < half {
        return mix_rgb([86.0, 130.0, 180.0], [150.0, 186.0, 216.0], (u - 0.5 + half) / (2.0 * half));
    }
    if v > 0.76 { [150.0, 104.0, 70.0] } else { mix_rgb([240.0, 204.0, 204.0], [226.0, 168.0, 176.0], v) }
}
