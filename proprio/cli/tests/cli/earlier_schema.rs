//! A recording stays readable whose board sent the earlier hash of the same layout of messages.

use std::path::Path;

use proprio_session::recording::{Item, Reader};
use serde_json::Value;
use telemetry::{Decoder, Message, SCHEMA, is_same_layout};

use super::common::{Folder, json, text};

const NAME: &str = "earlier-schema-hash";

#[test]
fn estimates_of_the_earlier_hash_are_reproduced_bit_for_bit() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../host-tests");
    let recording = folder.join("recordings").join(NAME).with_extension("mcap");
    let table = folder.join("tables").join(NAME).with_extension("toml");
    let run = Folder::new().done(&["replay", text(&recording), "--table", text(&table), "--json"]);
    let recorded = &json(&run)["sessions"][0]["recorded"];
    assert_eq!((&recorded["estimates"], &recorded["equal"]), (&300.into(), &300.into()), "{}", run.stderr);
    assert_eq!((&recorded["uncertainties"]["compared"], &recorded["uncertainties"]["equal"]), (&12.into(), &12.into()));
    assert_eq!((&recorded["first_difference"], &recorded["not_compared"]), (&Value::Null, &0.into()));
    assert!(!run.stderr.contains("warning") && run.stderr.contains("bit for bit"), "{}", run.stderr);
}

#[test]
fn every_hello_in_it_has_the_earlier_hash() {
    let recording = include_bytes!("../../../../host-tests/recordings/earlier-schema-hash.mcap");
    let mut decoder = Decoder::<Message>::new();
    let mut schemas = Vec::new();
    for item in Reader::new(&recording[..]) {
        let Item::Bytes(_, bytes) = item.expect("it is whole") else { continue };
        for message in bytes.into_iter().filter_map(|byte| decoder.push(byte)) {
            if let Message::Hello(hello) = message.expect("nothing is damaged") {
                schemas.push(hello.schema);
            }
        }
    }
    assert_eq!(schemas, [0x03c8_8117; 3]);
    assert!(is_same_layout(schemas[0]) && is_same_layout(SCHEMA) && !is_same_layout(SCHEMA ^ 1));
}
