//! Decodes a board's recorded stream, and prints the tip's position and what else the board reports.
//!
//! ```text
//! cargo run -p telemetry --example decode
//! cargo run -p telemetry --example decode -- session.bin
//! ```
//!
//! Without an argument it decodes `stream.bin` in this folder, 1.2 s of an emulated board with firmware 0.1.
//! `proprio convert session.mcap session.bin` makes such a file from a recording.

use std::error::Error;
use std::{env, fs};

use telemetry::{Decoder, Message};

/// One unit of an estimate's position, 2⁻²⁶ m.
const METERS: f64 = 1.0 / 67_108_864.0;

fn main() -> Result<(), Box<dyn Error>> {
    let default = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/stream.bin").to_owned();
    let stream = fs::read(env::args().nth(1).unwrap_or(default))?;

    // Bytes may come in any cut: the decoder takes them one by one and gives a message at the end of each frame.
    let mut decoder = Decoder::<Message>::new();
    for message in stream.into_iter().filter_map(|byte| decoder.push(byte)) {
        match message {
            Ok(Message::Hello(hello)) => {
                println!("firmware {}, arm {}, boot {}", hello.firmware, hello.arm, hello.boot);
            }
            Ok(Message::Estimate(estimate)) => {
                if let Some(tip) = estimate.segments.last().copied().flatten() {
                    let [x, y] = tip.end.map(|units| f64::from(units) * METERS * 1e3);
                    println!("tick {}: tip at {x:.1} mm, {y:.1} mm", estimate.tick);
                }
            }
            Ok(Message::Event(event)) => println!("{event:?}"),
            Ok(_) => {}
            Err(error) => println!("{error}"),
        }
    }
    println!("{:?}", decoder.counts());
    Ok(())
}
