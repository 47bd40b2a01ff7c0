//! Worlds that are objects of the program that this one runs in, by their names.

use crate::error::Error;
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::{Mutex, MutexGuard, PoisonError},
};
use wayword_platforms::process::ProcessOptions;

/// What the data of such a world begins with: `python:Rooms`.
const SCHEME: &str = "python:";

static WORLDS: Mutex<BTreeMap<String, ProcessOptions>> = Mutex::new(BTreeMap::new());

/// Makes a world known by a name. Returns what `--data` is for it. A world of the same name is replaced.
#[must_use]
pub fn put_inside(name: &str, options: ProcessOptions) -> PathBuf {
    let data = format!("{SCHEME}{name}");
    worlds().insert(data.clone(), options);
    data.into()
}

/// Forgets a world.
pub fn forget_inside(data: &Path) {
    worlds().remove(&*data.to_string_lossy());
}

/// A world by what `--data` is for it; `None` if that names a file.
///
/// # Errors
/// When it names such a world, but there is none.
pub(super) fn find(data: &Path) -> Result<Option<ProcessOptions>, Error> {
    let data = data.to_string_lossy();
    let Some(name) = data.strip_prefix(SCHEME) else { return Ok(None) };
    worlds().get(&*data).cloned().map(Some).ok_or_else(|| {
        Error::usage(
            format!("world {name} is an object of a Python program, and is not here"),
            "give the same call in Python again, with the world as `platform`",
        )
    })
}

fn worlds() -> MutexGuard<'static, BTreeMap<String, ProcessOptions>> {
    WORLDS.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::platforms::open_named;
    use serde_json::{Value, json};
    use wayword_platforms::process::Inside;

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
    fn a_world_of_the_same_process_is_opened_until_it_is_forgotten() {
        let data = put_inside("Yard", ProcessOptions::inside("Yard", Inside::new(answer)));
        let yard = open_named("process", Some(&data), None, None).unwrap();
        assert_eq!(yard.scenes().unwrap()[0].as_str(), "yard");
        let refused = yard.graph(&yard.scenes().unwrap()[0]).err().unwrap().to_string();
        assert!(refused.contains("graph") && refused.contains("Yard"), "{refused}");
        forget_inside(&data);
        let gone = open_named("process", Some(&data), None, None).err().unwrap().to_string();
        assert!(gone.contains("Yard") && gone.contains("hint: "), "{gone}");
    }
}
