//! The names of things and rooms, and which names mean the same.

mod affordances;
mod colours;
mod forms;
mod normal_spelling;
mod rooms;
mod things;

pub use affordances::affords_task;
pub use colours::same_colour;
pub use forms::{
    COUNT_WORDS, counted_name, is_plural, means_several, to_plural, to_singular, with_article, without_article,
};
pub use normal_spelling::{normal_word, normalise_name};
pub use rooms::{is_room, room_name, same_room};
pub use things::{LexiconThing, ThingClass, find_thing, is_fabric, is_thing, kinds_of, longest_name, names_agree};
