//! The Python package, tested in Python with the extension module of this build.
//!
//! `WAYWORD_PACKAGE_PYTHON` names a Python that has the packages of `python/tests/requirements.txt`; otherwise it is
//! `python3`. Parts with missing packages are skipped with a message.

#![cfg(unix)]
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and says what it skipped or counted"
)]

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

fn package() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../python").canonicalize().unwrap()
}

/// The extension module, which cargo builds into the folder of this test.
fn module() -> PathBuf {
    let ends = if cfg!(target_os = "macos") { "dylib" } else { "so" };
    env::current_exe().unwrap().with_file_name(format!("lib_wayword.{ends}"))
}

/// The Python that can run a module; `None` if there is none.
fn python(module: &str) -> Option<String> {
    let python = env::var("WAYWORD_PACKAGE_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has = Command::new(&python).args(["-c", &format!("import numpy, {module}")]).output();
    if has.is_ok_and(|has| has.status.success()) {
        return Some(python);
    }
    println!("SKIPPED: {python} has not both numpy and {module} (WAYWORD_PACKAGE_PYTHON names another Python)");
    None
}

/// A folder with the package as it is installed.
fn installed() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let to = folder.path().join("wayword");
    fs::create_dir(&to).unwrap();
    for file in fs::read_dir(package().join("wayword")).unwrap() {
        let file = file.unwrap().path();
        let is_source = file.extension().is_some_and(|ends| ends == "py" || ends == "pyi" || ends == "typed");
        if is_source {
            fs::copy(&file, to.join(file.file_name().unwrap())).unwrap();
        }
    }
    std::os::unix::fs::symlink(module(), to.join("_wayword.abi3.so")).unwrap();
    folder
}

fn passes(command: &mut Command) {
    let done = command.output().unwrap();
    let told = [done.stdout, done.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
    println!("{told}");
    assert!(done.status.success(), "{told}");
}

#[test]
fn the_package_passes_its_own_tests() {
    let Some(python) = python("pytest") else { return };
    let installed = installed();
    let mut command = Command::new(python);
    // Python looks for modules in the current folder first, so that is not the one of the sources.
    command.current_dir(installed.path()).env("PYTHONPATH", installed.path());
    command.args(["-B", "-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", "-c"]);
    passes(command.arg(package().join("pyproject.toml")).arg(package().join("tests")));
}

#[test]
fn the_package_is_typed_and_formatted() {
    if let Some(python) = python("mypy") {
        let cache = tempfile::tempdir().unwrap();
        passes(Command::new(python).current_dir(package()).args(["-m", "mypy", "--cache-dir"]).arg(cache.path()));
    }
    if let Some(python) = python("ruff") {
        for what in [&["check"][..], &["format", "--check"]] {
            passes(Command::new(&python).current_dir(package()).args(["-m", "ruff"]).args(what).arg("--no-cache"));
        }
    }
}
