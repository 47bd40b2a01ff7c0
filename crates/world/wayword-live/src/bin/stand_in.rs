//! Runs a stand-in in place of a simulator, for demonstrations without one, until it is interrupted.
//!
//! `cargo run --release -p wayword-live --features stand-in -- virtualhome 8080 --houses 1,4` listens on that port like
//! VirtualHome's executable; `... -- tdw 1071 --first 12` connects to a controller on that port like TDW's build.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program talks to whoever started it")]

use std::{env, error::Error, fs, net::SocketAddr, path::PathBuf, process::ExitCode, thread::park};
use wayword_live::{Houses, ShownAs, tdw, virtualhome};

const USAGE: &str = "\
usage: stand_in tdw|virtualhome PORT|ADDRESS:PORT [--houses SEED,SEED... | --first N] [--names FILE]

  --houses SEED,...  Show these generated houses. Those with two storeys are refused.
  --first N          Show the first N houses with one storey, from seed 0 on.
  --names FILE       Write which scene shows which house into a file, for `wayword robustness --scene-name @FILE`.
                     Otherwise it is printed.

Without houses, tdw shows a floor plan without furniture, and each home of virtualhome another house.";

/// The arguments of the command line.
struct Typed {
    simulator: String,
    address: SocketAddr,
    houses: Option<Houses>,
    names: Option<PathBuf>,
}

impl Typed {
    fn read(mut arguments: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
        let (Some(simulator), Some(address)) = (arguments.next(), arguments.next()) else { return Err(USAGE.into()) };
        let address = match address.parse() {
            Ok(port) => SocketAddr::from(([127, 0, 0, 1], port)),
            Err(_) => address.parse().map_err(|error| format!("{address}: {error}"))?,
        };
        let mut typed = Self { simulator, address, houses: None, names: None };
        while let Some(flag) = arguments.next() {
            let value = arguments.next().ok_or(USAGE)?;
            match flag.as_str() {
                "--houses" => {
                    let seeds = value.split(',').map(|seed| seed.trim().parse());
                    let seeds =
                        seeds.collect::<Result<_, _>>().map_err(|error| format!("--houses {value}: {error}"))?;
                    typed.houses = Some(Houses::of(seeds)?);
                }
                "--first" => {
                    let count = value.parse().map_err(|error| format!("--first {value}: {error}"))?;
                    typed.houses = Some(Houses::with_one_storey(0, count));
                }
                "--names" => typed.names = Some(value.into()),
                _ => return Err(USAGE.into()),
            }
        }
        Ok(typed)
    }

    /// Prints or writes which scene shows which house.
    fn tell(&self, shown: &[ShownAs]) -> Result<(), Box<dyn Error>> {
        let lines: String = shown.iter().map(|each| format!("{each}\n")).collect();
        match &self.names {
            Some(file) => fs::write(file, lines).map_err(|error| format!("{}: {error}", file.display()))?,
            None => print!("{lines}"),
        }
        Ok(())
    }
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let typed = Typed::read(env::args().skip(1))?;
    match (typed.simulator.as_str(), typed.houses.clone()) {
        ("tdw", houses) => {
            use tdw::stand_in::{Furnished, StandIn, StandInOptions};
            let mut options = StandInOptions { furnished: Furnished::OnceAdded, ..Default::default() };
            if let Some(houses) = houses {
                typed.tell(&StandIn::scenes(&houses)?)?;
                options = StandInOptions { furnished: Furnished::Always, houses, ..options };
            }
            StandIn::start(typed.address, options).join();
        }
        ("virtualhome", houses) => {
            use virtualhome::stand_in::StandIn;
            let _running = match houses {
                Some(houses) => {
                    typed.tell(&StandIn::scenes(&houses)?)?;
                    StandIn::showing(typed.address, houses)?
                }
                None => StandIn::start(typed.address)?,
            };
            loop {
                park();
            }
        }
        _ => return Err(USAGE.into()),
    }
    Ok(())
}
