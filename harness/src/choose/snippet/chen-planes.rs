pub fn options(target_format: wgpu::TextureFormat) -> chen_planes::Options {
    chen_planes::Options::paper(target_format)
}
pub fn model() -> common::need::Model {
    common::need::Model::default()
}
