//! The page for curators: pairs of a film and a text, the worst first, accepted or rejected by keys. Its script keeps the decisions in the
//! browser, and saves them as a file.

#[cfg(all(feature = "lerobot", feature = "parquet"))]
mod annotations;

#[cfg(all(feature = "lerobot", feature = "parquet"))]
pub use annotations::write_annotation_pages;

use super::{frames::turn_sign, load_templates, replace_page, script_hash, template_error};
use minijinja::context;
use serde::Serialize;
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};
use wayword_core::TurnKind;
use wayword_follower::pair::PairMotion;
use wayword_run::{
    error::CommandError,
    pairs::{FilmRecord, PICTURES, PairPartRecord, PairPartState, PairRecord, PairReport, read_films},
    pictures::WrittenPicture,
};

/// Pairs on a page.
const PAIRS_PER_PAGE: usize = 100;
/// Most things of a frame that are named.
const MOST_SEEN: usize = 8;
/// The script of these pages: the only one that their content security policy allows.
const SCRIPT: &str = include_str!("curate.js");

/// A page, as the template has it.
#[derive(Serialize)]
struct CuratedPage<'a> {
    title: &'static str,
    dataset: &'a str,
    page: usize,
    pages: &'a [PageLink],
    previous: Option<String>,
    next: Option<String>,
    total: usize,
    base_rate_percent: f64,
    decisions_key: &'a str,
    pairs: Vec<CuratedPair<'a>>,
}

/// A link to a page.
#[derive(Clone, Serialize)]
struct PageLink {
    href: String,
    first: usize,
    last: usize,
    is_here: bool,
}

/// A pair on a page.
#[derive(Serialize)]
struct CuratedPair<'a> {
    anchor: String,
    number: usize,
    id: &'a str,
    mark: CuratedMark,
    /// What `scene` is: "Scene", "Task".
    about: &'static str,
    scene: &'a str,
    source: &'static str,
    parts: Vec<CuratedPart<'a>>,
    frames: Vec<CuratedFrame<'a>>,
    /// More about it, below a heading.
    notes: Vec<String>,
    notes_title: &'static str,
}

/// The mark beside the name of a pair.
#[derive(Serialize)]
struct CuratedMark {
    class: &'static str,
    words: String,
}

/// A piece of a text: a part, or the words between two parts.
#[derive(Serialize)]
struct CuratedPart<'a> {
    /// From 1; none for words that belong to no part.
    number: Option<usize>,
    words: &'a str,
    state: &'static str,
    frames: Option<[usize; 2]>,
    reasons: Vec<&'a str>,
}

/// A frame of a pair's film.
#[derive(Serialize)]
struct CuratedFrame<'a> {
    number: usize,
    picture: Option<CuratedPicture>,
    seen: &'a [String],
    room: Option<&'a str>,
    then: Option<String>,
    sign: Option<&'static str>,
}

#[derive(Serialize)]
struct CuratedPicture {
    address: String,
    width_px: u32,
    height_px: u32,
}

/// Writes the pages of a check into its folder; returns the first.
///
/// # Errors
/// When the films cannot be read, or a page cannot be written.
pub fn write_curators_pages(folder: &Path, report: &PairReport) -> Result<PathBuf, CommandError> {
    let films = read_films(folder)?;
    let films: BTreeMap<&str, &FilmRecord> =
        films.iter().flat_map(|film| film.pairs.iter().map(move |pair| (pair.pair.as_str(), film))).collect();
    let templates = load_templates().map_err(template_error)?;
    let all = report.pairs.len();
    let pages = all.div_ceil(PAIRS_PER_PAGE).max(1);
    for page in 1..=pages {
        let links = PageLink::all(all, page);
        let first = (page - 1) * PAIRS_PER_PAGE;
        let shown = report.pairs.iter().enumerate().skip(first).take(PAIRS_PER_PAGE);
        let view = CuratedPage {
            title: "Pairs to accept or reject",
            dataset: &report.asked.dataset,
            page,
            previous: (page > 1).then(|| PageLink::file(page - 1)),
            next: (page < pages).then(|| PageLink::file(page + 1)),
            pages: &links,
            total: all,
            base_rate_percent: (1000.0 * report.asked.base_rate).round() / 10.0,
            decisions_key: &report.asked.texts,
            pairs: shown
                .map(|(at, pair)| {
                    curated_pair(at + 1, pair, films.get(pair.pair.as_str()).copied(), report.asked.base_rate)
                })
                .collect(),
        };
        let view = context! { page => view, has_files => true, script => SCRIPT, script_hash => script_hash(SCRIPT) };
        let drawn = templates.get_template("curate.html").and_then(|template| template.render(view));
        replace_page(&folder.join(PageLink::file(page)), |take| take(&drawn.map_err(template_error)?))?;
    }
    remove_later_pages(folder, pages)?;
    Ok(folder.join(PageLink::file(1)))
}

impl PageLink {
    /// The file of a page, from 1.
    fn file(page: usize) -> String {
        if page == 1 { "index.html".to_owned() } else { format!("page-{page}.html") }
    }

    /// The links to all pages of so many pairs, as one of them has them.
    fn all(pairs: usize, here: usize) -> Vec<Self> {
        let link = |page: usize| Self {
            href: Self::file(page),
            first: (page - 1) * PAIRS_PER_PAGE + 1,
            last: (page * PAIRS_PER_PAGE).min(pairs),
            is_here: page == here,
        };
        (1..=pairs.div_ceil(PAIRS_PER_PAGE).max(1)).map(link).collect()
    }
}

/// The word for a state, as style and script have it.
fn state_word(state: PairPartState) -> &'static str {
    match state {
        PairPartState::Fits => "fits",
        PairPartState::Unverified => "unverified",
        PairPartState::Wrong => "wrong",
    }
}

/// Removes the pages of an earlier check that had more of them.
fn remove_later_pages(folder: &Path, pages: usize) -> Result<(), CommandError> {
    for page in pages + 1.. {
        let file = folder.join(PageLink::file(page));
        if !file.is_file() {
            return Ok(());
        }
        fs::remove_file(&file).map_err(CommandError::io(&file, "remove"))?;
    }
    Ok(())
}

fn curated_pair<'a>(
    number: usize,
    pair: &'a PairRecord,
    film: Option<&'a FilmRecord>,
    base_rate: f64,
) -> CuratedPair<'a> {
    // Where a film is long, its pictures stand for all its frames.
    let frames = film.into_iter().flat_map(|film| {
        let mut firsts: BTreeMap<usize, usize> = BTreeMap::new();
        for (at, place) in film.walk.places.iter().enumerate() {
            firsts.entry(place.frame).or_insert(at);
        }
        let is_shown = |frame: &usize| film.pictures.is_empty() || film.pictures.contains_key(frame);
        let shown: Vec<(usize, usize)> = firsts.into_iter().filter(|(frame, _)| is_shown(frame)).collect();
        let ends: Vec<usize> = shown.iter().skip(1).chain(shown.last()).map(|(_, at)| *at).collect();
        shown.into_iter().zip(ends).map(move |((frame, at), end)| curated_frame(frame, film, [at, end]))
    });
    CuratedPair {
        anchor: format!("pair-{number}"),
        number,
        id: &pair.pair,
        mark: chance_mark(pair, base_rate),
        about: "Scene",
        scene: &pair.scene,
        source: match film.map(|film| film.walk.motion()) {
            Some(PairMotion::Poses) => "poses known",
            Some(PairMotion::Pictures) => "motion estimated from the pictures",
            Some(PairMotion::Unknown) | None => "motion unknown",
        },
        parts: curated_parts(pair),
        frames: frames.collect(),
        notes: Vec::new(),
        notes_title: "",
    }
}

/// A pair with at least this chance to be wrong is no good one, however many are expected to be wrong.
const DOUBTED_CHANCE: f64 = 0.2;

/// The chance that a pair is wrong, or why there is none.
fn chance_mark(pair: &PairRecord, base_rate: f64) -> CuratedMark {
    let Some(chance) = pair.chance_wrong else {
        return CuratedMark { class: "bad", words: pair.problem.clone().unwrap_or_default() };
    };
    let class = match chance {
        chance if chance >= 0.5 => "bad",
        chance if chance > base_rate.min(DOUBTED_CHANCE) => "open",
        _ => "good",
    };
    // No chance is certain.
    CuratedMark { class, words: format!("{:.0} % chance to be wrong", (100.0 * chance).clamp(1.0, 99.0)) }
}

/// The text in order: its parts, and the words between them.
fn curated_parts(pair: &PairRecord) -> Vec<CuratedPart<'_>> {
    let mut pieces = Vec::new();
    let mut at = 0;
    let between = |from: usize, to: usize| CuratedPart::between(pair.text.get(from..to).unwrap_or_default());
    for (number, part) in pair.parts.iter().enumerate() {
        let [from, to] = part.span;
        if from > at {
            pieces.push(between(at, from));
        }
        pieces.push(curated_part(number + 1, part, pair.text.get(from.max(at)..to).unwrap_or_default()));
        at = at.max(to);
    }
    if at < pair.text.len() {
        pieces.push(between(at, pair.text.len()));
    }
    pieces
}

impl<'a> CuratedPart<'a> {
    /// Words that belong to no part.
    fn between(words: &'a str) -> Self {
        Self { number: None, words, state: "unverified", frames: None, reasons: Vec::new() }
    }
}

fn curated_part<'a>(number: usize, part: &'a PairPartRecord, words: &'a str) -> CuratedPart<'a> {
    CuratedPart {
        number: Some(number),
        words,
        state: state_word(part.state),
        frames: Some(part.frames),
        reasons: part.findings.iter().map(|finding| finding.reason.as_str()).collect(),
    }
}

/// A frame with the turn on the way from its place to that of the next frame that is shown.
fn curated_frame(number: usize, film: &FilmRecord, [at, end]: [usize; 2]) -> CuratedFrame<'_> {
    let place = &film.walk.places[at];
    let hops = film.walk.hops.get(at..end).unwrap_or_default();
    let turn: Option<f64> = hops.iter().map(|hop| hop.turn_rad).sum();
    let turn = turn.filter(|_| !hops.is_empty()).map(|rad| (rad, TurnKind::from_rad(rad)));
    CuratedFrame {
        number,
        picture: film.pictures.get(&number).map(CuratedPicture::new),
        seen: &place.things[..place.things.len().min(MOST_SEEN)],
        room: place.rooms.first().map(String::as_str),
        then: turn.map(|(rad, kind)| match kind {
            TurnKind::Straight => "straight".to_owned(),
            _ => format!("{} {:.0}°", if rad < 0.0 { "left" } else { "right" }, rad.to_degrees().abs()),
        }),
        sign: turn.map(|(_, kind)| turn_sign(kind)),
    }
}

impl CuratedPicture {
    fn new((name, width_px, height_px): &WrittenPicture) -> Self {
        Self { address: format!("{PICTURES}/{name}"), width_px: *width_px, height_px: *height_px }
    }
}
