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

use super::surface::SurfacePattern;
use std::sync::OnceLock;
use wayword_render::Texture;

/// Side of a texture, texels.
pub(super) const TEXTURE_SIDE_TEXELS: u32 = 256;

/// Gamma-encoded colour, 0..=255 per channel.
pub(super) type TextureRgb = [f32; 3];

/// The texture of a pattern; painted once, since it is the same in every house.
pub(super) fn texture_for_pattern(pattern: SurfacePattern) -> Texture {
    static PAINTED_TEXTURES: [OnceLock<Texture>; SurfacePattern::ALL.len()] =
        [const { OnceLock::new() }; SurfacePattern::ALL.len()];
    let painted = SurfacePattern::ALL.iter().position(|each| *each == pattern).and_then(|at| PAINTED_TEXTURES.get(at));
    painted.map_or_else(|| paint_texture(pattern), |cell| cell.get_or_init(|| paint_texture(pattern)).clone())
}

fn paint_texture(pattern: SurfacePattern) -> Texture {
    let texel = |index: u32| {
        let (x, y) = (index % TEXTURE_SIDE_TEXELS, index / TEXTURE_SIDE_TEXELS);
        let (u, v) = ((x as f32 + 0.5) / TEXTURE_SIDE_TEXELS as f32, (y as f32 + 0.5) / TEXTURE_SIDE_TEXELS as f32);
        let [r, g, b] = pattern_texel(pattern, u, v).map(|channel| channel.clamp(0.0, 255.0) as u8);
        [r, g, b, 255]
    };
    Texture {
        width: TEXTURE_SIDE_TEXELS,
        height: TEXTURE_SIDE_TEXELS,
        texels: (0..TEXTURE_SIDE_TEXELS * TEXTURE_SIDE_TEXELS).map(texel).collect(),
    }
}

/// The colour at a place, both coordinates in 0..1, v downwards.
fn pattern_texel(pattern: SurfacePattern, u: f32, v: f32) -> TextureRgb {
    match pattern {
        SurfacePattern::Plain => [255.0; 3],
        SurfacePattern::Wood => patterns::wood_texel(u, v),
        SurfacePattern::Planks => patterns::planks_texel(u, v),
        SurfacePattern::Tiles => patterns::tiles_texel(u, v),
        SurfacePattern::Carpet => patterns::carpet_texel(u, v),
        SurfacePattern::Concrete => patterns::concrete_texel(u, v),
        SurfacePattern::Plaster => patterns::plaster_texel(u, v),
        SurfacePattern::Fabric => patterns::fabric_texel(u, v),
        SurfacePattern::Marble => patterns::marble_texel(u, v),
        SurfacePattern::Brushed => patterns::brushed_texel(u, v),
        SurfacePattern::Leaves => patterns::leaves_texel(u, v),
        SurfacePattern::Brick => patterns::brick_texel(u, v),
        SurfacePattern::Ornament => patterns::ornament_texel(u, v),
        SurfacePattern::Wicker => patterns::wicker_texel(u, v),
        SurfacePattern::Coils => patterns::coils_texel(u, v),
        SurfacePattern::Books => scenes::books_texel(u, v),
        SurfacePattern::Outside(outlook) => outside::outlook_texel(outlook, false, u, v),
        SurfacePattern::FromAbove(outlook) => outside::outlook_texel(outlook, true, u, v),
        SurfacePattern::Reflection => scenes::reflection_texel(u, v),
        SurfacePattern::Fire => scenes::fire_texel(u, v),
        SurfacePattern::Desktop => scenes::desktop_texel(u, v),
        SurfacePattern::Dial => scenes::dial_texel(u, v),
        SurfacePattern::Map => scenes::map_texel(u, v),
        SurfacePattern::Art(which) => paintings::painting_texel(which, u, v),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_texture_but_the_plain_one_shows_a_pattern() {
        for pattern in SurfacePattern::ALL {
            let texture = texture_for_pattern(pattern);
            let differs = texture.texels.iter().any(|texel| *texel != texture.texels[0]);
            assert_eq!(differs, pattern != SurfacePattern::Plain, "{pattern:?}");
        }
    }

    #[test]
    fn patterns_that_take_their_colour_from_the_surface_are_light_and_grey() {
        for pattern in [
            SurfacePattern::Wood,
            SurfacePattern::Fabric,
            SurfacePattern::Tiles,
            SurfacePattern::Plaster,
            SurfacePattern::Carpet,
        ] {
            let texture = paint_texture(pattern);
            let mean = texture.texels.iter().map(|texel| u64::from(texel[1])).sum::<u64>()
                / u64::from(TEXTURE_SIDE_TEXELS * TEXTURE_SIDE_TEXELS);
            assert!(mean > 200, "{pattern:?}: {mean}");
            assert!(texture.texels.iter().all(|[r, g, b, _]| r.abs_diff(*g) < 4 && g.abs_diff(*b) < 4));
        }
    }

    #[test]
    fn views_from_windows_differ_and_repeat_sideways() {
        let views = SurfacePattern::ALL
            .into_iter()
            .filter(|p| matches!(p, SurfacePattern::Outside(_) | SurfacePattern::FromAbove(_)));
        let textures: Vec<_> = views.map(texture_for_pattern).collect();
        for (at, texture) in textures.iter().enumerate() {
            assert!(textures[..at].iter().all(|other| other.texels != texture.texels));
            let row =
                |y: u32| &texture.texels[(y * TEXTURE_SIDE_TEXELS) as usize..((y + 1) * TEXTURE_SIDE_TEXELS) as usize];
            let apart = |a: [u8; 4], b: [u8; 4]| (0..3).map(|c| u64::from(a[c].abs_diff(b[c]))).sum::<u64>();
            let seam: u64 =
                (0..TEXTURE_SIDE_TEXELS).map(|y| apart(row(y)[0], row(y)[TEXTURE_SIDE_TEXELS as usize - 1])).sum();
            let inside: u64 = (0..TEXTURE_SIDE_TEXELS)
                .map(|y| apart(row(y)[TEXTURE_SIDE_TEXELS as usize / 2], row(y)[TEXTURE_SIDE_TEXELS as usize / 2 + 9]))
                .sum();
            assert!(seam < 2 * inside + 6000, "view {at} has a seam: {seam}, {inside} within");
        }
    }
}
