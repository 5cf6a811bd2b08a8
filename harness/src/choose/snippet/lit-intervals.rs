pub fn options(target_format: wgpu::TextureFormat) -> billeter_plv::Options {
    billeter_plv::Options::paper(target_format)
}
pub fn model() -> common::need::Model {
    common::need::Model::default()
}
