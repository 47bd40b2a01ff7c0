//! What things and rooms are called, and which names mean the same.

mod normal;
mod rooms;
mod things;

pub use normal::{normal, normal_word};
pub use rooms::{is_room, room_name, same_room};
pub use things::{Class, Thing, agree, is_thing, kinds, longest_name, thing};
