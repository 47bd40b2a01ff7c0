use super::*;
use crate::{key::undo_changes, test_data};
use clap::Parser;
use wayword_testkit::SCAN;

#[derive(Parser)]
struct Line {
    #[command(flatten)]
    flags: CorruptPeopleArgs,
}

/// The corrupted texts of the test kit's building, with their key.
fn written(building: &test_data::TestBuildingFolder, more: &[&str]) -> (Vec<Episode>, CorruptionKey) {
    let out = write_for(building, more).unwrap();
    (
        wayword_formats::read_any_format(&out).unwrap(),
        CorruptionKey::read(&CorruptionKey::path_for_texts(&out)).unwrap(),
    )
}

fn write_for(building: &test_data::TestBuildingFolder, more: &[&str]) -> Result<PathBuf, CommandError> {
    let out = building.data_folder().join("corrupted.json");
    let (data, episodes) = (building.data_folder(), building.data_folder().join("r2r/R2R_val_seen.json"));
    let mut words = vec!["corrupt-people".into(), "--data".into(), data, "--episodes".into(), episodes];
    words.extend(["--out".into(), out.clone()]);
    words.extend(more.iter().map(PathBuf::from));
    write_corruptions(&Line::try_parse_from(words).unwrap().flags, &CommandOutput::new(true, true)).map(|()| out)
}

#[test]
fn the_key_turns_every_corrupted_text_back_into_its_original() {
    let building = test_data::TestBuildingFolder::new();
    let (items, key) = written(&building, &["--count", "6"]);
    let originals = wayword_formats::read_any_format(&building.data_folder().join("r2r/R2R_val_seen.json")).unwrap();
    assert_eq!(items.len(), key.corruptions.len());
    let kinds: BTreeSet<&str> = key.corruptions.iter().map(|corruption| corruption.kind.as_str()).collect();
    assert!(kinds.len() >= 10, "{kinds:?}");
    for (item, corruption) in items.iter().zip(&key.corruptions) {
        assert_eq!(item.id, corruption.item);
        let original = originals.iter().find(|original| original.id == corruption.of).unwrap();
        assert_eq!((&item.viewpoints, item.start_heading), (&original.viewpoints, original.start_heading));
        let (was, _) = undo_changes(&item.instructions[0], &corruption.changes).unwrap();
        assert_eq!(was, original.instructions[corruption.instruction]);
        assert_ne!(was, item.instructions[0], "{corruption:?}");
        assert_eq!(corruption.path, format!("{SCAN}/{}", original.path_id));
    }
}

#[test]
fn a_kind_has_the_same_texts_whichever_other_kinds_are_asked_for() {
    let building = test_data::TestBuildingFolder::new();
    let texts = |more: &[&str]| -> Vec<String> {
        let (items, key) = written(&building, more);
        let of_kind =
            items.into_iter().zip(key.corruptions).filter(|(_, corruption)| corruption.kind == "turn-flipped");
        of_kind.map(|(item, _)| item.instructions[0].clone()).collect()
    };
    let alone = texts(&["--kind", "turn-flipped", "--count", "5"]);
    assert_eq!(alone.len(), 5);
    assert_eq!(texts(&["--count", "5"]), alone);
    assert_ne!(texts(&["--count", "5", "--seed", "1"]), alone);
}

#[test]
fn a_file_without_texts_is_not_written() {
    let building = test_data::TestBuildingFolder::new();
    let refusal = write_for(&building, &["--scan", "otherHouse"]).unwrap_err().to_string();
    assert!(refusal.contains("no text of these buildings"), "{refusal}");
    assert!(!building.data_folder().join("corrupted.json").exists());
}
