//! The surface of a mesh: a pattern in a colour, before it becomes a texture and a material.

use super::{colour::Colour, outlook::Outlook};

/// A picture that is laid on surfaces. It is light grey if the surface provides the colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Pattern {
    Plain,
    Wood,
    Planks,
    Tiles,
    Carpet,
    Concrete,
    Plaster,
    Fabric,
    Marble,
    Brushed,
    Leaves,
    Brick,
    Books,
    /// The view out of a window, from the ground floor.
    Outside(Outlook),
    /// The same from upstairs.
    FromAbove(Outlook),
    Reflection,
    Ornament,
    Wicker,
    Fire,
    Desktop,
    Dial,
    Coils,
    Map,
    Art(u8),
}

/// A pattern in a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Surface {
    pub(crate) pattern: Pattern,
    /// Gamma-encoded sRGB factor.
    pub(crate) rgb: [u8; 3],
    /// Whether it shines by itself, so that no light or shadow changes it.
    pub(crate) glows: bool,
}

/// How many paintings there are.
pub(crate) const ART_COUNT: u8 = 10;

impl Pattern {
    /// All of them, in the order of their textures.
    pub(crate) const ALL: [Self; 45] = [
        Self::Plain,
        Self::Wood,
        Self::Planks,
        Self::Tiles,
        Self::Carpet,
        Self::Concrete,
        Self::Plaster,
        Self::Fabric,
        Self::Marble,
        Self::Brushed,
        Self::Leaves,
        Self::Brick,
        Self::Books,
        Self::Outside(Outlook::Street),
        Self::Outside(Outlook::Garden),
        Self::Outside(Outlook::Yard),
        Self::Outside(Outlook::Woods),
        Self::Outside(Outlook::Hills),
        Self::Outside(Outlook::Sea),
        Self::Outside(Outlook::Meadow),
        Self::FromAbove(Outlook::Street),
        Self::FromAbove(Outlook::Garden),
        Self::FromAbove(Outlook::Yard),
        Self::FromAbove(Outlook::Woods),
        Self::FromAbove(Outlook::Hills),
        Self::FromAbove(Outlook::Sea),
        Self::FromAbove(Outlook::Meadow),
        Self::Reflection,
        Self::Ornament,
        Self::Wicker,
        Self::Fire,
        Self::Desktop,
        Self::Dial,
        Self::Coils,
        Self::Map,
        Self::Art(0),
        Self::Art(1),
        Self::Art(2),
        Self::Art(3),
        Self::Art(4),
        Self::Art(5),
        Self::Art(6),
        Self::Art(7),
        Self::Art(8),
        Self::Art(9),
    ];

    /// Side of the square that one picture covers, metres.
    pub(crate) fn repeat_m(self) -> f32 {
        match self {
            Self::Planks => 1.6,
            Self::Tiles => 1.2,
            Self::Carpet | Self::Leaves => 0.5,
            Self::Concrete | Self::Plaster => 2.0,
            Self::Fabric | Self::Wicker => 0.35,
            Self::Books => 0.9,
            _ => 1.0,
        }
    }
}

impl Surface {
    pub(crate) fn new(pattern: Pattern, rgb: [u8; 3]) -> Self {
        Self { pattern, rgb, glows: false }
    }

    /// One colour without a picture.
    pub(crate) fn plain(rgb: [u8; 3]) -> Self {
        Self::new(Pattern::Plain, rgb)
    }

    /// A picture in its own colours.
    pub(crate) fn picture(pattern: Pattern) -> Self {
        Self::new(pattern, [255; 3])
    }

    /// The same, shining by itself.
    pub(crate) fn glowing(self) -> Self {
        Self { glows: true, ..self }
    }

    pub(crate) fn wood(colour: Colour) -> Self {
        let pattern = if colour.shows_grain() { Pattern::Wood } else { Pattern::Plain };
        Self::new(pattern, colour.rgb())
    }

    pub(crate) fn fabric(colour: Colour) -> Self {
        Self::new(Pattern::Fabric, colour.rgb())
    }

    pub(crate) fn metal(colour: Colour) -> Self {
        Self::new(Pattern::Brushed, colour.rgb())
    }

    /// The same in a darker (below 1) or lighter shade.
    pub(crate) fn shade(self, factor: f32) -> Self {
        Self { rgb: self.rgb.map(|channel| (f32::from(channel) * factor).clamp(0.0, 255.0) as u8), ..self }
    }
}
