//! A device without a window.

use eframe::egui_wgpu;
use egui_wgpu::RenderState;

/// What draws, the driver that there is; `None` where there is none.
pub fn device() -> Option<RenderState> {
    let config = egui_wgpu::WgpuConfiguration::default();
    let instance = pollster::block_on(config.wgpu_setup.new_instance());
    let options = egui_wgpu::RendererOptions::default();
    pollster::block_on(RenderState::create(&config, &instance, None, options)).ok()
}
