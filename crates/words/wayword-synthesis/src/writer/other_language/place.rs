//! The words of another language for a text that names a place and a task.

use super::LanguageWriter;
use crate::writer::{
    object::ObjectContent,
    place::{GoalContent, PlaceContent, RoomContent},
    task::TaskContent,
};
use wayword_core::{ClimbDirection, ObjectDistinction, ObjectRelation, Side};
use wayword_language::languages::NameSense;

/// The task where the language has no words for the verb.
const PLAIN_TASK: &str = "look at {o}";

impl LanguageWriter<'_> {
    /// A text that names a place, and what to do there.
    pub(super) fn place_text(&mut self, content: &PlaceContent) -> Option<String> {
        let goal = self.goal(&content.goal)?;
        let please = if content.please { self.language.phrase("please")? } else { "" };
        Some(match &content.task {
            Some(task) => format!("{please}{goal}{}{}", self.language.phrase("before_task")?, self.task(task)?),
            None => format!("{please}{goal}"),
        })
    }

    fn goal(&mut self, goal: &GoalContent) -> Option<String> {
        match goal {
            GoalContent::Room(room) => {
                let room = self.room(room)?;
                Some(self.phrase("go_to_room")?.replace("{r}", &room))
            }
            GoalContent::Stay(None) => self.phrase("stay").map(str::to_owned),
            GoalContent::Stay(Some(room)) => {
                let room = self.room_name(room)?;
                Some(self.phrase("stay_in_room")?.replace("{r}", &room))
            }
            GoalContent::Climb(ClimbDirection::Up) => self.phrase("climb_up").map(str::to_owned),
            GoalContent::Climb(_) => self.phrase("climb_down").map(str::to_owned),
            GoalContent::Thing(thing) => {
                let thing = self.thing_name(thing)?;
                Some(self.phrase("go_to_thing")?.replace("{l}", &thing))
            }
            GoalContent::Through(room) => {
                let room = self.room_name(room)?;
                Some(self.phrase("through_room")?.replace("{r}", &room))
            }
            GoalContent::Onward => self.phrase("onward").map(str::to_owned),
        }
    }

    /// A room with its storey and its properties, which all stand before it.
    fn room(&mut self, content: &RoomContent) -> Option<String> {
        let mut room = self.room_name(&content.name)?;
        // What is in the room stands next to it, or else it would be in the other room.
        let with = content.by.iter().filter_map(|by| match by {
            ObjectDistinction::RoomWith { thing } => Some(thing),
            _ => None,
        });
        let beside = content.by.iter().filter_map(|by| match by {
            ObjectDistinction::RoomBy { room } => Some(room),
            _ => None,
        });
        let others =
            [("room_with", NameSense::Thing, with.collect::<Vec<_>>()), ("room_by", NameSense::Room, beside.collect())];
        for (phrase, sense, others) in others {
            let names: Vec<String> = others.into_iter().map(|other| self.name(other, sense)).collect::<Option<_>>()?;
            let all = names.into_iter().reduce(|all, name| self.language.both(&all, &name));
            let Some(all) = all else { continue };
            room = self.phrase(phrase)?.replace("{x}", &all).replace("{r}", &room);
        }
        let Some(level) = content.level else { return Some(room) };
        let number = self.language.number(level as usize)?;
        Some(self.phrase("level")?.replace("{n}", number).replace("{r}", &room))
    }

    /// A task with its object.
    pub(super) fn task(&mut self, content: &TaskContent) -> Option<String> {
        let object = self.object(&content.object)?;
        let task = self.language.task(&content.verb).or_else(|| self.language.task(PLAIN_TASK))?;
        Some(task.replace("{o}", &object))
    }

    /// An object with its properties, which all stand before it.
    fn object(&mut self, content: &ObjectContent) -> Option<String> {
        let mut object = self.thing_name(&content.called)?;
        // The colour and the wall stand next to the object, or else another thing would have them.
        let (colours, others): (Vec<_>, Vec<_>) =
            content.by.iter().partition(|by| matches!(by, ObjectDistinction::Colour { .. }));
        for by in colours {
            if let ObjectDistinction::Colour { colour } = by {
                object = self.language.with_look(colour, &object)?;
            }
        }
        if content.on_wall {
            object = self.phrase("wall")?.replace("{o}", &object);
        }
        for by in others {
            object = self.with_property(by, &object)?;
        }
        Some(object)
    }

    /// An object with one property.
    fn with_property(&mut self, by: &ObjectDistinction, object: &str) -> Option<String> {
        let is_right = |side: &Side| *side == Side::Right;
        let (phrase, names, number) = match by {
            ObjectDistinction::NextTo { neighbour } => ("closest", vec![neighbour], None),
            ObjectDistinction::Related { relation, to } => {
                let phrase = match relation {
                    ObjectRelation::Near => "near",
                    ObjectRelation::Above => "above",
                    ObjectRelation::Under => "under",
                    ObjectRelation::On => "on",
                    ObjectRelation::LeftOf => "left_of",
                    ObjectRelation::RightOf => "right_of",
                };
                (phrase, vec![to], None)
            }
            ObjectDistinction::Between { one, other } => ("between", vec![one, other], None),
            ObjectDistinction::OnSide { side } => (if is_right(side) { "on_right" } else { "on_left" }, vec![], None),
            ObjectDistinction::InRow { place: 1, from, .. } => {
                (if is_right(from) { "first_right" } else { "first_left" }, vec![], None)
            }
            ObjectDistinction::InRow { place: 2, of: 3, .. } | ObjectDistinction::InRow { place: 3, of: 5, .. } => {
                ("middle", vec![], None)
            }
            ObjectDistinction::InRow { place, from, .. } => {
                (if is_right(from) { "row_right" } else { "row_left" }, vec![], Some(*place))
            }
            ObjectDistinction::Range { nearest } => (if *nearest { "nearest" } else { "furthest" }, vec![], None),
            ObjectDistinction::Height { highest } => (if *highest { "highest" } else { "lowest" }, vec![], None),
            _ => return Some(object.to_owned()),
        };
        let mut words = self.phrase(phrase)?.to_owned();
        for (slot, name) in ["{x}", "{y}"].iter().zip(names) {
            words = words.replace(slot, &self.thing_name(name)?);
        }
        if let Some(number) = number {
            words = words.replace("{n}", self.language.number(number)?);
        }
        Some(words.replace("{o}", object))
    }
}
