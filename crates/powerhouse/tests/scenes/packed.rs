//! Packed meshes in scenes.

use std::io::Write;
use std::path::{Path, PathBuf};

use powerhouse::io::{MeshOptions, write_packed_mesh};
use powerhouse::{Error, FileScene, Registry, Remark, RunHooks, Scene, read_mesh, remark};
use powerhouse_test_support::TestFolder;

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

/// A scene of `data/` whose mesh file is another one.
fn with_mesh(name: &str, (from, to): (&str, &Path), keys: &str) -> Result<Scene, Error> {
    let path = data().join("scenes").join(name);
    let text = std::fs::read_to_string(&path).unwrap();
    let own = format!("file = \"../meshes/{from}\"");
    assert!(text.contains(&own), "{name}");
    let text = text.replacen(&own, &format!("file = '{}'\n{keys}", to.display()), 1);
    FileScene::from_toml(&text, path, &Registry::default()).map(FileScene::into_scene)
}

/// A scene has the same mesh from a packed mesh as from the file of which it was made: with a joint, along which nodes are
/// doubled, scaled and refined.
#[test]
fn a_packed_mesh_is_the_mesh_of_its_file() {
    let folder = TestFolder::new("packed");
    for (name, from) in [
        ("cavern_small.toml", "cavern_small.msh"),
        ("cavern_joint.toml", "cavern_small.msh"),
    ] {
        let text = data().join("meshes").join(from);
        let (mesh, _) = read_mesh(&text, MeshOptions::default()).unwrap();
        let packed = folder.join("mesh.phm");
        write_packed_mesh(&packed, &mesh, None).unwrap();
        for keys in ["", "scale = 1.25", "within = { y = [-20, 40] }"] {
            let scene = |file: &Path| with_mesh(name, (from, file), keys);
            let (of_text, of_packed) = (scene(&text), scene(&packed));
            match (of_text, of_packed) {
                (Ok(of_text), Ok(of_packed)) => {
                    assert_eq!(of_text.mesh(), of_packed.mesh(), "{name} {keys}");
                }
                (Err(of_text), Err(of_packed)) => {
                    let found = of_packed.to_string().replace("mesh.phm", from);
                    let head = |text: &str| text.lines().next().map(String::from);
                    assert_eq!(head(&of_text.to_string()), head(&found), "{name} {keys}");
                }
                (of_text, of_packed) => {
                    let [one, other] = [of_text.err(), of_packed.err()];
                    panic!("{name} {keys}: {one:?}, {other:?}");
                }
            }
        }
        assert!(with_mesh(name, (from, &packed), "").is_ok());
    }
}

/// A packed mesh that cannot be used is refused at its line, with its name.
#[test]
fn faults_of_a_packed_mesh_name_it() {
    let folder = TestFolder::new("packed-refused");
    let packed = folder.join("mesh.phm");
    let (name, from) = ("cavern_small.toml", "cavern_small.msh");
    let text = data().join("meshes").join(from);
    let (mesh, _) = read_mesh(&text, MeshOptions::default()).unwrap();
    write_packed_mesh(&packed, &mesh, None).unwrap();
    let refused = |keys: &str, passages: &[&str]| {
        let error = with_mesh(name, (from, &packed), keys).err().unwrap();
        for passage in passages {
            assert!(error.to_string().contains(passage), "{passage}: {error}");
        }
    };
    refused(
        "order = 1",
        &["order = 1", "a packed mesh", "cavern_small.toml"],
    );
    let mut bytes = std::fs::read(&packed).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&packed, &bytes).unwrap();
    refused("", &["mesh.phm", "damaged", "cavern_small.toml"]);
    std::fs::write(&packed, &bytes[..middle]).unwrap();
    refused("", &["mesh.phm", "written or copied in part"]);
    std::fs::write(&packed, std::fs::read(&text).unwrap()).unwrap();
    refused("", &["mesh.phm", "no packed mesh"]);
    std::fs::remove_file(&packed).unwrap();
    refused("", &["mesh.phm"]);
}

/// A packed mesh whose bytes are changed in place while a run uses it ends the run with its name; one of which the mesh file
/// was changed since is warned of.
#[test]
fn a_packed_mesh_that_changes_is_reported() {
    let folder = TestFolder::new("packed-in-use");
    let (name, from) = ("cavern_small.toml", "cavern_small.msh");
    let (text, packed) = (folder.join(from), folder.join("mesh.phm"));
    std::fs::copy(data().join("meshes").join(from), &text).unwrap();
    let (mesh, _) = read_mesh(&text, MeshOptions::default()).unwrap();
    write_packed_mesh(&packed, &mesh, Some(&text)).unwrap();
    let scene = || {
        with_mesh(name, (from, &packed), "")
            .unwrap()
            .with_duration(0.01)
    };
    let warned = |scene: Scene| {
        let simulation = scene.prepare().unwrap();
        let remarks = simulation.remarks().iter();
        let old = |remark: &&Remark| matches!(remark, Remark::OldPackedMesh(remark::OldPackedMesh { source, .. }) if source.ends_with(from));
        let found = remarks.filter(old).filter(|remark| remark.is_warning());
        (found.count(), simulation)
    };
    let (warnings, simulation) = warned(scene());
    assert_eq!(warnings, 0);
    let mut bytes = std::fs::read(&packed).unwrap();
    // A coordinate of a node.
    bytes[140] ^= 1;
    let path = packed.clone();
    let mut written = false;
    let hooks = RunHooks::default().with_progress(move |_| {
        if !std::mem::replace(&mut written, true) {
            std::thread::sleep(std::time::Duration::from_millis(20));
            let mut file = std::fs::OpenOptions::new().write(true).open(&path).unwrap();
            file.write_all(&bytes).unwrap();
        }
    });
    let error = simulation.run(hooks).unwrap_err();
    assert!(matches!(error, Error::MeshInUse(_)), "{error}");
    assert!(
        error
            .to_string()
            .contains("mesh.phm: the packed mesh was changed"),
        "{error}"
    );
    write_packed_mesh(&packed, &mesh, Some(&text)).unwrap();
    let mut longer = std::fs::read(&text).unwrap();
    longer.extend(b"\n");
    std::fs::write(&text, longer).unwrap();
    assert_eq!(warned(scene()).0, 1);
}
