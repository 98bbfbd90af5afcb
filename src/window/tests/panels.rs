//! Each control of the panels changes the parameter that it names, and no other.

use super::bench::{
    ALL, Bench, CAMERA, DISPLAY, LIGHTS, MATERIALS, OBJECTS, RENDER, TEXTURES, bench, choose,
    harness, harness_of, noise, press, render_with, slide, type_figure,
};
use super::small_scene;
use crate::render::Noise;
use crate::scene::description::{
    ColorOrTexture, IntegratorKind, LightKind, ObjectKind, SceneDescription, ToneOperator, WardForm,
};
use crate::window::panels::SizeMode;
use crate::window::structure::Part;
use crate::window::views::View;
use egui::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;

#[test]
fn showing_a_panel_changes_nothing() {
    for panel in ALL {
        let mut harness = harness(panel);
        harness.run();
        assert_eq!(harness.state().scene, small_scene(), "a panel edits by being shown");
    }
}

#[test]
fn the_graph_of_noise_keeps_its_place_before_there_is_anything_to_show() {
    let estimates = [(1, noise(40.0)), (2, noise(20.0)), (8, noise(7.0))];
    let end_of = |noise: &'static [(u32, Noise)]| {
        let harness = Harness::builder().with_size([320.0, 1200.0]).build_ui_state(
            move |ui, bench: &mut Bench| {
                render_with(ui, bench, noise);
                ui.label("what comes next");
            },
            bench(small_scene()),
        );
        let graph = harness.get_by(|node| {
            node.role() == Role::Image && node.label().unwrap_or_default().starts_with("noise")
        });
        (graph.rect(), harness.get_by_label("what comes next").rect())
    };
    let all: &'static [(u32, Noise)] = Box::leak(Box::new(estimates));
    let known = end_of(all);
    for n_estimates in [0, 1] {
        assert_eq!(end_of(&all[..n_estimates]), known, "after {n_estimates} estimates");
    }
}

#[test]
fn the_graph_tells_each_estimate_under_the_cursor() {
    let mut harness = harness(RENDER);
    let graph = harness.get_by_label_contains("noise 20 ± 2 % at 1 samples, 10 ± 1 % at 4 samples");
    let rect = graph.rect();
    let n_rings = |harness: &Harness<'_, Bench>| {
        let is_ring = |shape: &egui::Shape| matches!(shape, egui::Shape::Circle(circle) if circle.fill.a() == 0);
        harness.output().shapes.iter().filter(|clipped| is_ring(&clipped.shape)).count()
    };
    harness.hover_at(rect.center() - egui::vec2(0.0, 200.0));
    harness.run_steps(6);
    assert_eq!(n_rings(&harness), 0, "an estimate is marked, though none is under the cursor");
    // One sample is at the left edge, four are at a quarter of the way to the goal of 256.
    for (share, told) in [(0.02, "20 ± 2 % at 1 samples"), (0.3, "10 ± 1 % at 4 samples")] {
        harness.hover_at(rect.left_center() + egui::vec2(rect.width() * share, 0.0));
        harness.run_steps(6);
        let is_told = harness.query_by_label(told).is_some();
        assert!(is_told, "{told:?} is not told at {share} of the width");
        assert_eq!(n_rings(&harness), 1, "the estimate is not marked");
    }
}

#[test]
fn typed_figures_keep_their_full_precision() {
    let mut harness = harness(CAMERA);
    type_figure(&mut harness, "Aperture", "0.012345678901234");
    let radius = harness.state().scene.camera.aperture_radius;
    assert_eq!(radius, 0.012345678901234, "rounded to {radius}");
}

#[test]
fn leaving_a_box_without_typing_rounds_nothing() {
    let mut harness = harness(CAMERA);
    harness.state_mut().scene.camera.aperture_radius = 0.123456789012345;
    harness.run();
    harness.get_by_role_and_label(Role::SpinButton, "Aperture").click();
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
    let radius = harness.state().scene.camera.aperture_radius;
    assert_eq!(radius, 0.123456789012345, "rounded to {radius}");
}

#[test]
fn the_lens_follows_its_controls() {
    let mut harness = harness(CAMERA);
    slide(&mut harness, "Aperture", 0.2);
    type_figure(&mut harness, "Focus", "4.5");
    type_figure(&mut harness, "Field of view", "55");
    type_figure(&mut harness, "Blades", "6");
    let mut expected = small_scene();
    expected.camera.aperture_radius = 0.2;
    expected.camera.focal_distance = Some(4.5);
    expected.camera.vertical_fov = 55.0;
    expected.camera.aperture_blades = 6;
    assert_eq!(harness.state().scene, expected, "the camera differs");
    press(&mut harness, "On target");
    assert_eq!(harness.state().scene.camera.focal_distance, None, "does not follow the target");
}

#[test]
fn figures_out_of_range_are_held_to_it() {
    let mut harness = harness(CAMERA);
    type_figure(&mut harness, "Field of view", "500");
    type_figure(&mut harness, "Aperture", "-3");
    type_figure(&mut harness, "Eye X", "nan");
    let camera = &harness.state().scene.camera;
    assert!(camera.vertical_fov < 180.0, "field of view {}", camera.vertical_fov);
    assert_eq!(camera.aperture_radius, 0.0, "a negative lens");
    assert_eq!(camera.eye, small_scene().camera.eye, "took a number that is none");
}

#[test]
fn lights_follow_their_controls() {
    let mut harness = harness(LIGHTS);
    type_figure(&mut harness, "Power", "250");
    type_figure(&mut harness, "Width", "2.5");
    type_figure(&mut harness, "Position Y", "7");
    harness.get_by_role_and_label(Role::CheckBox, "Visible").click();
    harness.run();
    let light = &harness.state().scene.lights[0];
    assert_eq!(light.power, [250.0; 3], "another power");
    assert_eq!(light.size.pair(), [2.5, 1.0], "another size");
    assert_eq!(light.position, [2.0, 7.0, 3.0], "another place");
    assert!(!light.visible, "still visible");
    choose(&mut harness, "Light type", "Disk");
    let light = &harness.state().scene.lights[0];
    assert_eq!(light.kind, LightKind::Disk, "another kind");
    crate::io::scene_file::validate(&harness.state().scene).expect("the scene stays valid");
}

#[test]
fn one_side_of_a_rectangle_at_zero_closes_both() {
    let mut harness = harness(LIGHTS);
    type_figure(&mut harness, "Width", "0");
    crate::io::scene_file::validate(&harness.state().scene).expect("the scene stays valid");
}

#[test]
fn parts_are_added_copied_renamed_and_removed() {
    let mut harness = harness(LIGHTS);
    press(&mut harness, "Add");
    press(&mut harness, "Copy");
    assert_eq!(harness.state().scene.lights.len(), 3, "not added and copied");
    press(&mut harness, "Rename");
    let field = harness.get_by_role_and_label(Role::TextInput, "Light name");
    field.focus();
    harness.run();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.event(egui::Event::Text("rim".to_owned()));
    harness.key_press(egui::Key::Enter);
    harness.run();
    assert_eq!(harness.state().scene.lights[2].name, "rim", "not renamed");
    press(&mut harness, "Delete");
    let names: Vec<&str> =
        harness.state().scene.lights.iter().map(|light| light.name.as_str()).collect();
    assert_eq!(names, ["key", "light-1"], "another one was removed");
}

#[test]
fn gloss_follows_its_controls() {
    let mut harness = harness(MATERIALS);
    type_figure(&mut harness, "Alpha x", "0.08");
    type_figure(&mut harness, "Alpha y", "0.4");
    press(&mut harness, "Form: Bounded");
    type_figure(&mut harness, "Refraction", "1.33");
    let material = &harness.state().scene.materials[0];
    assert_eq!((material.alpha_x, material.alpha_y), (0.08, 0.4), "other roughness");
    assert_eq!(material.ward, WardForm::Bounded, "another form");
    assert_eq!(material.ior, 1.33, "another glass");
    harness.get_by_role_and_label(Role::CheckBox, "Link alpha x and y").click();
    harness.run();
    type_figure(&mut harness, "Alpha x", "0.2");
    let material = &harness.state().scene.materials[0];
    assert_eq!((material.alpha_x, material.alpha_y), (0.2, 0.2), "not linked");
}

#[test]
fn a_diffuse_colour_can_come_from_a_texture_and_a_preset_replaces_it() {
    let mut harness = harness(MATERIALS);
    choose(&mut harness, "Diffuse from", "veins");
    let veins = ColorOrTexture::Texture("veins".to_owned());
    assert_eq!(harness.state().scene.materials[0].diffuse, veins, "another colour");
    choose(&mut harness, "Material preset", "Mirror");
    assert_eq!(harness.state().scene.materials[0].reflection, [0.92; 3], "no mirror");
}

#[test]
fn another_material_can_be_chosen_and_edited() {
    let mut harness = harness(MATERIALS);
    choose(&mut harness, "Material", "plain");
    type_figure(&mut harness, "Alpha y", "0.3");
    let mut expected = small_scene();
    expected.materials[1].alpha_y = 0.3;
    assert_eq!(harness.state().scene, expected, "another material was edited");
}

#[test]
fn noise_follows_its_controls() {
    let mut harness = harness(TEXTURES);
    type_figure(&mut harness, "Scale", "7.5");
    type_figure(&mut harness, "Octaves", "3");
    type_figure(&mut harness, "Lacunarity", "2.2");
    type_figure(&mut harness, "Gain", "0.6");
    type_figure(&mut harness, "Distortion", "1.25");
    press(&mut harness, "+");
    let mut expected = small_scene();
    let texture = &mut expected.textures[0];
    texture.scale = 7.5;
    texture.octaves = 3;
    texture.lacunarity = 2.2;
    texture.gain = 0.6;
    texture.distortion = 1.25;
    texture.colors = Some(vec![[0.9; 3], [0.1; 3], [0.1; 3]]);
    assert_eq!(harness.state().scene, expected, "the texture differs");
}

#[test]
fn a_colour_is_typed_in_linear_light() {
    let mut harness = harness(MATERIALS);
    harness.get_by_role_and_label(Role::ColorWell, "Specular").click();
    harness.run();
    type_figure(&mut harness, "Specular: green", "0.25");
    let specular = harness.state().scene.materials[0].specular;
    assert_eq!(specular, [0.0, 0.25, 0.0], "another colour");
}

#[test]
fn objects_follow_their_controls() {
    let mut harness = harness(OBJECTS);
    type_figure(&mut harness, "Move Y", "0.5");
    type_figure(&mut harness, "Radius", "0.75");
    choose(&mut harness, "Made of", "plain");
    harness.get_by_role_and_label(Role::CheckBox, "Enabled").click();
    harness.run();
    let object = &harness.state().scene.objects[0];
    assert_eq!(object.translate, [0.0, 0.5, 0.0], "another place");
    assert_eq!(object.radius, Some(0.75), "another radius");
    assert_eq!(object.material.as_deref(), Some("plain"), "another material");
    assert!(!object.enabled, "still enabled");
    choose(&mut harness, "Shape", "Cylinder");
    crate::io::scene_file::validate(&harness.state().scene).expect("the scene stays valid");
}

#[test]
fn display_and_render_follow_their_controls() {
    let mut shown = harness(DISPLAY);
    type_figure(&mut shown, "Exposure", "1.5");
    press(&mut shown, "Curve: ACES");
    let tone = &shown.state().scene.tone_mapping;
    assert_eq!((tone.exposure, tone.operator), (1.5, ToneOperator::Aces), "another display");
    choose(&mut shown, "View", "Circle of confusion");
    assert_eq!(shown.state().display.view, View::Blur, "another view");

    let mut rendered = harness(RENDER);
    type_figure(&mut rendered, "Samples", "1000");
    press(&mut rendered, "Integrator: Path");
    choose(&mut rendered, "Accelerator", "brute-force");
    let render = &rendered.state().scene.render;
    assert_eq!((render.samples, render.integrator), (1000, IntegratorKind::Path), "other settings");
    assert_eq!(rendered.state().accelerator, 1, "another accelerator");
    type_figure(&mut rendered, "Threads", "3");
    assert_eq!(rendered.state().n_threads, 3, "another number of threads");
    press(&mut rendered, "Size: Fill");
    assert_eq!(rendered.state().size_mode, SizeMode::Fill, "the size stays fixed");
}

/// The small scene with a mesh in place of its ball.
fn scene_with_mesh() -> SceneDescription {
    let mut scene = small_scene();
    scene.objects[0].kind = ObjectKind::Mesh;
    scene.objects[0].file = Some("a.obj".to_owned());
    scene
}

/// Types another path into the field of the mesh.
fn type_mesh(harness: &mut Harness<'_, Bench>) {
    harness.get_by_role_and_label(Role::TextInput, "Mesh file").click();
    harness.run();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.event(egui::Event::Text("meshes/egg.obj".to_owned()));
    harness.run();
}

#[test]
fn a_mesh_is_entered_by_its_path() {
    let mut harness = harness_of(OBJECTS, bench(scene_with_mesh()));
    type_mesh(&mut harness);
    assert_eq!(harness.state().scene, scene_with_mesh(), "every letter counts");
    harness.key_press(egui::Key::Enter);
    harness.run();
    let object = &harness.state().scene.objects[0];
    assert_eq!(object.file.as_deref(), Some("meshes/egg.obj"), "another file");
    harness.get_by_role_and_label(Role::CheckBox, "Scale each axis").click();
    harness.run();
    type_figure(&mut harness, "Scale Y", "2");
    let scale = harness.state().scene.objects[0].scale.triple();
    assert_eq!(scale, [1.0, 2.0, 1.0], "another scale");
    press(&mut harness, "Mesh file: choose");
    let wanted = Some((Part::Object, "ball".to_owned()));
    assert_eq!(harness.state().selection.wants_file, wanted, "no file is asked for");
}

#[test]
fn a_path_half_typed_is_let_go_by_escape() {
    let mut harness = harness_of(OBJECTS, bench(scene_with_mesh()));
    type_mesh(&mut harness);
    harness.key_press(egui::Key::Escape);
    harness.run();
    assert_eq!(harness.state().scene, scene_with_mesh(), "it was taken over");
}

#[test]
fn what_is_made_from_a_file_asks_for_the_file_first() {
    for (panel, list, option, part, name) in [
        (OBJECTS, "Shape", "Mesh", Part::Object, "ball"),
        (TEXTURES, "Pattern", "Image", Part::Texture, "veins"),
    ] {
        let mut harness = harness(panel);
        choose(&mut harness, list, option);
        let wanted = Some((part, name.to_owned()));
        assert_eq!(harness.state().selection.wants_file, wanted, "{option} asks for no file");
        assert_eq!(harness.state().scene, small_scene(), "{option} without its file");
    }
}

#[test]
fn a_colour_is_set_by_its_hex_digits_and_by_the_arrow_keys() {
    let mut harness = harness(MATERIALS);
    harness.get_by_role_and_label(Role::ColorWell, "Specular").click();
    harness.run();
    let square = "Specular: saturation and brightness";
    let square = harness.get_by_role_and_label(Role::Slider, square).rect();
    let field = harness.get_by_role_and_label(Role::TextInput, "Specular: sRGB");
    assert!((field.rect().right() - square.right()).abs() < 1.5, "the picker is ragged");
    let blue = harness.get_by_role_and_label(Role::SpinButton, "Specular: blue").rect();
    assert!((blue.right() - square.right()).abs() < 1.5, "the picker is ragged");
    field.click();
    harness.run();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.event(egui::Event::Text("#ff0000".to_owned()));
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
    assert_eq!(harness.state().scene.materials[0].specular, [1.0, 0.0, 0.0], "another colour");
    harness.get_by_role_and_label(Role::Slider, "Specular: hue").focus();
    harness.run();
    harness.key_press(egui::Key::ArrowRight);
    harness.run();
    let [red, green, blue] = harness.state().scene.materials[0].specular;
    assert!(red == 1.0 && 0.05 < green && blue == 0.0, "hue: {red} {green} {blue}");
    let square = "Specular: saturation and brightness";
    harness.get_by_role_and_label(Role::Slider, square).focus();
    harness.run();
    harness.key_press(egui::Key::ArrowDown);
    harness.run();
    let darker = harness.state().scene.materials[0].specular[0];
    assert!((0.9..0.99).contains(&darker), "brightness: {darker}");
}
