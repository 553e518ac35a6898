//! What is run of the commands in the pages: the options that make them short, the commands in whose place another one is
//! run, and those that are not run, each with its reason.

use std::fs;
use std::path::Path;

/// An option that makes the commands of one kind short. It takes the place of the one that the page gives.
pub(crate) struct Short {
    pub(crate) command: &'static str,
    pub(crate) option: &'static str,
    pub(crate) value: &'static str,
    /// The exit status that they may have.
    pub(crate) status: &'static [i32],
}

/// What is run in place of a command.
pub(crate) struct Instead {
    pub(crate) command: &'static str,
    pub(crate) run: &'static str,
    pub(crate) status: i32,
    pub(crate) why: &'static str,
}

/// A command that is not run.
pub(crate) struct Left {
    pub(crate) command: &'static str,
    pub(crate) why: &'static str,
}

/// How large the runs are.
pub(crate) struct Size {
    pub(crate) short: &'static [Short],
    pub(crate) instead: &'static [Instead],
    pub(crate) left: &'static [&'static [Left]],
}

impl Size {
    /// All commands that are not run.
    pub(crate) fn left(&self) -> impl Iterator<Item = &'static Left> {
        self.left.iter().copied().flatten()
    }
}

const fn short(command: &'static str, option: &'static str, value: &'static str) -> Short {
    Short {
        command,
        option,
        value,
        status: &[0],
    }
}

const fn instead(command: &'static str, run: &'static str, why: &'static str) -> Instead {
    Instead {
        command,
        run,
        status: 0,
        why,
    }
}

const fn left(command: &'static str, why: &'static str) -> Left {
    Left { command, why }
}

/// With the status 1: of warnings, or of no result within a permitted error.
const fn warned(entry: Instead) -> Instead {
    Instead { status: 1, ..entry }
}

/// With the status 1 too: a check warns of a short run, and a trade of a short window may find no choice.
const fn may_warn(entry: Short) -> Short {
    Short {
        status: &[0, 1],
        ..entry
    }
}

const SCENE: &str = "SCENE is a word of the page for a scene";
const FOLDER: &str = "FOLDER is a word of the page for a folder of results";

/// Small enough for every test of the workspace, on the files that [`shrink`] has made small.
pub(crate) const SMALL: Size = Size {
    short: &[
        short("run", "--duration", "0.02"),
        short("sweep", "--duration", "0.02"),
        short("converge", "--duration", "0.02"),
        may_warn(short("trade", "--window", "0.02")),
        may_warn(short("check", "--duration", "0.02")),
    ],
    instead: &[
        instead(
            "powerhouse run data/scenes/cavern.toml",
            "powerhouse run data/scenes/cavern.toml --duration 1.6",
            "docs/output.md draws its snapshots from 1 s on",
        ),
        instead(
            "powerhouse check data/scenes/layered_site.toml --free-field",
            "powerhouse check data/scenes/layered_site.toml --free-field",
            "it is short, and a shorter one is refused, since the wave does not arrive",
        ),
        warned(instead(
            "powerhouse check SCENE",
            "powerhouse check data/scenes/cavern_small.toml --duration 0.2",
            SCENE,
        )),
        instead(
            "powerhouse check --free-field SCENE",
            "powerhouse check --free-field data/scenes/cavern_small.toml --duration 0.5",
            SCENE,
        ),
        warned(instead(
            "powerhouse trade SCENE --error 2%",
            "powerhouse trade data/scenes/cavern_small.toml --error 2% --window 0.02",
            "in so short a window no choice meets the error",
        )),
        warned(instead(
            "powerhouse converge SCENE --meshes 3 --error 5%",
            "powerhouse converge data/scenes/cavern_small.toml --meshes 2 --error 5% --duration 0.02",
            "a third mesh takes 256 times as long; in so short a time no band is so narrow",
        )),
        instead(
            "powerhouse converge SCENE --finer medium.msh --finer fine.msh",
            "powerhouse converge data/scenes/cavern_small.toml --finer medium.msh --duration 0.02",
            "there is one finer mesh in the folder",
        ),
        instead(
            "powerhouse advise boundary SCENE --error 5%",
            "powerhouse advise boundary data/scenes/cavern_small.toml --error 5%",
            SCENE,
        ),
        instead(
            "powerhouse advise box SCENE --error 5%",
            "powerhouse advise box data/scenes/cavern_small.toml --error 5%",
            SCENE,
        ),
        instead(
            "powerhouse sweep SCENE --jobs 2",
            "powerhouse sweep data/scenes/wang_2019.toml --jobs 2 --duration 0.02",
            SCENE,
        ),
        instead(
            "powerhouse run SCENE --case p-30",
            "powerhouse run data/scenes/wang_2019.toml --case p-30 --duration 0.02 --out results/p-30",
            SCENE,
        ),
        instead(
            "powerhouse report FOLDER",
            "powerhouse report results/wang_2019",
            FOLDER,
        ),
    ],
    left: &[OTHERS],
};

/// On the files of `data/` as they are: a quarter of an hour or more.
pub(crate) const MODERATE: Size = Size {
    short: &[
        short("run", "--duration", "2"),
        short("trade", "--window", "0.2"),
    ],
    instead: &[
        instead(
            "powerhouse run data/scenes/wang_2019.toml",
            "powerhouse run data/scenes/wang_2019.toml --duration 0.01",
            "its stages alone take minutes",
        ),
        instead(
            "powerhouse sweep data/scenes/wang_2019.toml --jobs 2",
            "powerhouse sweep data/scenes/wang_2019.toml --jobs 2 --case sv-30 --case p-30 --duration 0.01",
            "all cases take hours",
        ),
        warned(instead(
            "powerhouse check SCENE",
            "powerhouse check data/scenes/cavern_small.toml",
            "the scene has bricks that are too stiff in bending, and is warned of",
        )),
        instead(
            "powerhouse check --free-field SCENE",
            "powerhouse check --free-field data/scenes/cavern_small.toml",
            SCENE,
        ),
        instead(
            "powerhouse trade SCENE --error 2%",
            "powerhouse trade data/scenes/tunnel.toml --error 2% --window 0.2 --out results/trade",
            SCENE,
        ),
        warned(instead(
            "powerhouse converge SCENE --meshes 3 --error 5%",
            "powerhouse converge data/scenes/cavern_small.toml --meshes 2 --error 5% --duration 2",
            "a third mesh takes 256 times as long; section forces of full integration err by more",
        )),
        instead(
            "powerhouse converge SCENE --finer medium.msh --finer fine.msh",
            "powerhouse converge data/scenes/cavern_small.toml --finer ../meshes/cavern.msh --duration 2",
            "there is one finer mesh in the folder",
        ),
        instead(
            "powerhouse advise boundary SCENE --error 5%",
            "powerhouse advise boundary data/scenes/tunnel.toml --error 5%",
            SCENE,
        ),
        instead(
            "powerhouse advise box SCENE --error 5%",
            "powerhouse advise box data/scenes/tunnel.toml --error 5%",
            SCENE,
        ),
        instead(
            "powerhouse sweep SCENE --jobs 2",
            "powerhouse sweep data/scenes/wang_2019.toml --jobs 2 --case sv-30 --case p-30 --duration 0.01",
            SCENE,
        ),
        instead(
            "powerhouse run SCENE --case p-30",
            "powerhouse run data/scenes/wang_2019.toml --case p-30 --duration 0.01 --out results/p-30",
            SCENE,
        ),
        instead(
            "powerhouse report FOLDER",
            "powerhouse report results/wang_2019",
            FOLDER,
        ),
    ],
    left: &[OTHERS, HOURS],
};

/// The tutorial `docs/tunnel.md`, with short runs.
pub(crate) const SHORT_TUTORIAL: Size = Size {
    short: &[
        short("run", "--duration", "0.02"),
        short("sweep", "--duration", "0.02"),
        short("converge", "--duration", "0.02"),
    ],
    ..TUTORIAL
};

/// The tutorial `docs/tunnel.md` as it is printed.
pub(crate) const TUTORIAL: Size = Size {
    short: &[],
    instead: &[warned(instead(
        "powerhouse check mine/scene.toml --set wave.azimuth=90",
        "powerhouse check mine/scene.toml --set wave.azimuth=90",
        "the page shows what a warning is, and says that the status is 1",
    ))],
    left: &[GMSH],
};

/// Commands of the tutorial that are not of the project.
const GMSH: &[Left] = &[
    left(
        "cargo install --path crates/cli --locked",
        "the command of this build is tested",
    ),
    left("pip install gmsh", NETWORK),
    left(
        "sed 's/radius = 5/radius = 4/' data/meshes/tunnel.geo > mine/own.geo",
        "a file for Gmsh alone",
    ),
    left(MESHING, "Gmsh is not among what the tests need"),
];

/// The command of the tutorial that makes a mesh with Gmsh, and the mesh that tests have in the place of what it makes.
pub(crate) const MESHING: &str = "gmsh -3 mine/own.geo -o mine/own.msh";
/// A mesh of the tutorial, and where a copy of it is put in place of that of Gmsh.
pub(crate) const MESHED: [&str; 2] = ["mine/tunnel.msh", "mine/own.msh"];

const NETWORK: &str = "it needs a network";
const TESTS: &str = "a test does not run all tests";
const MPI: &str = "it needs MPI and a build with it; tests of ranks compare their results";
const CLUSTER: &str = "it needs Slurm and MPI";
const DEVICE: &str = "it needs a graphics processor and a build for it";
const PYTHON: &str = "it needs Python; the package has tests of its own";
const NIGHTLY: &str = "it needs a nightly compiler";
const TOOL: &str = "it needs a tool that is not part of a toolchain";

/// Commands that are not of the project, or that need more than a build of it.
const OTHERS: &[Left] = &[
    left("cargo test", TESTS),
    left("cargo test --test shelves published", TESTS),
    left(
        "cargo test --release --test shelves petersson -- --ignored",
        TESTS,
    ),
    left(
        "python3 data/published/pictures.py",
        "it needs Python; CI compares the pictures with their tables",
    ),
    left(
        "cargo test --release --test cli book -- --ignored --nocapture",
        TESTS,
    ),
    left(
        "cargo build --release -p powerhouse-cli --features gpu",
        DEVICE,
    ),
    left(
        "cargo test --release -p powerhouse-device --features cuda",
        DEVICE,
    ),
    left(
        "cargo run --release -p powerhouse-device --features cuda --example cube -- 51 1000",
        DEVICE,
    ),
    left("pip install ./python", PYTHON),
    left("pip install './python[all]'", PYTHON),
    left("python3 -m venv fe", PYTHON),
    left(
        "fe/bin/pip install wheels/powerhouse_fe-*.whl matplotlib",
        PYTHON,
    ),
    left("fe/bin/python crown.py", PYTHON),
    left("mpirun -n 4 powerhouse run data/scenes/cavern.toml", MPI),
    left(
        "sudo apt-get install libopenmpi-dev openmpi-bin libclang-dev",
        NETWORK,
    ),
    left(
        "cargo build --release -p powerhouse-cli --features mpi",
        MPI,
    ),
    left("mpirun -n 4 target/release/powerhouse run SCENE", MPI),
    left(
        "srun --mpi=pmix powerhouse run --resume \"$folder\"",
        CLUSTER,
    ),
    left(
        "srun --mpi=pmix powerhouse run valley.toml --out \"$folder\"",
        CLUSTER,
    ),
    left(
        "srun --label powerhouse sweep SCENE --out results/bay --jobs 2",
        CLUSTER,
    ),
    left("cargo install cargo-fuzz", NETWORK),
    left("fuzz/run", NIGHTLY),
    left("fuzz/run 1800 gmsh", NIGHTLY),
    left(
        "rustup component add miri rust-src --toolchain nightly",
        NETWORK,
    ),
    left(
        "cargo +nightly miri test -p powerhouse-elements --lib memory::tests",
        NIGHTLY,
    ),
    left("cargo install cargo-deny", NETWORK),
    left("cargo deny check licenses bans sources", TOOL),
    left("cargo deny check advisories", NETWORK),
    left("cargo install cargo-semver-checks", NETWORK),
    left(
        "cargo semver-checks --workspace --baseline-rev \"$(git describe --tags --abbrev=0 --match 'v*')\"",
        TOOL,
    ),
];

/// Commands on the meshes of the paper, which take hours.
const HOURS: &[Left] = &[
    left(
        "powerhouse sweep data/scenes/wang_2019.toml --jobs 2 --case sv-30 --case sv-30-medium \
         --case sv-30-paper",
        "hours",
    ),
    left(
        "powerhouse trade data/scenes/wang_2019.toml --of displacement,relative --window 1.5 --error 2% \
         --factors kernel,step,precision --every-combination",
        "hours: every run of it has stages of minutes",
    ),
    left(
        "powerhouse trade data/scenes/wang_2019.toml --error 2% --factors kernel,step,precision",
        "the same",
    ),
];

/// Makes the files of a copy of `data/` small: the coarse mesh in the scene of the cavern, and the coarse cavern with four
/// of the cases in place of the powerhouse of the paper. The check of the free field before a run is left out of both: it
/// refuses runs that end before the wave arrives.
pub(crate) fn shrink(data: &Path) {
    for [from, to] in [
        ["meshes/cavern.msh", "scenes/medium.msh"],
        ["meshes/cavern_small.msh", "meshes/cavern.msh"],
    ] {
        fs::copy(data.join(from), data.join(to)).unwrap();
    }
    let scene = fs::read_to_string(data.join("scenes/cavern_small.toml")).unwrap();
    let check = "self_check = 0.02\n";
    assert!(scene.contains(check));
    let scene = scene.replace(check, "");
    let mut powerhouse = scene.replace("results/cavern_small", "results/wang_2019");
    for (case, kind) in [
        ("sv-30", "sv"),
        ("p-30", "p"),
        ("sv-30-medium", "sv"),
        ("sv-30-paper", "sv"),
    ] {
        powerhouse += &format!(
            "\n[[case]]\nname = \"{case}\"\n\
             wave = [{{ kind = \"{kind}\", incidence = 30, record = \"el-centro-ns\" }}]\n"
        );
    }
    fs::write(data.join("scenes/cavern_small.toml"), scene).unwrap();
    fs::write(data.join("scenes/wang_2019.toml"), powerhouse).unwrap();
}
