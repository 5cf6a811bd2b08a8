pub fn options(target_format: wgpu::TextureFormat) -> szk_network::Options {
    szk_network::Options::paper(target_format)
}
pub fn model() -> common::need::Model {
    common::need::Model::default()
}
