//! The events of the system on their way to the window.

use super::keys::number_pad;
use eframe::{EframeWinitApplication, UserEvent};
use winit::application::ApplicationHandler;
use winit::event::{DeviceEvent, DeviceId, StartCause, WindowEvent};
use winit::event_loop::ActiveEventLoop;
use winit::window::WindowId;

/// Hands every event on; keys of the number pad are told apart from the others.
pub(super) struct Listening<'a>(pub(super) EframeWinitApplication<'a>);

impl ApplicationHandler<UserEvent> for Listening<'_> {
    fn window_event(&mut self, to: &ActiveEventLoop, window: WindowId, mut event: WindowEvent) {
        if let WindowEvent::KeyboardInput { event, .. } = &mut event {
            number_pad::tell_apart(event);
        }
        self.0.window_event(to, window, event);
    }

    fn new_events(&mut self, to: &ActiveEventLoop, cause: StartCause) {
        self.0.new_events(to, cause);
    }

    fn resumed(&mut self, to: &ActiveEventLoop) {
        self.0.resumed(to);
    }

    fn user_event(&mut self, to: &ActiveEventLoop, event: UserEvent) {
        self.0.user_event(to, event);
    }

    fn device_event(&mut self, to: &ActiveEventLoop, device: DeviceId, event: DeviceEvent) {
        self.0.device_event(to, device, event);
    }

    fn about_to_wait(&mut self, to: &ActiveEventLoop) {
        self.0.about_to_wait(to);
    }

    fn suspended(&mut self, to: &ActiveEventLoop) {
        self.0.suspended(to);
    }

    fn exiting(&mut self, to: &ActiveEventLoop) {
        self.0.exiting(to);
    }

    fn memory_warning(&mut self, to: &ActiveEventLoop) {
        self.0.memory_warning(to);
    }
}
