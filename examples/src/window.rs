//! The same renderer in a window.

use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context, Result, anyhow};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Window, WindowId};

use crate::engine::{Engine, Settings, Show};
use crate::gpu::Gpu;
use crate::passes::tone_pipeline;
use crate::sequence::BOTH;

/// Opens a window of `size` \[pixels\] and draws until it is closed.
pub fn run(settings: Settings, size: [u32; 2]) -> Result<()> {
    let events = EventLoop::new().map_err(|_| {
        anyhow!("there is no display to open a window on; draw into a file with --out instead")
    })?;
    events.set_control_flow(ControlFlow::Poll);
    let mut program = Program { settings, size, drawing: None, result: Ok(()) };
    events.run_app(&mut program).context("the window's events ended")?;
    program.result
}

struct Program {
    settings: Settings,
    size: [u32; 2],
    drawing: Option<Drawing>,
    /// What the window's events can't return.
    result: Result<()>,
}

/// A window, and what draws in it.
struct Drawing {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    configuration: wgpu::SurfaceConfiguration,
    gpu: Gpu,
    engine: Engine,
    tone: wgpu::RenderPipeline,
    show: Show,
    begun: Instant,
}

impl ApplicationHandler for Program {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.drawing.is_none() {
            match Drawing::new(events, self.settings, self.size) {
                Ok(drawing) => self.drawing = Some(drawing),
                Err(error) => self.end(events, Err(error)),
            }
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(drawing) = &mut self.drawing else { return };
        match event {
            WindowEvent::CloseRequested => self.end(events, Ok(())),
            WindowEvent::Resized(size) => drawing.resize(size),
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                let shafts = &mut drawing.show.shafts;
                match event.logical_key.as_ref() {
                    Key::Named(NamedKey::Escape) => self.end(events, Ok(())),
                    Key::Character("1") => shafts.lamp = !shafts.lamp,
                    Key::Character("2") => shafts.sun = !shafts.sun,
                    _ => {}
                }
            }
            WindowEvent::RedrawRequested => {
                if let Err(error) = drawing.draw() {
                    self.end(events, Err(error));
                }
            }
            _ => {}
        }
    }
}

impl Program {
    fn end(&mut self, events: &ActiveEventLoop, result: Result<()>) {
        self.result = result;
        // The surface goes before the window.
        self.drawing = None;
        events.exit();
    }
}

impl Drawing {
    fn new(events: &ActiveEventLoop, settings: Settings, [width, height]: [u32; 2]) -> Result<Self> {
        let attributes = Window::default_attributes()
            .with_title("light in fog: 1 lamp, 2 sun")
            .with_inner_size(PhysicalSize::new(width, height));
        let window = Arc::new(events.create_window(attributes).context("no window could be opened")?);
        let display = Box::new(events.owned_display_handle());
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_with_display_handle(display));
        let surface = instance
            .create_surface(Arc::clone(&window))
            .context("the graphics driver can't draw in this window")?;
        let gpu = Gpu::open(&instance, Some(&surface))?;
        let size = window.inner_size();
        let [width, height] = [size.width.max(1), size.height.max(1)];
        let mut configuration = surface
            .get_default_config(&gpu.adapter, width, height)
            .context("the graphics driver can't draw in this window")?;
        // Tone mapping ends in linear light.
        let formats = surface.get_capabilities(&gpu.adapter).formats;
        if let Some(&format) = formats.iter().find(|format| format.is_srgb()) {
            configuration.format = format;
        }
        surface.configure(&gpu.device, &configuration);
        let engine = Engine::new(&gpu.device, &gpu.queue, settings, [width, height])?;
        let tone = tone_pipeline(&gpu.device, configuration.format);
        let show = Show { shafts: BOTH, casters: true };
        window.request_redraw();
        Ok(Self { window, surface, configuration, gpu, engine, tone, show, begun: Instant::now() })
    }

    fn resize(&mut self, PhysicalSize { width, height }: PhysicalSize<u32>) {
        // A window that is minimised has no pixels.
        if width == 0 || height == 0 || [width, height] == self.engine.size() {
            return;
        }
        (self.configuration.width, self.configuration.height) = (width, height);
        self.surface.configure(&self.gpu.device, &self.configuration);
        self.engine.resize([width, height]);
    }

    fn draw(&mut self) -> Result<()> {
        use wgpu::CurrentSurfaceTexture::{Lost, Outdated, Suboptimal, Success};
        self.window.request_redraw();
        let frame = match self.surface.get_current_texture() {
            Success(frame) | Suboptimal(frame) => frame,
            Outdated | Lost => {
                self.surface.configure(&self.gpu.device, &self.configuration);
                return Ok(());
            }
            // Another time.
            _ => return Ok(()),
        };
        self.engine.draw(self.begun.elapsed().as_secs_f32(), self.show)?;
        self.engine.show(&self.tone, &frame.texture.create_view(&Default::default()));
        self.gpu.queue.present(frame);
        Ok(())
    }
}
