//! The catalogue of furniture: each kind's name, usual size, colours and material.

use super::{colour::Colour, dice::HouseDice};
use Colour as C;
use serde::{Deserialize, Serialize};

/// The usual properties of a kind of furniture.
pub(crate) struct CatalogueEntry {
    /// Its name in plain words.
    pub(crate) name: &'static str,
    /// Usual width, depth and height, centimetres.
    pub(crate) size_cm: [i32; 3],
    /// How much wider or narrower it may be, centimetres.
    pub(crate) give_cm: i32,
    /// Main material.
    pub(crate) material: &'static str,
    /// Usual colours.
    pub(crate) colours: &'static [Colour],
}

macro_rules! catalogue {
    ($($kind:ident $name:literal [$w:literal $d:literal $h:literal] +- $give:literal $material:literal [$($colour:ident)+];)*) => {
        /// A kind of furniture.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum FurnitureKind {
            $(#[doc = $name] $kind,)*
        }

        impl FurnitureKind {
            /// All of them.
            #[cfg(test)]
            pub(crate) const ALL: &'static [Self] = &[$(Self::$kind,)*];

            /// The usual properties of this kind.
            pub(crate) fn entry(self) -> CatalogueEntry {
                match self {
                    $(Self::$kind => CatalogueEntry {
                        name: $name,
                        size_cm: [$w, $d, $h],
                        give_cm: $give,
                        material: $material,
                        colours: &[$(C::$colour),+],
                    },)*
                }
            }
        }
    };
}

// One row for each kind: variant, name, [width depth height] in cm, +- variation of the width in cm, main material,
// [usual colours].
catalogue! {
    Sofa "sofa" [210 90 82] +- 20 "fabric" [Grey Beige Blue Green DarkGrey Teal Red Brown Pink Yellow];
    Armchair "armchair" [82 82 84] +- 4 "fabric" [Beige Yellow Blue Green Orange Red Grey Brown Pink Purple];
    CoffeeTable "coffee table" [110 60 42] +- 10 "wood" [Wooden Brown White Black Glass];
    TvStand "tv stand" [160 42 50] +- 15 "wood" [White Brown Black Wooden Grey];
    Television "television" [124 8 74] +- 8 "plastic" [Black];
    Bookshelf "bookshelf" [95 32 200] +- 15 "wood" [Brown White Wooden Black Blue];
    FloorLamp "floor lamp" [42 42 162] +- 2 "metal" [Black Silver Gold White];
    Rug "rug" [230 160 1] +- 20 "wool" [Red Blue Beige Grey Teal];
    Plant "plant" [52 52 130] +- 8 "plant" [Green];
    Painting "painting" [90 4 66] +- 20 "canvas" [Blue Orange Green Red Yellow Purple Teal White Black Pink];
    SideTable "side table" [48 48 54] +- 2 "wood" [Wooden White Black Glass Blue];
    TableLamp "lamp" [30 30 50] +- 2 "ceramic" [White Blue Green Gold Black];
    Fireplace "fireplace" [140 34 112] +- 10 "stone" [White Grey Red];
    Curtain "curtain" [60 8 220] +- 0 "fabric" [Beige Grey Blue Green Red White];
    Vase "vase" [22 22 44] +- 2 "ceramic" [White Blue Teal Red];
    Piano "piano" [148 60 122] +- 2 "wood" [Black Brown White];
    Photos "pictures" [120 3 150] +- 20 "paper" [Black];
    Tapestry "tapestry" [100 4 160] +- 20 "wool" [Red Blue Green Orange Purple Teal Beige];
    CoatHooks "coat hooks" [100 12 150] +- 10 "wood" [White Brown Wooden Black];
    BulletinBoard "bulletin board" [110 3 90] +- 10 "cork" [Wooden];
    ToolBoard "tool rack" [120 6 110] +- 20 "wood" [Wooden];
    GrandfatherClock "grandfather clock" [48 28 202] +- 0 "wood" [Brown Wooden];
    Clock "clock" [36 4 36] +- 2 "plastic" [White Black];
    CeilingLight "ceiling light" [44 44 16] +- 4 "glass" [White];
    Counter "kitchen counter" [60 62 91] +- 0 "wood" [White Grey Blue Green Wooden];
    KitchenSink "sink" [80 62 91] +- 0 "metal" [Silver];
    Stove "stove" [62 62 91] +- 0 "metal" [Silver Black White];
    Refrigerator "refrigerator" [76 70 182] +- 6 "metal" [Silver White];
    WallCabinet "cabinet" [80 36 66] +- 0 "wood" [White Grey Blue Green Wooden];
    RangeHood "range hood" [62 44 58] +- 0 "metal" [Silver];
    Island "kitchen island" [150 80 92] +- 10 "wood" [White Grey Blue Green Wooden];
    BarStool "stool" [38 38 68] +- 0 "wood" [Black Wooden White Red Yellow];
    Microwave "microwave" [48 34 28] +- 0 "metal" [Black Silver White];
    Toaster "toaster" [30 18 20] +- 0 "metal" [Silver Red];
    Kettle "kettle" [22 18 26] +- 0 "metal" [Silver Red Black];
    FruitBowl "fruit bowl" [32 32 16] +- 0 "ceramic" [White];
    Toilet "toilet" [40 68 78] +- 0 "ceramic" [White];
    Vanity "sink" [80 48 86] +- 12 "ceramic" [White];
    Mirror "mirror" [64 4 84] +- 8 "glass" [Gold White Black];
    Bathtub "bathtub" [165 76 58] +- 4 "ceramic" [White];
    Shower "shower" [92 92 205] +- 4 "glass" [LightBlue];
    Towel "towel" [56 8 74] +- 0 "fabric" [Blue White Teal Red Yellow Pink];
    BathMat "bath mat" [80 50 2] +- 5 "fabric" [Blue Teal Grey Pink];
    DiningTable "dining table" [170 92 75] +- 15 "wood" [Brown Wooden White Black Glass];
    Chair "chair" [44 48 92] +- 0 "wood" [Brown Wooden White Black Red Blue Green];
    Chandelier "chandelier" [66 66 62] +- 4 "metal" [Gold Black Silver];
    Sideboard "sideboard" [160 45 82] +- 15 "wood" [Brown White Wooden Blue Green Grey Black];
    Bed "bed" [160 206 100] +- 0 "fabric" [White Blue Grey Green Red Purple Beige Yellow Pink];
    Nightstand "nightstand" [46 42 54] +- 2 "wood" [Brown White Wooden Blue Black];
    Wardrobe "wardrobe" [150 60 205] +- 20 "wood" [White Brown Wooden Grey Green];
    Dresser "dresser" [116 48 84] +- 10 "wood" [White Brown Wooden Blue Green Grey Black];
    Bench "bench" [120 40 46] +- 8 "wood" [Brown White Wooden Green];
    Desk "desk" [140 66 75] +- 10 "wood" [Wooden White Brown Black Grey];
    OfficeChair "office chair" [60 60 108] +- 0 "fabric" [Black Grey Blue];
    Computer "computer" [58 22 46] +- 4 "plastic" [Black];
    FilingCabinet "filing cabinet" [46 56 104] +- 0 "metal" [Grey Black White];
    Globe "globe" [30 30 40] +- 0 "plastic" [Blue];
    Whiteboard "whiteboard" [130 4 90] +- 10 "plastic" [White];
    ConsoleTable "console table" [105 34 80] +- 10 "wood" [Brown White Wooden Black Glass Green];
    Washer "washing machine" [62 62 88] +- 0 "metal" [White];
    Dryer "dryer" [62 62 88] +- 0 "metal" [White Grey];
    LaundryBasket "laundry basket" [46 40 56] +- 2 "wicker" [Brown Beige White];
    IroningBoard "ironing board" [120 36 90] +- 0 "fabric" [Blue Red Grey];
    Shelf "shelf" [90 28 40] +- 6 "wood" [White Brown Wooden Black];
    CoatRack "coat rack" [50 50 178] +- 0 "wood" [Brown Black Wooden];
    ShoeRack "shoe rack" [80 34 54] +- 8 "wood" [Brown White Wooden];
    DoorMat "doormat" [84 54 2] +- 0 "coir" [Brown DarkGrey];
    ClothesRack "clothes rack" [120 50 170] +- 15 "metal" [Silver];
    Boxes "cardboard boxes" [70 50 84] +- 6 "cardboard" [Brown];
    Car "car" [178 400 146] +- 0 "metal" [Red Blue Silver White Green];
    Workbench "workbench" [150 60 92] +- 10 "wood" [Wooden Brown];
    MetalShelf "metal shelf" [110 45 180] +- 10 "metal" [Grey Silver];
    ClosetDoor "wardrobe" [160 6 212] +- 0 "wood" [White Wooden Brown Grey];
    WallBookshelf "bookshelf" [120 10 208] +- 0 "wood" [White Brown Wooden Black];
    Radiator "radiator" [100 9 58] +- 0 "metal" [White];
    Bicycle "bicycle" [168 50 104] +- 0 "metal" [Red Blue Green Black];
}

impl FurnitureKind {
    /// A size for one piece, centimetres.
    pub(crate) fn size_cm(self, dice: &mut HouseDice) -> [i32; 3] {
        let CatalogueEntry { size_cm: [width, depth, height], give_cm, .. } = self.entry();
        [width + dice.draw_stepped(-give_cm, give_cm, 2), depth, height]
    }

    /// A colour for one piece.
    pub(crate) fn draw_colour(self, dice: &mut HouseDice) -> Colour {
        let colours = self.entry().colours;
        colours[dice.index(colours.len())]
    }

    /// Whether its colour shows: several photographs have many.
    pub(crate) fn has_one_colour(self) -> bool {
        !matches!(self, Self::Photos | Self::CoatHooks)
    }

    /// Whether it is flat enough to walk over.
    pub(crate) fn is_flat(self) -> bool {
        matches!(self, Self::Rug | Self::BathMat | Self::DoorMat)
    }

    /// Whether it is slim and hangs on a wall, so that it takes no floor.
    pub(crate) fn is_slim_on_wall(self) -> bool {
        matches!(
            self,
            Self::Painting
                | Self::Mirror
                | Self::Clock
                | Self::Whiteboard
                | Self::Towel
                | Self::Curtain
                | Self::ClosetDoor
                | Self::WallBookshelf
                | Self::Radiator
                | Self::Photos
                | Self::Tapestry
                | Self::CoatHooks
                | Self::BulletinBoard
                | Self::ToolBoard
        )
    }
}
