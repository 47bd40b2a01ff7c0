//! The participants: how they arrive, consent, come back, stop, and are forgotten.

use super::{StudyTransaction, stage::ParticipationOutcome};
use crate::{
    study::{ParticipantStatus, RecruiterSettings, StudyError},
    token::{hash_parts, is_token, random_token},
};
use rusqlite::{OptionalExtension as _, Row, params};
use serde::{Deserialize, Serialize};

/// How long a session lasts, milliseconds. After that, the participant's link opens a new one.
const SESSION_MS: i64 = 7 * 24 * 3600 * 1000;
/// Most sessions of one person. A further one ends the oldest.
const MAX_SESSIONS_PER_PERSON: i64 = 8;
/// Longest id from a recruiter, bytes. A link with a longer one counts as unknown.
const MAX_RECRUITER_ID_BYTES: usize = 128;

/// What scripts and templates leave where a value is missing. No recruiter issues these as ids.
const NO_IDS: [&str; 6] = ["undefined", "null", "none", "nan", "nil", "false"];

/// Whether a recruiter may have issued an id. An empty one, a missing value, and the name of a parameter (a template that nobody
/// filled in) are none.
pub(crate) fn may_be_issued(id: &str, parameter: &str) -> bool {
    let is = |other: &str| id.eq_ignore_ascii_case(other);
    is_plain_id(id) && !id.is_empty() && !is(parameter) && !NO_IDS.into_iter().any(is)
}

fn is_plain_id(id: &str) -> bool {
    id.len() <= MAX_RECRUITER_ID_BYTES
        && id.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_' | b'.' | b':'))
}

/// The link by which a visitor came.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum ParticipantArrival {
    /// A personal link, by its token.
    Link(String),
    /// A recruiter's link, with the recruiter's ids of the person, the study and the session.
    Recruit { person: String, study: String, session: String },
}

impl ParticipantArrival {
    /// Whether its parts have the form of tokens and ids, which the site accepts.
    pub(crate) fn is_plain(&self) -> bool {
        match self {
            Self::Link(token) => is_token(token),
            Self::Recruit { person, study, session } => {
                !person.is_empty()
                    && !session.is_empty()
                    && [person, study, session].into_iter().all(|id| is_plain_id(id))
            }
        }
    }

    /// The hash under which the database stores the link.
    fn arrival_hash(&self) -> [u8; 32] {
        match self {
            Self::Link(token) => hash_parts(&["link", token]),
            Self::Recruit { person, study, session } => hash_parts(&["recruit", person, study, session]),
        }
    }
}

/// Where an arrival leads.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum ArrivalOutcome {
    /// To the stage that the person had reached, in a new session with this token.
    Back(String),
    /// To the consent page.
    New,
    /// Nowhere: the link is unknown, or belongs to another study.
    Unknown,
    /// Nowhere: the same person came by another link of the recruiter before.
    Twice,
    /// Nowhere: the person had all data deleted.
    Gone,
    /// Nowhere at the moment: all places are taken.
    Full,
    /// Nowhere: the study is over.
    Closed,
}

/// What happens to the answers of a participant who stops.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum WithdrawalChoice {
    /// The answers stay in the results.
    Keep,
    /// All data of the participant are deleted.
    Delete,
}

/// Personal links that were made.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct InviteTokens {
    /// One token for each link. A link is the site's address, `/t/` and a token. The database has only hashes of the tokens.
    pub tokens: Vec<String>,
    /// How many earlier links nobody has used so far. They stay valid.
    pub unused_before: u32,
}

/// What `forget` removes, or would remove.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ErasureReport {
    /// The participant.
    pub participant: String,
    /// How many answers.
    pub answers: u32,
    /// How many items in all, answered or not.
    pub items: u32,
    /// Whether they were deleted, or only counted.
    pub is_done: bool,
}

impl StudyTransaction<'_> {
    /// Makes personal links.
    pub(crate) fn invite_participants(&self, count: u32) -> Result<InviteTokens, StudyError> {
        let unused_before = self.count_unused_links()?;
        let mut tokens = Vec::new();
        for _ in 0..count {
            let token = new_token()?;
            let link = ParticipantArrival::Link(token.clone()).arrival_hash();
            self.db.execute("INSERT INTO link (hash, made_ms) VALUES (?1, ?2)", params![link, self.now_ms])?;
            tokens.push(token);
        }
        Ok(InviteTokens { tokens, unused_before })
    }

    /// Decides where an arrival leads. This writes only the new session of a known participant.
    pub(crate) fn enter_study(&self, arrival: &ParticipantArrival) -> Result<ArrivalOutcome, StudyError> {
        if !arrival.is_plain() {
            return Ok(ArrivalOutcome::Unknown);
        }
        if let Some(person) = self.person_by_link(arrival)? {
            return Ok(ArrivalOutcome::Back(self.open_session(person)?));
        }
        if self.is_barred(arrival)? {
            return Ok(ArrivalOutcome::Gone);
        }
        match arrival {
            ParticipantArrival::Link(_) => {
                let issued =
                    self.db.query_row("SELECT 1 FROM link WHERE hash = ?1", [arrival.arrival_hash()], |_| Ok(()));
                if self.study.settings.recruiter != RecruiterSettings::Links || issued.optional()?.is_none() {
                    return Ok(ArrivalOutcome::Unknown);
                }
            }
            ParticipantArrival::Recruit { person, study, .. } => {
                let RecruiterSettings::Parameters { only_study, .. } = &self.study.settings.recruiter else {
                    return Ok(ArrivalOutcome::Unknown);
                };
                if !only_study.is_empty() && only_study != study {
                    return Ok(ArrivalOutcome::Unknown);
                }
                let earlier = self.db.query_row("SELECT 1 FROM recruit WHERE id = ?1", [person], |_| Ok(()));
                if earlier.optional()?.is_some() {
                    return Ok(ArrivalOutcome::Twice);
                }
            }
        }
        if self.is_closed()? {
            return Ok(ArrivalOutcome::Closed);
        }
        let least = self.study.settings.least_items.max(1);
        Ok(if self.count_free_items()? >= least.min(self.study.plan.per_participant) {
            ArrivalOutcome::New
        } else {
            ArrivalOutcome::Full
        })
    }

    /// Admits a person who consented to the text with this hash. If the arrival is known already, it leads to the same person.
    pub(crate) fn record_consent(
        &self,
        arrival: &ParticipantArrival,
        consent: &str,
    ) -> Result<ArrivalOutcome, StudyError> {
        let outcome = self.enter_study(arrival)?;
        if outcome != ArrivalOutcome::New {
            return Ok(outcome);
        }
        let words = serde_json::json!(self.study.consent_words()).to_string();
        self.db.execute("INSERT OR IGNORE INTO consent (hash, words) VALUES (?1, ?2)", [consent, &words])?;
        self.db.execute(
            "INSERT INTO person (name, link, status, consent, consented_ms, seen_ms, understood, expected) \
             VALUES (?1, ?2, 'started', ?3, ?4, ?4, ?5, ?6)",
            params![
                new_token()?,
                arrival.arrival_hash(),
                consent,
                self.now_ms,
                self.study.settings.questions.is_empty(),
                // Near the end of a study, a participant is promised only as many items as are left.
                self.count_free_items()?.min(self.study.plan.per_participant)
            ],
        )?;
        let person = self.db.last_insert_rowid();
        if let ParticipantArrival::Recruit { person: id, study, session } = arrival {
            let row = params![person, id, study, session];
            self.db.execute("INSERT INTO recruit (person, id, study, session) VALUES (?1, ?2, ?3, ?4)", row)?;
        }
        Ok(ArrivalOutcome::Back(self.open_session(person)?))
    }

    /// The person of a session, with the person's id in the results. Also records a sign of life.
    pub(crate) fn person_by_session(&self, session: &str) -> Result<Option<(i64, String)>, StudyError> {
        if !is_token(session) {
            return Ok(None);
        }
        let values = params![hash_parts(&["session", session]), self.now_ms - SESSION_MS];
        let find =
            "SELECT person, name FROM session JOIN person ON person.id = person WHERE hash = ?1 AND made_ms > ?2";
        let found: Option<(i64, String)> =
            self.db.query_row(find, values, |row| Ok((row.get(0)?, row.get(1)?))).optional()?;
        if let Some((person, _)) = &found {
            // `abs`, because after the clock was set back an active participant would otherwise look absent.
            let update = "UPDATE person SET seen_ms = ?2 WHERE id = ?1 AND abs(seen_ms - ?2) > 1000";
            self.db.execute(update, params![person, self.now_ms])?;
        }
        Ok(found)
    }

    /// Ends a participation at the participant's own wish.
    pub(crate) fn withdraw_person(&self, person: i64, choice: WithdrawalChoice) -> Result<(), StudyError> {
        match choice {
            WithdrawalChoice::Delete => {
                self.bar_person(person)?;
                self.erase_person(person)
            }
            WithdrawalChoice::Keep => {
                self.give_back(person)?;
                let update =
                    "UPDATE person SET status = 'withdrawn', finished_ms = ?2 WHERE id = ?1 AND status = 'started'";
                self.db.execute(update, params![person, self.now_ms])?;
                Ok(())
            }
        }
    }

    /// Deletes all data of a participant, or counts them for a dry run. `participant` is our id, the recruiter's id, or a personal
    /// link.
    pub(crate) fn forget_participant(&self, participant: &str, is_dry: bool) -> Result<ErasureReport, StudyError> {
        let token = participant.rsplit_once("/t/").map_or(participant, |(_, token)| token);
        let link = ParticipantArrival::Link(token.to_owned()).arrival_hash();
        let find = "SELECT id, name FROM person \
                    WHERE name = ?1 OR link = ?2 OR id IN (SELECT person FROM recruit WHERE recruit.id = ?1)";
        let found =
            self.db.query_row(find, params![participant, link], |row| Ok((row.get(0)?, row.get(1)?))).optional()?;
        let Some((person, name)): Option<(i64, String)> = found else {
            let problem = format!("there is no participant {participant}");
            return Err(StudyError::refused_request(
                problem,
                "`wayword study status STUDY --participants` lists them; forgotten ones are gone",
            ));
        };
        let count = "SELECT count(*), count(answer) FROM slot WHERE person = ?1";
        let (items, answers) = self.db.query_row(count, [person], |row| Ok((row.get(0)?, row.get(1)?)))?;
        if !is_dry {
            self.erase_person(person)?;
        }
        Ok(ErasureReport { participant: name, answers, items, is_done: !is_dry })
    }

    /// Keeps a person who had all data deleted from taking part again as a stranger, until the study is closed.
    fn bar_person(&self, person: i64) -> Result<(), StudyError> {
        let insert = "INSERT OR IGNORE INTO gone (hash) SELECT link FROM person WHERE id = ?1";
        self.db.execute(insert, [person])?;
        let find = "SELECT id FROM recruit WHERE person = ?1";
        let recruit: Option<String> = self.db.query_row(find, [person], |row| row.get(0)).optional()?;
        if let Some(recruit) = recruit {
            self.db.execute(
                "INSERT OR IGNORE INTO gone (hash) VALUES (?1)",
                [hash_parts(&["recruiter's id", &recruit])],
            )?;
        }
        Ok(())
    }

    /// Whether the link or the recruiter's id belongs to a person who had all data deleted.
    fn is_barred(&self, arrival: &ParticipantArrival) -> Result<bool, StudyError> {
        let recruit = match arrival {
            ParticipantArrival::Link(_) => None,
            ParticipantArrival::Recruit { person, .. } => Some(hash_parts(&["recruiter's id", person])),
        };
        let find = "SELECT EXISTS (SELECT 1 FROM gone WHERE hash IN (?1, ?2))";
        Ok(self.db.query_row(find, params![arrival.arrival_hash(), recruit], |row| row.get(0))?)
    }

    /// Deletes a person with all answers, and counts the person as forgotten.
    fn erase_person(&self, person: i64) -> Result<(), StudyError> {
        let link: Option<[u8; 32]> =
            self.db.query_row("SELECT link FROM person WHERE id = ?1", [person], |row| row.get(0)).optional()?;
        self.db.execute("DELETE FROM link WHERE hash = ?1", [link])?;
        if self.db.execute("DELETE FROM person WHERE id = ?1", [person])? > 0 {
            self.set_meta("forgotten", &(count_forgotten(self)? + 1).to_string())?;
        }
        Ok(())
    }

    /// Closes the study and deletes the participants' ids at the recruiter, unless people are still answering. Returns how many are.
    pub(crate) fn close_study(&self, even_if_live: bool) -> Result<u32, StudyError> {
        self.end_all_done()?;
        let live = self.count_live()?;
        if live == 0 || even_if_live {
            if !self.is_closed()? {
                self.set_meta("closed_ms", &self.now_ms.to_string())?;
            }
            // Anyone with the recruiter's list could recompute the hash of a recruiter's link and so learn who took part.
            self.db.execute("UPDATE person SET link = randomblob(32) WHERE id IN (SELECT person FROM recruit)", [])?;
            self.db.execute("DELETE FROM recruit", [])?;
            self.db.execute("DELETE FROM gone", [])?;
        }
        Ok(live)
    }

    /// How many participants are still answering: not finished, and seen within the lease.
    pub(crate) fn count_live(&self) -> Result<u32, StudyError> {
        let since_ms = self.now_ms - self.lease_length_ms();
        let count = "SELECT count(*) FROM person WHERE status = 'started' AND seen_ms > ?1";
        Ok(self.db.query_row(count, [since_ms], |row| row.get(0))?)
    }

    /// How a participation ended; `None` while it goes on.
    pub(super) fn find_outcome(&self, person: i64) -> Result<Option<ParticipationOutcome>, StudyError> {
        let find = "SELECT status FROM person WHERE id = ?1";
        match self.db.query_row(find, [person], |row| status_in_column(row, 0))? {
            ParticipantStatus::Started => Ok(None),
            status => Ok(Some(ParticipationOutcome { status, answers: self.answer_progress(person)?.answered })),
        }
    }

    /// Ends a participation with a status.
    pub(super) fn end_participation(
        &self,
        person: i64,
        status: ParticipantStatus,
    ) -> Result<ParticipationOutcome, StudyError> {
        let update = "UPDATE person SET status = ?2, finished_ms = ?3 WHERE id = ?1";
        self.db.execute(update, params![person, status.name(), self.now_ms])?;
        Ok(ParticipationOutcome { status, answers: self.answer_progress(person)?.answered })
    }

    /// The participant who came by this link before.
    fn person_by_link(&self, arrival: &ParticipantArrival) -> Result<Option<i64>, StudyError> {
        let find = "SELECT id FROM person WHERE link = ?1";
        Ok(self.db.query_row(find, [arrival.arrival_hash()], |row| row.get(0)).optional()?)
    }

    /// Opens a session for a person and returns its token.
    fn open_session(&self, person: i64) -> Result<String, StudyError> {
        let session = new_token()?;
        let insert = "INSERT INTO session (hash, person, made_ms) VALUES (?1, ?2, ?3)";
        self.db.execute(insert, params![hash_parts(&["session", &session]), person, self.now_ms])?;
        let delete_oldest = "DELETE FROM session WHERE person = ?1 AND rowid NOT IN \
                   (SELECT rowid FROM session WHERE person = ?1 ORDER BY made_ms DESC, rowid DESC LIMIT ?2)";
        self.db.execute(delete_oldest, params![person, MAX_SESSIONS_PER_PERSON])?;
        Ok(session)
    }
}

/// A new token.
pub(super) fn new_token() -> Result<String, StudyError> {
    random_token()
        .map_err(|error| StudyError::refused_request(format!("the system has no randomness: {error}"), "try again"))
}

/// How many participants were forgotten.
pub(super) fn count_forgotten(transaction: &StudyTransaction<'_>) -> Result<u64, StudyError> {
    Ok(transaction.read_meta("forgotten")?.and_then(|count| count.parse().ok()).unwrap_or(0))
}

/// The status in a column of a row.
pub(super) fn status_in_column(row: &Row<'_>, column: usize) -> Result<ParticipantStatus, rusqlite::Error> {
    let name: String = row.get(column)?;
    let found = ParticipantStatus::ALL.into_iter().find(|status| status.name() == name);
    found.ok_or_else(|| unreadable_value(column, format!("unknown status {name}")))
}

/// An error for a value that this program did not write.
pub(super) fn unreadable_value(
    column: usize,
    error: impl Into<Box<dyn std::error::Error + Send + Sync + 'static>>,
) -> rusqlite::Error {
    rusqlite::Error::FromSqlConversionFailure(column, rusqlite::types::Type::Text, error.into())
}
