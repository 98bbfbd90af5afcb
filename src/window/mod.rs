//! The desktop window: a viewport that sharpens while it is watched, and a panel with every
//! setting of the scene.
#![allow(dead_code)]
mod color;
mod dialogs;
mod help;
mod keys;
mod navigation;
mod panels;
mod picture;
mod presets;
mod state;
mod status;
mod structure;
mod theme;
mod toasts;
mod toolbar;
mod viewport;
mod widgets;
