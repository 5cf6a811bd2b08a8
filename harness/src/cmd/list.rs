//! `harness list`: names that the command line and the scene file know.

use common::scene::builtin;
use common::terms::Term;

use crate::techniques;

/// Everything that has a name.
pub(crate) fn run() -> String {
    let mut text = String::from("scenes (or a file: .obj, .gltf, .glb, .json):\n");
    let width = builtin::NAMES.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (name, what) in builtin::NAMES {
        text += &format!("  {name:width$}  {what}\n");
    }
    text += "\ntechniques:\n";
    let methods: Vec<_> = techniques::all().into_iter().chain(techniques::improvements()).collect();
    let width = methods.iter().map(|method| method.name.len()).max().unwrap_or(0);
    let (peers, ours): (Vec<_>, Vec<_>) = methods.iter().partition(|method| method.peer);
    for (index, method) in ours.iter().chain(&peers).enumerate() {
        if index == ours.len() {
            text += "\npeers, which a user would otherwise pick, and the floor below all of them:\n";
        }
        let settings: Vec<String> =
            method.settings().iter().map(|(name, value)| format!("{name} = {value}")).collect();
        text += &format!("  {:width$}  {}\n", method.name, settings.join(", "));
    }
    text += "  ray-march-N, ray-march-offset-N, ray-march-equiangular-N, ray-march-equiangular-offset-N,\n";
    text += "  chen-planes-paper-N for N from 1 to 4096\n";
    text += "  froxels-TxZ, froxels-TxZxS: tiles of T pixels, Z slices, S samples a froxel (4), up to 64x1024x64\n";
    text += "  biri-ss-WxH: the default with tables of W times H texels, 4 to 4096 each way\n";
    text += "  chen-planes-NxK: the default with N planes of K places where shadows are looked up, up to 4096x64\n";
    text += "  szk-network-NxD: the default with N particles and D directions, up to 65536x512\n";
    text += "  reference, reference-unbounded (of `render` only; they differ in indirect_airlight)\n";
    text += &format!("\nterms: {}\n", Term::ALL.map(Term::name).join(", "));
    text += "\nphase functions (in a scene file):\n";
    for (name, what) in PHASES {
        text += &format!("  {name:18}  {what}\n");
    }
    text
}

const PHASES: [(&str, &str); 7] = [
    ("isotropic", "alike into all directions"),
    ("rayleigh", "particles much smaller than the wavelength"),
    ("henyey-greenstein", "`g` from -0.99 to 0.99, the mean cosine"),
    ("cornette-shanks", "`g` from -0.99 to 0.99"),
    ("mie-hazy", "haze (Nishita et al. 1987)"),
    ("mie-murky", "murky air (Nishita et al. 1987)"),
    ("mixture", "a weighted sum of these, weights by colour"),
];
