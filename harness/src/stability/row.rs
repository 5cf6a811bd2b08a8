//! A row of the atlas: one way to break a method, swept from harmless to absurd.

use common::Scene;

use crate::techniques::Method;

/// One way to break a method.
pub(crate) struct Row {
    /// Short name, for files and the command line.
    pub id: &'static str,
    /// Part of the atlas.
    pub part: Part,
    /// What is done, in a few words.
    pub title: &'static str,
    /// What may go wrong, and why.
    pub why: &'static str,
    pub parameter: Parameter,
    /// Values that the quick form measures.
    pub quick: &'static [f64],
    /// The scene at a value of the parameter.
    pub build: fn(f64) -> Setup,
    pub measure: Measure,
    /// Who is measured at a value.
    pub methods: fn(f64) -> Vec<Entry>,
    /// What the promised figures are multiplied by at a value, where a law is known.
    pub law: fn(f64) -> f64,
}

impl Row {
    /// What most rows of a part have in common.
    pub(crate) fn of(part: Part) -> Self {
        Self {
            id: "",
            part,
            title: "",
            why: "",
            parameter: Parameter::Choice { name: "", values: &[] },
            quick: &[],
            build: |_| Setup::returning([], |_| Scene::empty("")),
            measure: Measure::Error,
            methods: all,
            law: |_| 1.0,
        }
    }
}

/// What the rows of the atlas are grouped by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    Light,
    Medium,
    Scale,
    Shadows,
    Casters,
    Load,
    Motion,
    Clouds,
    Settings,
}

impl Part {
    pub(crate) const ALL: [Self; 9] = [
        Self::Light,
        Self::Medium,
        Self::Scale,
        Self::Shadows,
        Self::Casters,
        Self::Load,
        Self::Motion,
        Self::Clouds,
        Self::Settings,
    ];

    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Light => "Where light and eye are",
            Self::Medium => "The medium",
            Self::Scale => "Scale and place",
            Self::Shadows => "Shadows",
            Self::Casters => "What casts them",
            Self::Load => "How much, and of what size",
            Self::Motion => "Motion and repetition",
            Self::Clouds => "Clouds",
            Self::Settings => "A method's own settings",
        }
    }
}

/// What is swept.
#[derive(Clone, Copy)]
pub(crate) enum Parameter {
    /// A number, its harmless values first.
    Number { name: &'static str, unit: &'static str, values: &'static [f64] },
    /// One of several things; the value is its index.
    Choice { name: &'static str, values: &'static [&'static str] },
}

impl Parameter {
    pub(crate) fn name(&self) -> &'static str {
        let (Self::Number { name, .. } | Self::Choice { name, .. }) = self;
        name
    }

    /// All values, harmless ones first.
    pub(crate) fn values(&self) -> Vec<f64> {
        match self {
            Self::Number { values, .. } => values.to_vec(),
            Self::Choice { values, .. } => (0..values.len()).map(|index| index as f64).collect(),
        }
    }

    /// A value in words, without its unit.
    pub(crate) fn label(&self, value: f64) -> String {
        match self {
            Self::Number { .. } if value == 0.0 => "0".into(),
            Self::Number { .. } if (1e-3..1e5).contains(&value.abs()) => {
                let text = format!("{value:.4}");
                text.trim_end_matches('0').trim_end_matches('.').into()
            }
            Self::Number { .. } => format!("{value:.0e}"),
            Self::Choice { values, .. } => values.get(value as usize).copied().unwrap_or("?").into(),
        }
    }

    pub(crate) fn unit(&self) -> &'static str {
        match self {
            Self::Number { unit, .. } => unit,
            Self::Choice { .. } => "",
        }
    }
}

/// What a figure is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Measure {
    /// Relative RMSE of the airlight; where all should be black, RMS over the mean of the lit scene.
    Error,
    /// RMS of the relative errors of the lit pixels, where some are brighter than all others together.
    Relative,
    /// RMS of how much more a picture changes from frame to frame than the reference, over the reference's mean.
    Flicker,
    /// Largest difference between two pictures of the same, over the brightest pixel.
    Return,
    /// Growth of what the program has on heap and device over the second half of the frames \[bytes a frame\].
    Memory,
    /// Nothing but whether the picture is sound: what is right is not known.
    Sound,
}

impl Measure {
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Error => "relative RMSE",
            Self::Relative => "RMS of relative errors",
            Self::Flicker => "flicker: RMS of change beyond the reference's, over its mean",
            Self::Return => "largest difference, over the brightest pixel",
            Self::Memory => "memory growth, bytes a frame",
            Self::Sound => "broken pixels, share of all",
        }
    }

    /// Whether it is a share of the picture's light.
    pub(crate) fn relative(self) -> bool {
        self != Self::Memory
    }
}

/// What is drawn at a value, and what it is held against.
pub(crate) struct Setup {
    /// Frames, drawn one after the other by the same renderer; most rows have one.
    pub frames: Vec<Still>,
    pub truth: Truth,
    /// Texels on a side of the shadow maps.
    pub shadow_map: u32,
    /// Format of the target; the adapter's best without.
    pub format: Option<wgpu::TextureFormat>,
}

/// One frame.
#[derive(Clone)]
pub(crate) struct Still {
    pub scene: Scene,
    /// \[pixels\].
    pub size: (u32, u32),
    /// Frames of one place have one picture.
    pub place: u32,
}

impl Still {
    pub(crate) fn of(scene: Scene) -> Self {
        Self { scene, size: SIZE, place: 0 }
    }
}

/// What a picture should be.
pub(crate) enum Truth {
    /// The reference of the same scene.
    Own,
    /// The reference of the same scene, but for these pixels: what is right there has no bound.
    OwnBut(Vec<(u32, u32)>),
    /// The reference of another scene that has the same picture.
    Of(Box<Scene>),
    /// The reference of the same scene in pictures of which each is every n-th pixel of the drawn one, n odd.
    Thinned(u32),
    /// Black; the figure is relative to this scene's mean.
    Black(Box<Scene>),
    /// Not known.
    Unknown,
}

/// A method in a column of the matrix.
pub(crate) struct Entry {
    pub column: &'static str,
    pub method: Method,
}

/// Size of most pictures: odd, so that the middle of a pixel is the middle of the picture.
pub(crate) const SIZE: (u32, u32) = (97, 77);
/// Texels of most shadow maps.
pub(crate) const SHADOW_MAP: u32 = 1024;

impl Setup {
    /// One picture of a scene, held against its own reference.
    pub(crate) fn of(scene: Scene) -> Self {
        Self { frames: vec![Still::of(scene)], truth: Truth::Own, shadow_map: SHADOW_MAP, format: None }
    }

    /// Pictures of places, some of them more than once: those are to be the same.
    pub(crate) fn returning(places: impl IntoIterator<Item = u32>, scene: impl Fn(u32) -> Scene) -> Self {
        let still = |place| Still { place, ..Still::of(scene(place)) };
        let frames = places.into_iter().map(still).collect();
        Self { frames, truth: Truth::Unknown, shadow_map: SHADOW_MAP, format: None }
    }

    /// Pictures of a motion, held against the reference's.
    pub(crate) fn moving(count: u32, scene: impl Fn(u32) -> Scene) -> Self {
        Self::returning(0..count, scene).against(Truth::Own)
    }

    /// All frames in another size.
    pub(crate) fn of_size(mut self, size: (u32, u32)) -> Self {
        self.frames.iter_mut().for_each(|still| still.size = size);
        self
    }

    pub(crate) fn against(self, truth: Truth) -> Self {
        Self { truth, ..self }
    }

    pub(crate) fn on_maps_of(self, shadow_map: u32) -> Self {
        Self { shadow_map, ..self }
    }
}

/// Columns of the matrix, in order; the first four are the techniques' defaults.
pub(crate) const COLUMNS: [&str; 14] = [
    "billeter-plv-default",
    "biri-ss-default",
    "chen-planes-default",
    "szk-network-default",
    "lit-intervals",
    "billeter-plv-paper",
    "biri-ss-paper",
    "chen-planes-paper",
    "szk-network-paper",
    "ray-march-64",
    "ray-march-offset-64",
    "ray-march-equiangular-offset-64",
    "froxels-8x64",
    "unshadowed",
];

/// Columns that the quick form measures: what something is promised of.
pub(crate) const PROMISED: [&str; 5] = [COLUMNS[0], COLUMNS[1], COLUMNS[2], COLUMNS[3], COLUMNS[4]];

/// The columns of that name, in their settings.
pub(crate) fn named(columns: &[&'static str]) -> Vec<Entry> {
    let of = |column: &&'static str| {
        crate::techniques::find_one(column).ok().map(|method| Entry { column, method })
    };
    columns.iter().filter_map(of).collect()
}

/// All that draw homogeneous media with shadows.
pub(crate) fn all(_: f64) -> Vec<Entry> {
    let shadowed: Vec<&str> = COLUMNS
        .into_iter()
        .filter(|column| !column.starts_with("szk-network") && *column != "unshadowed")
        .collect();
    named(&shadowed)
}

/// All that draw homogeneous media, where nothing casts a shadow.
pub(crate) fn all_and_unshadowed(_: f64) -> Vec<Entry> {
    let columns: Vec<&str> =
        COLUMNS.into_iter().filter(|column| !column.starts_with("szk-network")).collect();
    named(&columns)
}

/// The defaults of the three techniques for homogeneous media, and the lit intervals.
pub(crate) fn defaults(_: f64) -> Vec<Entry> {
    named(&[COLUMNS[0], COLUMNS[1], COLUMNS[2], COLUMNS[4]])
}

/// The two settings for clouds.
pub(crate) fn clouds(_: f64) -> Vec<Entry> {
    named(&[COLUMNS[3], COLUMNS[8]])
}
