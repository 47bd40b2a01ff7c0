//! Finds the password of a connection in an environment variable that the user names, or in a password file.
//! See <https://www.postgresql.org/docs/15/libpq-pgpass.html>.

use crate::DatabaseError;
use postgres::{Config, config::Host};
#[cfg(unix)]
use std::os::unix::fs::MetadataExt;
use std::{
    env, fs,
    path::{Path, PathBuf},
};

/// Largest password file, bytes. A larger file is refused.
const MAX_PASSWORD_FILE_BYTES: u64 = 1 << 20;

/// The password of a connection; `None` if no source has one for it. `variable` is the environment variable that the user names.
pub(crate) fn find_password(config: &Config, variable: Option<&str>) -> Result<Option<String>, DatabaseError> {
    if let Some(name) = variable {
        let value = env::var(name).ok().filter(|value| !value.is_empty());
        return value.map(Some).ok_or_else(|| DatabaseError::Name {
            problem: format!("its password should be in the environment variable {name}, which is not set"),
            hint: "set the variable, or leave --password-env out and use a password file (PGPASSFILE)",
        });
    }
    let named = env::var_os("PGPASSFILE").filter(|path| !path.is_empty()).map(PathBuf::from);
    let usual = || Some(PathBuf::from(env::var_os("HOME")?).join(".pgpass"));
    match named {
        Some(path) => find_in_file(config, &path),
        None => usual().filter(|path| path.exists()).map_or(Ok(None), |path| find_in_file(config, &path)),
    }
}

/// The password that a file has for a connection. A file that other users may read is refused.
fn find_in_file(config: &Config, path: &Path) -> Result<Option<String>, DatabaseError> {
    let failed = |problem: String, hint| DatabaseError::File { path: path.to_owned(), problem, hint };
    let metadata = fs::metadata(path).map_err(|error| failed(error.to_string(), "check PGPASSFILE"))?;
    if !metadata.is_file() || metadata.len() > MAX_PASSWORD_FILE_BYTES {
        return Err(failed("this is no password file".to_owned(), "check PGPASSFILE"));
    }
    #[cfg(unix)]
    if is_open_to_others(MetadataExt::mode(&metadata), MetadataExt::uid(&metadata)) {
        return Err(failed("others may read this password file".to_owned(), "chmod 600 the file"));
    }
    let text = fs::read_to_string(path).map_err(|error| failed(error.to_string(), "check PGPASSFILE"))?;
    Ok(text.lines().find_map(|line| password_in_line(line, &wanted_fields(config))))
}

/// Whether other users may read or write a file of this mode and owner. A file of root may be readable for its group, because
/// Kubernetes mounts secrets this way: root owns the file, and the worker is the only member of the group.
#[cfg(unix)]
fn is_open_to_others(mode: u32, owner: u32) -> bool {
    // Bits of the mode: 0o077 is any access by group or others; 0o037 lets the group read.
    let not_allowed = if owner == 0 { 0o037 } else { 0o077 };
    mode & not_allowed != 0
}

/// Host, port, database and user of the connection, in the order of a line of the password file.
fn wanted_fields(config: &Config) -> [String; 4] {
    let host = match config.get_hosts().first() {
        Some(Host::Tcp(name)) => name.clone(),
        _ => "localhost".to_owned(),
    };
    let port = config.get_ports().first().copied().unwrap_or(5432);
    let user = config.get_user().map(str::to_owned).or_else(|| env::var("USER").ok());
    [host, port.to_string(), config.get_dbname().unwrap_or_default().to_owned(), user.unwrap_or_default()]
}

/// The password of a line, if the line is for the connection with the `wanted` fields. `*` in a line fits every value.
fn password_in_line(line: &str, wanted: &[String; 4]) -> Option<String> {
    if line.starts_with('#') {
        return None;
    }
    let fields = split_fields(line);
    let [names @ .., password] = &fields[..] else { return None };
    let fits =
        names.len() == wanted.len() && names.iter().zip(wanted).all(|(name, wanted)| name == "*" || name == wanted);
    fits.then(|| password.clone())
}

/// The fields of a line, between colons. A backslash takes the next character as it is.
fn split_fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut characters = line.chars();
    while let Some(character) = characters.next() {
        let last = fields.len() - 1;
        match character {
            // The password is the fifth field and may contain colons.
            ':' if last < 4 => fields.push(String::new()),
            '\\' => fields[last].extend(characters.next()),
            other => fields[last].push(other),
        }
    }
    fields
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_line_that_fits_gives_the_password() {
        let wanted = ["far", "5432", "db", "me"].map(str::to_owned);
        let of = |line: &str| password_in_line(line, &wanted);
        assert_eq!(of("far:5432:db:me:ge:heim").as_deref(), Some("ge:heim"));
        assert_eq!(of("*:*:*:me:a\\:b\\\\").as_deref(), Some("a:b\\"));
        assert_eq!(of("other:5432:db:me:x"), None);
        assert_eq!(of("# far:5432:db:me:x"), None);
        assert_eq!(of("far:5432:db"), None);
    }

    #[cfg(unix)]
    #[test]
    fn a_group_may_read_roots_file_alone() {
        assert!(!is_open_to_others(0o100_440, 0) && !is_open_to_others(0o100_400, 1000));
        assert!(
            is_open_to_others(0o100_440, 1000) && is_open_to_others(0o100_460, 0) && is_open_to_others(0o100_444, 0)
        );
    }

    #[cfg(unix)]
    #[test]
    fn a_file_that_others_may_read_is_refused() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pass");
        fs::write(&path, "*:*:*:*:geheim\n").unwrap();
        let set = |mode| fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
        let mut config = Config::new();
        config.host("far").dbname("db").user("me");
        set(0o644);
        assert!(find_in_file(&config, &path).unwrap_err().to_string().contains("chmod 600"));
        set(0o600);
        assert_eq!(find_in_file(&config, &path).unwrap().as_deref(), Some("geheim"));
    }
}
