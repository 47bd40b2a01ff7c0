//! The codecs that can be read.

use super::{
    av1::Av1,
    colour::Colour,
    decoder::Decode,
    h264::{self, H264},
};

/// A codec that can be read, with the settings of its decoder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Codec {
    H264(h264::Setup),
    /// With the colours that the container gives.
    Av1(Colour),
}

impl Codec {
    pub(super) fn decoder(&self) -> Result<Box<dyn Decode>, String> {
        Ok(match self {
            Self::H264(setup) => Box::new(H264::new(setup)?),
            Self::Av1(colour) => Box::new(Av1::new(*colour)?),
        })
    }

    /// Whether decoding can begin with a sample that the container marks so.
    pub(super) fn can_begin_with(&self, sample: &[u8]) -> bool {
        match self {
            Self::H264(setup) => setup.can_begin_with(sample),
            Self::Av1(_) => true,
        }
    }
}
