//! The names of things and rooms, and which names mean the same.

mod colours;
mod forms;
mod normal;
mod rooms;
mod things;

pub use colours::same_colour;
pub use forms::{COUNTS, counted, is_plural, plural, says_several, singular, with_article, without_article};
pub use normal::{normal, normal_word};
pub use rooms::{is_room, room_name, same_room};
pub use things::{Class, Thing, agree, is_fabric, is_thing, kinds, longest_name, thing};
