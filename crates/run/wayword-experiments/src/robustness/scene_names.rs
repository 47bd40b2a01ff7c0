//! The names that scenes of a run have on other platforms, as `--scene-name` gives them.

use std::{collections::BTreeMap, fs, path::Path};
use wayword_run::error::CommandError;

/// The other names of each scene of the run. A scene has several if several platforms have their own name for it.
pub(super) type SceneNames = BTreeMap<String, Vec<String>>;

/// Parses names as typed: `SCENE=NAME`, or `@FILE` for a file with a name on each line.
///
/// # Errors
/// When one is typed in another way, a file cannot be read, or a name is given twice.
pub(super) fn parse_names(typed: &[String]) -> Result<SceneNames, CommandError> {
    let mut names = SceneNames::new();
    for text in typed {
        match text.strip_prefix('@') {
            Some(file) => {
                let lines = fs::read_to_string(file).map_err(CommandError::io(Path::new(file), "read"))?;
                for line in lines.lines().map(str::trim).filter(|line| !line.is_empty()) {
                    add_name(&mut names, line)?;
                }
            }
            None => add_name(&mut names, text)?,
        }
    }
    Ok(names)
}

fn add_name(names: &mut SceneNames, text: &str) -> Result<(), CommandError> {
    let parts = text.split_once('=').filter(|(scene, name)| !scene.is_empty() && !name.is_empty());
    let Some((scene, name)) = parts else {
        let hint = "write the run's scene and its name there, as in --scene-name house2-3=home_2, or --scene-name @FILE for a file of such lines";
        return Err(CommandError::usage(format!("--scene-name {text}: there is no SCENE=NAME"), hint));
    };
    if let Some((other, _)) = names.iter().find(|(_, names)| names.iter().any(|known| known == name)) {
        let problem = format!("--scene-name: {name} is named for {other} and for {scene}");
        return Err(CommandError::usage(problem, "leave one out"));
    }
    names.entry(scene.to_owned()).or_default().push(name.to_owned());
    Ok(())
}

/// The names under which to look for a scene on another platform: first those that were given, then its own.
pub(super) fn names_elsewhere<'a>(names: &'a SceneNames, scene: &'a str) -> Vec<&'a str> {
    names.get(scene).into_iter().flatten().map(String::as_str).chain([scene]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_typed_or_come_from_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("names");
        fs::write(&file, "house2-0=home_0\n\nhouse2-7=home_1\n").unwrap();
        let typed = [format!("@{}", file.display()), "house2-7=floorplan_1a".to_owned()];
        let names = parse_names(&typed).unwrap();
        assert_eq!(names_elsewhere(&names, "house2-7"), ["home_1", "floorplan_1a", "house2-7"]);
        assert_eq!(names_elsewhere(&names, "house2-0"), ["home_0", "house2-0"]);
        assert_eq!(names_elsewhere(&names, "house2-9"), ["house2-9"]);
        for wrong in [&["home_0"][..], &["=home_0"], &["a=b", "a=b"], &["a=c", "b=c"], &["@nowhere"]] {
            let wrong: Vec<String> = wrong.iter().map(|text| (*text).to_owned()).collect();
            assert!(parse_names(&wrong).is_err(), "{wrong:?}");
        }
    }
}
