//! Bodies of the fuzz targets: each takes any bytes, and panics where an invariant of their reader does not hold.
//!
//! `fuzz/` runs them under libFuzzer, and the tests of this crate run them over the seeds in `fuzz/corpus`, without a fuzzer.

mod camera_csv;
mod frame_decoder;
mod frames;
mod input_file;
mod page_messages;
mod parts;
mod profile;
mod ram_flash;
mod recording;
mod requests;
mod session_csv;
mod table_page;
mod table_toml;

pub use camera_csv::camera_csv;
pub use frame_decoder::frame_decoder;
pub use page_messages::page_messages;
pub use profile::profile;
pub use recording::recording;
pub use requests::requests;
pub use session_csv::session_csv;
pub use table_page::table_page;
pub use table_toml::table_toml;
