//! The start page: a place to drop a file, the files opened before, and the gallery.

use super::background::Background;
use super::{recent, theme};
use crate::io::gallery::{self, GALLERY, PICTURE_SIZE};
use crate::io::snapshot::read_pixels;
use egui::{
    Align2, Button, Color32, ColorImage, CursorIcon, Id, LayerId, Order, Rect, RichText, Sense,
    Stroke, StrokeKind, TextStyle, TextureHandle, TextureOptions, Ui, Vec2, pos2,
};
use std::path::{Path, PathBuf};

/// The page is no wider than this, in points.
const WIDEST: f32 = 1480.0;
/// Width of the column with recent files, in points.
const SIDE_WIDTH: f32 = 272.0;
/// A picture of the gallery is at least this wide, in points.
const CARD_WIDTH: f32 = 208.0;
const GAP: f32 = 16.0;
/// Height of the title below a picture.
const TITLE_HEIGHT: f32 = 26.0;
/// Height of the line of a recent file.
const RECENT_HEIGHT: f32 = 50.0;

/// What was chosen on the page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum StartChoice {
    /// Ask for a file.
    Open,
    /// Open the gallery scene of that index.
    Gallery(usize),
    /// Open that file.
    File(PathBuf),
    /// Back to the open scene.
    Back,
}

/// The pictures of the page: made ready on a thread of their own when they are first shown.
pub(super) struct Thumbnails {
    thread: Background<Wanted, Made>,
    asked: Option<Vec<PathBuf>>,
    is_old: bool,
    gallery: Vec<Option<TextureHandle>>,
    recent: Vec<Option<TextureHandle>>,
}

/// What the page needs.
struct Wanted {
    /// Whether the gallery's pictures have still to be made.
    gallery: bool,
    /// Where the pictures of recent files would be.
    recent: Vec<PathBuf>,
}

/// In the same order; `None` where there is no picture.
#[derive(Default)]
struct Made {
    gallery: Option<Vec<Option<ColorImage>>>,
    recent: Vec<Option<ColorImage>>,
}

impl Thumbnails {
    /// Starts the thread; `wake` is called when the pictures are ready.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub(super) fn new(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let make = |wanted: Wanted| Made {
            gallery: wanted
                .gallery
                .then(|| GALLERY.iter().map(|entry| thumbnail(entry.name)).collect()),
            recent: wanted.recent.iter().map(|place| recent::read(place)).collect(),
        };
        let thread = Background::new("small pictures", make, wake)?;
        Ok(Self { thread, asked: None, is_old: false, gallery: Vec::new(), recent: Vec::new() })
    }

    /// Asks for the pictures that the page needs, and takes those that are ready; `recent` is where
    /// those of the recent files would be.
    pub(super) fn update(&mut self, ctx: &egui::Context, recent: Vec<PathBuf>) {
        let is_other = self.asked.as_ref() != Some(&recent);
        if is_other {
            // What is shown belongs to other lines.
            self.recent.clear();
        }
        if std::mem::take(&mut self.is_old) || is_other {
            self.thread.order(Wanted { gallery: self.gallery.is_empty(), recent: recent.clone() });
            self.asked = Some(recent);
        }
        let Some(made) = self.thread.take() else { return };
        let load = |image| ctx.load_texture("start page", image, TextureOptions::LINEAR);
        let load_all = |images: Vec<Option<ColorImage>>| {
            images.into_iter().map(|image| image.map(load)).collect()
        };
        if let Some(gallery) = made.gallery {
            self.gallery = load_all(gallery);
        }
        self.recent = load_all(made.recent);
    }

    /// The pictures of recent files have changed.
    pub(super) fn look_again(&mut self) {
        self.is_old = true;
    }

    /// Which of the recent files have a picture on the page.
    #[cfg(test)]
    pub(super) fn recent_shown(&self) -> Vec<bool> {
        self.recent.iter().map(Option::is_some).collect()
    }
}

/// The picture of a gallery scene, as the program rendered it.
fn thumbnail(name: &str) -> Option<ColorImage> {
    let pixels = read_pixels(gallery::picture(name)?, PICTURE_SIZE).ok()?;
    let size = [PICTURE_SIZE.0 as usize, PICTURE_SIZE.1 as usize];
    Some(ColorImage::from_rgb(size, &pixels))
}

/// Shows the page. `can_return` says whether a scene is open behind it.
pub(super) fn start_ui(
    ui: &mut Ui,
    thumbnails: &Thumbnails,
    recent: &[PathBuf],
    can_return: bool,
) -> Option<StartChoice> {
    ui.painter().rect_filled(ui.max_rect(), 0.0, ui.visuals().panel_fill);
    let mut chosen = None;
    egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let room = ui.available_width() - 2.0 * GAP;
        let width = room.min(WIDEST);
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing = Vec2::ZERO;
            ui.add_space(GAP + (room - width) / 2.0);
            ui.vertical(|ui| {
                ui.set_width(width);
                ui.add_space(GAP);
                ui.horizontal_top(|ui| {
                    ui.vertical(|ui| {
                        ui.set_width(SIDE_WIDTH);
                        side_ui(ui, recent, &thumbnails.recent, can_return, &mut chosen);
                    });
                    ui.add_space(2.0 * GAP);
                    ui.vertical(|ui| gallery_ui(ui, &thumbnails.gallery, &mut chosen));
                });
                ui.add_space(GAP);
            });
        });
    });
    chosen
}

fn side_ui(
    ui: &mut Ui,
    recent: &[PathBuf],
    pictures: &[Option<TextureHandle>],
    can_return: bool,
    chosen: &mut Option<StartChoice>,
) {
    ui.heading("Penumbra");
    ui.add_space(4.0);
    ui.weak("See how a picture is made of light.");
    ui.add_space(GAP);
    drop_zone(ui);
    ui.add_space(10.0);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        let open = Button::new("Open a file…").min_size(Vec2::new(110.0, 28.0));
        if ui.add(open).on_hover_text("a scene, a mesh or a snapshot").clicked() {
            *chosen = Some(StartChoice::Open);
        }
        let back = Button::new("Back to the scene").min_size(Vec2::new(110.0, 28.0));
        if can_return && ui.add(back).on_hover_text("closes this page (Esc)").clicked() {
            *chosen = Some(StartChoice::Back);
        }
    });
    ui.add_space(GAP + 4.0);
    ui.strong("Recent");
    ui.add_space(4.0);
    if recent.is_empty() {
        ui.weak("Files that you open are listed here.");
    }
    for (index, path) in recent.iter().enumerate() {
        let picture = pictures.get(index).and_then(Option::as_ref);
        if recent_ui(ui, path, picture) {
            *chosen = Some(StartChoice::File(path.clone()));
        }
    }
}

/// Where a file can be dropped; it can be dropped anywhere else in the window too.
fn drop_zone(ui: &mut Ui) {
    let (rect, response) =
        ui.allocate_exact_size(Vec2::new(ui.available_width(), 108.0), Sense::hover());
    let told = "Drop a scene, a mesh or a snapshot";
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, told));
    let is_over = ui.input(|input| !input.raw.hovered_files.is_empty());
    let color = if is_over { theme::accent(ui.visuals()) } else { ui.visuals().weak_text_color() };
    let fill = if is_over { color.gamma_multiply(0.12) } else { Color32::TRANSPARENT };
    ui.painter().rect_filled(rect, 8.0, fill);
    let edge = rect.shrink(1.0);
    let corners = [
        edge.left_top(),
        edge.right_top(),
        edge.right_bottom(),
        edge.left_bottom(),
        edge.left_top(),
    ];
    let stroke = Stroke::new(1.0, color.gamma_multiply(if is_over { 1.0 } else { 0.6 }));
    ui.painter().extend(egui::Shape::dashed_line(&corners, stroke, 6.0, 5.0));
    let font = TextStyle::Body.resolve(ui.style());
    ui.painter().text(rect.center(), Align2::CENTER_CENTER, told, font, color);
}

/// Says over the picture that a file held there would be opened.
pub(super) fn drop_hint(ctx: &egui::Context, over: Rect) {
    if ctx.input(|input| input.raw.hovered_files.is_empty()) {
        return;
    }
    let shade = LayerId::new(Order::Foreground, Id::unique("drop shade"));
    let painter = ctx.layer_painter(shade).with_clip_rect(over);
    painter.rect_filled(over, 0.0, Color32::from_black_alpha(150));
    let edge = Stroke::new(2.0, theme::ACCENT_ON_PICTURE);
    painter.rect_stroke(over.shrink(12.0), 8.0, edge, StrokeKind::Inside);
    egui::Area::new(Id::unique("drop hint"))
        .order(Order::Tooltip)
        .interactable(false)
        .pivot(Align2::CENTER_CENTER)
        .fixed_pos(over.center())
        .show(ctx, |ui| ui.label(RichText::new("Drop to open").heading().color(Color32::WHITE)));
}

/// A line for a file opened before; gives back whether it was clicked.
fn recent_ui(ui: &mut Ui, path: &Path, picture: Option<&TextureHandle>) -> bool {
    let (rect, response) =
        ui.allocate_exact_size(Vec2::new(ui.available_width(), RECENT_HEIGHT), Sense::click());
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    if response.hovered() || response.has_focus() {
        let behind = rect.expand2(Vec2::new(6.0, 0.0));
        ui.painter().rect_filled(behind, 6.0, ui.visuals().widgets.hovered.weak_bg_fill);
    }
    let inner = rect.shrink2(Vec2::new(0.0, 5.0));
    let width = inner.height() * recent::SIZE.0 as f32 / recent::SIZE.1 as f32;
    let frame = Rect::from_min_size(inner.min, Vec2::new(width.round(), inner.height()));
    picture_ui(ui, frame, 4, picture);
    if picture.is_none() {
        // The kind of file, where there is no picture of it.
        let kind = path.extension().unwrap_or_default().to_string_lossy();
        let font = TextStyle::Small.resolve(ui.style());
        let color = ui.visuals().weak_text_color();
        let painter = ui.painter().with_clip_rect(frame.intersect(ui.clip_rect()));
        painter.text(frame.center(), Align2::CENTER_CENTER, kind, font, color);
    }
    let beside = inner.with_min_x(frame.right() + 10.0).shrink2(Vec2::new(0.0, 2.0));
    let mut lines = ui.new_child(egui::UiBuilder::new().max_rect(beside));
    lines.spacing_mut().item_spacing.y = 1.0;
    lines.add(egui::Label::new(name).truncate());
    let folder = path.parent().unwrap_or(path).display().to_string();
    lines.add(egui::Label::new(RichText::new(folder).weak().small()).truncate());
    response
        .on_hover_cursor(CursorIcon::PointingHand)
        .on_hover_text(path.display().to_string())
        .clicked()
}

/// A picture of the page in its place, or the place alone.
fn picture_ui(ui: &Ui, place: Rect, radius: u8, picture: Option<&TextureHandle>) {
    match picture {
        Some(picture) => egui::Image::new(picture)
            .corner_radius(radius)
            .fit_to_exact_size(place.size())
            .paint_at(ui, place),
        None => {
            ui.painter().rect_filled(place, radius, ui.visuals().extreme_bg_color);
        }
    }
}

fn gallery_ui(ui: &mut Ui, pictures: &[Option<TextureHandle>], chosen: &mut Option<StartChoice>) {
    ui.heading("Gallery");
    ui.add_space(4.0);
    ui.weak("Scenes that come with the program, each about one thing.");
    ui.add_space(GAP);
    let room = ui.available_width();
    let n_columns = ((room + GAP) / (CARD_WIDTH + GAP)).floor().clamp(1.0, 4.0) as usize;
    let width = ((room - GAP * (n_columns - 1) as f32) / n_columns as f32).floor();
    for (row, entries) in GALLERY.chunks(n_columns).enumerate() {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = GAP;
            for (column, entry) in entries.iter().enumerate() {
                let index = row * n_columns + column;
                let picture = pictures.get(index).and_then(Option::as_ref);
                if card_ui(ui, width, entry.title, picture) {
                    *chosen = Some(StartChoice::Gallery(index));
                }
            }
        });
        ui.add_space(GAP - 4.0);
    }
}

/// A picture with its title; gives back whether it was clicked.
fn card_ui(ui: &mut Ui, width: f32, title: &str, picture: Option<&TextureHandle>) -> bool {
    let height = (width * PICTURE_SIZE.1 as f32 / PICTURE_SIZE.0 as f32).round();
    let size = Vec2::new(width, height + TITLE_HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, title));
    let image = Rect::from_min_size(rect.min, Vec2::new(width, height));
    picture_ui(ui, image, 6, picture);
    let is_active = response.hovered() || response.has_focus();
    if is_active {
        let stroke = Stroke::new(2.0, theme::accent(ui.visuals()));
        ui.painter().rect_stroke(image, 6.0, stroke, StrokeKind::Outside);
    }
    let color =
        if is_active { ui.visuals().strong_text_color() } else { ui.visuals().text_color() };
    let font = TextStyle::Body.resolve(ui.style());
    let at = pos2(image.left() + 1.0, image.bottom() + TITLE_HEIGHT / 2.0);
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    painter.text(at, Align2::LEFT_CENTER, title, font, color);
    response.on_hover_cursor(CursorIcon::PointingHand).clicked()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_of_the_gallery_has_its_picture() {
        for entry in GALLERY {
            let picture = thumbnail(entry.name);
            let size = picture.as_ref().map(|picture| picture.size);
            assert_eq!(size, Some([480, 270]), "{}", entry.name);
        }
    }
}
