//! XML within bounds.
#![allow(clippy::unwrap_used)]

use clearway_files::{FileError, xml};
use proptest::prelude::*;
use std::path::Path;

fn refused(text: &str) -> FileError {
    match xml::parse(Path::new("r.urdf"), text) {
        Ok(_) => panic!("accepted: {}", &text[..text.len().min(100)]),
        Err(error) => error,
    }
}

#[test]
fn nodes_know_their_place() {
    let document = xml::parse(
        Path::new("r.urdf"),
        "<?xml version=\"1.0\"?>\n<robot name='a>b'>\n  <!-- <x> -->\n  <link name=\"é\"/><joint/>\n</robot>",
    )
    .unwrap();
    let joint = document.descendants().find(|n| n.has_tag_name("joint")).unwrap();
    assert_eq!(xml::position(joint), (4, 19));
}

#[test]
fn depth_and_counts_are_bounded() {
    let error = refused(&"<a>\n".repeat(200_000));
    assert_eq!(error.position(), Some((257, 1)));
    assert!(error.to_string().contains("nested more than 256 deep"), "{error}");
    assert!(refused(&format!("<r>{}</r>", "<a/>".repeat(300_000))).found().contains("more than 200000 elements"));
    let attributes: String = (0..100_000).map(|i| format!(" a{i}=''")).collect();
    assert!(refused(&format!("<r{attributes}/>")).found().contains("attributes"));
    let namespaces: String = (0..1000).map(|i| format!("<a xmlns:n{i}='u'/>")).collect();
    assert!(refused(&format!("<r>{namespaces}</r>")).found().contains("namespace"));
    assert!(xml::parse(Path::new("r.urdf"), &format!("{}{}", "<a>".repeat(256), "</a>".repeat(256))).is_ok());
}

#[test]
fn entities_are_refused() {
    let error = refused("<?xml version=\"1.0\"?>\n<!DOCTYPE r [<!ENTITY a \"b\">]>\n<r>&a;</r>");
    assert_eq!(error.position(), Some((2, 1)));
    assert!(error.to_string().contains("document type"), "{error}");
    assert!(refused("<r>&a;</r>").found().contains("not well-formed"));
}

#[test]
fn what_is_not_xml_is_told() {
    assert!(refused("").to_string().contains("an empty file, expected XML"));
    assert!(
        refused("name: shelf").to_string().contains("r.urdf:1:1: text that starts with `name: shelf`, expected XML")
    );
    let error = refused("<robot>\n  <link>\n</robot>");
    assert_eq!(error.position(), Some((3, 1)));
    assert!(error.found().starts_with("not well-formed XML"), "{error}");
    for text in ["<", "<!", "<!--", "<![CDATA[", "<?", "</", "<a", "<a b=\"", "<a></b>"] {
        refused(text);
    }
}

proptest! {
    #[test]
    fn no_text_panics(text in "[<>/!?\\-\\[\\]a='\"& \n\u{e9}]{0,80}") {
        let _ = xml::parse(Path::new("r.urdf"), &text);
    }
}
