//! Writes the seeds of the fuzz targets, `fuzz/corpus`, from sessions, recordings, tables and streams of this repository:
//! `cargo run -p fuzz-targets --bin seeds`. Other files there, which a fuzzer has found, stay.

mod board;
mod recordings;
mod text;

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

/// Name and bytes of a seed.
type Seed = (String, Vec<u8>);

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

/// The repository's folder.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A text of the repository.
fn text_of(path: &str) -> Result<String, Box<dyn Error>> {
    fs::read_to_string(root().join(path)).map_err(|error| format!("{path}: {error}").into())
}

/// A seed of a first byte and what follows it.
fn seed(name: impl Into<String>, first: u8, rest: &[u8]) -> Seed {
    (name.into(), [&[first], rest].concat())
}
