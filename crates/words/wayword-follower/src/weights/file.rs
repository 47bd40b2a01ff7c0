//! Reads and writes the file of weights: JSON, with a list of numbers for each table of features.

use super::FeatureWeights;
use crate::{
    features::tables::{ALL, FeatureTable},
    online::{HOPS_AWAY_CLASSES, OnwardWeights, STEPS_LEFT_CLASSES},
};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Why a file of weights cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum WeightsError {
    /// It is not JSON of this kind.
    #[error("it does not hold weights: {0}")]
    Json(#[from] serde_json::Error),
    /// A table is missing, or has the wrong number of weights.
    #[error("table {table} has {found} weights and needs {needed}")]
    Table {
        /// The table.
        table: &'static str,
        /// How many weights there are.
        found: usize,
        /// How many there have to be.
        needed: usize,
    },
    /// A weight is not a finite number.
    #[error("table {0} has a weight that is not finite")]
    NotFinite(&'static str),
}

/// The content of a file of weights. The last three fields are only in the file of a walker without a map ([`OnwardWeights`]).
#[derive(Serialize, Deserialize)]
struct WeightsFile {
    /// The data that the weights were fitted to.
    origin: String,
    /// The command that fits them.
    command: String,
    /// The weights of each table.
    tables: BTreeMap<String, Vec<f64>>,
    /// For a walker: the weights of a step that goes on.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    going: BTreeMap<String, Vec<f64>>,
    /// For a walker: weights of going on, by the number of steps after that one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    left: Vec<f64>,
    /// For a walker: weights of stopping at a viewpoint, and of going on to one, by how many hops away it is.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    away: Vec<f64>,
}

impl FeatureWeights {
    /// Reads a file of weights.
    ///
    /// # Errors
    /// When a table is missing or has the wrong size.
    pub fn parse(text: &str) -> Result<Self, WeightsError> {
        weights_from_tables(&serde_json::from_str::<WeightsFile>(text)?.tables)
    }

    /// The weights as a file, rounded to thousandths. `origin` names the data of the fit, `command` how it was run.
    #[must_use]
    pub fn to_json(&self, origin: &str, command: &str) -> String {
        let (origin, command) = (origin.into(), command.into());
        write_tables(&WeightsFile {
            origin,
            command,
            tables: tables_from_weights(self),
            going: BTreeMap::new(),
            left: Vec::new(),
            away: Vec::new(),
        })
    }
}

impl OnwardWeights {
    /// Reads a file of a walker's weights.
    ///
    /// # Errors
    /// When a table is missing or has the wrong size.
    pub fn parse(text: &str) -> Result<Self, WeightsError> {
        let file: WeightsFile = serde_json::from_str(text)?;
        let wrong = |table, found: &[f64], needed| WeightsError::Table { table, found: found.len(), needed };
        let left = file.left.as_slice().try_into().map_err(|_| wrong("left", &file.left, STEPS_LEFT_CLASSES))?;
        let mut away = [[0.0; HOPS_AWAY_CLASSES]; 2];
        if file.away.len() != 2 * HOPS_AWAY_CLASSES {
            return Err(wrong("away", &file.away, 2 * HOPS_AWAY_CLASSES));
        }
        away.as_flattened_mut().copy_from_slice(&file.away);
        Ok(Self { done: weights_from_tables(&file.tables)?, going: weights_from_tables(&file.going)?, left, away })
    }

    /// The weights as a file, rounded to thousandths. `origin` names the data of the fit, `command` how it was run.
    #[must_use]
    pub fn to_json(&self, origin: &str, command: &str) -> String {
        let (tables, going) = (tables_from_weights(&self.done), tables_from_weights(&self.going));
        let left = self.left.iter().map(round_weight).collect();
        let away = self.away.as_flattened().iter().map(round_weight).collect();
        write_tables(&WeightsFile { origin: origin.into(), command: command.into(), tables, going, left, away })
    }
}

/// A file of weights as text: JSON with a line for each table.
pub(crate) fn write_tables(file: &impl Serialize) -> String {
    let mut text = serde_json::to_string(file).unwrap_or_default().replace("],\"", "],\n\"");
    text.push('\n');
    text
}

/// A weight rounded to thousandths.
fn round_weight(weight: &f64) -> f64 {
    (weight * 1000.0).round() / 1000.0
}

/// Weights of a set of tables, rounded, by the names of the tables.
pub(crate) fn lists_by_table(tables: &[FeatureTable], weights: &[f64]) -> BTreeMap<String, Vec<f64>> {
    let rounded =
        |table: &FeatureTable| weights[table.from..table.from + table.size].iter().map(round_weight).collect();
    tables.iter().map(|table| (table.name.to_owned(), rounded(table))).collect()
}

/// The weights of a set of tables, in the order of the features' numbers, from lists by the names of the tables.
pub(crate) fn weights_by_table(
    tables: &[FeatureTable],
    lists: &BTreeMap<String, Vec<f64>>,
) -> Result<Vec<f64>, WeightsError> {
    let mut weights = Vec::new();
    for table in tables {
        let found = lists.get(table.name).map_or(&[][..], Vec::as_slice);
        if found.len() != table.size {
            return Err(WeightsError::Table { table: table.name, found: found.len(), needed: table.size });
        }
        if !found.iter().all(|weight| weight.is_finite()) {
            return Err(WeightsError::NotFinite(table.name));
        }
        weights.extend_from_slice(found);
    }
    Ok(weights)
}

fn tables_from_weights(weights: &FeatureWeights) -> BTreeMap<String, Vec<f64>> {
    lists_by_table(ALL, weights.values())
}

fn weights_from_tables(tables: &BTreeMap<String, Vec<f64>>) -> Result<FeatureWeights, WeightsError> {
    Ok(FeatureWeights(weights_by_table(ALL, tables)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_from_tables_refuses_weights_that_are_not_finite() {
        let mut tables = tables_from_weights(&FeatureWeights::by_hand());
        assert!(weights_from_tables(&tables).is_ok());
        tables.get_mut("HOPS").unwrap()[3] = f64::NAN;
        assert!(matches!(weights_from_tables(&tables), Err(WeightsError::NotFinite("HOPS"))));
    }

    #[test]
    fn parse_refuses_a_walker_s_weights_of_the_wrong_size() {
        let weights = OnwardWeights::fitted();
        let text = weights.to_json("some data", "some command");
        assert_eq!(OnwardWeights::parse(&text).unwrap(), *weights);
        let wrong = |from: &str, to: &str| {
            let error = OnwardWeights::parse(&text.replace(from, to)).unwrap_err();
            let WeightsError::Table { table, found, needed } = error else { panic!("{error}") };
            (table, found, needed)
        };
        assert_eq!(wrong("\"left\":[", "\"left\":[0.5,"), ("left", 9, 8));
        assert_eq!(wrong("\"away\":[", "\"away\":[0.5,"), ("away", 17, 16));
        assert_eq!(wrong("\"going\"", "\"gone\"").1, 0);
        assert!(text.contains("\"origin\":\"some data\",\"command\":\"some command\""));
    }

    #[test]
    fn to_json_keeps_every_part_of_a_walker_s_weights() {
        let mut weights = OnwardWeights::by_hand();
        weights.left = std::array::from_fn(|at| at as f64 + 0.1234);
        weights.away = [0, 1].map(|which| std::array::from_fn(|at| -(at as f64) - f64::from(which) * 100.0));
        let again = OnwardWeights::parse(&weights.to_json("", "")).unwrap();
        assert_eq!((again.left[3], again.left[7]), (3.123, 7.123));
        assert_eq!((again.away[0][2], again.away[1][7]), (-2.0, -107.0));
    }
}
