//! Writes the seeds of the fuzz targets, `fuzz/corpus`, from sessions, recordings, tables and streams of this repository:
//! `cargo run -p fuzz-targets --bin seeds`. Other files there, which a fuzzer has found, stay.

mod board;
mod recordings;
mod seed;
mod text;

use std::error::Error;
use std::fs;

use seed::{Seed, root};

fn main() -> Result<(), Box<dyn Error>> {
    let targets: [(&str, Vec<Seed>); 9] = [
        ("frame_decoder", board::frames()?),
        ("requests", board::requests()),
        ("table_page", board::tables()?),
        ("recording", recordings::recordings()?),
        ("session_csv", text::sessions()?),
        ("camera_csv", text::cameras()?),
        ("profile", text::profiles()),
        ("table_toml", text::tables()?),
        ("page_messages", text::page_messages()),
    ];
    for (target, seeds) in targets {
        let folder = root().join("fuzz/corpus").join(target);
        fs::create_dir_all(&folder)?;
        for (name, bytes) in &seeds {
            fs::write(folder.join(name), bytes)?;
        }
        let bytes: usize = seeds.iter().map(|(_, bytes)| bytes.len()).sum();
        println!("{target}: {} seeds, {bytes} bytes", seeds.len());
    }
    Ok(())
}
