//! Paints the views out of windows. Each picture repeats sideways, because every window of a side shows its own part.
//!
//! The horizon is at eye level. From upstairs the ground and all things on it lie lower.
//!
//! The last argument of each noise is its own number, so that no two things share a pattern; the one before it is how many
//! cells the noise has.

use super::{
    super::outlook::WindowOutlook,
    TextureRgb,
    noise::{cloudy_noise, distance_from, hash_noise, mix_rgb, smooth_noise},
};

/// The horizon, as a share of the picture's height from the top.
const HORIZON_SHARE: f32 = 0.43;

/// The colour at a place of the view: `u` runs to the right and `v` down, each from 0 to 1 over the picture.
pub(super) fn outlook_texel(outlook: WindowOutlook, from_upstairs: bool, u: f32, v: f32) -> TextureRgb {
    // How much lower near things lie.
    let drop = if from_upstairs { 0.2 } else { 0.0 };
    match outlook {
        WindowOutlook::Street => street_texel(u, v, drop),
        WindowOutlook::Garden => garden_texel(u, v, drop),
        WindowOutlook::Yard => yard_texel(u, v, drop),
        WindowOutlook::Woods => woods_texel(u, v, drop),
        WindowOutlook::Hills => hills_texel(u, v, drop),
        WindowOutlook::Sea => sea_texel(u, v, drop),
        WindowOutlook::Meadow => meadow_texel(u, v, drop),
    }
}

fn sky_texel(u: f32, v: f32) -> TextureRgb {
    let cloud = ((cloudy_noise(u, v, 3, 32) - 0.5) * 4.0).clamp(0.0, 1.0);
    mix_rgb(mix_rgb([120.0, 176.0, 232.0], [212.0, 231.0, 246.0], v * 2.0), [255.0; 3], cloud * 0.9)
}

/// How far a place lies to the right of `from`, the short way around the repeating picture.
fn offset_around(u: f32, from: f32) -> f32 {
    (u - from + 0.5).rem_euclid(1.0) - 0.5
}

fn grass_texel(u: f32, v: f32, top: f32) -> TextureRgb {
    mix_rgb([140.0, 182.0, 88.0], [84.0, 136.0, 60.0], (v - top) * 2.0 + smooth_noise(u, v, (48, 32), 35) * 0.3)
}

/// A tree; `(x, y)` is the middle of its crown, and the trunk reaches down to `foot`. `None` outside the tree.
fn tree_texel(u: f32, v: f32, (x, y): (f32, f32), radius: f32, foot: f32) -> Option<TextureRgb> {
    let du = offset_around(u, x);
    let ragged = radius * (0.78 + 0.44 * smooth_noise(u, v, (28, 28), 33));
    if distance_from(du, v, (0.0, y)) < ragged {
        let lit = smooth_noise(u, v, (24, 24), 34) - (v - y) * 1.6;
        return Some(mix_rgb([44.0, 92.0, 44.0], [124.0, 168.0, 78.0], lit));
    }
    (du.abs() < radius * 0.1 && v > y && v < foot).then_some([92.0, 68.0, 48.0])
}

fn garden_texel(u: f32, v: f32, drop: f32) -> TextureRgb {
    let lawn = 0.6 + drop;
    let trees = [(0.2, 0.3, 0.21, 0.72), (0.68, 0.26, 0.17, 0.66), (0.9, 0.48, 0.1, 0.68)];
    if let Some(colour) =
        trees.into_iter().find_map(|(x, y, radius, foot)| tree_texel(u, v, (x, y + drop), radius, foot + drop))
    {
        return colour;
    }
    if v > lawn {
        let (x, y) = ((u * 40.0) as i32, (v * 40.0) as i32);
        let bed = v > 0.84 && hash_noise(x, y, 50) < 0.22;
        return if bed {
            [[226.0, 84.0, 96.0], [240.0, 208.0, 90.0]][(x & 1) as usize]
        } else {
            grass_texel(u, v, lawn)
        };
    }
    let hedge = v > lawn - 0.12 + smooth_noise(u, 0.0, (24, 1), 36) * 0.03;
    if hedge {
        mix_rgb([52.0, 96.0, 48.0], [92.0, 140.0, 70.0], smooth_noise(u, v, (32, 32), 37))
    } else {
        sky_texel(u, v)
    }
}

/// Two houses to a picture, a pavement, a road, and a car at the kerb.
fn street_texel(u: f32, v: f32, drop: f32) -> TextureRgb {
    let ground = 0.6 + drop;
    if let Some(colour) = parked_car_texel(offset_around(u, 0.62), v - ground) {
        return colour;
    }
    if v > ground + 0.3 {
        return grass_texel(u, v, ground + 0.3);
    }
    if v > ground + 0.07 {
        let line = (0.17..0.19).contains(&(v - ground)) && (u * 4.0).fract() < 0.5;
        return if line { [226.0; 3] } else { [104.0 + 14.0 * smooth_noise(u, v, (64, 64), 51); 3] };
    }
    if v > ground {
        return [178.0 + 12.0 * smooth_noise(u, v, (32, 32), 52); 3];
    }
    let which = (u * 2.0) as i32;
    opposite_house_texel(which, (u * 2.0).fract(), v - drop).unwrap_or_else(|| sky_texel(u, v))
}

/// A house across the street, one of two by `which`: `x` runs over its plot, and the ground lies at 0.6. `None` beside it.
fn opposite_house_texel(which: i32, x: f32, v: f32) -> Option<TextureRgb> {
    let walls = [[206.0, 186.0, 150.0], [164.0, 92.0, 72.0]][(which & 1) as usize];
    let roof = [[122.0, 66.0, 52.0], [78.0, 80.0, 90.0]][(which & 1) as usize];
    let middle = (x - 0.46).abs();
    if v < 0.24 {
        return (v > 0.04 && middle < 0.18 + (v - 0.04) * 1.2)
            .then(|| mix_rgb(roof, [0.0; 3], (v * 60.0).fract() * 0.15));
    }
    if middle > 0.38 {
        // A bush between the plots.
        return (v > 0.46 && hash_noise((x * 64.0) as i32, (v * 64.0) as i32, 53) < 0.9).then_some([70.0, 116.0, 62.0]);
    }
    let pane = |from: f32, to: f32, top: f32, low: f32| (from..to).contains(&x) && (top..low).contains(&v);
    if pane(0.18, 0.34, 0.3, 0.46) || pane(0.62, 0.78, 0.3, 0.46) {
        let bar = ((x - 0.18) * 12.5).fract() < 0.12 || (0.37..0.385).contains(&v);
        return Some(if bar { [240.0; 3] } else { [86.0, 108.0, 130.0] });
    }
    if pane(0.42, 0.54, 0.36, 0.6) {
        return Some([[54.0, 88.0, 70.0], [190.0, 60.0, 50.0]][(which & 1) as usize]);
    }
    Some(mix_rgb(walls, [0.0; 3], (v * 40.0).fract() * 0.1))
}

/// The parked car: `du` is measured from its middle, `dv` down from the edge of the pavement. `None` beside the car.
fn parked_car_texel(du: f32, dv: f32) -> Option<TextureRgb> {
    let wheel = |x: f32| distance_from(du, dv, (x, 0.1));
    let near = wheel(-0.13).min(wheel(0.13));
    if near < 0.045 {
        return Some(if near < 0.02 { [170.0; 3] } else { [32.0; 3] });
    }
    if (0.0..0.1).contains(&dv) && du.abs() < 0.22 {
        return Some(mix_rgb([60.0, 104.0, 176.0], [34.0, 62.0, 118.0], dv * 9.0));
    }
    let cabin = (-0.075..0.0).contains(&dv) && du.abs() < 0.15 + dv * 0.6;
    cabin.then(|| if du.abs() < 0.008 || dv < -0.062 { [60.0, 104.0, 176.0] } else { [56.0, 70.0, 84.0] })
}

/// A shed with a door and a roof before a wooden fence, and a tree behind it.
fn yard_texel(u: f32, v: f32, drop: f32) -> TextureRgb {
    let (lawn, x) = (0.64 + drop, offset_around(u, 0.34));
    if x.abs() < 0.17 && (0.3 + drop..0.72 + drop).contains(&v) {
        let door = (x - 0.02).abs() < 0.06 && v > 0.46 + drop;
        let board = if ((x + 0.5) * 24.0).fract() < 0.1 { 0.25 } else { 0.0 };
        let paint = if door { [236.0, 232.0, 220.0] } else { [120.0, 142.0, 150.0] };
        return mix_rgb(paint, [0.0; 3], board);
    }
    let roof = v > 0.2 + drop && v < 0.3 + drop && x.abs() < 0.06 + (v - 0.2 - drop) * 1.5;
    if roof {
        return [104.0, 62.0, 52.0];
    }
    if v > lawn {
        return grass_texel(u, v, lawn);
    }
    if v > 0.4 + drop {
        let board = (u * 20.0).floor();
        if (u * 20.0).fract() < 0.08 || (0.45..0.46).contains(&(v - drop)) {
            return [98.0, 72.0, 48.0];
        }
        return mix_rgb([176.0, 134.0, 90.0], [146.0, 106.0, 70.0], hash_noise(board as i32, 0, 54));
    }
    tree_texel(u, v, (0.8, 0.22 + drop), 0.19, 0.5 + drop).unwrap_or_else(|| sky_texel(u, v))
}

fn woods_texel(u: f32, v: f32, drop: f32) -> TextureRgb {
    let floor = 0.66 + drop;
    let trunk = (0..9).find_map(|each| {
        let near = hash_noise(each, 1, 55);
        let du = offset_around(u, (each as f32 + 0.6 * hash_noise(each, 0, 55)) / 9.0).abs();
        let is_on = du < 0.012 + 0.022 * near && v < floor + 0.12 * near;
        is_on.then(|| {
            mix_rgb([62.0, 46.0, 36.0], [132.0, 104.0, 78.0], 0.3 + 0.4 * smooth_noise(u, v, (96, 6), 56) - du * 8.0)
        })
    });
    if let Some(colour) = trunk {
        return colour;
    }
    if v > floor {
        return mix_rgb([96.0, 84.0, 48.0], [74.0, 116.0, 54.0], cloudy_noise(u, v, 12, 57));
    }
    let gap = smooth_noise(u, v, (20, 14), 58);
    let leaves = mix_rgb([34.0, 74.0, 40.0], [104.0, 150.0, 66.0], cloudy_noise(u, v, 14, 59));
    if gap > 0.84 && v < 0.5 {
        mix_rgb(sky_texel(u, v), leaves, 0.3)
    } else {
        mix_rgb(leaves, [18.0, 34.0, 22.0], (v - 0.3) * 0.8)
    }
}

fn hills_texel(u: f32, v: f32, drop: f32) -> TextureRgb {
    let ridge = |height: f32, swell: f32, cells: i32| {
        height + swell * (smooth_noise(u, 0.0, (cells, 1), 70 + cells as u32) - 0.5)
    };
    if v > ridge(0.72 + drop, 0.14, 3) {
        return mix_rgb(
            [126.0, 170.0, 76.0],
            [78.0, 124.0, 56.0],
            (v - 0.66 - drop) * 2.0 + smooth_noise(u, v, (40, 20), 43) * 0.2,
        );
    }
    if v > ridge(0.52 + drop * 0.4, 0.16, 4) {
        let field = ((u * 9.0 + v * 4.0) as i32, (v * 16.0 + u * 3.0) as i32);
        let tones = [[176.0, 186.0, 96.0], [118.0, 158.0, 84.0], [206.0, 190.0, 112.0], [98.0, 142.0, 84.0]];
        return tones[(hash_noise(field.0 % 9, field.1, 44) * 4.0) as usize % 4];
    }
    if v > ridge(HORIZON_SHARE - 0.06, 0.2, 5) {
        return mix_rgb([128.0, 158.0, 160.0], [146.0, 174.0, 150.0], (v - 0.3) * 4.0);
    }
    sky_texel(u, v)
}

fn sea_texel(u: f32, v: f32, drop: f32) -> TextureRgb {
    let x = offset_around(u, 0.58);
    // The gap in it is the mast.
    let sail = (HORIZON_SHARE - 0.16..HORIZON_SHARE - 0.01).contains(&v)
        && x.abs() < (v - HORIZON_SHARE + 0.17) * 0.5
        && (x + 0.01).abs() > 0.006;
    if sail {
        return [250.0, 248.0, 240.0];
    }
    // The boat's hull.
    if (HORIZON_SHARE..HORIZON_SHARE + 0.03).contains(&v) && x.abs() < 0.08 - (v - HORIZON_SHARE) {
        return [150.0, 60.0, 48.0];
    }
    if v < HORIZON_SHARE {
        return sky_texel(u, v);
    }
    let shore = 0.74 - drop * 0.2 + 0.04 * smooth_noise(u, 0.0, (5, 1), 45);
    if v < shore - 0.02 {
        let wave = smooth_noise(u, v, (10, 64), 46);
        return mix_rgb(
            mix_rgb([52.0, 112.0, 168.0], [92.0, 166.0, 190.0], (v - HORIZON_SHARE) * 3.0),
            [236.0; 3],
            (wave - 0.7) * 1.4,
        );
    }
    if v < shore {
        [244.0, 248.0, 248.0]
    } else {
        mix_rgb([228.0, 208.0, 160.0], [206.0, 182.0, 132.0], cloudy_noise(u, v, 16, 47))
    }
}

fn meadow_texel(u: f32, v: f32, drop: f32) -> TextureRgb {
    let near = 0.5 + drop * 0.5;
    if let Some(colour) = tree_texel(u, v, (0.3, 0.34 + drop * 0.7), 0.15, 0.6 + drop * 0.7) {
        return colour;
    }
    if v > near {
        let (x, y) = ((u * 90.0) as i32, (v * 90.0) as i32);
        let bloom = hash_noise(x, y, 48);
        if bloom < 0.10 * (v - near) * 4.0 {
            let tones = [[232.0, 70.0, 58.0], [250.0, 220.0, 80.0], [238.0, 238.0, 250.0], [140.0, 110.0, 200.0]];
            return tones[(hash_noise(x, y, 49) * 4.0) as usize % 4];
        }
        return mix_rgb(
            [176.0, 196.0, 104.0],
            [112.0, 152.0, 66.0],
            (v - near) * 1.6 + smooth_noise(u, v, (64, 12), 42) * 0.3,
        );
    }
    let edge = v > near - 0.07 + 0.05 * smooth_noise(u, 0.0, (14, 1), 39);
    if edge {
        mix_rgb([72.0, 112.0, 78.0], [98.0, 136.0, 88.0], smooth_noise(u, v, (30, 30), 38))
    } else {
        sky_texel(u, v)
    }
}
