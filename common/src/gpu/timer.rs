//! GPU time by pass, from timestamp queries where the adapter has them.

use std::collections::BTreeMap;

use super::readback::read_bytes;

/// Collects the begin and end of every pass of one frame.
///
/// Ask it for the `timestamp_writes` of each pass, then [`PassTimer::resolve`] in the same encoder,
/// submit, and [`PassTimer::read`]. [`PassTimer::off`] answers `None` to everything.
pub struct PassTimer {
    queries: Option<Queries>,
    labels: Vec<&'static str>,
}

struct Queries {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    nanoseconds_per_tick: f32,
}

/// Passes of one frame that are timed; later ones are not.
const CAPACITY: u32 = 512;

impl PassTimer {
    /// A timer, if the device has timestamp queries; else the same as [`PassTimer::off`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let queries = device.features().contains(wgpu::Features::TIMESTAMP_QUERY).then(|| Queries {
            set: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("common: pass timer"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * CAPACITY,
            }),
            resolved: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("common: pass times"),
                size: u64::from(2 * CAPACITY) * 8,
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            nanoseconds_per_tick: queue.get_timestamp_period(),
        });
        Self { queries, labels: Vec::new() }
    }

    /// A timer that measures nothing.
    pub fn off() -> Self {
        Self { queries: None, labels: Vec::new() }
    }

    /// Whether it measures.
    pub fn is_on(&self) -> bool {
        self.queries.is_some()
    }

    /// For `RenderPassDescriptor::timestamp_writes`.
    pub fn render(&mut self, label: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let begin = self.begin(label)?;
        self.queries.as_ref().map(|queries| wgpu::RenderPassTimestampWrites {
            query_set: &queries.set,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(begin + 1),
        })
    }

    /// For `ComputePassDescriptor::timestamp_writes`.
    pub fn compute(&mut self, label: &'static str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let begin = self.begin(label)?;
        self.queries.as_ref().map(|queries| wgpu::ComputePassTimestampWrites {
            query_set: &queries.set,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(begin + 1),
        })
    }

    fn begin(&mut self, label: &'static str) -> Option<u32> {
        self.queries.as_ref()?;
        let index = self.labels.len() as u32;
        (index < CAPACITY).then(|| {
            self.labels.push(label);
            2 * index
        })
    }

    /// Encodes what makes the times readable; once, after the last pass.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(queries) = &self.queries
            && !self.labels.is_empty()
        {
            encoder.resolve_query_set(&queries.set, 0..2 * self.labels.len() as u32, &queries.resolved, 0);
        }
    }

    /// Milliseconds by label, passes of one label added up; waits for the device, and starts afresh.
    pub fn read(&mut self, device: &wgpu::Device, queue: &wgpu::Queue) -> BTreeMap<&'static str, f64> {
        let mut times = BTreeMap::new();
        let labels = std::mem::take(&mut self.labels);
        let Some(queries) = &self.queries else { return times };
        let Some(bytes) = read_bytes(device, queue, &queries.resolved, 16 * labels.len() as u64) else {
            return times;
        };
        let ticks: Vec<u64> =
            bytes.chunks_exact(8).map(|b| u64::from_le_bytes(b.try_into().unwrap_or_default())).collect();
        for (label, pair) in labels.into_iter().zip(ticks.chunks_exact(2)) {
            let nanoseconds =
                pair[1].saturating_sub(pair[0]) as f64 * f64::from(queries.nanoseconds_per_tick);
            *times.entry(label).or_insert(0.0) += nanoseconds * 1e-6;
        }
        times
    }
}
