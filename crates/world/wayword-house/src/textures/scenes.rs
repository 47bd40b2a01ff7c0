//! Paints pictures of things: books, glass, fire, screens. `u` runs to the right and `v` down, each from 0 to 1.

use super::{
    TextureRgb,
    noise::{cloudy_noise, hash_noise, mix_rgb, smooth_noise},
};

const SPINE_COLOURS: [TextureRgb; 9] = [
    [158.0, 44.0, 40.0],
    [38.0, 70.0, 122.0],
    [46.0, 100.0, 66.0],
    [214.0, 182.0, 92.0],
    [232.0, 226.0, 210.0],
    [92.0, 60.0, 98.0],
    [54.0, 52.0, 56.0],
    [196.0, 112.0, 52.0],
    [110.0, 150.0, 168.0],
];

/// Spines of books of different height and colour, side by side.
pub(super) fn books_texel(u: f32, v: f32) -> TextureRgb {
    let x = u * 26.0;
    let (book, across) = (x.floor() as i32, x.fract());
    let top = hash_noise(book, 0, 30) * 0.24;
    if v < top {
        return [44.0, 36.0, 30.0];
    }
    let spine = SPINE_COLOURS[(hash_noise(book, 1, 31) * 9.0) as usize % 9];
    if !(0.06..=0.94).contains(&across) {
        return mix_rgb(spine, [0.0; 3], 0.5);
    }
    let band = v - top;
    if (0.1..0.14).contains(&band) || (0.52..0.56).contains(&band) {
        return mix_rgb(spine, [240.0, 220.0, 160.0], 0.7);
    }
    mix_rgb(spine, [255.0; 3], 0.12 - (across - 0.5).abs() * 0.3)
}

/// The sheen of glass: pale bluish, with two slanting streaks.
pub(super) fn reflection_texel(u: f32, v: f32) -> TextureRgb {
    let base = mix_rgb([226.0, 238.0, 244.0], [150.0, 172.0, 186.0], (u * 0.3 + v * 0.7).clamp(0.0, 1.0));
    let slant = u + v * 0.8;
    let streak = (0.5..0.64).contains(&slant) || (0.7..0.74).contains(&slant);
    if streak { mix_rgb(base, [255.0; 3], 0.55) } else { base }
}

pub(super) fn fire_texel(u: f32, v: f32) -> TextureRgb {
    let flicker = smooth_noise(u, v, (9, 3), 38) * 0.6 + smooth_noise(u, v, (18, 6), 39) * 0.3;
    let height = 1.0 - v;
    let reach = (1.0 - (u - 0.5).abs() * 2.0) * 0.75 + flicker * 0.5 - height;
    if reach < 0.06 {
        return [30.0, 22.0, 18.0];
    }
    mix_rgb([222.0, 70.0, 20.0], [255.0, 226.0, 110.0], reach * 1.6)
}

/// A screen with a task bar, and a window with lines of text.
pub(super) fn desktop_texel(u: f32, v: f32) -> TextureRgb {
    if v > 0.93 {
        return if (u * 30.0).fract() < 0.4 && u < 0.3 { [230.0, 230.0, 235.0] } else { [34.0, 40.0, 56.0] };
    }
    if (0.12..0.62).contains(&u) && (0.12..0.82).contains(&v) {
        if v < 0.18 {
            return [64.0, 110.0, 186.0];
        }
        let line = ((v - 0.22) * 18.0).fract() < 0.35
            && (0.16..0.34 + 0.24 * hash_noise(0, (v * 18.0) as i32, 40)).contains(&u);
        return if line { [96.0, 100.0, 108.0] } else { [248.0, 249.0, 250.0] };
    }
    mix_rgb([44.0, 110.0, 170.0], [120.0, 190.0, 214.0], u * 0.5 + v * 0.5)
}

/// Twelve marks and two hands at ten past ten.
pub(super) fn dial_texel(u: f32, v: f32) -> TextureRgb {
    let (x, y) = (u - 0.5, 0.5 - v);
    let radius = (x * x + y * y).sqrt();
    let dark = [30.0, 30.0, 34.0];
    let hand = |dx: f32, dy: f32, length: f32| {
        let along = x * dx + y * dy;
        (0.0..length).contains(&along) && (x * dy - y * dx).abs() < 0.018
    };
    let mark = (0..12).any(|hour| {
        let angle = std::f32::consts::TAU * hour as f32 / 12.0;
        let (dx, dy) = (libm::sinf(angle), libm::cosf(angle));
        (0.38..0.45).contains(&(x * dx + y * dy)) && (x * dy - y * dx).abs() < 0.015
    });
    if mark || radius < 0.03 || hand(-0.866, 0.5, 0.22) || hand(0.866, 0.5, 0.33) {
        return dark;
    }
    if radius > 0.47 { [190.0, 190.0, 192.0] } else { [250.0, 250.0, 247.0] }
}

/// Land and sea.
pub(super) fn map_texel(u: f32, v: f32) -> TextureRgb {
    let land = cloudy_noise(u, v, 5, 41);
    if land > 0.55 {
        mix_rgb([110.0, 150.0, 80.0], [200.0, 178.0, 110.0], (land - 0.55) * 6.0)
    } else {
        [58.0, 112.0, 178.0]
    }
}
