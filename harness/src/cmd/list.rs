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
    for method in &methods {
        let settings: Vec<String> =
            method.settings().iter().map(|(name, value)| format!("{name} = {value}")).collect();
        text += &format!("  {:width$}  {}\n", method.name, settings.join(", "));
    }
    text += "  ray-march-N, ray-march-equiangular-N, chen-planes-paper-N for N from 1 to 4096\n";
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
