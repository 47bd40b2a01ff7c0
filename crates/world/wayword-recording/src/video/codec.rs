//! The codecs that can be read.

use super::{
    av1::Av1Decoder,
    colour::StreamColour,
    decoder::SampleDecoder,
    h264::{self, H264Decoder},
};

/// A codec that can be read, with the settings of its decoder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum ReadableCodec {
    H264(h264::H264Setup),
    /// With the colours that the container gives.
    Av1(StreamColour),
}

impl ReadableCodec {
    pub(super) fn new_decoder(&self) -> Result<Box<dyn SampleDecoder>, String> {
        Ok(match self {
            Self::H264(setup) => Box::new(H264Decoder::new(setup)?),
            Self::Av1(colour) => Box::new(Av1Decoder::new(*colour)?),
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
