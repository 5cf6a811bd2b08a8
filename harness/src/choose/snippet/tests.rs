//! Each committed snippet is what is written now, compiles, and makes just the options that it was written for.

use super::*;
use crate::techniques;

fn settings_of(name: &str) -> Settings {
    let model = Model { lights: vec![Shaft::Shadowed, Shaft::Off], grey: true, phase: PhaseModel::Isotropic };
    Settings::of(&techniques::find_one(name).unwrap(), &model)
}

/// Set to write the snippets anew.
const WRITE: &str = "WRITE_SNIPPETS";

/// The module of one snippet, and that its options are those of a method.
macro_rules! holds {
    ($test:ident, $method:literal, $file:literal, $options:expr) => {
        #[test]
        fn $test() {
            #[expect(unreachable_pub, reason = "written for a file of its own")]
            mod written {
                include!($file);
            }
            let text = of(&settings_of($method)).unwrap();
            if std::env::var_os(WRITE).is_some() {
                std::fs::write(format!("{}/src/choose/snippet/{}", env!("CARGO_MANIFEST_DIR"), $file), text)
                    .unwrap();
                return;
            }
            assert_eq!(text, include_str!($file));
            let format = wgpu::TextureFormat::Rgba32Float;
            assert_eq!(written::options(format), $options(format));
            assert_eq!(written::model(), settings_of($method).model);
        }
    };
}

holds!(lit_intervals, "lit-intervals@512", "lit-intervals.rs", billeter_plv::Options::rays);
holds!(light_volumes, "billeter-plv-paper", "billeter-plv.rs", billeter_plv::Options::paper);
holds!(shadow_planes, "biri-ss-default", "biri-ss.rs", biri_ss::Options::best);
holds!(sampling_planes, "chen-planes-default", "chen-planes.rs", chen_planes::Options::best);
holds!(network, "szk-network-paper", "szk-network.rs", |format| {
    // The particles are the scene's, as many as were chosen.
    let particles = written::particles(&common::scene::builtin::sphere().cloud.unwrap()).unwrap();
    assert_eq!(particles.list.len(), 1024);
    szk_network::Options::paper(format)
});

#[test]
fn a_peer_is_said_in_words() {
    let text = of(&settings_of("ray-march-64@1024")).unwrap();
    assert!(text.starts_with("// ray-march on shadow maps of 1024² texels: {\"steps\":64}."), "{text}");
    assert!(text.contains("PhaseModel::Isotropic"));
    let file: Result<Settings, _> =
        serde_json::from_str(&serde_json::to_string(&settings_of("ray-march-64")).unwrap());
    assert_eq!(file.unwrap(), settings_of("ray-march-64"));
}
