//! Runs a stand-in for a simulator, for demonstrations without one:
//! `cargo run -p wayword-live --features stand-in -- tdw 1071` connects to a controller on that port like TDW's build;
//! `... -- virtualhome 8080` listens on that port like VirtualHome's executable.

use std::{env, error::Error, net::SocketAddr, thread::park};
use wayword_live::{tdw, virtualhome};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let usage = "usage: stand_in tdw|virtualhome PORT";
    let [simulator, port] = arguments.as_slice() else { return Err(usage.into()) };
    let address = SocketAddr::from(([127, 0, 0, 1], port.parse()?));
    match simulator.as_str() {
        "tdw" => {
            // As in the genuine build, an unfurnished floor plan shows no furniture and has no labels.
            let options = tdw::stand_in::StandInOptions { furnishes: false, ..Default::default() };
            tdw::stand_in::StandIn::start(address, options).join();
        }
        "virtualhome" => {
            let _running = virtualhome::stand_in::StandIn::start(address)?;
            loop {
                park();
            }
        }
        _ => return Err(usage.into()),
    }
    Ok(())
}
