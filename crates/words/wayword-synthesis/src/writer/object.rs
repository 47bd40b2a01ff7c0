//! Words for the object of the task: its name, and the properties that distinguish it from other objects.

use crate::{
    style::Wording,
    weighed::weighed,
    writer::{Brief, WriteError, phrases::ordinal, task::free_object},
};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use wayword_core::{Description, Distinction, Relation, Side};
use wayword_language::lexicon::{agree, is_plural};

/// The object of the task with its possible descriptions.
pub(super) struct Said<'a> {
    pub(super) name: String,
    /// Its name in this text.
    called: String,
    descriptions: &'a [Description],
    told_by: &'a [Distinction],
    has_namesake: bool,
    hangs: bool,
}

/// How much more often "on the wall" is used for hanging things than for all things.
const OF_HANGING: f64 = 10.0;

impl<'a> Said<'a> {
    pub(super) fn of(brief: &Brief<'a>, rng: &mut ChaCha8Rng) -> Result<Self, WriteError> {
        let walk = brief.walk;
        let wording = &brief.profile.wording;
        Ok(match &walk.path.target {
            Some(target) => Self {
                name: target.name.clone(),
                called: wording.called(&target.name, rng).to_owned(),
                descriptions: &target.descriptions,
                told_by: &target.told_by,
                has_namesake: target.has_namesake,
                hangs: target.hangs,
            },
            None => {
                let name = free_object(brief, rng).ok_or(WriteError::NoObject)?;
                Self { called: name.clone(), name, descriptions: &[], told_by: &[], has_namesake: false, hangs: false }
            }
        })
    }

    /// Draws a description of the object: if `is_sure`, one that fits no other object, with the shares of the style;
    /// otherwise anything true. `more` asks for additional properties.
    pub(super) fn description(
        &self,
        wording: &Wording,
        is_sure: bool,
        more: usize,
        rng: &mut ChaCha8Rng,
    ) -> Vec<&'a Distinction> {
        let all: Vec<&[Distinction]> = if self.descriptions.is_empty() {
            self.told_by.iter().map(std::slice::from_ref).collect()
        } else {
            self.descriptions.iter().map(|description| description.by.as_slice()).collect()
        };
        let mut by: Vec<&Distinction> = if is_sure { draw(&all, wording, rng).iter().collect() } else { Vec::new() };
        // Additional properties of another kind do not make it less clear.
        let said_of = |by: &[&Distinction], of: &dyn Fn(&Distinction) -> bool| by.iter().any(|by| of(by));
        let extra = if is_sure { more } else { more.max(usize::from(rng.random_bool(wording.share("object")))) };
        for _ in 0..extra {
            let of_object = by.iter().filter(|by| !by.is_of_room()).count();
            let has_by = said_of(&by, &|by| matches!(by, Distinction::RoomBy { .. }));
            let has_with = said_of(&by, &|by| matches!(by, Distinction::RoomWith { .. }));
            let repeats =
                |other: &Distinction| by.iter().any(|by| by.names().any(|name| other.names().any(|o| agree(o, name))));
            let adds = |other: &&Distinction| match other {
                _ if repeats(other) => false,
                Distinction::RoomBy { .. } => !has_by,
                Distinction::RoomWith { .. } => !has_with,
                Distinction::Related { .. } | Distinction::NextTo { .. } => of_object < 1 + usize::from(extra > 1),
                _ => false,
            };
            let others = all.iter().flat_map(|by| by.iter()).filter(adds).map(std::slice::from_ref);
            by.extend(draw(&others.collect::<Vec<_>>(), wording, rng));
        }
        if self.has_namesake && !said_of(&by, &|by| !by.is_of_room()) {
            by.extend(self.in_view(wording, rng));
        }
        by
    }

    /// Draws a property that distinguishes the object from its namesakes in view at the end. An object without
    /// namesakes gets one as often as people mention one.
    pub(super) fn in_view(&self, wording: &Wording, rng: &mut ChaCha8Rng) -> Vec<&'a Distinction> {
        let says = self.has_namesake || rng.random_bool(wording.share("object"));
        let told: Vec<&[Distinction]> = self.told_by.iter().map(std::slice::from_ref).collect();
        draw(if says { &told } else { &[] }, wording, rng).iter().collect()
    }

    /// The object with its article.
    pub(super) fn phrase(&self, by: &[&Distinction], wording: &Wording, rng: &mut ChaCha8Rng) -> String {
        let of_object = by.iter().filter(|by| !by.is_of_room());
        let (mut phrase, mut behind) = (format!("the {}", self.called), Vec::new());
        for by in of_object {
            match *by {
                Distinction::Colour { colour } => phrase = phrase.replacen("the ", &format!("the {colour} "), 1),
                Distinction::InRow { .. } | Distinction::Range { .. } | Distinction::Height { .. } => {
                    phrase = superlative(by, &self.called, wording, rng).unwrap_or(phrase);
                }
                _ => behind.extend(relation(by, wording, rng)),
            }
        }
        let is_on = by.iter().any(|by| matches!(by, Distinction::Related { relation: Relation::On, .. }));
        if self.hangs && !is_on && rng.random_bool((wording.share("wall") * OF_HANGING).min(0.6)) {
            behind.insert(0, wording.draw("wall", rng, |_| true).unwrap_or("on the wall").to_owned());
        }
        let link = wording.draw("link", rng, |link| link != "located" && link != "that's" || behind.len() == 1);
        if let (Some(first), Some(link)) = (behind.first_mut(), link.filter(|link| !link.is_empty())) {
            let link = match link.split_once(['\'', ' ']) {
                Some((that, "s" | "is")) if is_plural(&self.called) => format!("{that} are"),
                _ => link.to_owned(),
            };
            *first = format!("{link} {first}");
        }
        std::iter::once(phrase).chain(behind).collect::<Vec<_>>().join(" ")
    }
}

/// Draws one of several descriptions: first the combination of kinds of properties, by how likely people use it, then
/// one description of it, cheaper ones more often.
fn draw<'a>(all: &[&'a [Distinction]], wording: &Wording, rng: &mut ChaCha8Rng) -> &'a [Distinction] {
    let mut of_kind: BTreeMap<Vec<&str>, Vec<&'a [Distinction]>> = BTreeMap::new();
    for by in all {
        of_kind.entry(by.iter().map(table).collect()).or_default().push(by);
    }
    let kinds: Vec<&Vec<&[Distinction]>> = of_kind.values().collect();
    let weights: Vec<f64> = kinds.iter().map(|kind| likelihood(kind[0], wording)).collect();
    let Some(kind) = weighed(&weights, rng) else { return &[] };
    let cheaper: Vec<f64> = (0..kinds[kind].len()).map(|at| 0.85_f64.powi(at as i32)).collect();
    weighed(&cheaper, rng).map_or(&[], |at| kinds[kind][at])
}

/// How likely a text of the style uses exactly these properties of an object and its room.
fn likelihood(by: &[Distinction], wording: &Wording) -> f64 {
    let told = wording.table("told");
    let all: f64 = told.values().sum::<f64>().max(1e-9);
    let share = |table: &str| told.get(table).copied().unwrap_or(0.5) / all;
    let odds = |name: &str| wording.share(name) / (1.0 - wording.share(name)).max(0.05);
    let one = |by: &Distinction| match by {
        Distinction::Level { .. } => odds("level").max(0.4) * 0.8,
        Distinction::RoomBy { .. } => odds("room by") * 0.6,
        Distinction::RoomWith { .. } => odds("room with") * 0.25,
        Distinction::OnSide { .. } => odds("object") * share("side") * 2.0,
        // "Near" is almost always possible: of the descriptions that single a target out, most contain it.
        Distinction::Related { relation: Relation::Near, .. } => odds("object") * share("near") * 1.2,
        // The measured share is for both sides together.
        Distinction::Related { relation: Relation::LeftOf | Relation::RightOf, .. } => {
            odds("object") * share("beside") * 1.5
        }
        _ => odds("object") * share(table(by)) * 3.0,
    };
    by.iter().map(one).product()
}

/// The name of the table of constructions for a property.
fn table(by: &Distinction) -> &'static str {
    match by {
        Distinction::NextTo { .. } => "closest",
        Distinction::Related { relation: Relation::Near, .. } => "near",
        Distinction::Related { relation: Relation::Above, .. } => "above",
        Distinction::Related { relation: Relation::Under, .. } => "under",
        Distinction::Related { relation: Relation::On, .. } => "on",
        Distinction::Related { relation: Relation::LeftOf | Relation::RightOf, .. } => "beside",
        Distinction::Between { .. } => "between",
        Distinction::OnSide { .. } => "side",
        Distinction::InRow { place: 1, .. } => "row first",
        Distinction::InRow { place: 2, of: 3, .. } | Distinction::InRow { place: 3, of: 5, .. } => "middle",
        Distinction::InRow { .. } => "row",
        Distinction::Range { nearest: true } => "nearest",
        Distinction::Range { nearest: false } => "furthest",
        Distinction::Height { highest: true } => "highest",
        Distinction::Height { highest: false } => "lowest",
        Distinction::Colour { .. } => "colour",
        Distinction::Level { .. } => "level",
        Distinction::RoomBy { .. } => "room by",
        Distinction::RoomWith { .. } => "room with",
    }
}

fn superlative(by: &Distinction, name: &str, wording: &Wording, rng: &mut ChaCha8Rng) -> Option<String> {
    let way = wording.draw(table(by), rng, |_| true)?;
    let (place, is_right) = match by {
        Distinction::InRow { place, from, .. } => (*place as u32, *from == Side::Right),
        _ => (1, false),
    };
    let way = way.replace("{th}", ordinal(place)?);
    let way = if is_right { way.replace("leftmost", "rightmost").replace("left", "right") } else { way };
    Some(way.replace("{o}", name))
}

fn relation(by: &Distinction, wording: &Wording, rng: &mut ChaCha8Rng) -> Option<String> {
    let way = wording.draw(table(by), rng, |_| true)?;
    Some(match by {
        Distinction::Related { relation: Relation::RightOf, to } => {
            way.replace("left", "right").replace("{x}", wording.called(to, rng))
        }
        Distinction::NextTo { neighbour: to } | Distinction::Related { to, .. } => {
            way.replace("{x}", wording.called(to, rng))
        }
        Distinction::Between { one, other } => way.replace("{x}", one).replace("{y}", other),
        Distinction::OnSide { side: Side::Right } => way.replace("left", "right"),
        Distinction::OnSide { side: Side::Left } => way.to_owned(),
        _ => return None,
    })
}
