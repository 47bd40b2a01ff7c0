//! Writes a sketch as an SVG. Pictures are inside it, so it loads no other file.

use super::{
    super::{file_kind::SVG_START, picture},
    sketch::{Ink, Mark, Point, Sketch},
};
use crate::pages::data_uri;
use std::fmt::Write;
use wayword_run::error::Error;

/// The drawing as text; `title` is shown when the user points at it.
///
/// # Errors
/// When the picture below cannot be encoded.
pub(super) fn svg(sketch: &Sketch, title: &str) -> Result<String, Error> {
    let [width, height] = sketch.size;
    let mut out = format!(
        "{SVG_START}xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-weight=\"bold\">\n<title>{}</title>\n<rect width=\"100%\" height=\"100%\" \
         fill=\"#fff\"/>\n",
        escaped(title)
    );
    if let Some((image, [low, high])) = &sketch.picture {
        let (size, data) = ([high[0] - low[0], high[1] - low[1]].map(tidy), data_uri::jpeg(&picture::jpeg(image)?));
        let place = format!("x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"", low[0], low[1], size[0], size[1]);
        line(&mut out, format_args!("<image {place} preserveAspectRatio=\"none\" href=\"{data}\"/>"));
    }
    for mark in &sketch.marks {
        draw(&mut out, mark);
    }
    out.push_str("</svg>\n");
    Ok(out)
}

fn draw(out: &mut String, mark: &Mark) {
    match mark {
        Mark::Line { points, width, ink, dash } => {
            let dash = dash.map_or(String::new(), |[on, off]| format!(" stroke-dasharray=\"{on} {off}\""));
            let (points, ink) = (listed(points), css(*ink));
            let style = "fill=\"none\" stroke-linecap=\"round\" stroke-linejoin=\"round\"";
            line(
                out,
                format_args!("<polyline points=\"{points}\" {style} stroke=\"{ink}\" stroke-width=\"{width}\"{dash}/>"),
            );
        }
        Mark::Disc { at: [x, y], radius, ink, title } => {
            let circle = format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{}\"", css(*ink));
            match title {
                Some(title) => line(out, format_args!("{circle}><title>{}</title></circle>", escaped(title))),
                None => line(out, format_args!("{circle}/>")),
            }
        }
        Mark::Triangle { corners, ink } => {
            line(out, format_args!("<polygon points=\"{}\" fill=\"{}\"/>", listed(corners), css(*ink)));
        }
        Mark::Text { at: [x, y], size, text, ink, is_centred } => {
            let anchor = if *is_centred { " text-anchor=\"middle\"" } else { "" };
            let place = format!("x=\"{x}\" y=\"{}\" font-size=\"{size}\"{anchor}", tidy(y + 0.36 * size));
            line(out, format_args!("<text {place} fill=\"{}\">{}</text>", css(*ink), escaped(text)));
        }
    }
}

fn line(out: &mut String, text: std::fmt::Arguments<'_>) {
    // Writing to a text cannot fail.
    let _ = writeln!(out, "{text}");
}

fn listed(points: &[Point]) -> String {
    points.iter().map(|[x, y]| format!("{},{}", tidy(*x), tidy(*y))).collect::<Vec<_>>().join(" ")
}

fn tidy(units: f64) -> f64 {
    (units * 100.0).round() / 100.0
}

fn css([r, g, b]: Ink) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A text between tags. Characters that XML forbids become U+FFFD.
fn escaped(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut out, c| {
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
        assert_eq!(escaped("a<b>&\"c\u{1}"), "a&lt;b&gt;&amp;&quot;c\u{fffd}");
        let mark = Mark::Disc { at: [1.0, 2.0], radius: 3.0, ink: [255, 0, 0], title: Some("</title><script>".into()) };
        let sketch = Sketch { size: [10.0, 10.0], picture: None, marks: vec![mark] };
        let svg = svg(&sketch, "\"<svg>").unwrap();
        assert!(!svg.contains("<script>") && svg.matches("<svg").count() == 1, "{svg}");
        assert!(svg.contains(r##"<circle cx="1" cy="2" r="3" fill="#ff0000">"##), "{svg}");
    }
}
