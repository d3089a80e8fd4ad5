//! The adapter of the GPU backend.
//!
//! Burn acquires it at the first operation and panics if there is none; `device` acquires it in advance.

use std::sync::OnceLock;

use burn::tensor::wgpu::{WgpuInitError, wgpu};
use burn::tensor::{Device, DeviceKind};

use super::BackendError;
use execution::progress;

/// The device of the adapter that wgpu prefers, or that `CUBECL_WGPU_DEFAULT_DEVICE` names; logs which.
pub(super) fn device() -> Result<Device, BackendError> {
    // An adapter is acquired once a process.
    static DEVICE: OnceLock<Result<Device, BackendError>> = OnceLock::new();
    DEVICE.get_or_init(acquire).clone()
}

fn acquire() -> Result<Device, BackendError> {
    match Device::wgpu_options().init_with_setup() {
        Ok((device, setup)) => {
            log(&setup.adapter.get_info());
            Ok(device)
        }
        // An operation on the default device came first.
        Err(WgpuInitError::Registration { .. }) => Ok(Device::wgpu(DeviceKind::DefaultDevice)),
        Err(WgpuInitError::AdapterUnavailable { message, .. }) => {
            Err(BackendError::NoAdapter { reason: message })
        }
        Err(error) => Err(BackendError::NoAdapter {
            reason: error.to_string(),
        }),
    }
}

fn log(adapter: &wgpu::AdapterInfo) {
    let wgpu::AdapterInfo {
        name,
        backend,
        driver_info,
        ..
    } = adapter;
    progress::log(&format!("adapter: {name}, {backend}, {driver_info}"));
    if adapter.device_type == wgpu::DeviceType::Cpu {
        progress::log(
            "this adapter is software on the CPU: --backend flex computes the same, many times as fast",
        );
    }
}
