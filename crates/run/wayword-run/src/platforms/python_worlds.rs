//! Registers worlds that are Python objects of the program that this one runs in, so that `--data python:NAME` can open them.

use crate::error::CommandError;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
};
use wayword_platforms::process::ProcessOptions;

/// The prefix of `--data` for a registered world, as in `python:Rooms`.
const PYTHON_SCHEME: &str = "python:";

/// The registered worlds, by their values of `--data`.
static INSIDE_WORLDS: Mutex<BTreeMap<String, ProcessOptions>> = Mutex::new(BTreeMap::new());

/// Registers a world under a name, and replaces an older one of that name. Returns the value of `--data` for it.
#[must_use]
pub fn register_world(name: &str, options: ProcessOptions) -> PathBuf {
    let data = format!("{PYTHON_SCHEME}{name}");
    lock_worlds().insert(data.clone(), options);
    data.into()
}

/// Forgets a world.
pub fn unregister_world(data: &Path) {
    lock_worlds().remove(&*data.to_string_lossy());
}

/// The world for a value of `--data`; `None` if that is a file.
///
/// # Errors
/// When no world of that name is registered.
pub(super) fn find_registered_world(data: &Path) -> Result<Option<ProcessOptions>, CommandError> {
    let data = data.to_string_lossy();
    let Some(name) = data.strip_prefix(PYTHON_SCHEME) else { return Ok(None) };
    lock_worlds().get(&*data).cloned().map(Some).ok_or_else(|| {
        CommandError::usage(
            format!("world {name} is an object of a Python program, and is not here"),
            "give the same call in Python again, with the world as `platform`",
        )
    })
}

fn lock_worlds() -> MutexGuard<'static, BTreeMap<String, ProcessOptions>> {
    INSIDE_WORLDS.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platforms::open_named;
    use serde_json::{Value, json};
    use wayword_platforms::process::InsideWorld;

    fn answer(request: &[u8]) -> Vec<u8> {
        let request: Value = serde_json::from_slice(request).unwrap();
        let result = match request["method"].as_str().unwrap() {
            "hello" => json!({
                "protocol": 1, "frame": request["params"]["frame"], "name": "a yard", "offers": ["graph", "labels"]
            }),
            "scenes" => json!({ "scenes": ["yard"] }),
            other => return json!({ "id": request["id"], "error": { "message": other } }).to_string().into_bytes(),
        };
        json!({ "id": request["id"], "result": result }).to_string().into_bytes()
    }

    #[test]
    fn find_registered_world_opens_a_world_until_it_is_forgotten() {
        let data = register_world("Yard", ProcessOptions::for_inside_world("Yard", InsideWorld::new(answer)));
        let yard = open_named("process", Some(&data), None, None).unwrap();
        assert_eq!(yard.list_scenes().unwrap()[0].as_str(), "yard");
        let refused = yard.graph_for_scene(&yard.list_scenes().unwrap()[0]).err().unwrap().to_string();
        assert!(refused.contains("graph") && refused.contains("Yard"), "{refused}");
        unregister_world(&data);
        let gone = open_named("process", Some(&data), None, None).err().unwrap().to_string();
        assert!(gone.contains("Yard") && gone.contains("hint: "), "{gone}");
    }
}
