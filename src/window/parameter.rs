//! What a right click on a control does: resets its parameter, or copies its path.

use crate::io::scene_file::{self, ParameterPath};
use crate::scene::description::SceneDescription;
use egui::{Id, Response, Sense};

/// Ties the control of that name to a parameter of the scene: a right click resets it or copies
/// its path. An empty path is no parameter's.
pub(super) fn parameter(response: &Response, label: &str, path: &str) {
    if path.is_empty() {
        return;
    }
    #[cfg(test)]
    super::tests::parameters::note(&response.ctx, label, path);
    #[cfg(not(test))]
    let _ = label;
    // A slider by itself feels drags alone.
    let clickable = (!response.sense.senses_click()).then(|| response.interact(Sense::click()));
    let response = clickable.as_ref().unwrap_or(response);
    // Beside the popup that lists and swatches open themselves.
    let menu = egui::Popup::context_menu(response).id(response.id.with("parameter"));
    menu.show(|ui| {
        let has_default = path.parse().is_ok_and(|path| scene_file::has_default(&path));
        let reset = ui.add_enabled(has_default, egui::Button::new("Reset"));
        if reset
            .on_hover_text("the value of a scene file that does not say")
            .on_disabled_hover_text("has no usual value")
            .clicked()
        {
            ui.data_mut(|data| data.insert_temp(reset_id(), path.to_owned()));
        }
        if ui.button("Copy path").on_hover_text(path).clicked() {
            ui.copy_text(path.to_owned());
        }
    });
}

/// Gives the parameter its default whose reset was asked for in this frame.
///
/// # Errors
/// Where the scene would not be valid then, in words.
pub(super) fn take_reset(ctx: &egui::Context, scene: &mut SceneDescription) -> Result<(), String> {
    let asked = ctx.data_mut(|data| data.remove_temp::<String>(reset_id()));
    let Some(path) = asked else { return Ok(()) };
    let path: ParameterPath = path.parse().map_err(|error| format!("{error}"))?;
    *scene = scene_file::with_default(scene, &path).map_err(|error| error.to_string())?;
    Ok(())
}

fn reset_id() -> Id {
    Id::unique("reset a parameter")
}
