//! Small plots with logarithmic axes, side by side in one SVG.

use std::fmt::Write as _;

/// One plot of three curves of (x, y).
pub(crate) struct Panel {
    pub(crate) title: &'static str,
    pub(crate) curves: [Vec<[f64; 2]>; 3],
}

const COLUMNS: usize = 4;
const WIDTH: f64 = 240.0;
const HEIGHT: f64 = 200.0;
/// Left, top, right and bottom of a panel.
const MARGINS: [f64; 4] = [42.0, 26.0, 10.0, 34.0];
const COLORS: [&str; 3] = ["#b0413e", "#2f6690", "#e0a030"];

/// Writes the SVG; all panels have their own ranges.
pub(crate) fn draw(panels: &[Panel], labels: [&str; 3], caption: &str) -> String {
    let rows = panels.len().div_ceil(COLUMNS);
    let (width, height) = (WIDTH * COLUMNS as f64, HEIGHT * rows as f64 + 30.0);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"sans-serif\" font-size=\"10\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n"
    );
    for (index, (label, color)) in labels.iter().zip(COLORS).enumerate() {
        let x = 20.0 + 110.0 * index as f64;
        let _ = writeln!(
            svg,
            "<path d=\"M{x} 15h24\" stroke=\"{color}\" stroke-width=\"2\"/>\
             <text x=\"{}\" y=\"19\">{label}</text>",
            x + 30.0
        );
    }
    let _ =
        writeln!(svg, "<text x=\"{}\" y=\"19\" text-anchor=\"end\">{caption}</text>", width - 12.0);
    for (index, panel) in panels.iter().enumerate() {
        let x = WIDTH * (index % COLUMNS) as f64;
        let y = HEIGHT * (index / COLUMNS) as f64 + 30.0;
        let _ = writeln!(svg, "<g transform=\"translate({x} {y})\">{}</g>", panel_svg(panel));
    }
    svg + "</svg>\n"
}

fn panel_svg(panel: &Panel) -> String {
    let [left, top, right, bottom] = MARGINS;
    let range = |axis: usize| {
        let logs = || panel.curves.iter().flatten().map(|point| point[axis].max(1e-9).log10());
        let (low, high) = (logs().fold(f64::MAX, f64::min), logs().fold(f64::MIN, f64::max));
        (low, high.max(low + 0.1))
    };
    let ((x_low, x_high), (y_low, y_high)) = (range(0), range(1));
    let (inner_width, inner_height) = (WIDTH - left - right, HEIGHT - top - bottom);
    let at_x = |log: f64| left + inner_width * (log - x_low) / (x_high - x_low);
    let at_y = |log: f64| top + inner_height * (y_high - log) / (y_high - y_low);
    let mut svg = format!(
        "<text x=\"{left}\" y=\"{}\" font-weight=\"bold\">{}</text>\
         <rect x=\"{left}\" y=\"{top}\" width=\"{inner_width}\" height=\"{inner_height}\" \
         fill=\"none\" stroke=\"#999\"/>",
        top - 8.0,
        panel.title
    );
    for power in decades(x_low, x_high) {
        let (x, foot) = (at_x(f64::from(power)), top + inner_height);
        let _ = write!(
            svg,
            "<path d=\"M{x:.1} {top}V{foot}\" stroke=\"#ddd\"/>\
             <text x=\"{x:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            foot + 14.0,
            number(power)
        );
    }
    for power in decades(y_low, y_high) {
        let y = at_y(f64::from(power));
        let _ = write!(
            svg,
            "<path d=\"M{left} {y:.1}h{inner_width}\" stroke=\"#ddd\"/>\
             <text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            left - 4.0,
            y + 3.0,
            number(power)
        );
    }
    for (curve, color) in panel.curves.iter().zip(COLORS) {
        let places: Vec<String> = curve
            .iter()
            .map(|[x, y]| {
                format!("{:.1},{:.1}", at_x(x.max(1e-9).log10()), at_y(y.max(1e-9).log10()))
            })
            .collect();
        let _ = write!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"/>",
            places.join(" ")
        );
    }
    svg
}

/// Powers of ten between two logarithms.
fn decades(low: f64, high: f64) -> std::ops::RangeInclusive<i32> {
    low.ceil() as i32..=high.floor() as i32
}

/// A power of ten as a person writes it.
fn number(power: i32) -> String {
    let value = 10.0_f64.powi(power);
    if power >= 0 {
        format!("{value:.0}")
    } else {
        format!("{value:.*}", power.unsigned_abs() as usize)
    }
}
