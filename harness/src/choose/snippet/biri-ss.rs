pub fn options(target_format: wgpu::TextureFormat) -> biri_ss::Options {
    biri_ss::Options::paper(target_format)
}
pub fn model() -> common::need::Model {
    common::need::Model::default()
}
