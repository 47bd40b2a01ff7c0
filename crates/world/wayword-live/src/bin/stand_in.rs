//! Runs a stand-in in place of a simulator, for demonstrations without one, until it is interrupted.
//!
//! `cargo run --release -p wayword-live --features stand-in -- virtualhome 8080 --houses 1,4` listens on that port like
//! VirtualHome's executable; `... -- tdw 1071 --first 12` connects to a controller on that port like TDW's build.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program talks to whoever started it")]

use std::{env, error::Error, fs, net::SocketAddr, path::PathBuf, process::ExitCode, thread::park};
use wayword_live::{ShownAs, StandInHouses, tdw, virtualhome};

const USAGE: &str = "\
usage: stand_in tdw|virtualhome PORT|ADDRESS:PORT [--houses SEED,SEED... | --first N] [--names FILE]

  --houses SEED,...  Show these generated houses. Those with two storeys are refused.
  --first N          Show the first N houses with one storey, from seed 0 on.
  --names FILE       Write which scene shows which house into a file, for `wayword robustness --scene-name @FILE`.
                     Otherwise it is printed.

Without houses, tdw shows a floor plan without furniture, and each home of virtualhome another house.";

/// The arguments of the command line.
struct StandInArguments {
    simulator: String,
    address: SocketAddr,
    houses: Option<StandInHouses>,
    names: Option<PathBuf>,
}

impl StandInArguments {
    fn from_arguments(mut arguments: impl Iterator<Item = String>) -> Result<Self, Box<dyn Error>> {
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
                    typed.houses = Some(StandInHouses::from_seeds(seeds)?);
                }
                "--first" => {
                    let count = value.parse().map_err(|error| format!("--first {value}: {error}"))?;
                    typed.houses = Some(StandInHouses::with_one_storey(0, count));
                }
                "--names" => typed.names = Some(value.into()),
                _ => return Err(USAGE.into()),
            }
        }
        Ok(typed)
    }

    /// Prints or writes which scene shows which house.
    fn write_scene_names(&self, shown: &[ShownAs]) -> Result<(), Box<dyn Error>> {
        let lines: String = shown.iter().map(|each| format!("{each}\n")).collect();
        match &self.names {
            Some(file) => fs::write(file, lines).map_err(|error| format!("{}: {error}", file.display()))?,
            None => print!("{lines}"),
        }
        Ok(())
    }
}

fn main() -> ExitCode {
    match run_stand_in() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run_stand_in() -> Result<(), Box<dyn Error>> {
    let typed = StandInArguments::from_arguments(env::args().skip(1))?;
    match (typed.simulator.as_str(), typed.houses.clone()) {
        ("tdw", houses) => {
            use tdw::stand_in::{StandInFurnishing, StandInOptions, TdwStandIn};
            let mut options = StandInOptions { furnished: StandInFurnishing::OnceAdded, ..Default::default() };
            if let Some(houses) = houses {
                typed.write_scene_names(&TdwStandIn::shown_scenes(&houses)?)?;
                options = StandInOptions { furnished: StandInFurnishing::Always, houses, ..options };
            }
            TdwStandIn::start(typed.address, options).join();
        }
        ("virtualhome", houses) => {
            use virtualhome::stand_in::VirtualHomeStandIn;
            let _running = match houses {
                Some(houses) => {
                    typed.write_scene_names(&VirtualHomeStandIn::shown_scenes(&houses)?)?;
                    VirtualHomeStandIn::showing_houses(typed.address, houses)?
                }
                None => VirtualHomeStandIn::start(typed.address)?,
            };
            loop {
                park();
            }
        }
        _ => return Err(USAGE.into()),
    }
    Ok(())
}
