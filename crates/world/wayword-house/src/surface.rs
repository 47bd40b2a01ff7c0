//! The surface of a mesh: a pattern in a colour, before it becomes a texture and a material.

use super::{colour::Colour, outlook::WindowOutlook};

/// A picture that is laid on surfaces. It is light grey if the surface provides the colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum SurfacePattern {
    Plain,
    Wood,
    Planks,
    Tiles,
    Carpet,
    Concrete,
    Plaster,
    Fabric,
    Marble,
    /// Brushed metal.
    Brushed,
    /// A leaf of a plant.
    Leaves,
    Brick,
    /// The spines of a row of books.
    Books,
    /// The view out of a window, from the ground floor.
    Outside(WindowOutlook),
    /// The same from upstairs.
    FromAbove(WindowOutlook),
    /// The sheen of glass.
    Reflection,
    /// A rug with borders and a medallion.
    Ornament,
    Wicker,
    Fire,
    /// The screen of a computer.
    Desktop,
    /// The face of a clock.
    Dial,
    /// The rings of a hot plate.
    Coils,
    /// Land and sea, for a globe.
    Map,
    /// A painting, by its number below [`ART_COUNT`].
    Art(u8),
}

/// A pattern in a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct HouseSurface {
    pub(crate) pattern: SurfacePattern,
    /// Gamma-encoded sRGB factor.
    pub(crate) rgb: [u8; 3],
    /// Whether it shines by itself, so that no light or shadow changes it.
    pub(crate) glows: bool,
}

/// How many paintings there are.
pub(crate) const ART_COUNT: u8 = 10;

impl SurfacePattern {
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
        Self::Outside(WindowOutlook::Street),
        Self::Outside(WindowOutlook::Garden),
        Self::Outside(WindowOutlook::Yard),
        Self::Outside(WindowOutlook::Woods),
        Self::Outside(WindowOutlook::Hills),
        Self::Outside(WindowOutlook::Sea),
        Self::Outside(WindowOutlook::Meadow),
        Self::FromAbove(WindowOutlook::Street),
        Self::FromAbove(WindowOutlook::Garden),
        Self::FromAbove(WindowOutlook::Yard),
        Self::FromAbove(WindowOutlook::Woods),
        Self::FromAbove(WindowOutlook::Hills),
        Self::FromAbove(WindowOutlook::Sea),
        Self::FromAbove(WindowOutlook::Meadow),
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

impl HouseSurface {
    pub(crate) fn new(pattern: SurfacePattern, rgb: [u8; 3]) -> Self {
        Self { pattern, rgb, glows: false }
    }

    /// One colour without a picture.
    pub(crate) fn from_rgb(rgb: [u8; 3]) -> Self {
        Self::new(SurfacePattern::Plain, rgb)
    }

    /// A picture in its own colours.
    pub(crate) fn for_picture(pattern: SurfacePattern) -> Self {
        Self::new(pattern, [255; 3])
    }

    /// The same, shining by itself.
    pub(crate) fn glowing(self) -> Self {
        Self { glows: true, ..self }
    }

    /// Wood in a colour; paint hides its grain.
    pub(crate) fn for_wood(colour: Colour) -> Self {
        let pattern = if colour.shows_grain() { SurfacePattern::Wood } else { SurfacePattern::Plain };
        Self::new(pattern, colour.rgb())
    }

    /// Cloth in a colour.
    pub(crate) fn for_fabric(colour: Colour) -> Self {
        Self::new(SurfacePattern::Fabric, colour.rgb())
    }

    /// Brushed metal in a colour.
    pub(crate) fn for_metal(colour: Colour) -> Self {
        Self::new(SurfacePattern::Brushed, colour.rgb())
    }

    /// The same in a darker (below 1) or lighter shade.
    pub(crate) fn shaded_by(self, factor: f32) -> Self {
        Self { rgb: self.rgb.map(|channel| (f32::from(channel) * factor).clamp(0.0, 255.0) as u8), ..self }
    }
}
