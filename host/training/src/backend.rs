//! Backend: the library that computes on tensors, and its device.

pub use burn::tensor::Device;
use clap::{Args, ValueEnum};

#[cfg(feature = "wgpu")]
mod wgpu;

/// Library that computes on tensors. The first that is compiled in is the default.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Backend {
    /// Any GPU, through Vulkan, Metal or Direct3D 12.
    #[cfg(feature = "wgpu")]
    Wgpu,
    /// CPU: the library burn-flex; 1.5 to 1.8 times as fast as ndarray.
    #[cfg(feature = "flex")]
    Flex,
    /// CPU: the library burn-ndarray, which Burn deprecates in favour of flex.
    #[cfg(feature = "ndarray")]
    Ndarray,
}

/// Choice of a backend among those compiled in.
#[derive(Clone, Copy, Debug, Args)]
pub struct BackendArguments {
    /// Library that computes on tensors; a GPU's if one is compiled in and none is given.
    #[arg(hide_short_help = true, long, value_enum)]
    pub backend: Option<Backend>,
}

/// Why there is no device to compute on.
#[derive(Clone, Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum BackendError {
    #[error("no backend is compiled in: build with one of the features flex, ndarray, wgpu")]
    NoneCompiled,
    #[error(
        "no adapter for --backend wgpu: {reason}\n\
         `vulkaninfo --summary` lists what Vulkan finds; without a GPU, choose --backend flex, \
         or, to try the backend, install a software Vulkan (Debian: mesa-vulkan-drivers)"
    )]
    NoAdapter { reason: String },
}

impl BackendArguments {
    /// The device, with gradients.
    pub fn device(self) -> Result<Device, BackendError> {
        let compiled = Backend::value_variants().first().copied();
        let chosen = self.backend.or(compiled);
        let backend = chosen.ok_or(BackendError::NoneCompiled)?;
        Ok(backend.device()?.autodiff())
    }
}

impl Backend {
    /// The device, without gradients.
    pub fn device(self) -> Result<Device, BackendError> {
        match self {
            #[cfg(feature = "wgpu")]
            Self::Wgpu => wgpu::device(),
            #[cfg(feature = "flex")]
            Self::Flex => Ok(Device::flex()),
            #[cfg(feature = "ndarray")]
            Self::Ndarray => Ok(ndarray()),
        }
    }
}

/// Device of ndarray. Burn 0.22 deprecates it in favour of `flex`; it stays selectable as long as Burn has it.
#[cfg(feature = "ndarray")]
#[expect(deprecated, reason = "selectable on purpose, see docs/decisions.md")]
fn ndarray() -> Device {
    Device::ndarray()
}
