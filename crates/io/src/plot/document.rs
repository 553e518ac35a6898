//! SVG document of a plot.

use std::fmt::Write as _;

use super::curve::path;
use super::{Plot, PlotPanel};
use crate::scale::Scale;
use crate::xml::escaped;

const WIDTH: f64 = 960.0;
const LEFT: f64 = 84.0;
const RIGHT: f64 = 20.0;
const TITLE: f64 = 34.0;
const PANEL: f64 = 210.0;
const GAP: f64 = 14.0;
const FOOT: f64 = 50.0;
const LEGEND_ROW: f64 = 20.0;
/// Upper bound of the width of a letter of 13 pixels.
const LETTER: f64 = 7.4;
/// Length of the line in front of a name in the legend.
const SAMPLE: f64 = 24.0;

/// Colours on light and on dark ground that colour-blind readers can distinguish, after Okabe and
/// Ito (2008); more curves than colours are dashed.
const COLOURS: [(&str, &str); 6] = [
    ("#0072b2", "#56b4e9"),
    ("#d55e00", "#ff8f4d"),
    ("#009e73", "#34d1a2"),
    ("#b0568a", "#ec9fcb"),
    ("#b07a00", "#f2bc42"),
    ("#555555", "#c4c4c4"),
];
const DASHES: [&str; 4] = ["", "7 4", "2 3", "9 3 2 3"];

pub(super) fn svg(plot: &Plot) -> String {
    let horizontal = scale_of(plot.panels.iter(), |curve| curve.x, 10, false);
    let legends: Vec<Vec<(usize, f64, f64)>> = plot.panels.iter().map(legend).collect();
    let rows = |legend: &[(usize, f64, f64)]| legend.last().map_or(0.0, |last| last.2 + 1.0);
    let heights: Vec<f64> = legends
        .iter()
        .map(|legend| LEGEND_ROW * rows(legend) + PANEL + GAP)
        .collect();
    let top = if plot.title.is_empty() { 10.0 } else { TITLE };
    let height = top + heights.iter().sum::<f64>() + FOOT - GAP;
    let mut out = head(height);
    if !plot.title.is_empty() {
        let _ = writeln!(
            out,
            r#"<text class="title" x="{LEFT}" y="22">{}</text>"#,
            escaped(&plot.title)
        );
    }
    let mut y = top;
    for (index, panel) in plot.panels.iter().enumerate() {
        for &(curve, x, row) in &legends[index] {
            let y = y + LEGEND_ROW * row + 0.5 * LEGEND_ROW;
            let _ = writeln!(
                out,
                "<path {} d=\"M{x} {y}h{SAMPLE}\"/><text x=\"{}\" y=\"{}\">{}</text>",
                style(panel, curve),
                x + SAMPLE + 6.0,
                y + 4.5,
                escaped(panel.curves[curve].name)
            );
        }
        y += LEGEND_ROW * rows(&legends[index]);
        draw_panel(&mut out, (panel, &plot.gaps), &horizontal, y);
        y += PANEL + GAP;
    }
    draw_foot(&mut out, plot, &horizontal, y - GAP);
    out.push_str("</svg>\n");
    out
}

fn head(height: f64) -> String {
    let mut light = String::new();
    let mut dark = String::new();
    for (index, (on_light, on_dark)) in COLOURS.iter().enumerate() {
        let _ = write!(light, ".c{index}{{stroke:{on_light}}}");
        let _ = write!(dark, ".c{index}{{stroke:{on_dark}}}");
    }
    format!(
        concat!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" "#,
            r#"width="{width}" height="{height}">"#,
            "\n<style>text{{font:13px system-ui,sans-serif;fill:#222}}.title{{font-size:16px}}",
            ".back{{fill:#fff}}.grid{{stroke:#e2e2e2;fill:none}}.zero{{stroke:#999}}",
            ".frame{{stroke:#888;fill:none}}.curve{{fill:none;stroke-width:1.4;",
            "stroke-linejoin:round;stroke-linecap:round}}.faint{{stroke:#aaa;stroke-width:.7}}{light}@media(prefers-color-scheme:dark){{text{{fill:#ddd}}",
            ".back{{fill:#17191d}}.grid{{stroke:#30343a}}.zero{{stroke:#777}}.faint{{stroke:#666}}{dark}}}</style>\n",
            "<rect class=\"back\" width=\"{width}\" height=\"{height}\"/>\n"
        ),
        width = WIDTH,
        height = height,
        light = light,
        dark = dark
    )
}

/// Style of a curve: those without a name are faint, the others differ in the order of their names.
fn style(panel: &PlotPanel, index: usize) -> String {
    if panel.curves[index].name.is_empty() {
        return r#"class="curve faint""#.into();
    }
    let before = panel.curves[..index].iter();
    let curve = before.filter(|curve| !curve.name.is_empty()).count();
    let colour = curve % COLOURS.len();
    let dash = DASHES[curve / COLOURS.len() % DASHES.len()];
    if dash.is_empty() {
        format!(r#"class="curve c{colour}""#)
    } else {
        format!(r#"class="curve c{colour}" stroke-dasharray="{dash}""#)
    }
}

fn scale_of<'a>(
    panels: impl Iterator<Item = &'a PlotPanel<'a>>,
    values: impl Fn(&super::PlotCurve<'a>) -> &'a [f64],
    wanted: usize,
    room: bool,
) -> Scale {
    let all = panels.flat_map(|panel| &panel.curves);
    let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
    for &value in all.flat_map(values) {
        least = least.min(value);
        greatest = greatest.max(value);
    }
    if least > greatest {
        (least, greatest) = (0.0, 1.0);
    }
    Scale::new(least, greatest, wanted, room)
}

/// Index of each curve, the left end of its entry in the legend, and the row.
fn legend(panel: &PlotPanel) -> Vec<(usize, f64, f64)> {
    let (mut x, mut row) = (LEFT, 0.0);
    let mut entries = Vec::new();
    let curves = panel.curves.iter().enumerate();
    for (index, curve) in curves.filter(|(_, curve)| !curve.name.is_empty()) {
        let width = SAMPLE + 6.0 + LETTER * curve.name.chars().count() as f64 + 16.0;
        if x > LEFT && x + width > WIDTH - RIGHT {
            (x, row) = (LEFT, row + 1.0);
        }
        entries.push((index, x, row));
        x += width;
    }
    entries
}

/// Title of an axis: name and unit, the unit with the power of ten of the axis.
fn axis_title(label: &str, unit: &str, exponent: i32) -> String {
    let power = match exponent {
        0 => String::new(),
        exponent => format!("10{} ", superscript(exponent)),
    };
    let unit = match (unit, power.as_str()) {
        ("" | "1", "") => String::new(),
        ("" | "1", power) => format!("({})", power.trim_end()),
        (unit, power) => format!("({power}{unit})"),
    };
    format!("{label} {unit}").trim().to_owned()
}

fn superscript(number: i32) -> String {
    let raised = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        digit => char::from_u32('⁰' as u32 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
    };
    number.to_string().chars().map(raised).collect()
}

fn draw_panel(
    out: &mut String,
    (panel, gaps): (&PlotPanel, &[usize]),
    horizontal: &Scale,
    top: f64,
) {
    let vertical = scale_of([panel].into_iter(), |curve| curve.y, 5, true);
    let width = WIDTH - LEFT - RIGHT;
    let x_of = |share: f64| LEFT + width * share;
    let y_of = |share: f64| top + PANEL * (1.0 - share);
    for &mark in &horizontal.marks {
        let x = x_of(horizontal.share_of_mark(mark));
        let _ = writeln!(out, r#"<path class="grid" d="M{x:.2} {top}v{PANEL}"/>"#);
    }
    for &mark in &vertical.marks {
        let y = y_of(vertical.share_of_mark(mark));
        let class = if mark == 0.0 { "grid zero" } else { "grid" };
        let _ = writeln!(
            out,
            concat!(
                "<path class=\"{}\" d=\"M{} {:.2}h{}\"/>",
                "<text x=\"{}\" y=\"{:.2}\" text-anchor=\"end\">{}</text>"
            ),
            class,
            LEFT,
            y,
            width,
            LEFT - 8.0,
            y + 4.5,
            vertical.text(mark)
        );
    }
    // Faint curves are behind the others.
    let is_faint = |index: &usize| panel.curves[*index].name.is_empty();
    let all = 0..panel.curves.len();
    let order = all
        .clone()
        .filter(is_faint)
        .chain(all.filter(|index| !is_faint(index)));
    for index in order {
        let curve = &panel.curves[index];
        let point = |i: usize| {
            let (across, up) = (horizontal.share(curve.x[i]), vertical.share(curve.y[i]));
            (x_of(across), y_of(up))
        };
        let count = curve.x.len();
        let inner = gaps.iter().copied().filter(|&gap| gap > 0 && gap < count);
        let ends = inner.clone().chain([count]);
        let pieces = [0].into_iter().chain(inner).zip(ends);
        let drawn: String = pieces
            .map(|(start, end)| path((start..end).map(point)))
            .collect();
        let _ = writeln!(out, r#"<path {} d="{drawn}"/>"#, style(panel, index));
    }
    let _ = writeln!(
        out,
        r#"<rect class="frame" x="{LEFT}" y="{top}" width="{width}" height="{PANEL}"/>"#
    );
    let (x, y) = (18.0, top + 0.5 * PANEL);
    let _ = writeln!(
        out,
        r#"<text x="{x}" y="{y}" text-anchor="middle" transform="rotate(-90 {x} {y})">{}</text>"#,
        escaped(&axis_title(&panel.label, &panel.unit, vertical.exponent))
    );
}

fn draw_foot(out: &mut String, plot: &Plot, horizontal: &Scale, bottom: f64) {
    let width = WIDTH - LEFT - RIGHT;
    for &mark in &horizontal.marks {
        let _ = writeln!(
            out,
            r#"<text x="{:.2}" y="{:.2}" text-anchor="middle">{}</text>"#,
            LEFT + width * horizontal.share_of_mark(mark),
            bottom + 18.0,
            horizontal.text(mark)
        );
    }
    let _ = writeln!(
        out,
        r#"<text x="{:.2}" y="{:.2}" text-anchor="middle">{}</text>"#,
        LEFT + 0.5 * width,
        bottom + 38.0,
        escaped(&axis_title(&plot.label, &plot.unit, horizontal.exponent))
    );
}
