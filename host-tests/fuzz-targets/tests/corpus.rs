//! The bodies of the fuzz targets over the seeds and findings in `fuzz/corpus`, without a fuzzer.

use std::fs;
use std::path::{Path, PathBuf};

/// Runs a target over the files of its folder.
fn run(name: &str, target: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus").join(name);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("the folder can be listed").path()).collect();
    files.sort();
    assert!(files.len() >= 12, "{}: {} files", folder.display(), files.len());
    for file in files {
        // Shown where it fails.
        println!("{}", file.display());
        target(&fs::read(&file).expect("the file can be read"));
    }
}

/// One test for each target.
macro_rules! corpus {
    ($($target:ident)*) => {
        $(#[test]
        fn $target() {
            run(stringify!($target), fuzz_targets::$target);
        })*

        #[test]
        fn every_folder_of_the_corpus_is_run() {
            let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
            let entries = fs::read_dir(corpus).expect("there is a corpus");
            let mut folders: Vec<_> = entries.map(|entry| entry.expect("it can be listed").file_name()).collect();
            folders.sort();
            let mut targets = [$(stringify!($target)),*];
            targets.sort_unstable();
            assert_eq!(folders, targets);
        }
    };
}

corpus!(camera_csv frame_decoder page_messages profile recording requests session_csv table_page table_toml);
