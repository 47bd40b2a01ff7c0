//! The object that an item of a submission names. REVERIE's evaluator reads `predObjId`; VLN-DUET and agents after it
//! write `pred_objid`.

use crate::{DatasetItem, FormatError};
use serde_json::Value;
use std::collections::BTreeSet;
use wayword_core::ObjectId;

/// The name of the field in REVERIE's evaluator.
const OFFICIAL: &str = "predObjId";
/// Other fields, without underscores and in lower case, in which agents may name an object. Whether they do is not
/// certain: a field may be the object of the dataset.
const DOUBTFUL: [&str; 9] = [
    "objid",
    "objectid",
    "predobj",
    "predobject",
    "predobjectid",
    "predictedobjid",
    "predictedobject",
    "predictedobjectid",
    "predobjids",
];
const ONE_NAME_HINT: &str = "name the object in each item by \"predObjId\"";

/// Takes the objects of a file's items.
#[derive(Default)]
pub(super) struct ObjectNames {
    /// The names that the first item with an object gives it.
    of_file: Option<BTreeSet<String>>,
    /// Whether it was told that the file mixes names.
    is_told: bool,
    /// Whether it was told that another field seems to name the object.
    is_doubt_told: bool,
}

impl ObjectNames {
    /// Takes the object of an item: `predObjId` in any spelling with or without underscores and capitals.
    ///
    /// # Errors
    /// When its value is no name, an item has two that differ, an earlier item has another spelling, or there is none
    /// but a field that seems to be meant for it.
    pub(super) fn take_object(&mut self, item: &mut DatasetItem<'_>) -> Result<Option<ObjectId>, FormatError> {
        let names: BTreeSet<String> = item.field_names().filter(|name| bare(name) == bare(OFFICIAL)).cloned().collect();
        let Some(first) = names.first() else {
            return self.refuse_doubtful(item).map(|()| None);
        };
        self.refuse_mixture(item, &names)?;
        let mut found = None;
        for name in &names {
            let value = item.take_optional(name).filter(|object| !object.is_null());
            let object = value.map(|object: Value| item.checked_object(name, &object)).transpose()?;
            if name != first && object != found {
                let problem = format!("it differs from \"{first}\", and both name the object");
                return Err(item.wrong_field(name, problem, ONE_NAME_HINT));
            }
            found = object;
        }
        Ok(found)
    }

    /// Refuses an item with other names than the first, once for the file.
    fn refuse_mixture(&mut self, item: &DatasetItem<'_>, names: &BTreeSet<String>) -> Result<(), FormatError> {
        let of_file = self.of_file.get_or_insert_with(|| names.clone());
        if of_file == names || std::mem::replace(&mut self.is_told, true) {
            return Ok(());
        }
        let listed =
            |names: &BTreeSet<String>| names.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ");
        let problem = format!("earlier items name the object by {}, this one by {}", listed(of_file), listed(names));
        Err(item.wrong_field(names.first().map_or(OFFICIAL, String::as_str), problem, ONE_NAME_HINT))
    }

    /// Refuses an item in which only a field that may be meant for something else seems to name the object, once for the file.
    fn refuse_doubtful(&mut self, item: &DatasetItem<'_>) -> Result<(), FormatError> {
        let doubtful = item.field_names().find(|name| DOUBTFUL.contains(&bare(name).as_str()));
        match doubtful.filter(|_| !std::mem::replace(&mut self.is_doubt_told, true)) {
            Some(name) => Err(item.wrong_field(
                &name.clone(),
                "it seems to name the object, which is read from \"predObjId\", and the item has none",
                "rename it to \"predObjId\" in all items; leave it out if the agent did not choose it",
            )),
            None => Ok(()),
        }
    }
}

/// A field's name without underscores, in lower case.
fn bare(name: &str) -> String {
    name.chars().filter(|letter| *letter != '_').map(|letter| letter.to_ascii_lowercase()).collect()
}
