//! Parses and describes the scripted eye of `--eye`, which sees from labels with a given recall and given mistakes.

use wayword_robustness::worlds::EyeQuality;
use wayword_run::error::CommandError;

/// The share of its recall that an eye loses at the end of a dose's range, unless `--eye` sets `falls`.
const DEFAULT_RECALL_FALL_SHARE: f64 = 0.8;

/// Parses `recall=0.9,mistakes=0.05,falls=0.8,rises=0.1,guesses-sides`. `falls` and `rises` are the shares by which the
/// recall falls and the mistakes rise at the end of a dose's range. Parts that are left out have the values of an eye that sees
/// everything, and loses recall with the dose.
pub(super) fn parse_eye(typed: &str) -> Result<EyeQuality, CommandError> {
    let mut eye = EyeQuality { falls: DEFAULT_RECALL_FALL_SHARE, ..EyeQuality::PERFECT };
    for part in typed.split(',').map(str::trim) {
        let (name, value) = part.split_once('=').unwrap_or((part, ""));
        let share = match name {
            "guesses-sides" if value.is_empty() => {
                eye.guesses_sides = true;
                continue;
            }
            "recall" => &mut eye.recall,
            "mistakes" => &mut eye.mistakes,
            "falls" => &mut eye.falls,
            "rises" => &mut eye.rises,
            _ => return Err(eye_error(typed, part)),
        };
        let value = value.parse().ok().filter(|value: &f64| (0.0..=1.0).contains(value));
        *share = value.ok_or_else(|| eye_error(typed, part))?;
    }
    Ok(eye)
}

fn eye_error(typed: &str, part: &str) -> CommandError {
    CommandError::usage(
        format!("--eye {typed}: {part:?} is none of its parts"),
        "give recall, mistakes, falls and rises as shares from 0 to 1, and guesses-sides, as in --eye recall=0.9,mistakes=0.05",
    )
}

/// Describes the eye in a sentence.
pub(super) fn describe_eye(eye: &EyeQuality) -> String {
    let EyeQuality { recall, mistakes, falls, rises, guesses_sides } = eye;
    let guesses = if *guesses_sides { "; it guesses sides" } else { "" };
    format!(
        "A scripted eye sees: of the labels of the same pose {recall} x (1 - {falls} x strength), and calls {mistakes} + {rises} x strength of them by another name{guesses}. The strength of a change is how far its dose is on the way to the end of its range, from 0 to 1"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parse_eye_fills_in_defaults() {
        let eye = parse_eye("recall=0.9, guesses-sides").unwrap();
        assert_eq!(
            eye,
            EyeQuality { recall: 0.9, falls: DEFAULT_RECALL_FALL_SHARE, guesses_sides: true, ..EyeQuality::PERFECT }
        );
        for wrong in ["", "recall", "recall=2", "sees=1", "guesses-sides=1", "recall=NaN"] {
            assert!(parse_eye(wrong).is_err(), "{wrong}");
        }
    }
}
