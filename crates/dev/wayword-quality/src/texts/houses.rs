//! Compares texts about generated houses with the plan of the house: the last room, the thing at the stop, and the target.

use super::{
    names::{Named, named, words},
    rooms::last_room,
    row::{Row, number, share},
    side_by_side,
};
use clap::Args;
use std::{
    collections::{BTreeMap, btree_map::Entry},
    path::PathBuf,
};
use wayword_core::{DVec3, Platform};
use wayword_formats::jsonl::{self, Record};
use wayword_house::{EYE_M, HouseScene, Object, generate, seed_of};
use wayword_language::lexicon::{agree, normal, same_room};
use wayword_run::{error::Error, output::Output, platforms, run_folder::file, settings::Asked};
use wayword_world::labels_around;

/// "Stop at the sofa": the sofa is within this distance of the end, metres.
const STOP_M: f64 = 2.0;
/// The target is within this distance of the end, metres.
const TARGET_M: f64 = 3.0;
/// Verbs of stops.
const STOPS: [&str; 7] = ["stop", "wait", "halt", "end", "finish", "pause", "stand"];
/// Phrases between the verb and a thing that is near.
const AT: [&str; 7] = ["at", "by", "next to", "beside", "near", "in front of", "close to"];
/// At most this many words are between the verb and the name of the thing.
const GAP: usize = 8;

/// The flags of `houses`.
#[derive(Debug, Args)]
pub struct Flags {
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
struct Held {
    text: String,
    /// Whether the room that the text names last is the one that the walk ends in, or that the target is in.
    room: Option<bool>,
    /// The distance from the end to the box of the thing at which the text stops, metres; infinite where the house has none.
    stop_m: Option<f64>,
    /// The distance from the end to the target's box, metres, and whether it is in sight.
    target: Option<(f64, bool)>,
}

impl Held {
    fn is_wrong(&self) -> bool {
        self.room == Some(false)
            || self.stop_m.is_some_and(|far_m| far_m > STOP_M)
            || self.target.is_some_and(|(far_m, is_seen)| far_m > TARGET_M || !is_seen)
    }
}

pub fn measure(flags: &Flags, output: &Output) -> Result<(), Error> {
    let platform = platforms::open(&Asked::default().resolve()?)?;
    let mut styles: BTreeMap<String, Vec<Held>> = BTreeMap::new();
    let mut houses: BTreeMap<u64, HouseScene> = BTreeMap::new();
    for run in &flags.runs {
        for record in jsonl::read(&run.join(file::INSTRUCTIONS))? {
            let Some(seed) = seed_of(record.path.scene.as_str()) else { continue };
            let home = match houses.entry(seed) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => {
                    let drawn = HouseScene::new(generate(seed));
                    new.insert(drawn.map_err(|error| Error::usage(error.to_string(), "give runs over houses"))?)
                }
            };
            let held = held(&record, home, platform.as_ref())?;
            styles.entry(record.instruction.style.clone()).or_default().push(held);
        }
    }
    let sides: Vec<(&str, Vec<Row>)> = styles.iter().map(|(style, held)| (style.as_str(), rows(held))).collect();
    let wrong = styles.values().flatten().filter(|held| held.is_wrong()).take(flags.show);
    wrong.for_each(|held| {
        output.say(format!("room {:?}, stop {:?} m, target {:?}: {}", held.room, held.stop_m, held.target, held.text));
    });
    output.data(&sides.iter().map(|(name, rows)| (*name, rows)).collect::<BTreeMap<_, _>>(), side_by_side(&sides));
    Ok(())
}

fn held(record: &Record, home: &HouseScene, platform: &dyn Platform) -> Result<Held, Error> {
    let text = &record.instruction.text;
    let Some(last) = record.path.frames.last() else { return Ok(Held::default()) };
    let feet = last.pose.position - DVec3::Z * EYE_M;
    let end_room = home.house.room_at(feet.x, feet.y, feet.z).map(|room| room.kind.word());
    let object_of = |id: &str| home.objects.get(&id.parse().ok()?);
    let target = record.path.target.as_ref().and_then(|target| Some((target, object_of(target.object.as_str())?)));
    let has_task = record.instruction.style == "reverie";
    let own = target.filter(|_| has_task).map(|(_, object)| home.house.rooms[object.room].kind.word()).or(end_room);
    let target = match target.filter(|_| has_task) {
        Some((target, object)) => {
            let around = labels_around(platform, &record.path.scene, last)?;
            Some((off_m(feet, object), around.iter().any(|label| label.object == target.object)))
        }
        None => None,
    };
    Ok(Held {
        text: text.clone(),
        room: last_room(text).zip(own).map(|(said, own)| same_room(&said, own)),
        stop_m: stop_at(&words(text)).map(|name| nearest_m(feet, &name, home)),
        target,
    })
}

/// The thing at which a text stops: "stop by the sofa".
fn stop_at(words: &[String]) -> Option<String> {
    let names = named(words);
    let stop = words.iter().rposition(|word| STOPS.contains(&word.as_str()))?;
    let is_near = |name: &&Named| {
        let between = words.get(stop + 1..name.start).filter(|between| between.len() <= GAP);
        let run = between.map(|between| format!(" {} ", between.join(" ")));
        run.is_some_and(|run| AT.iter().any(|phrase| run.contains(&format!(" {phrase} "))))
    };
    let after = names.iter().find(|name| name.is_thing && name.start > stop && is_near(name));
    after.filter(|name| !name.is_room || name.is_seen()).map(|name| name.name.clone())
}

fn nearest_m(feet: DVec3, name: &str, home: &HouseScene) -> f64 {
    let is_called = |object: &&Object| agree(&object.name, name) || normal(&object.name) == normal(name);
    let called = home.objects.values().filter(is_called);
    called.map(|object| off_m(feet, object)).fold(f64::INFINITY, f64::min)
}

/// The distance from the feet of the walker to an object's box, metres along the floor; infinite on another storey.
fn off_m(feet: DVec3, object: &Object) -> f64 {
    let (low, high) = object.bounds_m;
    let nearest = feet.clamp(DVec3::new(low.x, low.y, f64::MIN), DVec3::new(high.x, high.y, f64::MAX));
    let is_here = low.z < feet.z + 2.5 && high.z > feet.z - 0.5;
    if is_here { (nearest - feet).truncate().length() } else { f64::INFINITY }
}

fn rows(held: &[Held]) -> Vec<Row> {
    let targets = || held.iter().filter_map(|held| held.target);
    let stops = || held.iter().filter_map(|held| held.stop_m);
    vec![
        number("texts", held.len() as f64),
        share("the room named last is the target's, or the end's", held.iter().filter_map(|held| held.room)),
        share("\"stop at X\": an X within 2 m of the end", stops().map(|far_m| far_m <= STOP_M)),
        share("\"stop at X\": an X within 3 m of the end", stops().map(|far_m| far_m <= TARGET_M)),
        share(
            "the target within 3 m of the end, and in sight",
            targets().map(|(far_m, seen)| far_m <= TARGET_M && seen),
        ),
        share("the target in sight of the end", targets().map(|(_, is_seen)| is_seen)),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stop_is_at_the_thing_that_it_names() {
        let at = |text: &str| stop_at(&words(text));
        assert_eq!(at("Go past the bed and stop next to the sofa.").as_deref(), Some("sofa"));
        assert_eq!(at("Walk to the sofa, then wait in the kitchen by the table.").as_deref(), Some("table"));
        assert_eq!(at("Walk to the sofa and stop in the kitchen."), None);
    }

    #[test]
    fn a_box_is_as_far_as_its_nearest_side() {
        let object = Object {
            name: "table".into(),
            colour: None,
            bounds_m: (DVec3::new(1.0, -1.0, 0.0), DVec3::new(3.0, 1.0, 0.8)),
            room: 0,
            role: wayword_house::Role::Furniture,
        };
        assert_eq!(off_m(DVec3::ZERO, &object), 1.0);
        assert_eq!(off_m(DVec3::new(0.0, 0.0, 3.0), &object), f64::INFINITY);
    }
}
