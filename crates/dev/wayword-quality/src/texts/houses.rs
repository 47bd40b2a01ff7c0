//! Compares texts about generated houses with the plan of the house: the last room, the thing at the stop, and the target.

use super::{
    names::{LexiconName, find_names, split_words},
    rooms::last_room,
    row::{TextFigureRow, number_row, share_row},
    side_by_side,
};
use clap::Args;
use std::{
    collections::{BTreeMap, btree_map::Entry},
    path::PathBuf,
};
use wayword_core::{DVec3, Platform};
use wayword_formats::jsonl::{self, InstructionRecord};
use wayword_house::{EYE_M, HouseScene, NumberedObject, generate_house, seed_of};
use wayword_language::lexicon::{names_agree, normalise_name, same_room};
use wayword_run::{error::CommandError, output::CommandOutput, platforms, run_folder::file, settings::AskedSettings};
use wayword_world::labels_around;

/// "Stop at the sofa": the sofa is within this distance of the end, metres.
const STOP_M: f64 = 2.0;
/// The target is within this distance of the end, metres.
const TARGET_M: f64 = 3.0;
/// Verbs of stops.
const STOP_VERBS: [&str; 7] = ["stop", "wait", "halt", "end", "finish", "pause", "stand"];
/// Phrases between the verb and a thing that is near.
const NEARNESS_PHRASES: [&str; 7] = ["at", "by", "next to", "beside", "near", "in front of", "close to"];
/// At most this many words are between the verb and the name of the thing.
const MAX_GAP_WORDS: usize = 8;

/// The flags of `houses`.
#[derive(Debug, Args)]
pub struct HouseTextsArgs {
    /// Run folders over generated houses.
    #[arg(required = true)]
    runs: Vec<PathBuf>,
    /// Show this many texts that the plan contradicts.
    #[arg(long, default_value_t = 0)]
    show: usize,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// The comparison of one text with the plan. A field is `None` where the text makes no claim of that kind.
#[derive(Debug, Default)]
struct HousePlanComparison {
    text: String,
    /// Whether the room that the text names last is the one that the walk ends in, or that the target is in.
    room: Option<bool>,
    /// The distance from the end to the box of the thing at which the text stops, metres; infinite where the house has none.
    stop_m: Option<f64>,
    /// The distance from the end to the target's box, metres, and whether it is in sight.
    target: Option<(f64, bool)>,
}

impl HousePlanComparison {
    /// Whether the plan contradicts the text in any respect.
    fn is_wrong(&self) -> bool {
        self.room == Some(false)
            || self.stop_m.is_some_and(|far_m| far_m > STOP_M)
            || self.target.is_some_and(|(far_m, is_seen)| far_m > TARGET_M || !is_seen)
    }
}

/// Compares texts about generated houses with their plans, and prints the figures of each style.
///
/// # Errors
/// When a run cannot be read, or a house cannot be drawn.
pub fn measure_house_texts(flags: &HouseTextsArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let platform = platforms::open_platform(&AskedSettings::default().resolve()?)?;
    let mut styles: BTreeMap<String, Vec<HousePlanComparison>> = BTreeMap::new();
    let mut houses: BTreeMap<u64, HouseScene> = BTreeMap::new();
    for run in &flags.runs {
        for record in jsonl::read_records(&run.join(file::INSTRUCTIONS))? {
            let Some(seed) = seed_of(record.path.scene.as_str()) else { continue };
            let home = match houses.entry(seed) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => {
                    let drawn = HouseScene::new(generate_house(seed));
                    new.insert(drawn.map_err(|error| CommandError::usage(error.to_string(), "give runs over houses"))?)
                }
            };
            let comparison = compare_with_plan(&record, home, platform.as_ref())?;
            styles.entry(record.instruction.style.clone()).or_default().push(comparison);
        }
    }
    let sides: Vec<(&str, Vec<TextFigureRow>)> =
        styles.iter().map(|(style, comparisons)| (style.as_str(), plan_rows(comparisons))).collect();
    let wrong = styles.values().flatten().filter(|comparison| comparison.is_wrong()).take(flags.show);
    wrong.for_each(|comparison| {
        let HousePlanComparison { text, room, stop_m, target } = comparison;
        output.say(format!("room {room:?}, stop {stop_m:?} m, target {target:?}: {text}"));
    });
    output.print_result(
        &sides.iter().map(|(name, rows)| (*name, rows)).collect::<BTreeMap<_, _>>(),
        side_by_side(&sides),
    );
    Ok(())
}

/// Compares one text with the plan of its house. Only a text in style `reverie` has a task, and so a target.
fn compare_with_plan(
    record: &InstructionRecord,
    home: &HouseScene,
    platform: &dyn Platform,
) -> Result<HousePlanComparison, CommandError> {
    let text = &record.instruction.text;
    let Some(last) = record.path.frames.last() else { return Ok(HousePlanComparison::default()) };
    let feet = last.pose.position - DVec3::Z * EYE_M;
    let end_room = home.house.room_at(feet.x, feet.y, feet.z).map(|room| room.kind.word());
    let object_of = |id: &str| home.objects.get(&id.parse().ok()?);
    let target = record.path.target.as_ref().and_then(|target| Some((target, object_of(target.object.as_str())?)));
    let has_task = record.instruction.style == "reverie";
    let right_room =
        target.filter(|_| has_task).map(|(_, object)| home.house.rooms[object.room].kind.word()).or(end_room);
    let target = match target.filter(|_| has_task) {
        Some((target, object)) => {
            let around = labels_around(platform, &record.path.scene, last)?;
            Some((off_m(feet, object), around.iter().any(|label| label.object == target.object)))
        }
        None => None,
    };
    Ok(HousePlanComparison {
        text: text.clone(),
        room: last_room(text).zip(right_room).map(|(named, right)| same_room(&named, right)),
        stop_m: stop_at(&split_words(text)).map(|name| nearest_m(feet, &name, home)),
        target,
    })
}

/// The thing at which a text stops: "stop by the sofa".
fn stop_at(words: &[String]) -> Option<String> {
    let names = find_names(words);
    let stop = words.iter().rposition(|word| STOP_VERBS.contains(&word.as_str()))?;
    let is_near = |name: &&LexiconName| {
        let between = words.get(stop + 1..name.start).filter(|between| between.len() <= MAX_GAP_WORDS);
        let run = between.map(|between| format!(" {} ", between.join(" ")));
        run.is_some_and(|run| NEARNESS_PHRASES.iter().any(|phrase| run.contains(&format!(" {phrase} "))))
    };
    let after = names.iter().find(|name| name.is_thing && name.start > stop && is_near(name));
    after.filter(|name| !name.is_room || name.is_seen()).map(|name| name.name.clone())
}

/// The distance to the nearest object of a name, metres; infinite where the house has none on this storey.
fn nearest_m(feet: DVec3, name: &str, home: &HouseScene) -> f64 {
    let is_called = |object: &&NumberedObject| {
        names_agree(&object.name, name) || normalise_name(&object.name) == normalise_name(name)
    };
    let called = home.objects.values().filter(is_called);
    called.map(|object| off_m(feet, object)).fold(f64::INFINITY, f64::min)
}

/// The distance from the feet of the walker to an object's box, metres along the floor; infinite on another storey.
fn off_m(feet: DVec3, object: &NumberedObject) -> f64 {
    let (low, high) = object.bounds_m;
    let nearest = feet.clamp(DVec3::new(low.x, low.y, f64::MIN), DVec3::new(high.x, high.y, f64::MAX));
    // On this storey: not wholly above the ceiling, nor wholly below the floor.
    let is_here = low.z < feet.z + 2.5 && high.z > feet.z - 0.5;
    if is_here { (nearest - feet).truncate().length() } else { f64::INFINITY }
}

fn plan_rows(comparisons: &[HousePlanComparison]) -> Vec<TextFigureRow> {
    let targets = || comparisons.iter().filter_map(|comparison| comparison.target);
    let stops = || comparisons.iter().filter_map(|comparison| comparison.stop_m);
    vec![
        number_row("texts", comparisons.len() as f64),
        share_row(
            "the room named last is the target's, or the end's",
            comparisons.iter().filter_map(|comparison| comparison.room),
        ),
        share_row("\"stop at X\": an X within 2 m of the end", stops().map(|far_m| far_m <= STOP_M)),
        share_row("\"stop at X\": an X within 3 m of the end", stops().map(|far_m| far_m <= TARGET_M)),
        share_row(
            "the target within 3 m of the end, and in sight",
            targets().map(|(far_m, seen)| far_m <= TARGET_M && seen),
        ),
        share_row("the target in sight of the end", targets().map(|(_, is_seen)| is_seen)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_is_at_the_thing_that_it_names() {
        let at = |text: &str| stop_at(&split_words(text));
        assert_eq!(at("Go past the bed and stop next to the sofa.").as_deref(), Some("sofa"));
        assert_eq!(at("Walk to the sofa, then wait in the kitchen by the table.").as_deref(), Some("table"));
        assert_eq!(at("Walk to the sofa and stop in the kitchen."), None);
    }

    #[test]
    fn a_box_is_as_far_as_its_nearest_side() {
        let object = NumberedObject {
            name: "table".into(),
            colour: None,
            bounds_m: (DVec3::new(1.0, -1.0, 0.0), DVec3::new(3.0, 1.0, 0.8)),
            room: 0,
            role: wayword_house::ObjectRole::Furniture,
        };
        assert_eq!(off_m(DVec3::ZERO, &object), 1.0);
        assert_eq!(off_m(DVec3::new(0.0, 0.0, 3.0), &object), f64::INFINITY);
    }
}
