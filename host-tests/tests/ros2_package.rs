//! The package of our own messages for machines with ROS 2: it is that of the recordings.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crate is in the workspace").to_owned()
}

/// Name and text of each definition in a folder of which `is_own` is true, sorted.
fn definitions(folder: &str, is_own: impl Fn(&str) -> bool) -> Vec<(String, String)> {
    let files = fs::read_dir(root().join(folder)).expect("the folder can be listed");
    let mut found: Vec<(String, String)> = files
        .map(|file| file.expect("the folder can be listed").path())
        .map(|path| (path.file_name().expect("a file").to_string_lossy().into_owned(), path))
        .filter(|(name, _)| is_own(name))
        .map(|(name, path)| (name, fs::read_to_string(path).expect("a definition is text")))
        .collect();
    found.sort();
    found
}

#[test]
fn definitions_of_the_package_are_those_in_recordings() {
    let schemas = fs::read_to_string(root().join("proprio/session/src/recording/schema.rs")).expect("it is there");
    let is_own = |name: &str| {
        let message = name.trim_end_matches(".msg");
        schemas.contains(&format!("\"proprio_msgs/msg/{message}\""))
    };
    let recorded = definitions("proprio/session/src/recording/definitions", is_own);
    assert!(!recorded.is_empty());
    assert_eq!(definitions("ros2/proprio_msgs/msg", |_| true), recorded);
}

#[test]
fn the_package_has_the_version_of_the_workspace() {
    let manifest = fs::read_to_string(root().join("ros2/proprio_msgs/package.xml")).expect("it is there");
    let version = format!("<version>{}</version>", env!("CARGO_PKG_VERSION"));
    assert!(manifest.contains(&version), "{version}");
}
