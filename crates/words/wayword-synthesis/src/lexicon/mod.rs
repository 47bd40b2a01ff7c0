//! What things and rooms are called, and which names mean the same.

mod normal;
mod rooms;
mod things;

pub use normal::{normal, normal_word};
pub use rooms::{room_name, same_room};
pub use things::{Class, Thing, agree, kinds, longest_name, thing};
pub(crate) use {rooms::is_room, things::is_thing};
