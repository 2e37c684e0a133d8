//! An MCAP file as a ROS 2 bag: a channel per topic, messages in CDR, quality of service as
//! rosbag2 notes it. Not compressed, and the same messages give the same bytes.

use super::cdr::Cdr;
use super::messages::Message;
use crate::ExportError;
use crate::rows::Nanoseconds;
use mcap::records::MessageHeader;
use mcap::{Attachment, WriteOptions, Writer};
use std::collections::BTreeMap;
use std::io::Cursor;

pub(crate) struct Bag {
    writer: Writer<Cursor<Vec<u8>>>,
}

/// A topic, and how many messages it has.
pub(crate) struct Channel {
    id: u16,
    sequence: u32,
    kind: &'static str,
}

/// Who comes late to a topic gets its last message, or none.
#[derive(Clone, Copy)]
pub(crate) enum Late {
    GetsTheLast,
    GetsNone,
}

impl Bag {
    pub fn new() -> Result<Self, ExportError> {
        let options = WriteOptions::new()
            .compression(None)
            .profile("ros2")
            .library(concat!("clearway ", env!("CARGO_PKG_VERSION")));
        let mut writer = options.create(Cursor::new(Vec::new()))?;
        // rosbag2 takes a file with this record, its metadata left empty, to note quality of service in
        // numbers, which all releases understand. Without it, those from Jazzy on look for words.
        let entries = ["serialized_metadata", "ROS_DISTRO"].map(|key| (key.to_owned(), String::new()));
        writer.write_metadata(&mcap::records::Metadata { name: "rosbag2".to_owned(), metadata: entries.into() })?;
        Ok(Self { writer })
    }

    pub fn channel<M: Message>(&mut self, topic: &str, late: Late) -> Result<Channel, ExportError> {
        let schema = self.writer.add_schema(M::TYPE, "ros2msg", M::SCHEMA.as_bytes())?;
        let metadata = BTreeMap::from([("offered_qos_profiles".to_owned(), quality_of_service(late))]);
        let id = self.writer.add_channel(schema, topic, "cdr", &metadata)?;
        Ok(Channel { id, sequence: 0, kind: M::TYPE })
    }

    pub fn write<M: Message>(
        &mut self,
        channel: &mut Channel,
        time: Nanoseconds,
        message: &M,
    ) -> Result<(), ExportError> {
        debug_assert_eq!(channel.kind, M::TYPE);
        let mut cdr = Cdr::new();
        message.write(&mut cdr);
        let header =
            MessageHeader { channel_id: channel.id, sequence: channel.sequence, log_time: time, publish_time: time };
        channel.sequence += 1;
        Ok(self.writer.write_to_known_channel(&header, &cdr.into_bytes())?)
    }

    pub fn attach_json(&mut self, name: &str, time: Nanoseconds, content: Vec<u8>) -> Result<(), ExportError> {
        let attachment = Attachment {
            log_time: time,
            create_time: time,
            name: name.to_owned(),
            media_type: "application/json".to_owned(),
            data: content.into(),
        };
        Ok(self.writer.attach(&attachment)?)
    }

    pub fn write_metadata(&mut self, name: &str, entries: BTreeMap<String, String>) -> Result<(), ExportError> {
        Ok(self.writer.write_metadata(&mcap::records::Metadata { name: name.to_owned(), metadata: entries })?)
    }

    pub fn finish(mut self) -> Result<Vec<u8>, ExportError> {
        self.writer.finish()?;
        Ok(self.writer.into_inner().into_inner())
    }
}

/// One publisher that is reliable and keeps its last message, or the last 100; as YAML, in the numbers
/// of `rmw`.
fn quality_of_service(late: Late) -> String {
    const FOR_EVER: &str = "\n    sec: 9223372036\n    nsec: 854775807";
    let (depth, durability) = match late {
        Late::GetsTheLast => (1, 1),
        Late::GetsNone => (100, 2),
    };
    format!(
        "- history: 1\n  depth: {depth}\n  reliability: 1\n  durability: {durability}\n  deadline:{FOR_EVER}\n  \
         lifespan:{FOR_EVER}\n  liveliness: 1\n  liveliness_lease_duration:{FOR_EVER}\n  \
         avoid_ros_namespace_conventions: false"
    )
}
