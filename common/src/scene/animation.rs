//! Motion: lights, objects, camera and medium as functions of time.
//!
//! A track is a pure function of the base scene and the time, so frame n is the same on every
//! machine. Tracks are applied in their order: two of them on one target add up, the second starting
//! from what the first has made.

use std::f32::consts::TAU;

use glam::{Affine3A, Quat, Vec3};
use serde::{Deserialize, Serialize};

use super::Scene;
use crate::Light;

/// One thing that moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Track {
    /// What moves.
    pub target: Target,
    /// How it moves.
    pub motion: Motion,
}

/// What a track moves. Each is a place, a direction, an angle or a factor; see [`Motion`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Target {
    /// Place \[m\] of a point or spot light.
    LightPosition {
        /// Index into [`Scene::lights`].
        light: usize,
    },
    /// Direction of a spot or directional light; made a unit vector.
    LightDirection {
        /// Index into [`Scene::lights`].
        light: usize,
    },
    /// Factor on a light's intensity or irradiance; 1 is the base scene's.
    LightIntensity {
        /// Index into [`Scene::lights`].
        light: usize,
    },
    /// Place of all objects of a name: a shift \[m\] from where the base scene has them.
    ObjectTranslation {
        /// [`Object::name`](super::Object::name).
        object: String,
    },
    /// Turn \[rad\] of all objects of a name about an axis, from how the base scene has them.
    ObjectRotation {
        /// [`Object::name`](super::Object::name).
        object: String,
        /// A point of the axis, in the world \[m\].
        centre: Vec3,
        /// Direction of the axis, in the world; not zero.
        axis: Vec3,
    },
    /// Place of the eye \[m\].
    CameraEye,
    /// Place that the camera looks at \[m\].
    CameraTarget,
    /// Factor on both coefficients of the medium; 1 is the base scene's.
    MediumDensity,
}

/// A number (angle, factor) or three of them (place, shift, direction).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// Angle \[rad\] or factor.
    Scalar(f32),
    /// Place or shift \[m\], or direction.
    Vector(Vec3),
}

/// A value at a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Key {
    /// Time \[s\].
    pub time: f32,
    /// Value of the target at that time.
    pub value: Value,
}

/// How a target changes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Motion {
    /// From key to key along a line; before the first key and after the last one at rest. The values
    /// take the place of the base scene's; for objects they are shifts or angles from it.
    Keyframes {
        /// At least one, their times rising.
        keys: Vec<Key>,
    },
    /// Around an axis at a constant rate, counter-clockwise seen from where the axis points. For a
    /// place the radius is its distance from the axis at time 0; a direction or an angle turns on
    /// the spot (an angle without use of `centre` and `axis`). Not for a factor.
    Orbit {
        /// A point of the axis \[m\].
        #[serde(default)]
        centre: Vec3,
        /// Direction of the axis; not zero.
        #[serde(default = "up")]
        axis: Vec3,
        /// Time for one turn \[s\], not 0; negative is clockwise.
        period: f32,
    },
    /// The base value plus `amplitude · sin(2π time / period)`.
    Oscillate {
        /// Largest change, in the unit of the target.
        amplitude: Value,
        /// Time for one swing to and fro \[s\], not 0.
        period: f32,
    },
}

fn up() -> Vec3 {
    Vec3::Y
}

/// What kind of value a target takes.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Place,
    Direction,
    Angle,
    Factor,
}

impl Target {
    fn kind(&self) -> Kind {
        match self {
            Self::LightPosition { .. } | Self::ObjectTranslation { .. } => Kind::Place,
            Self::CameraEye | Self::CameraTarget => Kind::Place,
            Self::LightDirection { .. } => Kind::Direction,
            Self::ObjectRotation { .. } => Kind::Angle,
            Self::LightIntensity { .. } | Self::MediumDensity => Kind::Factor,
        }
    }
}

impl Track {
    /// Puts the thing into its place at `time` \[s\]. A target that is not in the scene, or a motion
    /// that does not fit it, changes nothing; [`Track::problem`] says so.
    pub fn apply(&self, scene: &mut Scene, time: f32) {
        match &self.target {
            Target::LightPosition { light } => match scene.lights.get_mut(*light) {
                Some(Light::Point(light)) => self.motion.move_place(&mut light.position, time),
                Some(Light::Spot(light)) => self.motion.move_place(&mut light.position, time),
                _ => {}
            },
            Target::LightDirection { light } => match scene.lights.get_mut(*light) {
                Some(Light::Spot(light)) => {
                    // What is up in the light map turns with the cone.
                    let turn = self.motion.turn(&mut light.direction, time);
                    light.up = turn * light.up;
                }
                Some(Light::Directional(light)) => {
                    self.motion.turn(&mut light.direction, time);
                }
                _ => {}
            },
            Target::LightIntensity { light } => {
                let factor = self.motion.scalar(1.0, time).max(0.0);
                match scene.lights.get_mut(*light) {
                    Some(Light::Point(light)) => light.intensity *= factor,
                    Some(Light::Spot(light)) => light.intensity *= factor,
                    Some(Light::Directional(light)) => light.irradiance *= factor,
                    None => {}
                }
            }
            Target::ObjectTranslation { object } => {
                for object in scene.objects.iter_mut().filter(|o| o.name == *object) {
                    let base = Vec3::from(object.world_from_object.translation);
                    let mut place = base;
                    match &self.motion {
                        Motion::Keyframes { .. } => {
                            let mut shift = Vec3::ZERO;
                            self.motion.move_place(&mut shift, time);
                            place += shift;
                        }
                        _ => self.motion.move_place(&mut place, time),
                    }
                    object.world_from_object.translation = place.into();
                }
            }
            Target::ObjectRotation { object, centre, axis } => {
                let Some(axis) = axis.try_normalize() else { return };
                let angle = self.motion.scalar(0.0, time);
                let turn = Affine3A::from_translation(*centre)
                    * Affine3A::from_quat(Quat::from_axis_angle(axis, angle))
                    * Affine3A::from_translation(-*centre);
                // Left alone at angle 0, so that rounding does not move it.
                for object in scene.objects.iter_mut().filter(|o| o.name == *object && angle != 0.0) {
                    object.world_from_object = turn * object.world_from_object;
                }
            }
            Target::CameraEye => self.motion.move_place(&mut scene.camera.eye, time),
            Target::CameraTarget => self.motion.move_place(&mut scene.camera.target, time),
            Target::MediumDensity => {
                let factor = self.motion.scalar(1.0, time).max(0.0);
                scene.medium.sigma_s *= factor;
                scene.medium.sigma_a *= factor;
            }
        }
    }

    /// What is wrong with this track in this scene, if anything: one clause, to be put behind its
    /// name.
    pub fn problem(&self, scene: &Scene) -> Option<String> {
        self.target.problem(scene).or_else(|| self.motion.problem(self.target.kind()))
    }
}

impl Target {
    fn problem(&self, scene: &Scene) -> Option<String> {
        let object_problem = |name: &String| {
            let known = scene.objects.iter().any(|object| object.name == *name);
            (!known).then(|| format!("moves the object `{name}`, which is not in the scene"))
        };
        match self {
            Self::LightPosition { light }
            | Self::LightDirection { light }
            | Self::LightIntensity { light } => {
                let moves = match self {
                    Self::LightPosition { .. } => "position",
                    Self::LightDirection { .. } => "direction",
                    _ => "intensity",
                };
                match scene.lights.get(*light) {
                    None => {
                        let count = scene.lights.len();
                        Some(format!("moves light {light}, but the scene has {count} (counted from 0)"))
                    }
                    Some(Light::Point(_)) if moves == "direction" => {
                        Some(format!("moves the direction of light {light}, which is a point light"))
                    }
                    Some(Light::Directional(_)) if moves == "position" => {
                        Some(format!("moves the position of light {light}, which is directional"))
                    }
                    Some(_) => None,
                }
            }
            Self::ObjectTranslation { object } => object_problem(object),
            Self::ObjectRotation { object, centre, axis } => {
                if !centre.is_finite() || axis.try_normalize().is_none() {
                    return Some("turns about an axis that is zero or not finite".into());
                }
                object_problem(object)
            }
            Self::CameraEye | Self::CameraTarget | Self::MediumDensity => None,
        }
    }
}

impl Motion {
    fn problem(&self, kind: Kind) -> Option<String> {
        let value_problem = |value: &Value| match (value, kind) {
            (Value::Scalar(_), Kind::Place | Kind::Direction) => {
                Some("has a number where three belong".into())
            }
            (Value::Vector(_), Kind::Angle | Kind::Factor) => {
                Some("has three numbers where one belongs".into())
            }
            (Value::Scalar(x), _) if !x.is_finite() => Some("has a value that is not finite".into()),
            (Value::Scalar(x), Kind::Factor) if *x < 0.0 => {
                Some(format!("has a factor of {x}, which is negative"))
            }
            (Value::Vector(v), _) if !v.is_finite() => Some("has a value that is not finite".into()),
            _ => None,
        };
        let period_problem = |period: f32| {
            (period == 0.0 || !period.is_finite()).then(|| format!("has a period of {period} s"))
        };
        match self {
            Self::Keyframes { keys } => {
                if keys.is_empty() {
                    return Some("has no keys".into());
                }
                if keys.iter().any(|key| !key.time.is_finite())
                    || keys.windows(2).any(|pair| pair[0].time >= pair[1].time)
                {
                    return Some("has keys whose times do not rise".into());
                }
                keys.iter().find_map(|key| value_problem(&key.value))
            }
            Self::Orbit { .. } if kind == Kind::Factor => Some("lets a factor orbit".into()),
            Self::Orbit { centre, axis, period } => {
                if !centre.is_finite() || axis.try_normalize().is_none() {
                    return Some("orbits an axis that is zero or not finite".into());
                }
                period_problem(*period)
            }
            Self::Oscillate { amplitude: Value::Scalar(x), .. } if kind == Kind::Factor && x.abs() > 1.0 => {
                Some(format!("has an amplitude of {x}, which makes a factor negative"))
            }
            Self::Oscillate { amplitude, period } => {
                value_problem(amplitude).or_else(|| period_problem(*period))
            }
        }
    }

    /// A place \[m\] at `time` \[s\].
    fn move_place(&self, place: &mut Vec3, time: f32) {
        match self {
            Self::Keyframes { keys } => {
                if let Some(Value::Vector(value)) = key_value(keys, time) {
                    *place = value;
                }
            }
            Self::Orbit { centre, axis, period } => {
                let turns = fraction(time, *period);
                if let (Some(axis), true) = (axis.try_normalize(), turns != 0.0) {
                    *place = *centre + Quat::from_axis_angle(axis, TAU * turns) * (*place - *centre);
                }
            }
            Self::Oscillate { amplitude: Value::Vector(amplitude), period } => {
                *place += *amplitude * (TAU * fraction(time, *period)).sin();
            }
            Self::Oscillate { .. } => {}
        }
    }

    /// A unit direction at `time` \[s\]; returns the turn that was made.
    fn turn(&self, direction: &mut Vec3, time: f32) -> Quat {
        let turn = match self {
            Self::Orbit { axis, period, .. } => match axis.try_normalize() {
                Some(axis) => Quat::from_axis_angle(axis, TAU * fraction(time, *period)),
                None => Quat::IDENTITY,
            },
            _ => {
                let mut to = *direction;
                self.move_place(&mut to, time);
                match to.try_normalize() {
                    Some(to) if to != *direction => Quat::from_rotation_arc(*direction, to),
                    _ => Quat::IDENTITY,
                }
            }
        };
        if turn != Quat::IDENTITY {
            *direction = (turn * *direction).normalize();
        }
        turn
    }

    /// An angle or a factor at `time` \[s\].
    fn scalar(&self, base: f32, time: f32) -> f32 {
        match self {
            Self::Keyframes { keys } => match key_value(keys, time) {
                Some(Value::Scalar(value)) => value,
                _ => base,
            },
            // Only an angle can orbit; for a factor it is a problem that `problem` reports.
            Self::Orbit { period, .. } if base == 0.0 => TAU * fraction(time, *period),
            Self::Oscillate { amplitude: Value::Scalar(amplitude), period } => {
                base + amplitude * (TAU * fraction(time, *period)).sin()
            }
            _ => base,
        }
    }
}

/// Part of the period that has passed, in [0, 1): whole periods are dropped before any sine, so that
/// late frames are as exact as early ones.
fn fraction(time: f32, period: f32) -> f32 {
    let turns = f64::from(time) / f64::from(period);
    if turns.is_finite() { (turns - turns.floor()) as f32 } else { 0.0 }
}

/// Value between the two keys around `time` \[s\].
fn key_value(keys: &[Key], time: f32) -> Option<Value> {
    let after = keys.partition_point(|key| key.time <= time);
    let (Some(low), Some(high)) = (keys.get(after.saturating_sub(1)), keys.get(after).or(keys.last())) else {
        return None;
    };
    let span = high.time - low.time;
    let along = if span > 0.0 { ((time - low.time) / span).clamp(0.0, 1.0) } else { 0.0 };
    match (low.value, high.value) {
        (Value::Scalar(a), Value::Scalar(b)) => Some(Value::Scalar(a + (b - a) * along)),
        (Value::Vector(a), Value::Vector(b)) => Some(Value::Vector(a.lerp(b, along))),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
