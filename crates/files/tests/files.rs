//! Which files are read and written, and which are not.
#![allow(clippy::unwrap_used)]

use clearway_files::{Limits, Root, check_writable, read_bytes, read_text, write_atomic};
use std::fs::{self, File};
use std::path::Path;

#[test]
fn large_files_are_refused_unread() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("big.yaml");
    File::create(&path).unwrap().set_len(50 * 1024 * 1024).unwrap();
    let error = read_text(&path, &Limits::DOCUMENT).unwrap_err().to_string();
    assert!(
        error.ends_with("big.yaml: holds 50.0 MiB, expected at most 8 MiB\n  help: is this the right file?"),
        "{error}"
    );
    assert_eq!(read_bytes(&path, &Limits::MESH).unwrap().len(), 50 * 1024 * 1024);
}

#[test]
fn only_regular_files_are_opened() {
    let dir = tempfile::tempdir().unwrap();
    let error = read_bytes(dir.path(), &Limits::DOCUMENT).unwrap_err();
    assert!(error.found().contains("is a directory"), "{error}");
    let error = read_bytes(&dir.path().join("none.yaml"), &Limits::DOCUMENT).unwrap_err().to_string();
    assert!(error.contains("no such file") && error.contains("help: check the spelling"), "{error}");
    let error = read_bytes(&dir.path().join("no/where/none.yaml"), &Limits::DOCUMENT).unwrap_err().to_string();
    assert!(error.contains("does not exist either"), "{error}");
    #[cfg(unix)]
    for device in ["/dev/zero", "/dev/null"] {
        let error = read_bytes(Path::new(device), &Limits::DOCUMENT).unwrap_err();
        assert!(error.found().contains("not a regular file"), "{error}");
    }
    #[cfg(unix)]
    {
        let fifo = dir.path().join("fifo");
        assert!(std::process::Command::new("mkfifo").arg(&fifo).status().unwrap().success());
        assert!(read_bytes(&fifo, &Limits::DOCUMENT).unwrap_err().found().contains("not a regular file"));
    }
}

#[test]
fn the_first_byte_that_is_not_utf8_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("latin1.yaml");
    fs::write(&path, b"name: \xc3\xa9\nid: \xc3\xa9\xe9\n").unwrap();
    let error = read_text(&path, &Limits::DOCUMENT).unwrap_err();
    assert_eq!(error.position(), Some((2, 6)));
    assert!(error.to_string().contains("byte 0xe9 is not UTF-8"), "{error}");
    fs::write(&path, "\u{feff}name: a").unwrap();
    assert_eq!(read_text(&path, &Limits::DOCUMENT).unwrap(), "name: a");
}

#[test]
fn nothing_outside_a_root_is_found() {
    let dir = tempfile::tempdir().unwrap();
    let inside = dir.path().join("scene");
    fs::create_dir_all(inside.join("meshes")).unwrap();
    fs::write(inside.join("meshes/a.stl"), "x").unwrap();
    fs::write(dir.path().join("secret.stl"), "x").unwrap();
    let root = Root::new(&inside).unwrap();
    assert!(root.resolve("meshes/a.stl").unwrap().ends_with("meshes/a.stl"));
    assert!(root.resolve("./meshes/../meshes/a.stl").is_ok());
    for path in ["../secret.stl", "meshes/../../secret.stl", "../scene/meshes/a.stl", "../nothing"] {
        let error = root.resolve(path).unwrap_err();
        assert!(error.found().contains("leaves its directory"), "{error}");
        assert!(error.to_string().contains("help: move the file"), "{error}");
    }
    assert!(root.resolve("/etc/passwd").unwrap_err().found().contains("absolute"));
    assert!(root.resolve("").is_err());
    assert!(root.resolve("a\0b").is_err());
    assert!(root.resolve("x".repeat(10_000)).is_err());
    assert!(root.resolve("meshes/b.stl").unwrap_err().found().contains("no such file"));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(dir.path().join("secret.stl"), inside.join("link.stl")).unwrap();
        assert!(root.resolve("link.stl").unwrap_err().found().contains("leaves its directory"));
    }
    assert!(Root::new(dir.path().join("none")).unwrap_err().found().contains("no such directory"));
    assert!(Root::new("").is_ok());
}

#[test]
fn writing_replaces_whole_files_and_leaves_nothing_behind() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("plan.json");
    write_atomic(&path, b"old").unwrap();
    write_atomic(&path, b"new").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    let error = write_atomic(dir.path().join("none/plan.json"), b"x").unwrap_err().to_string();
    assert!(error.contains("its directory does not exist") && error.contains("mkdir -p"), "{error}");
    assert!(write_atomic(dir.path(), b"x").unwrap_err().found().contains("is a directory"));
    for wrong in [dir.path().to_owned(), dir.path().join("none/plan.json"), path.join("plan.json")] {
        let (told, met) = (check_writable(&wrong).unwrap_err(), write_atomic(&wrong, b"x").unwrap_err());
        assert_eq!(told, met);
    }
    check_writable(&path).unwrap();
    check_writable(dir.path().join("other.json")).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
    #[cfg(unix)]
    {
        let link = dir.path().join("latest.json");
        std::os::unix::fs::symlink(&path, &link).unwrap();
        write_atomic(&link, b"through").unwrap();
        assert!(link.symlink_metadata().unwrap().is_symlink());
        assert_eq!(fs::read(&path).unwrap(), b"through");
        write_atomic("/dev/null", b"x").unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }
}
