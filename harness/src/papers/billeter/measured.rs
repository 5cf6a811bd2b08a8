//! Times and errors that the table and the claims are read from.

use common::image::Image;
use common::{Scene, Term, metrics};
use serde::Serialize;

use super::super::Press;
use super::{PAPER, SHADOW_MAP, TRIANGLES, cathedral};
use crate::cmd::reference;
use crate::failure::Failure;
use crate::interrupt;
use crate::measure::{Drawn, Stage, Times, Turn, times_in_turn};
use crate::record::Spread;
use crate::techniques;

/// Steps of progress: errors, and times of each group.
pub(super) const STEPS: u64 = 1 + GROUPS.len() as u64;

/// Rounds of the cases of one group go on for so long on a software adapter \[s\].
const BUDGET: f64 = 20.0;

/// What is varied within a group of cases, which are drawn in turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Group {
    /// The size of shadow maps, with full and adaptive meshes.
    Maps,
    Triangles,
    Lights,
    /// Both settings and marches.
    Marches,
}

const GROUPS: [Group; 4] = [Group::Maps, Group::Triangles, Group::Lights, Group::Marches];

/// Triangles of the scene: a quarter and four times the figure's beside its own.
pub(super) const COUNTS: [u32; 3] = [TRIANGLES / 4, TRIANGLES, 4 * TRIANGLES];
/// Lights: the sun alone, the figure's two, and each of them twice.
pub(super) const LIGHTS: [usize; 3] = [1, 2, 4];
/// Texels on a side of shadow maps.
pub(super) const MAPS: [u32; 4] = [128, 256, 512, 1024];
/// The map that triangles and lights are varied with.
pub(super) const SMALL_MAP: u32 = 256;
pub(super) const ADAPTIVE: &str = "billeter-plv-paper-adaptive";
pub(super) const QUADRATURE: &str = "billeter-plv-paper-quadrature";
/// Steps of the marches that it is held against.
pub(super) const STEPS_OF_MARCH: [u32; 5] = [16, 64, 256, 512, 1024];

/// Number of a scene among those of [`scenes`]: the figure's own.
const FIGURE: usize = 1;

/// One case.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    pub group: Group,
    pub triangles: usize,
    pub lights: usize,
    pub name: String,
    pub shadow_map_size: u32,
    pub frames: usize,
    /// The technique's own passes; wall time without timestamps.
    pub technique_ms: Spread,
    pub frame_ms: Spread,
    /// Of the airlight at time 0; null for other scenes than the figure's.
    pub rel_rmse: Option<f64>,
    pub bias: Option<f64>,
    /// Round by round.
    pub technique_samples_ms: Vec<f64>,
    pub frame_samples_ms: Vec<f64>,
}

/// All of it.
pub(super) struct Measured {
    pub rows: Vec<Row>,
    /// Relative RMS difference between table and quadrature on the same mesh.
    pub table_error: f64,
    /// Error that the reference itself may have.
    pub uncertainty: f64,
}

/// What is measured: a scene, a method, a size of shadow maps.
struct Case {
    group: Group,
    scene: usize,
    name: String,
    map: u32,
}

/// The figure's scene between one with fewer and one with more triangles, and with fewer and more lights.
fn scenes() -> Vec<Scene> {
    let mut scenes: Vec<Scene> = COUNTS.map(cathedral).into();
    for lights in [LIGHTS[0], LIGHTS[2]] {
        let mut scene = cathedral(TRIANGLES);
        scene.lights = scene.lights.iter().cycle().take(lights).cloned().collect();
        // Lights that are gone can't move.
        scene.animation.clear();
        scenes.push(scene);
    }
    scenes
}

fn cases() -> Vec<Case> {
    let case = |group, scene, name: &str, map| Case { group, scene, name: name.into(), map };
    let maps = |name: &'static str| MAPS.map(|map| case(Group::Maps, FIGURE, name, map));
    let mut cases: Vec<Case> = maps(PAPER).into_iter().chain(maps(ADAPTIVE)).collect();
    cases.extend([0, 1, 2].map(|scene| case(Group::Triangles, scene, PAPER, SMALL_MAP)));
    cases.extend([3, FIGURE, 4].map(|scene| case(Group::Lights, scene, PAPER, SMALL_MAP)));
    let march = |name: &str| case(Group::Marches, FIGURE, name, SHADOW_MAP);
    cases.extend([PAPER, QUADRATURE, super::DEFAULT].map(march));
    for technique in ["ray-march", "ray-march-equiangular"] {
        cases.extend(STEPS_OF_MARCH.map(|steps| march(&format!("{technique}-{steps}"))));
    }
    cases
}

impl Measured {
    /// Takes all errors, then all times in turn.
    pub(super) fn take(press: &Press<'_>) -> Result<Self, Failure> {
        let (scenes, cases) = (scenes(), cases());
        press.progress.doing("errors");
        let figure = scenes[FIGURE].at(0.0);
        let view = figure.camera.view(press.timed_size.0, press.timed_size.1);
        let rendered = reference(&figure, &view, Term::Airlight.into(), &|share| {
            press.progress.detail(format!("cathedral: reference, {:.0} %", 100.0 * share));
        })?;
        let truth = rendered.airlight.ok_or_else(|| Failure::Run("the reference lacks a term".into()))?;
        let (mut times, mut images) = (Vec::new(), Vec::new());
        press.progress.step();
        for group in GROUPS {
            press.progress.doing(&format!("times: {group:?}"));
            let of_group: Vec<&Case> = cases.iter().filter(|case| case.group == group).collect();
            let (drawn, taken) = draw(press, &scenes, &of_group)?;
            images.extend(drawn);
            times.extend(taken);
            press.progress.step();
        }

        let error = |image: &Image, truth: &Image| {
            metrics::compare(image, truth).map_err(|error| Failure::Run(error.to_string()))
        };
        let mut rows = Vec::new();
        for ((case, times), image) in cases.iter().zip(&times).zip(&images) {
            let errors = image.as_ref().map(|image| error(image, &truth)).transpose()?;
            rows.push(Row::of(case, &scenes[case.scene], times, errors));
        }
        let image = |name: &str| {
            let index = cases.iter().position(|case| case.group == Group::Marches && case.name == name);
            let found = index.and_then(|index| images[index].as_ref());
            found.ok_or_else(|| Failure::Run(format!("{name} was not drawn")))
        };
        let table_error = error(image(PAPER)?, image(QUADRATURE)?)?.rel_rmse;
        Ok(Self { rows, table_error, uncertainty: rendered.uncertainty })
    }

    /// The row of a method on the figure's scene; of the first case, if it is not among them.
    pub(super) fn row(&self, group: Group, name: &str, map: u32) -> &Row {
        self.pick(|row| row.group == group && row.name == name && row.shadow_map_size == map)
    }

    /// The scene of so many lights.
    pub(super) fn with_lights(&self, lights: usize) -> &Row {
        self.pick(|row| row.group == Group::Lights && row.lights == lights)
    }

    /// The scene of about so many triangles.
    pub(super) fn with_triangles(&self, triangles: u32) -> &Row {
        let near = |row: &Row| (row.triangles as f64 / f64::from(triangles)).ln().abs() < 0.3;
        self.pick(|row| row.group == Group::Triangles && near(row))
    }

    fn pick(&self, wanted: impl Fn(&Row) -> bool) -> &Row {
        self.rows.iter().find(|row| wanted(row)).unwrap_or(&self.rows[0])
    }
}

/// The figure's pictures among the cases, and the times of all of them in turn.
fn draw(
    press: &Press<'_>,
    scenes: &[Scene],
    cases: &[&Case],
) -> Result<(Vec<Option<Image>>, Vec<Times>), Failure> {
    let mut grounds: Vec<(usize, u32)> = Vec::new();
    let (mut stages, mut turns, mut images) = (Vec::new(), Vec::new(), Vec::new());
    let (device, queue) = (&press.context.device, &press.context.queue);
    for case in cases {
        interrupt::check()?;
        let ground = (case.scene, case.map);
        let stage = match grounds.iter().position(|known| *known == ground) {
            Some(stage) => stage,
            None => {
                grounds.push(ground);
                stages.push(Stage::new(press.context, &scenes[case.scene], press.timed_size, case.map)?);
                stages.len() - 1
            }
        };
        let method = techniques::find_one(&case.name).map_err(Failure::Run)?;
        let format = press.context.radiance_format();
        let mut technique = method.make(device, queue, format, press.timed_size).map_err(Failure::Run)?;
        images.push(if case.scene == FIGURE {
            Some(stages[stage].picture(Some(technique.as_mut()), 0.0, Drawn::Airlight)?)
        } else {
            None
        });
        turns.push(Turn { stage, technique });
    }
    let times = times_in_turn(&mut stages, &mut turns, &press.frames.within(BUDGET))?;
    Ok((images, times))
}

impl Row {
    fn of(case: &Case, scene: &Scene, times: &Times, errors: Option<metrics::Errors>) -> Self {
        let technique = if times.passes_total.is_empty() { &times.wall } else { &times.passes_total };
        Self {
            group: case.group,
            triangles: scene.triangle_count(),
            lights: scene.lights.len(),
            name: case.name.clone(),
            shadow_map_size: case.map,
            frames: times.frame.len(),
            technique_ms: Spread::of(technique),
            frame_ms: Spread::of(&times.frame),
            rel_rmse: errors.as_ref().map(|errors| errors.rel_rmse),
            bias: errors.as_ref().map(|errors| errors.bias),
            technique_samples_ms: technique.clone(),
            frame_samples_ms: times.frame.clone(),
        }
    }
}
