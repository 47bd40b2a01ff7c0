//! Writes a sketch as an SVG. Pictures are inside it, so it loads no other file.

use super::{
    super::{file_kind::SVG_START, picture},
    sketch::{InkColour, MapMark, MapSketch, SheetPoint},
};
use crate::pages::data_uri;
use std::fmt::Write;
use wayword_run::{error::CommandError, output::show_unseen};

/// The drawing as text; `title` is shown when the user points at it.
///
/// # Errors
/// When the picture below cannot be encoded.
pub(super) fn sketch_svg(sketch: &MapSketch, title: &str) -> Result<String, CommandError> {
    let [width, height] = sketch.size;
    let mut out = format!(
        "{SVG_START}xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-weight=\"bold\">\n<title>{}</title>\n<rect width=\"100%\" height=\"100%\" \
         fill=\"#fff\"/>\n",
        escape_xml(title)
    );
    if let Some((image, [low, high])) = &sketch.picture {
        let (size, data) =
            ([high[0] - low[0], high[1] - low[1]].map(round_units), data_uri::jpeg_uri(&picture::encode_jpeg(image)?));
        let place = format!("x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"", low[0], low[1], size[0], size[1]);
        append_line(&mut out, format_args!("<image {place} preserveAspectRatio=\"none\" href=\"{data}\"/>"));
    }
    for mark in &sketch.marks {
        append_mark(&mut out, mark);
    }
    out.push_str("</svg>\n");
    Ok(out)
}

fn append_mark(out: &mut String, mark: &MapMark) {
    match mark {
        MapMark::Line { points, width, ink, dash } => {
            let dash = dash.map_or(String::new(), |[on, off]| format!(" stroke-dasharray=\"{on} {off}\""));
            let (points, ink) = (list_points(points), css_colour(*ink));
            let style = "fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\"";
            append_line(
                out,
                format_args!("<polyline points=\"{points}\" {style} stroke=\"{ink}\" stroke-width=\"{width}\"{dash}/>"),
            );
        }
        MapMark::Disc { at: [x, y], radius, ink, title } => {
            let circle = format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{}\"", css_colour(*ink));
            match title {
                Some(title) => append_line(out, format_args!("{circle}><title>{}</title></circle>", escape_xml(title))),
                None => append_line(out, format_args!("{circle}/>")),
            }
        }
        MapMark::Triangle { corners, ink } => {
            append_line(
                out,
                format_args!("<polygon points=\"{}\" fill=\"{}\"/>", list_points(corners), css_colour(*ink)),
            );
        }
        MapMark::Text { at: [x, y], size, text, ink, is_centred } => {
            let anchor = if *is_centred { " text-anchor=\"middle\"" } else { "" };
            let place = format!("x=\"{x}\" y=\"{}\" font-size=\"{size}\"{anchor}", round_units(y + 0.36 * size));
            append_line(out, format_args!("<text {place} fill=\"{}\">{}</text>", css_colour(*ink), escape_xml(text)));
        }
    }
}

fn append_line(out: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a text cannot fail.
    let _ = writeln!(out, "{text}");
}

fn list_points(points: &[SheetPoint]) -> String {
    points.iter().map(|[x, y]| format!("{},{}", round_units(*x), round_units(*y))).collect::<Vec<_>>().join(" ")
}

fn round_units(units: f64) -> f64 {
    (units * 100.0).round() / 100.0
}

fn css_colour([r, g, b]: InkColour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A text between tags. Unseen characters are shown, and those that XML forbids become U+FFFD.
fn escape_xml(text: &str) -> String {
    show_unseen(text).chars().fold(String::with_capacity(text.len()), |mut out, c| {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
        out
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn svg_escapes_names_from_files() {
        assert_eq!(escape_xml("a<b>&\"c\u{1}"), "a&lt;b&gt;&amp;&quot;c\\u{1}");
        let mark =
            MapMark::Disc { at: [1.0, 2.0], radius: 3.0, ink: [255, 0, 0], title: Some("</title><script>".into()) };
        let sketch = MapSketch { size: [10.0, 10.0], picture: None, marks: vec![mark] };
        let svg = sketch_svg(&sketch, "\"<svg>").unwrap();
        assert!(!svg.contains("<script>") && svg.matches("<svg").count() == 1, "{svg}");
        assert!(svg.contains(r##"<circle cx="1" cy="2" r="3" fill="#ff0000">"##), "{svg}");
    }
}
