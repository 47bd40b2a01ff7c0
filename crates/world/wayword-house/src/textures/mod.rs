//! Computes the textures of surfaces. No picture is read from a file.
//!
//! If the surface provides the colour, the texture is light grey, because the two are multiplied and a texture can only
//! darken.

mod noise;
mod outside;
mod paintings;
mod patterns;
mod prints;
mod scenes;

use super::surface::Pattern;
use std::sync::OnceLock;
use wayword_render::Texture;

/// Side of a texture, texels.
pub(super) const SIDE: u32 = 256;

/// Gamma-encoded colour, 0..=255 per channel.
pub(super) type Rgb = [f32; 3];

/// The texture of a pattern; painted once, since it is the same in every house.
pub(super) fn of(pattern: Pattern) -> Texture {
    static PAINTED: [OnceLock<Texture>; Pattern::ALL.len()] = [const { OnceLock::new() }; Pattern::ALL.len()];
    let painted = Pattern::ALL.iter().position(|each| *each == pattern).and_then(|at| PAINTED.get(at));
    painted.map_or_else(|| paint(pattern), |cell| cell.get_or_init(|| paint(pattern)).clone())
}

fn paint(pattern: Pattern) -> Texture {
    let texel = |index: u32| {
        let (x, y) = (index % SIDE, index / SIDE);
        let (u, v) = ((x as f32 + 0.5) / SIDE as f32, (y as f32 + 0.5) / SIDE as f32);
        let [r, g, b] = colour(pattern, u, v).map(|channel| channel.clamp(0.0, 255.0) as u8);
        [r, g, b, 255]
    };
    Texture { width: SIDE, height: SIDE, texels: (0..SIDE * SIDE).map(texel).collect() }
}

/// The colour at a place, both coordinates in 0..1, v downwards.
fn colour(pattern: Pattern, u: f32, v: f32) -> Rgb {
    match pattern {
        Pattern::Plain => [255.0; 3],
        Pattern::Wood => patterns::wood(u, v),
        Pattern::Planks => patterns::planks(u, v),
        Pattern::Tiles => patterns::tiles(u, v),
        Pattern::Carpet => patterns::carpet(u, v),
        Pattern::Concrete => patterns::concrete(u, v),
        Pattern::Plaster => patterns::plaster(u, v),
        Pattern::Fabric => patterns::fabric(u, v),
        Pattern::Marble => patterns::marble(u, v),
        Pattern::Brushed => patterns::brushed(u, v),
        Pattern::Leaves => patterns::leaves(u, v),
        Pattern::Brick => patterns::brick(u, v),
        Pattern::Ornament => patterns::ornament(u, v),
        Pattern::Wicker => patterns::wicker(u, v),
        Pattern::Coils => patterns::coils(u, v),
        Pattern::Books => scenes::books(u, v),
        Pattern::Outside(outlook) => outside::outside(outlook, false, u, v),
        Pattern::FromAbove(outlook) => outside::outside(outlook, true, u, v),
        Pattern::Reflection => scenes::reflection(u, v),
        Pattern::Fire => scenes::fire(u, v),
        Pattern::Desktop => scenes::desktop(u, v),
        Pattern::Dial => scenes::dial(u, v),
        Pattern::Map => scenes::map(u, v),
        Pattern::Art(which) => paintings::painting(which, u, v),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_texture_but_the_plain_one_shows_a_pattern() {
        for pattern in Pattern::ALL {
            let texture = of(pattern);
            let differs = texture.texels.iter().any(|texel| *texel != texture.texels[0]);
            assert_eq!(differs, pattern != Pattern::Plain, "{pattern:?}");
        }
    }

    #[test]
    fn patterns_that_take_their_colour_from_the_surface_are_light_and_grey() {
        for pattern in [Pattern::Wood, Pattern::Fabric, Pattern::Tiles, Pattern::Plaster, Pattern::Carpet] {
            let texture = paint(pattern);
            let mean = texture.texels.iter().map(|texel| u64::from(texel[1])).sum::<u64>() / u64::from(SIDE * SIDE);
            assert!(mean > 200, "{pattern:?}: {mean}");
            assert!(texture.texels.iter().all(|[r, g, b, _]| r.abs_diff(*g) < 4 && g.abs_diff(*b) < 4));
        }
    }

    #[test]
    fn views_from_windows_differ_and_repeat_sideways() {
        let views = Pattern::ALL.into_iter().filter(|p| matches!(p, Pattern::Outside(_) | Pattern::FromAbove(_)));
        let textures: Vec<_> = views.map(of).collect();
        for (at, texture) in textures.iter().enumerate() {
            assert!(textures[..at].iter().all(|other| other.texels != texture.texels));
            let row = |y: u32| &texture.texels[(y * SIDE) as usize..((y + 1) * SIDE) as usize];
            let apart = |a: [u8; 4], b: [u8; 4]| (0..3).map(|c| u64::from(a[c].abs_diff(b[c]))).sum::<u64>();
            let seam: u64 = (0..SIDE).map(|y| apart(row(y)[0], row(y)[SIDE as usize - 1])).sum();
            let inside: u64 = (0..SIDE).map(|y| apart(row(y)[SIDE as usize / 2], row(y)[SIDE as usize / 2 + 9])).sum();
            assert!(seam < 2 * inside + 6000, "view {at} has a seam: {seam}, {inside} within");
        }
    }
}
