//! The object of the task: chosen where no target is given, with words for its name and for the properties that
//! distinguish it from other objects.

use crate::{
    style::PlaceWording,
    weighted_draw::draw_weighted,
    writer::{WriteError, WritingBrief, phrases::ordinal_of},
};
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use wayword_core::{ObjectDescription, ObjectDistinction, ObjectRelation, Side, Verdict};
use wayword_language::lexicon::{ThingClass, find_thing, is_plural, names_agree, normalise_name};

/// What a text tells of the object of its task, in English names.
#[derive(Clone)]
pub(super) struct ObjectContent {
    /// Its name in this text.
    pub(super) called: String,
    /// The properties of the object that the text names.
    pub(super) by: Vec<ObjectDistinction>,
    /// Whether it has "on the wall".
    pub(super) on_wall: bool,
}

/// The object of the task with its possible descriptions.
pub(super) struct TaskObject<'a> {
    pub(super) name: String,
    /// Its name in this text.
    called: String,
    /// Combinations of properties that fit the object, for a listener who knows the building.
    descriptions: &'a [ObjectDescription],
    /// Single properties that distinguish it from its namesakes in view.
    told_by: &'a [ObjectDistinction],
    /// Whether another object of its name is in view at the end.
    has_namesake: bool,
    /// Whether it certainly hangs on a wall.
    hangs: bool,
}

/// How much more often "on the wall" is used for hanging things than for all things.
const HANGING_WALL_FACTOR: f64 = 10.0;

impl<'a> TaskObject<'a> {
    /// The target of the path, or an object that is chosen from those in view at the end.
    pub(super) fn for_brief(brief: &WritingBrief<'a>, rng: &mut ChaCha8Rng) -> Result<Self, WriteError> {
        let walk = brief.walk;
        let wording = &brief.profile.wording;
        Ok(match &walk.path.target {
            Some(target) => Self {
                name: target.name.clone(),
                called: wording.draw_name(&target.name, rng).to_owned(),
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
    pub(super) fn draw_description(
        &self,
        wording: &PlaceWording,
        is_sure: bool,
        more: usize,
        rng: &mut ChaCha8Rng,
    ) -> Vec<&'a ObjectDistinction> {
        let all: Vec<&[ObjectDistinction]> = if self.descriptions.is_empty() {
            self.told_by.iter().map(std::slice::from_ref).collect()
        } else {
            self.descriptions.iter().map(|description| description.by.as_slice()).collect()
        };
        let mut by: Vec<&ObjectDistinction> =
            if is_sure { draw_distinctions(&all, wording, rng).iter().collect() } else { Vec::new() };
        // Additional properties of another kind do not make it less clear.
        let has_any = |by: &[&ObjectDistinction], of: &dyn Fn(&ObjectDistinction) -> bool| by.iter().any(|by| of(by));
        let extra =
            if is_sure { more } else { more.max(usize::from(rng.random_bool(wording.share_of_texts("object")))) };
        for _ in 0..extra {
            let of_object = by.iter().filter(|by| !by.is_about_room()).count();
            let has_by = has_any(&by, &|by| matches!(by, ObjectDistinction::RoomBy { .. }));
            let has_with = has_any(&by, &|by| matches!(by, ObjectDistinction::RoomWith { .. }));
            let repeats = |other: &ObjectDistinction| {
                by.iter().any(|by| by.named_things().any(|name| other.named_things().any(|o| names_agree(o, name))))
            };
            let adds = |other: &&ObjectDistinction| match other {
                _ if repeats(other) => false,
                ObjectDistinction::RoomBy { .. } => !has_by,
                ObjectDistinction::RoomWith { .. } => !has_with,
                ObjectDistinction::Related { .. } | ObjectDistinction::NextTo { .. } => {
                    of_object < 1 + usize::from(extra > 1)
                }
                _ => false,
            };
            let others = all.iter().flat_map(|by| by.iter()).filter(adds).map(std::slice::from_ref);
            by.extend(draw_distinctions(&others.collect::<Vec<_>>(), wording, rng));
        }
        if self.has_namesake && !has_any(&by, &|by| !by.is_about_room()) {
            by.extend(self.draw_distinction_in_view(wording, rng));
        }
        by
    }

    /// Draws a property that distinguishes the object from its namesakes in view at the end. An object without
    /// namesakes gets one as often as people mention one.
    pub(super) fn draw_distinction_in_view(
        &self,
        wording: &PlaceWording,
        rng: &mut ChaCha8Rng,
    ) -> Vec<&'a ObjectDistinction> {
        let mentions_one = self.has_namesake || rng.random_bool(wording.share_of_texts("object"));
        let told: Vec<&[ObjectDistinction]> = self.told_by.iter().map(std::slice::from_ref).collect();
        draw_distinctions(if mentions_one { &told } else { &[] }, wording, rng).iter().collect()
    }

    /// The object with its article and those of the properties in `by` that are about the object; in words, and what they say.
    pub(super) fn object_phrase(
        &self,
        by: &[&ObjectDistinction],
        wording: &PlaceWording,
        rng: &mut ChaCha8Rng,
    ) -> (String, ObjectContent) {
        let of_object = by.iter().filter(|by| !by.is_about_room());
        let (mut phrase, mut behind) = (format!("the {}", self.called), Vec::new());
        for by in of_object {
            match *by {
                ObjectDistinction::Colour { colour } => phrase = phrase.replacen("the ", &format!("the {colour} "), 1),
                ObjectDistinction::InRow { .. }
                | ObjectDistinction::Range { .. }
                | ObjectDistinction::Height { .. } => {
                    phrase = superlative_phrase(by, &self.called, wording, rng).unwrap_or(phrase);
                }
                _ => behind.extend(relation_phrase(by, wording, rng)),
            }
        }
        let is_on = by.iter().any(|by| matches!(by, ObjectDistinction::Related { relation: ObjectRelation::On, .. }));
        let wall_share = (wording.share_of_texts("wall") * HANGING_WALL_FACTOR).min(0.6);
        let on_wall = self.hangs && !is_on && rng.random_bool(wall_share);
        if on_wall {
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
        let by = by.iter().filter(|by| !by.is_about_room()).map(|by| (*by).clone()).collect();
        let content = ObjectContent { called: self.called.clone(), by, on_wall };
        (std::iter::once(phrase).chain(behind).collect::<Vec<_>>().join(" "), content)
    }
}

/// Chooses an object for the task that was seen from the last frame, preferably the only one of its kind and a good
/// landmark.
fn free_object(brief: &WritingBrief<'_>, rng: &mut ChaCha8Rng) -> Option<String> {
    let last = brief.walk.path.frames.len() - 1;
    let blamed = |name: &str| {
        let failed = brief.complaints.iter().flat_map(|complaint| {
            complaint
                .findings
                .iter()
                .filter(|finding| finding.verdict == Verdict::Fail)
                .map(move |finding| (complaint, finding))
        });
        failed
            .filter_map(|(complaint, finding)| complaint.text.get(finding.span?[0]..finding.span?[1]))
            .any(|words| normalise_name(words) == normalise_name(name))
    };
    let seen: Vec<_> = brief.walk.seen_from(last).collect();
    let alone = |name: &str| seen.iter().filter(|other| names_agree(&other.sighting.name, name)).count() == 1;
    let plain = |name: &str| name.len() <= 40 && name.chars().all(|c| c.is_alphabetic() || c == ' ');
    let candidates = seen.iter().filter(|seen| plain(&seen.sighting.name) && !blamed(&seen.sighting.name));
    let scored = candidates.map(|seen| {
        let name = &seen.sighting.name;
        let (salience, class) =
            find_thing(name).map_or((0, ThingClass::Unknown), |thing| (thing.salience, thing.class));
        // One of several, or a part of the building, is chosen only if there is no other object.
        let poor = seen.sighting.several
            || matches!(class, ThingClass::Structure | ThingClass::Fabric | ThingClass::Stairs | ThingClass::Unknown);
        let score = f64::from(salience) + if alone(name) { 4.0 } else { 0.0 } - if poor { 20.0 } else { 0.0 };
        (score + rng.random_range(0.0..2.0), name.clone())
    });
    scored.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name)
}

/// Draws one of several descriptions: first the combination of kinds of properties, by how likely people use it, then
/// one description of it, cheaper ones more often.
fn draw_distinctions<'a>(
    all: &[&'a [ObjectDistinction]],
    wording: &PlaceWording,
    rng: &mut ChaCha8Rng,
) -> &'a [ObjectDistinction] {
    let mut of_kind: BTreeMap<Vec<&str>, Vec<&'a [ObjectDistinction]>> = BTreeMap::new();
    for by in all {
        of_kind.entry(by.iter().map(construction_table).collect()).or_default().push(by);
    }
    // A description that holds another one tells more than it has to.
    let is_idle = |kind: &Vec<&str>| {
        of_kind.keys().any(|other| other.len() < kind.len() && other.iter().all(|table| kind.contains(table)))
    };
    let idle = |kind| if is_idle(kind) { wording.idle_factor() } else { 1.0 };
    let weights: Vec<f64> =
        of_kind.iter().map(|(kind, by)| idle(kind) * distinctions_likelihood(by[0], wording)).collect();
    let kinds: Vec<&Vec<&[ObjectDistinction]>> = of_kind.values().collect();
    let Some(kind) = draw_weighted(&weights, rng) else { return &[] };
    let cheaper: Vec<f64> = (0..kinds[kind].len()).map(|at| 0.85_f64.powi(at as i32)).collect();
    draw_weighted(&cheaper, rng).map_or(&[], |at| kinds[kind][at])
}

/// How often a colour that tells an object from others is named, relative to all properties of objects. It shows from everywhere, and readers
/// find the object by it more surely than by a neighbour. Scans' labels have no colours, so it is not measured.
const COLOUR_SHARE: f64 = 0.7;

/// How likely a text of the style uses exactly these properties of an object and its room.
fn distinctions_likelihood(by: &[ObjectDistinction], wording: &PlaceWording) -> f64 {
    let told = wording.table("told");
    let all: f64 = told.values().sum::<f64>().max(1e-9);
    let share = |table: &str| told.get(table).copied().unwrap_or(0.5) / all;
    let odds = |name: &str| wording.share_of_texts(name) / (1.0 - wording.share_of_texts(name)).max(0.05);
    let likelihood = |by: &ObjectDistinction| match by {
        ObjectDistinction::Level { .. } => odds("level").max(0.4) * 0.8,
        ObjectDistinction::RoomBy { .. } => odds("room by") * 0.6,
        ObjectDistinction::RoomWith { .. } => odds("room with") * 0.25,
        ObjectDistinction::Colour { .. } => odds("object") * COLOUR_SHARE,
        ObjectDistinction::OnSide { .. } => odds("object") * share("side") * 2.0,
        // "Near" is almost always possible: of the descriptions that single a target out, most contain it.
        ObjectDistinction::Related { relation: ObjectRelation::Near, .. } => odds("object") * share("near") * 1.2,
        // The measured share is for both sides together.
        ObjectDistinction::Related { relation: ObjectRelation::LeftOf | ObjectRelation::RightOf, .. } => {
            odds("object") * share("beside") * 1.5
        }
        _ => odds("object") * share(construction_table(by)) * 3.0,
    };
    by.iter().map(likelihood).product()
}

/// The name of the table of constructions for a property.
fn construction_table(by: &ObjectDistinction) -> &'static str {
    match by {
        ObjectDistinction::NextTo { .. } => "closest",
        ObjectDistinction::Related { relation: ObjectRelation::Near, .. } => "near",
        ObjectDistinction::Related { relation: ObjectRelation::Above, .. } => "above",
        ObjectDistinction::Related { relation: ObjectRelation::Under, .. } => "under",
        ObjectDistinction::Related { relation: ObjectRelation::On, .. } => "on",
        ObjectDistinction::Related { relation: ObjectRelation::LeftOf | ObjectRelation::RightOf, .. } => "beside",
        ObjectDistinction::Between { .. } => "between",
        ObjectDistinction::OnSide { .. } => "side",
        ObjectDistinction::InRow { place: 1, .. } => "row first",
        ObjectDistinction::InRow { place: 2, of: 3, .. } | ObjectDistinction::InRow { place: 3, of: 5, .. } => "middle",
        ObjectDistinction::InRow { .. } => "row",
        ObjectDistinction::Range { nearest: true } => "nearest",
        ObjectDistinction::Range { nearest: false } => "furthest",
        ObjectDistinction::Height { highest: true } => "highest",
        ObjectDistinction::Height { highest: false } => "lowest",
        ObjectDistinction::Colour { .. } => "colour",
        ObjectDistinction::Level { .. } => "level",
        ObjectDistinction::RoomBy { .. } => "room by",
        ObjectDistinction::RoomWith { .. } => "room with",
    }
}

/// "The leftmost lamp", "the lamp nearest to you": the whole phrase for an object with this superlative.
fn superlative_phrase(
    by: &ObjectDistinction,
    name: &str,
    wording: &PlaceWording,
    rng: &mut ChaCha8Rng,
) -> Option<String> {
    let way = wording.draw(construction_table(by), rng, |_| true)?;
    let (place, is_right) = match by {
        ObjectDistinction::InRow { place, from, .. } => (*place as u32, *from == Side::Right),
        _ => (1, false),
    };
    let way = way.replace("{th}", ordinal_of(place)?);
    let way = if is_right { way.replace("leftmost", "rightmost").replace("left", "right") } else { way };
    Some(way.replace("{o}", name))
}

/// "On the left", "near the sofa": the words behind the name of an object for this property.
fn relation_phrase(by: &ObjectDistinction, wording: &PlaceWording, rng: &mut ChaCha8Rng) -> Option<String> {
    let way = wording.draw(construction_table(by), rng, |_| true)?;
    Some(match by {
        ObjectDistinction::Related { relation: ObjectRelation::RightOf, to } => {
            way.replace("left", "right").replace("{x}", wording.draw_name(to, rng))
        }
        ObjectDistinction::NextTo { neighbour: to } | ObjectDistinction::Related { to, .. } => {
            way.replace("{x}", wording.draw_name(to, rng))
        }
        ObjectDistinction::Between { one, other } => way.replace("{x}", one).replace("{y}", other),
        ObjectDistinction::OnSide { side: Side::Right } => way.replace("left", "right"),
        ObjectDistinction::OnSide { side: Side::Left } => way.to_owned(),
        _ => return None,
    })
}
