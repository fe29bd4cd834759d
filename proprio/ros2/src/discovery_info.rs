//! `rmw_dds_common/msg/ParticipantEntitiesInfo`: the message by which other nodes know the nodes of a participant of DDS.

use proprio_session::recording::CdrWriter;

/// Its topic and its type, without the prefix of other topics.
pub const TOPIC: &str = "ros_discovery_info";
pub const TYPE: &str = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_";

/// The message of a participant with one node, whose writers are given.
pub fn encode(participant: [u8; 16], name: &str, writers: &[[u8; 16]], identifier_bytes: usize) -> Vec<u8> {
    let mut cdr = CdrWriter::new();
    let identifier = |cdr: &mut CdrWriter, guid: &[u8; 16]| {
        for byte in guid.iter().copied().chain([0; 8]).take(identifier_bytes) {
            cdr.u8(byte);
        }
    };
    identifier(&mut cdr, &participant);
    cdr.length(1);
    cdr.string("/");
    cdr.string(name);
    // No reader.
    cdr.length(0);
    cdr.length(writers.len());
    for writer in writers {
        identifier(&mut cdr, writer);
    }
    cdr.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::encode;

    #[test]
    fn an_identifier_of_earlier_distributions_is_padded_to_24_bytes() {
        let (participant, writer) = ([1; 16], [2; 16]);
        let name = [&[1, 0, 0, 0, 2, 0, 0, 0][..], b"/\0", &[0; 2], &[2, 0, 0, 0], b"p\0", &[0; 2]].concat();
        let rest = [&name[..], &[0; 4], &[1, 0, 0, 0], &writer].concat();
        let header = [0, 1, 0, 0];
        assert_eq!(encode(participant, "p", &[writer], 16), [&header[..], &participant, &rest].concat());
        let padded = [&header[..], &participant, &[0; 8], &rest, &[0; 8]].concat();
        assert_eq!(encode(participant, "p", &[writer], 24), padded);
    }
}
