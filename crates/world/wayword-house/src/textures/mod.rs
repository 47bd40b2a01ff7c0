//! Pictures that are laid on surfaces. They are computed, not read from files.
//!
//! Patterns whose colour comes from their surface are light grey, because a texture can only darken what it multiplies.

mod noise;
mod paintings;
mod patterns;
mod prints;
mod scenes;

use super::surface::Pattern;
use std::sync::LazyLock;
use wayword_render::Texture;

/// Side of a texture, texels.
pub(super) const SIDE: u32 = 256;

/// Gamma-encoded colour, 0..=255 per channel.
pub(super) type Rgb = [f32; 3];

/// All textures, in the order of [`Pattern::ALL`]; painted once, since every house has the same.
pub(super) fn all() -> Vec<Texture> {
    static PAINTED: LazyLock<Vec<Texture>> = LazyLock::new(|| Pattern::ALL.map(paint).into());
    PAINTED.clone()
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
        Pattern::Garden => scenes::garden(u, v),
        Pattern::Treetops => scenes::treetops(u, v),
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
    fn every_pattern_but_the_plain_one_has_something_to_see() {
        for (pattern, texture) in Pattern::ALL.iter().zip(all()) {
            let differs = texture.texels.iter().any(|texel| *texel != texture.texels[0]);
            assert_eq!(differs, *pattern != Pattern::Plain, "{pattern:?}");
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
}
