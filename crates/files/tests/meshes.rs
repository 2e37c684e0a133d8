//! The three formats say the same thing; broken ones are told.
#![allow(clippy::unwrap_used)]

use clearway_files::mesh::{self, Mesh, MeshBudget};
use clearway_files::{FileError, points};
use proptest::prelude::*;
use std::fs;
use std::path::Path;

fn load(name: &str, bytes: &[u8]) -> Result<Mesh, FileError> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    fs::write(&path, bytes).unwrap();
    mesh::load(&path, &mut MeshBudget::default())
}

#[track_caller]
fn refused(name: &str, bytes: &[u8], words: &str) -> FileError {
    let error = load(name, bytes).unwrap_err();
    assert!(error.to_string().contains(words), "{words:?} is not in: {error}");
    error
}

fn binary_stl(triangles: &[[[f32; 3]; 3]], claimed: u32) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes[..5].copy_from_slice(b"solid");
    bytes.extend(claimed.to_le_bytes());
    for t in triangles {
        bytes.extend([0; 12]);
        bytes.extend(t.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.5]];
const ASCII: &str = "solid part one\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 2.0 5e-1\n  endloop\n endfacet\nendsolid part\n";

fn dae(body: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">\n{body}</COLLADA>\n"
    )
}

const GEOMETRY: &str = r##"
<library_geometries><geometry id="g"><mesh>
  <source id="s"><float_array id="f" count="9">0 0 0 1 0 0 0 2 0.5</float_array>
    <technique_common><accessor source="#f" count="3" stride="3"/></technique_common></source>
  <vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
  <triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#n" offset="1"/>
    <p>0 9 1 9 2 9</p></triangles>
</mesh></geometry></library_geometries>
"##;

fn corners(mesh: &Mesh) -> Vec<[f64; 3]> {
    mesh.triangles.iter().flatten().map(|&i| mesh.vertices[i as usize]).collect()
}

#[test]
fn the_formats_agree() {
    let expected = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.5]];
    let obj = "mtllib ../../../etc/passwd\nv 0 0 0\nv 1 0 0 # c\nv 0 2 .5 1 0 0\nvn 0 0 1\nf 1//1 2//1 -1//1\n";
    for (name, bytes) in [
        ("a.stl", binary_stl(&[TRIANGLE], 1)),
        ("a.STL", ASCII.as_bytes().to_vec()),
        ("a.obj", obj.as_bytes().to_vec()),
        ("a.dae", dae(GEOMETRY).into_bytes()),
    ] {
        let mesh = load(name, &bytes).unwrap();
        assert_eq!(corners(&mesh), expected, "{name}");
        assert_eq!(mesh.sha256.len(), 64);
    }
    assert_eq!(
        load("a.obj", b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4").unwrap().triangles,
        [[0, 1, 2], [0, 2, 3]]
    );
}

#[test]
fn the_hash_is_of_the_file() {
    let mesh = load("a.stl", ASCII.as_bytes()).unwrap();
    assert_eq!(mesh.sha256, "a16d8f60be0136c0de55853e17ca0ba22b82c3dce909d5eb58d9a8046ea51b45");
}

#[test]
fn a_dae_is_placed_by_its_scene() {
    let scene = r##"<asset><unit meter="0.01"/><up_axis>Y_UP</up_axis></asset>
<library_visual_scenes><visual_scene id="w">
  <node><translate>10 0 0</translate><rotate>0 0 1 90</rotate><instance_geometry url="#g"/>
    <node><matrix>2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1</matrix><instance_node url="#n"/></node></node>
</visual_scene></library_visual_scenes>
<library_nodes><node id="n"><translate>0 0 1</translate><instance_geometry url="#g"/></node></library_nodes>
<scene><instance_visual_scene url="#w"/></scene>"##;
    let mesh = load("a.dae", dae(&format!("{GEOMETRY}{scene}")).as_bytes()).unwrap();
    // A quarter turn about z, 10 cm along x; then twice as large, 1 up before scaling.
    let expected =
        [[0.1, 0.0, 0.0], [0.1, 0.01, 0.0], [0.08, 0.0, 0.005], [0.1, 0.0, 0.02], [0.1, 0.02, 0.02], [0.06, 0.0, 0.03]];
    for (found, expected) in corners(&mesh).iter().zip(expected) {
        let off = (0..3).map(|i| (found[i] - expected[i]).abs()).fold(0.0, f64::max);
        assert!(off < 1e-12, "{found:?} is not {expected:?}");
    }
    assert_eq!(mesh.triangles.len(), 2);
}

#[test]
fn broken_stl_is_told() {
    refused("a.stl", &binary_stl(&[TRIANGLE], 4_000_000_000), "found `solid");
    let mut lying = binary_stl(&[TRIANGLE], 4_000_000_000);
    lying[..5].fill(0);
    refused("a.stl", &lying, "claims 4000000000 triangles and holds 1");
    refused("a.stl", &lying[..90], "claims 4000000000 triangles and holds 0");
    refused("a.stl", b"", "only 0 bytes");
    refused("a.stl", &binary_stl(&[], 0), "without triangles");
    refused("a.stl", &binary_stl(&[[[0.0; 3], [f32::NAN, 0.0, 0.0], [0.0; 3]]], 1), "a corner at [NaN, 0, 0]");
    let error = refused("a.stl", ASCII.replace("2.0", "two").as_bytes(), "found `two`");
    assert_eq!(error.position(), Some((6, 1)));
    refused("a.stl", &ASCII.as_bytes()[..60], "");
    refused("a.stl", ASCII.replace("5e-1", "inf").as_bytes(), "a corner at [0, 2, inf]");
    refused("a.stl", ASCII.replace("vertex 1 0 0", "").as_bytes(), "a facet with 2 corners");
}

#[test]
fn broken_obj_is_told() {
    let error = refused("a.obj", b"v 0 0 0\nv 1 0 0\nf 1 2 9\n", "a face names corner `9` of 2");
    assert_eq!(error.position(), Some((3, 1)));
    refused("a.obj", b"v 0 0 0\nf 1 0 1\n", "corner `0` of 1");
    refused("a.obj", b"v 0 0 0\nf 1 -9223372036854775808 1\n", "of 1");
    refused("a.obj", b"v 0 0 0\nf 1 1\n", "a face of 2 corners");
    refused("a.obj", b"v 0 x 0\n", "found `x`");
    refused("a.obj", b"hello", "no corners");
    refused("a.obj", b"v 0 0 0\n", "without triangles");
}

#[test]
fn broken_dae_is_told() {
    refused("a.dae", b"<x/>", "found <x>, expected <COLLADA>");
    refused("a.dae", dae("").as_bytes(), "without triangles");
    refused("a.dae", dae(&GEOMETRY.replace("0 9 1 9 2 9", "0 9 1 9 3 9")).as_bytes(), "corner 3 of 3");
    refused("a.dae", dae(&GEOMETRY.replace("0 9 1 9 2 9", "0 9 1 9")).as_bytes(), "three to a triangle");
    refused("a.dae", dae(&GEOMETRY.replace("#v", "#gone")).as_bytes(), "names `#gone`, which is not in the file");
    refused("a.dae", dae(&format!("{GEOMETRY}<asset><unit meter=\"0\"/></asset>")).as_bytes(), "a positive number");
    refused("a.dae", dae(&GEOMETRY.replace("0.5<", "NaN<")).as_bytes(), "NaN");
}

#[test]
fn instances_cannot_multiply() {
    let mut nodes = String::new();
    for i in 0..40 {
        let inner = format!("<instance_node url=\"#n{}\"/>", i + 1).repeat(10);
        nodes += &format!("<node id=\"n{i}\">{inner}</node>");
    }
    let scene = format!(
        "{GEOMETRY}<library_nodes>{nodes}<node id=\"n40\"><instance_geometry url=\"#g\"/></node></library_nodes><library_visual_scenes><visual_scene id=\"w\"><node><instance_node url=\"#n0\"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#w\"/></scene>"
    );
    refused("a.dae", dae(&scene).as_bytes(), "too often");
    refused("a.dae", dae(&scene.replace("#n40", "#n0")).as_bytes(), "without end");
}

#[test]
fn names_and_budgets() {
    refused("a.step", b"", "a mesh file of type `.step`, expected `.stl`, `.obj` or `.dae`");
    refused("a", b"", "without extension");
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("big.stl");
    fs::File::create(&path).unwrap().set_len(65 * 1024 * 1024).unwrap();
    assert!(mesh::load(&path, &mut MeshBudget::default()).unwrap_err().to_string().contains("at most 64 MiB"));
}

#[test]
fn point_clouds() {
    let read = |text: &str| points::from_str(Path::new("c.xyz"), text);
    assert_eq!(
        read("# x y z\n1 2 3\n\n4,5,6,255\r\n7;\t8 9 # far\n").unwrap(),
        [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0]]
    );
    let ply = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float y\nproperty float x\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n4 5 6\n3 0 1 0\n";
    assert_eq!(read(ply).unwrap(), [[2.0, 1.0, 3.0], [5.0, 4.0, 6.0]]);
    let error = read("1 2 3\n1 2\n").unwrap_err();
    assert_eq!(error.position(), Some((2, 1)));
    assert!(read("1 2 nan").is_err());
    assert!(read("").unwrap_err().found().contains("without points"));
    assert!(read(&ply.replace("vertex 2", "vertex 9999999999")).unwrap_err().found().contains("where the header says"));
    assert!(read(&ply.replace("ascii", "binary_little_endian")).unwrap_err().found().contains("binary_little_endian"));
    assert!(read("ply\n").is_err());
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for name in ["a.stl", "a.obj", "a.dae"] {
            let _ = load(name, &bytes);
        }
    }

    #[test]
    fn no_mutation_panics(at in 0_usize..2000, byte in any::<u8>(), cut in 0_usize..2000) {
        for (name, mut bytes) in [("a.stl", ASCII.as_bytes().to_vec()), ("a.stl", binary_stl(&[TRIANGLE; 3], 3)), ("a.dae", dae(GEOMETRY).into_bytes()), ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".to_vec())] {
            let at = at % bytes.len();
            bytes[at] = byte;
            let _ = load(name, &bytes);
            bytes.truncate(cut % bytes.len());
            let _ = load(name, &bytes);
        }
    }
}
