//! A run as one HTML page that needs nothing but itself: map, frames, dialogue, captions, instructions and checks.
//!
//! The page is made item by item, so that its size is not bound by memory, and the same run gives the same bytes. All that
//! comes from files or models is untrusted: the templates escape it, and the page forbids itself scripts and addresses.

pub mod comparison;
pub(crate) mod data_uri;
mod frames;
pub(crate) mod map;
mod model;
mod page;
pub(crate) mod palette;
mod pictures;
mod places;
mod records;
pub mod replay;
pub(crate) mod sheet;
mod spans;
mod texts;

use crate::error::Error;
use minijinja::{AutoEscape, Environment, UndefinedBehavior};
use model::ItemView;
use page::PageView;
use pictures::Pictures;
use records::Records;
use serde::Serialize;
use std::{
    fmt,
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::Path,
};

/// What was written.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Written {
    /// The page.
    pub page: String,
    /// Items on it.
    pub items: usize,
    /// Items of the run that are not on it.
    pub left_out: usize,
    /// Pictures on it.
    pub pictures: usize,
    /// Pictures of its items that are not on it: missing, no JPEG, too large, or the page was full.
    pub pictures_left_out: usize,
}

impl fmt::Display for Written {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {} items, {} pictures", self.page, self.items, self.pictures)?;
        if self.left_out > 0 {
            write!(f, "; {} items left out (see --items)", self.left_out)?;
        }
        if self.pictures_left_out > 0 {
            write!(f, "; {} pictures left out", self.pictures_left_out)?;
        }
        Ok(())
    }
}

/// Writes the page of a run, with its first `most_items` items; what was there before is replaced once the page is whole.
///
/// # Errors
/// When `run` is no run folder, a line of it is not of its kind, or the page cannot be written.
pub fn write(run: &Path, out: &Path, most_items: usize) -> Result<Written, Error> {
    let records = Records::read(run, most_items)?;
    let pictures = replace(out, |take| render(&records, run, take))?;
    Ok(Written {
        page: out.display().to_string(),
        items: records.items.len(),
        left_out: records.left_out,
        pictures: pictures.shown,
        pictures_left_out: pictures.left_out,
    })
}

/// Takes a page part by part.
type Take<'a> = dyn FnMut(&str) -> Result<(), Error> + 'a;

/// Writes a page; what was there before is replaced once the page is whole.
fn replace<T>(out: &Path, render: impl FnOnce(&mut Take<'_>) -> Result<T, Error>) -> Result<T, Error> {
    let mut name = out.file_name().unwrap_or_default().to_owned();
    name.push(".new");
    let unfinished = out.with_file_name(name);
    let mut page = BufWriter::new(File::create(&unfinished).map_err(Error::io(&unfinished, "write"))?);
    let told = render(&mut |part| page.write_all(part.as_bytes()).map_err(Error::io(&unfinished, "write")))?;
    page.into_inner().map_err(io::IntoInnerError::into_error).map_err(Error::io(&unfinished, "write"))?;
    fs::rename(&unfinished, out).map_err(Error::io(out, "write"))?;
    Ok(told)
}

/// Hands the page to `take`, part by part.
fn render(records: &Records, run: &Path, take: &mut Take<'_>) -> Result<Pictures, Error> {
    let templates = templates().map_err(broken)?;
    let draw = |name: &str, view: minijinja::Value| templates.get_template(name)?.render(view);
    let mut pictures = Pictures::of(run);
    take(&draw("head.html", minijinja::Value::from_serialize(PageView::new(records))).map_err(broken)?)?;
    for (at, record) in records.items.iter().enumerate() {
        let view = ItemView::new(at + 1, record, &mut pictures);
        take(&draw("item.html", minijinja::Value::from_serialize(view)).map_err(broken)?)?;
    }
    take(include_str!("foot.html"))?;
    Ok(pictures)
}

fn templates() -> Result<Environment<'static>, minijinja::Error> {
    let mut templates = Environment::new();
    templates.set_undefined_behavior(UndefinedBehavior::Strict);
    templates.set_auto_escape_callback(|name| if name.ends_with(".css") { AutoEscape::None } else { AutoEscape::Html });
    templates.set_trim_blocks(true);
    templates.set_lstrip_blocks(true);
    templates.set_keep_trailing_newline(true);
    templates.add_template("style.css", include_str!("style.css"))?;
    templates.add_template("signs.html", include_str!("signs.html"))?;
    templates.add_template("open.html", include_str!("open.html"))?;
    templates.add_template("head.html", include_str!("head.html"))?;
    templates.add_template("map.html", include_str!("map.html"))?;
    templates.add_template("text.html", include_str!("text.html"))?;
    templates.add_template("item.html", include_str!("item.html"))?;
    templates.add_template("comparison.css", include_str!("comparison/style.css"))?;
    templates.add_template("comparison.html", include_str!("comparison/page.html"))?;
    templates.add_template("table.html", include_str!("comparison/table.html"))?;
    templates.add_template("forest.html", include_str!("comparison/forest.html"))?;
    templates.add_template("replay.html", include_str!("replay/replay.html"))?;
    Ok(templates)
}

// A closure's argument cannot be a reference where `map_err` gives the value away.
#[allow(clippy::needless_pass_by_value)]
fn broken(error: minijinja::Error) -> Error {
    Error::usage(format!("the page cannot be drawn: {error:#}"), "report this as a bug")
}

#[cfg(test)]
mod tests;
