//! Which device a model computes on, and in which precision its weights are kept.

use crate::LocalError;
use candle_core::DType;

/// The device on which models compute.
#[derive(Debug, Clone)]
pub struct ModelDevice(pub(crate) candle_core::Device);

/// The precision of a model's weights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WeightPrecision {
    /// 32 bits.
    #[default]
    F32,
    /// bfloat16: 16 bits with the range of 32. Halves the memory, for models that would not fit otherwise.
    Bf16,
    /// IEEE half precision: 16 bits with more digits than [`WeightPrecision::Bf16`] and a smaller range.
    F16,
}

impl ModelDevice {
    /// The CPU.
    #[must_use]
    pub fn cpu() -> Self {
        Self(candle_core::Device::Cpu)
    }

    /// A device by its name: `cpu`, `cuda`, `cuda:1`, `metal`.
    ///
    /// # Errors
    /// When this build or machine has no device of that name.
    pub fn from_name(name: &str) -> Result<Self, LocalError> {
        let (kind, number) = name.split_once(':').unwrap_or((name, "0"));
        let device_error = |problem: String| LocalError::Compute { model: format!("device {name}"), problem };
        let number: usize = number
            .parse()
            .map_err(|_| device_error("its number is not valid; write cpu, cuda, cuda:1 or metal".to_owned()))?;
        let device = match kind {
            "cpu" => Ok(candle_core::Device::Cpu),
            "cuda" => candle_core::Device::new_cuda(number),
            "metal" => candle_core::Device::new_metal(number),
            _ => return Err(device_error("there is no such device; write cpu, cuda, cuda:1 or metal".to_owned())),
        };
        device
            .map(Self)
            .map_err(|error| device_error(format!("{error}; build with --features {kind} on a machine that has one")))
    }
}

impl WeightPrecision {
    /// The same precision as a type of the library candle.
    pub(crate) fn candle_dtype(self) -> DType {
        match self {
            Self::F32 => DType::F32,
            Self::Bf16 => DType::BF16,
            Self::F16 => DType::F16,
        }
    }
}
