//! Figures as a person reads them: as many digits as mean something, with their units.

use crate::render::Noise;

/// At most four significant digits, without trailing zeros.
pub(super) fn short(figure: f64) -> String {
    significant(figure, 4)
}

/// So many significant digits at most, without trailing zeros; whole numbers keep all of theirs.
pub(super) fn significant(figure: f64, n_digits: u8) -> String {
    if figure == 0.0 || !figure.is_finite() {
        return format!("{figure}");
    }
    let magnitude = figure.abs().log10().floor();
    let more = f64::from(n_digits) - 1.0;
    if !(-5.0..7.0).contains(&magnitude) {
        return format!("{figure:.*e}", more.clamp(0.0, 3.0) as usize);
    }
    let decimals = (more - magnitude).clamp(0.0, 8.0) as usize;
    let text = format!("{figure:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// Seconds as a person says them, rounded down.
pub(super) fn duration(seconds: f64) -> String {
    let whole = seconds.max(0.0) as u64;
    match whole {
        0..60 => format!("{whole} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole / 60 % 60),
    }
}

/// Bytes in the unit that suits them.
pub(super) fn bytes_text(bytes: f64) -> String {
    if bytes < 1e6 { format!("{:.0} kB", bytes / 1e3) } else { format!("{:.1} MB", bytes / 1e6) }
}

/// Two significant digits: the estimate is no better.
pub(super) fn percent_text(percent: f64) -> String {
    let magnitude = percent.abs().max(1e-9).log10().floor();
    let decimals = (1.0 - magnitude).clamp(0.0, 8.0) as usize;
    let text = format!("{percent:.decimals$}");
    let text =
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} %")
}

/// "2.1 ± 0.2 %": the noise, to the digit that its uncertainty leaves certain.
pub(super) fn noise_text(noise: Noise) -> String {
    let error = noise.percent * noise.uncertainty;
    if !(0.0 < error && error.is_finite()) {
        return percent_text(noise.percent);
    }
    // One digit: 0.98 counts as 1.
    let unit = 10.0_f64.powf(error.log10().floor());
    let error = (error / unit).round() * unit;
    let decimals = (-(error * 1.0001).log10().floor()).clamp(0.0, 8.0) as usize;
    format!("{:.decimals$} ± {error:.decimals$} %", noise.percent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Course;

    #[test]
    fn figures_show_what_matters_and_no_more() {
        for (figure, shown) in [
            (0.0, "0"),
            (5.0, "5"),
            (0.15, "0.15"),
            (0.123456, "0.1235"),
            (1234.5678, "1235"),
            (-2.5, "-2.5"),
            (0.00002, "0.00002"),
            (1e9, "1.000e9"),
            (100.0, "100"),
        ] {
            assert_eq!(short(figure), shown, "for {figure}");
        }
    }

    #[test]
    fn durations_are_rounded_down() {
        for (seconds, said) in
            [(0.99, "0 s"), (59.99, "59 s"), (61.5, "1 min 01 s"), (3725.0, "1 h 02 min")]
        {
            assert_eq!(duration(seconds), said, "for {seconds}");
        }
    }

    #[test]
    fn percentages_have_two_digits() {
        for (percent, text) in
            [(9.804, "9.8 %"), (212.7, "213 %"), (1.0, "1 %"), (0.0123, "0.012 %")]
        {
            assert_eq!(percent_text(percent), text, "for {percent}");
        }
    }

    #[test]
    fn noise_has_the_digits_that_its_uncertainty_leaves() {
        for (percent, uncertainty, text) in [
            (2.13, 0.08, "2.1 ± 0.2 %"),
            (12.3, 0.08, "12 ± 1 %"),
            (166.4, 0.3, "166 ± 50 %"),
            (0.0421, 0.1, "0.042 ± 0.004 %"),
            (2.13, 0.0, "2.1 %"),
        ] {
            let noise = Noise { percent, uncertainty, course: Course::even(0.5) };
            assert_eq!(noise_text(noise), text, "for {percent} ± {uncertainty}");
        }
    }
}
