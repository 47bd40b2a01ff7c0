//! `wayword`: see `wayword --help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    wayword::main(std::env::args_os().collect()).into()
}
