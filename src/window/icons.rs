//! The pictograms of the toolbar, drawn with lines so that they are crisp at any scale and have
//! the colour of the text beside them. Fonts have no such set.

use crate::math::portable::{cos, sin};
use egui::{Atom, Color32, Painter, Pos2, Rect, Shape, Stroke, Vec2, pos2};
use std::f32::consts::TAU;

/// Side of a pictogram in points.
const SIDE: f32 = 14.0;

/// What is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Icon {
    /// An arrow back to the left.
    Undo,
    /// An arrow on to the right.
    Redo,
    /// Two bars.
    Pause,
    /// A triangle to the right.
    Resume,
    /// The corners of a frame around a dot.
    Frame,
    /// A camera.
    Snapshot,
    /// A picture with a hill and a sun.
    Picture,
    /// A question mark in a circle.
    Help,
    /// A window with a column on the right.
    Panel,
}

impl Icon {
    /// As a part of a button, in front of its text.
    pub(super) fn atom<'a>(self) -> Atom<'a> {
        Atom::paint(Vec2::splat(SIDE), move |ui, place| {
            self.paint(ui.painter(), place.rect, place.fallback_text_color);
        })
    }

    fn paint(self, painter: &Painter, place: Rect, color: Color32) {
        let pen = Pen { painter, place, stroke: Stroke::new(1.3, color) };
        match self {
            Self::Undo => pen.arrow_around(false),
            Self::Redo => pen.arrow_around(true),
            Self::Pause => {
                pen.bar([3.0, 2.0], [5.5, 12.0]);
                pen.bar([8.5, 2.0], [11.0, 12.0]);
            }
            Self::Resume => pen.area(&[[3.5, 1.5], [12.0, 7.0], [3.5, 12.5]]),
            Self::Frame => {
                for (x, y) in [(1.5, 1.5), (12.5, 1.5), (12.5, 12.5), (1.5, 12.5)] {
                    let inward = |at: f32| if at < 7.0 { at + 3.0 } else { at - 3.0 };
                    pen.line(&[[inward(x), y], [x, y], [x, inward(y)]]);
                }
                pen.dot([7.0, 7.0], 1.6);
            }
            Self::Snapshot => {
                pen.line(&[
                    [1.0, 4.0],
                    [4.0, 4.0],
                    [5.0, 2.0],
                    [9.0, 2.0],
                    [10.0, 4.0],
                    [13.0, 4.0],
                    [13.0, 12.0],
                    [1.0, 12.0],
                    [1.0, 4.0],
                ]);
                pen.circle([7.0, 7.8], 2.5);
            }
            Self::Picture => {
                pen.frame([1.0, 2.0], [13.0, 12.0]);
                pen.line(&[[1.0, 10.5], [5.0, 6.5], [8.0, 9.5], [9.5, 8.0], [13.0, 11.0]]);
                pen.dot([9.7, 5.0], 1.2);
            }
            Self::Help => {
                pen.circle([7.0, 7.0], 6.0);
                pen.arc([7.0, 5.6], 1.8, -0.5, 0.28);
                pen.line(&[[7.1, 7.4], [7.0, 8.4]]);
                pen.dot([7.0, 10.2], 0.8);
            }
            Self::Panel => {
                pen.frame([1.0, 2.0], [13.0, 12.0]);
                pen.bar([8.5, 2.0], [13.0, 12.0]);
            }
        }
    }
}

/// Draws in a square of 14 x 14, y down, wherever it lies.
struct Pen<'a> {
    painter: &'a Painter,
    place: Rect,
    stroke: Stroke,
}

impl Pen<'_> {
    fn at(&self, [x, y]: [f32; 2]) -> Pos2 {
        let scale = self.place.width() / SIDE;
        pos2(self.place.left() + x * scale, self.place.top() + y * scale)
    }

    fn points(&self, points: &[[f32; 2]]) -> Vec<Pos2> {
        points.iter().map(|point| self.at(*point)).collect()
    }

    fn line(&self, points: &[[f32; 2]]) {
        self.painter.line(self.points(points), self.stroke);
    }

    fn area(&self, points: &[[f32; 2]]) {
        let shape = Shape::convex_polygon(self.points(points), self.stroke.color, Stroke::NONE);
        self.painter.add(shape);
    }

    fn bar(&self, from: [f32; 2], to: [f32; 2]) {
        let area = Rect::from_two_pos(self.at(from), self.at(to));
        self.painter.rect_filled(area, 0.5, self.stroke.color);
    }

    fn frame(&self, from: [f32; 2], to: [f32; 2]) {
        let area = Rect::from_two_pos(self.at(from), self.at(to));
        self.painter.rect_stroke(area, 1.5, self.stroke, egui::StrokeKind::Middle);
    }

    fn dot(&self, middle: [f32; 2], radius: f32) {
        self.painter.circle_filled(self.at(middle), radius, self.stroke.color);
    }

    fn circle(&self, middle: [f32; 2], radius: f32) {
        self.painter.circle_stroke(self.at(middle), radius, self.stroke);
    }

    /// Part of a circle; turns are counted clockwise from the right.
    fn arc(&self, [x, y]: [f32; 2], radius: f32, from: f32, to: f32) {
        let points = (0..=16).map(|step| {
            let angle = TAU * (from + (to - from) * step as f32 / 16.0);
            [x + radius * cos(angle), y + radius * sin(angle)]
        });
        self.line(&points.collect::<Vec<_>>());
    }

    /// An arrow that leaves to the left and comes round from below; mirrored, to the right.
    fn arrow_around(&self, mirrored: bool) {
        let x = |x: f32| if mirrored { 14.0 - x } else { x };
        self.line(&[[x(4.8), 1.8], [x(1.8), 4.8], [x(4.8), 7.8]]);
        let bend = (0..=16).map(|step| {
            let angle = TAU * (-0.25 + 0.5 * step as f32 / 16.0);
            [x(8.6 + 3.6 * cos(angle)), 8.4 + 3.6 * sin(angle)]
        });
        let way = std::iter::once([x(1.8), 4.8]).chain(bend).chain([[x(5.0), 12.0]]);
        self.line(&way.collect::<Vec<_>>());
    }
}
