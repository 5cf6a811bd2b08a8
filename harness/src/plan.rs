//! What a run measures: which methods on which scenes, at which sizes, and to answer which question.

use common::{Light, Scene};
use glam::Vec3;

use crate::failure::Failure;
use crate::record::Study;
use crate::techniques::{self, Method};

/// The scenes of a run that names none.
const SCENES: [&str; 2] = ["cathedral", "amphora"];

/// What a full run draws of clouds, besides.
const CLOUD: &str = "sphere";

/// The scene of which cost is measured against one thing at a time.
const SCALED: &str = "cathedral";

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Depth {
    /// Every technique in a few settings.
    Quick,
    /// Every technique over all of its knobs, each improvement, and cost against all that it may grow with.
    Full,
}

/// What is measured.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Subject {
    /// A built-in scene or a file, with so many triangles where it can.
    Scene { name: String, triangles: Option<u32> },
    /// The same with so many lights: its own, and then lamps along the view.
    Lit { name: String, lights: usize },
}

/// Methods on one scene at one size.
#[derive(Clone, Debug)]
pub(crate) struct Group {
    pub study: Study,
    pub subject: Subject,
    /// Size of the pictures \[pixels\].
    pub size: (u32, u32),
    pub methods: Vec<Method>,
}

/// What the user wants measured.
pub(crate) struct Wish<'a> {
    pub depth: Depth,
    /// None for the built-in ones.
    pub scenes: &'a [String],
    /// Techniques or methods; none for all.
    pub only: &'a [String],
    pub improvements: bool,
    /// None for all.
    pub studies: &'a [Study],
    pub triangles: Option<u32>,
    /// Size of the pictures \[pixels\].
    pub size: (u32, u32),
}

/// Settings of a full run besides those of a quick one. Ray marches are swept on large maps, which cost them nothing and
/// leave them the least error; techniques that draw the map are swept over its size.
const SWEEP: [&str; 63] = [
    "ray-march-8@2048",
    "ray-march-16@2048",
    "ray-march-32@2048",
    "ray-march-64@2048",
    "ray-march-128@2048",
    "ray-march-256@2048",
    "ray-march-512@2048",
    "ray-march-1024@2048",
    "ray-march-offset-8@2048",
    "ray-march-offset-16@2048",
    "ray-march-offset-32@2048",
    "ray-march-offset-64@2048",
    "ray-march-offset-128@2048",
    "ray-march-offset-256@2048",
    "ray-march-offset-1024@2048",
    "ray-march-equiangular-8@2048",
    "ray-march-equiangular-16@2048",
    "ray-march-equiangular-32@2048",
    "ray-march-equiangular-64@2048",
    "ray-march-equiangular-128@2048",
    "ray-march-equiangular-256@2048",
    "ray-march-equiangular-1024@2048",
    "ray-march-equiangular-offset-8@2048",
    "ray-march-equiangular-offset-32@2048",
    "ray-march-equiangular-offset-64@2048",
    "ray-march-equiangular-offset-256@2048",
    "froxels-16x64@2048",
    "froxels-8x64@2048",
    "froxels-8x128@2048",
    "froxels-4x128@2048",
    "froxels-4x256@2048",
    "lit-intervals@256",
    "lit-intervals@512",
    "lit-intervals@1024",
    "lit-intervals@2048",
    "lit-intervals@4096",
    "billeter-plv-paper@256",
    "billeter-plv-paper@512",
    "billeter-plv-paper@1024",
    "billeter-plv-default@256",
    "billeter-plv-default@512",
    "billeter-plv-default@1024",
    "billeter-plv-default@2048",
    "billeter-plv-default@4096",
    "chen-planes-paper-25@1024",
    "chen-planes-paper-50@1024",
    "chen-planes-paper-200@1024",
    "chen-planes-8x4@2048",
    "chen-planes-16x4@2048",
    "chen-planes-16x8@2048",
    "chen-planes-32x8@2048",
    "chen-planes-64x8@2048",
    "chen-planes-128x8@2048",
    "chen-planes-64x32@2048",
    "szk-network-256x64",
    "szk-network-1024x64",
    "szk-network-1024x128",
    "szk-network-4096x32",
    "szk-network-4096x64",
    "szk-network-4096x128",
    "szk-network-8192x64",
    "szk-network-16384x64",
    "szk-network-16384x128",
];

/// Methods whose cost is measured against triangles, lights and so on.
const SCALING: [&str; 9] = [
    "billeter-plv-paper",
    "billeter-plv-default",
    "biri-ss-paper",
    "biri-ss-default",
    "chen-planes-paper",
    "chen-planes-default",
    "ray-march-64",
    "froxels-8x64",
    "lit-intervals",
];

/// Counts and sizes of a full run.
const TRIANGLES: [u32; 7] = [1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000];
const LIGHTS: [usize; 5] = [1, 2, 4, 8, 16];
const SHADOW_MAPS: [u32; 5] = [256, 512, 1024, 2048, 4096];
/// Triangles of the grating, a third of which are silhouette edges.
const GRATING: [u32; 5] = [1_000, 3_000, 10_000, 30_000, 100_000];

/// All that a run measures, in the order in which it does. A sentence where a name means nothing.
pub(crate) fn groups(wish: &Wish<'_>) -> Result<Vec<Group>, Failure> {
    let named = named(wish.only)?;
    let wanted = |method: &Method| named.is_empty() || named.iter().any(|(name, _)| method.is_of(name));
    let mut main = if wish.depth == Depth::Full { grid()? } else { techniques::all() };
    main.retain(&wanted);
    // What was named and is in no list of ours.
    main.extend(named.iter().flat_map(|(_, methods)| methods.clone()));
    let main = once(main);
    let own = !wish.scenes.is_empty();
    let mut scenes: Vec<String> = if own { wish.scenes.to_vec() } else { SCENES.map(String::from).to_vec() };
    if !own && wish.depth == Depth::Full {
        scenes.push(CLOUD.into());
    }
    let mut groups: Vec<Group> = Vec::new();
    for (index, name) in scenes.iter().enumerate() {
        if scenes[..index].contains(name) {
            continue;
        }
        let subject = Subject::Scene { name: name.clone(), triangles: wish.triangles };
        // A cloud's reference are paths, which take long.
        let size = if !own && name == CLOUD { part(wish.size, 4) } else { wish.size };
        groups.push(Group { study: Study::Main, subject: subject.clone(), size, methods: main.clone() });
        if wish.improvements || wish.studies.contains(&Study::Improvements) || wish.depth == Depth::Full {
            let mut methods: Vec<Method> = techniques::all()
                .into_iter()
                .filter(|m| m.preset == "paper" && m.technique != techniques::CLOUDS)
                .collect();
            methods.extend(techniques::improvements());
            methods.retain(&wanted);
            groups.push(Group { study: Study::Improvements, subject, size: part(size, 2), methods });
        }
    }
    if wish.depth == Depth::Full && !own {
        let mut methods = found(&SCALING)?;
        methods.retain(&wanted);
        groups.extend(scaling(wish.size, &methods));
    }
    groups.retain(|group| !group.methods.is_empty());
    groups.retain(|group| wish.studies.is_empty() || wish.studies.contains(&group.study));
    if groups.is_empty() {
        return Err(Failure::Input(
            "there is nothing to measure: studies other than main and improvements take --full and no --scene, and \
             --only has to name a method that is part of the study"
                .into(),
        ));
    }
    Ok(groups)
}

/// Every technique and peer over all of its knobs: the main study of a full run.
pub(crate) fn grid() -> Result<Vec<Method>, Failure> {
    let mut methods = techniques::all();
    methods.extend(found(&SWEEP)?);
    Ok(once(methods))
}

/// Cost against one thing at a time.
fn scaling(size: (u32, u32), methods: &[Method]) -> Vec<Group> {
    let small = part(size, 2);
    let scene = |triangles| Subject::Scene { name: SCALED.into(), triangles };
    let group = |study, subject, size| Group { study, subject, size, methods: methods.to_vec() };
    let mut groups = Vec::new();
    groups.extend(TRIANGLES.map(|count| group(Study::Triangles, scene(Some(count)), small)));
    groups.extend(
        LIGHTS.map(|lights| group(Study::Lights, Subject::Lit { name: SCALED.into(), lights }, small)),
    );
    groups.extend([8, 4, 2, 1].map(|share| group(Study::Resolution, scene(None), part(size, share))));
    groups.extend(SHADOW_MAPS.map(|map| {
        let at = |method: &Method| method.clone().with_shadow_map(map);
        Group { methods: methods.iter().map(at).collect(), ..group(Study::ShadowMap, scene(None), small) }
    }));
    let grating = |count| Subject::Scene { name: "grating".into(), triangles: Some(count) };
    groups.extend(GRATING.map(|count| group(Study::Edges, grating(count), small)));
    groups
}

/// What `only` names, with the methods that are in no list.
fn named(only: &[String]) -> Result<Vec<(String, Vec<Method>)>, Failure> {
    let find = |name: &String| Ok((name.clone(), techniques::find(name).map_err(Failure::Input)?));
    only.iter().map(find).collect()
}

fn found(names: &[&str]) -> Result<Vec<Method>, Failure> {
    let one = |name: &&str| techniques::find_one(name).map_err(Failure::Run);
    names.iter().map(one).collect()
}

/// Each method once, in the order in which it comes first.
fn once(methods: Vec<Method>) -> Vec<Method> {
    let mut kept: Vec<Method> = Vec::new();
    for method in methods {
        if !kept.iter().any(|known| known.name == method.name) {
            kept.push(method);
        }
    }
    kept
}

/// That part of either side.
fn part((width, height): (u32, u32), share: u32) -> (u32, u32) {
    ((width / share).max(1), (height / share).max(1))
}

impl Subject {
    /// As the command line spells it.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Scene { name, .. } | Self::Lit { name, .. } => name.clone(),
        }
    }

    /// Whether both are of one file or one built-in scene.
    pub(crate) fn is_same_file(&self, other: &Self) -> bool {
        self.name() == other.name()
    }

    /// In few words.
    pub(crate) fn text(&self, scene: &Scene) -> String {
        match self {
            Self::Scene { triangles: None, .. } => scene.name.clone(),
            Self::Scene { .. } => format!("{}, {} triangles", scene.name, scene.triangle_count()),
            Self::Lit { lights, .. } => format!("{}, {lights} lights", scene.name),
        }
    }

    /// Whether it is built in: then methods are held to their bounds.
    pub(crate) fn is_builtin(&self) -> bool {
        match self {
            Self::Scene { name, .. } => common::scene::builtin::NAMES.iter().any(|(known, _)| known == name),
            Self::Lit { .. } => true,
        }
    }

    /// The scene; `say` is told what the loader has to say.
    pub(crate) fn load(&self, say: impl Fn(&str)) -> Result<Scene, Failure> {
        match self {
            Self::Scene { name, triangles } => crate::cmd::load(name, *triangles, say),
            Self::Lit { name, lights } => Ok(lit(crate::cmd::load(name, None, say)?, *lights)),
        }
    }
}

/// The scene with so many lights: lamps are added, one behind the other along the way the camera looks.
fn lit(mut scene: Scene, lights: usize) -> Scene {
    let lamp = scene.lights.iter().find_map(|light| match light {
        Light::Point(point) => Some(point.clone()),
        _ => None,
    });
    let own = scene.lights.len();
    let along = scene.camera.target - scene.camera.eye;
    if let Some(lamp) = lamp {
        // Around the lamp, never in one place.
        let place = |index: usize| {
            along * (0.08 * (index as f32 - 7.0) + 0.013) + Vec3::Y * 0.17 * (index % 3) as f32
        };
        scene.lights.extend((own..lights).map(|index| {
            Light::Point(common::PointLight { position: lamp.position + place(index - own), ..lamp.clone() })
        }));
    }
    scene.lights.truncate(lights);
    // Its motion may be that of a light that is gone.
    scene.animation.clear();
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wish<'a>(depth: Depth, scenes: &'a [String], only: &'a [String]) -> Wish<'a> {
        Wish { depth, scenes, only, improvements: false, studies: &[], triangles: None, size: (640, 512) }
    }

    fn names(group: &Group) -> Vec<&str> {
        group.methods.iter().map(|method| method.name.as_str()).collect()
    }

    #[test]
    fn a_quick_run_is_the_main_study_of_two_scenes() {
        let groups = groups(&wish(Depth::Quick, &[], &[])).unwrap();
        assert_eq!(groups.len(), 2);
        assert!(groups.iter().all(|group| group.study == Study::Main && group.size == (640, 512)));
    }

    #[test]
    fn a_full_run_answers_every_question() {
        let groups = groups(&wish(Depth::Full, &[], &[])).unwrap();
        let of = |study| groups.iter().filter(move |group| group.study == study);
        assert_eq!(of(Study::Triangles).count(), TRIANGLES.len());
        for study in [Study::Lights, Study::Resolution, Study::ShadowMap, Study::Edges] {
            assert!(of(study).count() >= 4, "{study:?}");
            assert!(of(study).all(|group| group.methods.len() == SCALING.len()));
        }
        // Each scene has settings of the paper beside its improvements.
        assert!(of(Study::Improvements).all(|group| names(group).contains(&"biri-ss-paper")));
        let main = names(of(Study::Main).next().unwrap());
        assert!(SWEEP.iter().all(|name| main.contains(name)));
        let mut each = main.clone();
        each.dedup();
        assert_eq!(each, main, "no method twice");
    }

    #[test]
    fn what_was_named_is_measured_and_nothing_else() {
        let scenes = ["pen", "pen", "hall"].map(String::from);
        let only = ["ray-march-7", "chen-planes"].map(String::from);
        let quick = groups(&wish(Depth::Quick, &scenes, &only)).unwrap();
        assert_eq!(quick.len(), 2, "each scene once");
        assert_eq!(names(&quick[0]), ["chen-planes-paper", "chen-planes-default", "ray-march-7"]);
        let full = groups(&wish(Depth::Full, &[], &only)).unwrap();
        let foreign = |method: &&Method| !method.is_of("chen-planes") && method.name != "ray-march-7";
        assert_eq!(full.iter().flat_map(|group| &group.methods).find(foreign).map(|m| &m.name), None);
        assert!(groups(&wish(Depth::Quick, &[], &["fog".into()])).is_err());
        let studies = [Study::Edges, Study::Improvements];
        let part = groups(&Wish { studies: &studies, ..wish(Depth::Full, &[], &[]) }).unwrap();
        assert!(!part.is_empty() && part.iter().all(|group| studies.contains(&group.study)));
    }

    #[test]
    fn lamps_are_added_where_none_is() {
        let subject = |lights| Subject::Lit { name: "cathedral".into(), lights };
        for count in LIGHTS {
            let scene = subject(count).load(|_| ()).unwrap();
            assert_eq!((scene.lights.len(), scene.problem()), (count, None));
            let places: Vec<_> = scene.lights.iter().filter_map(Light::position).collect();
            let apart = |(i, a): (usize, &Vec3)| places[..i].iter().all(|b| a.distance(*b) > 0.1);
            assert!(places.iter().enumerate().all(apart), "{places:?}");
        }
    }
}
