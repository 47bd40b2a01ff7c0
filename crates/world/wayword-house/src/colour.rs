//! The colours of objects, each with its everyday word.

use serde::{Deserialize, Serialize};

macro_rules! palette {
    ($($name:ident $word:literal $rgb:expr;)*) => {
        /// A named colour.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Colour {
            $(#[doc = $word] $name,)*
        }

        impl Colour {
            /// The word for it.
            #[must_use]
            pub fn word(self) -> &'static str {
                match self { $(Self::$name => $word,)* }
            }

            /// Gamma-encoded sRGB.
            #[must_use]
            pub fn rgb(self) -> [u8; 3] {
                match self { $(Self::$name => $rgb,)* }
            }
        }
    };
}

palette! {
    White "white" [240, 240, 236];
    Cream "cream" [238, 226, 198];
    Beige "beige" [212, 192, 158];
    LightBrown "light brown" [190, 144, 96];
    Brown "brown" [122, 74, 42];
    Wooden "wooden" [206, 160, 106];
    DarkBrown "dark brown" [88, 56, 36];
    Black "black" [38, 38, 42];
    Grey "grey" [150, 152, 156];
    DarkGrey "dark grey" [86, 88, 94];
    Silver "silver" [196, 200, 206];
    Red "red" [186, 48, 44];
    Orange "orange" [224, 126, 48];
    Yellow "yellow" [232, 196, 72];
    Green "green" [82, 134, 80];
    LightGreen "light green" [190, 212, 182];
    Teal "teal" [56, 134, 134];
    LightBlue "light blue" [160, 196, 222];
    Blue "blue" [62, 98, 168];
    Purple "purple" [122, 82, 146];
    Pink "pink" [222, 158, 168];
    Gold "gold" [206, 166, 84];
    Glass "glass" [190, 216, 222];
}

impl Colour {
    /// Whether the grain of wood shows in it; paint hides the grain.
    #[must_use]
    pub fn shows_grain(self) -> bool {
        matches!(self, Self::Wooden | Self::LightBrown | Self::Brown | Self::DarkBrown)
    }

    /// As a factor for a light grey texture or as a plain colour, 0..=1 per channel, gamma-encoded.
    #[must_use]
    pub fn to_factor(self) -> [f32; 3] {
        self.rgb().map(|channel| f32::from(channel) / 255.0)
    }
}
