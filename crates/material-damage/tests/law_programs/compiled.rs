//! Programs in CUDA C, compiled as C++, have the bits of their laws.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use powerhouse_material_damage::{ElastoPlastic, LeeFenves, LinearElastic, Mazars, media, presets};
use powerhouse_model::{ConstitutiveLaw, NumberFormat, Program};
use powerhouse_program::{cuda, law_program, wgsl};

use super::laws::{Number, damped, hoek_brown, mohr_coulomb, points, same, softening};

/// Definitions with which a C++ compiler takes CUDA C: one thread after the other.
const EMULATION: &str = r"
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#define __device__
#define __global__
struct Indices { unsigned int x; };
static Indices blockIdx, blockDim, threadIdx;
";

/// Program that calls the kernel of its first argument for the numbers of a file.
const DRIVER: &str = r#"
template <typename Real, typename Kernel>
static int drive(Kernel kernel, size_t inputs, size_t outputs, char **argument) {
  const size_t count = (size_t)atol(argument[4]);
  Real *x = (Real *)malloc(sizeof(Real) * inputs * count);
  Real *y = (Real *)malloc(sizeof(Real) * outputs * count);
  FILE *from = fopen(argument[2], "rb");
  if (!from || fread(x, sizeof(Real), inputs * count, from) != inputs * count) return 3;
  fclose(from);
  blockDim.x = 128;
  for (blockIdx.x = 0; (size_t)blockIdx.x * blockDim.x < count; ++blockIdx.x)
    for (threadIdx.x = 0; threadIdx.x < blockDim.x; ++threadIdx.x) kernel(x, y, count);
  FILE *to = fopen(argument[3], "wb");
  if (!to || fwrite(y, sizeof(Real), outputs * count, to) != outputs * count) return 4;
  return fclose(to);
}
"#;

/// Numbers of a file, and the number of bytes of each.
trait Stored: Number {
    const BYTES: usize;
    fn write(self, to: &mut Vec<u8>);
    fn read(from: &[u8]) -> Self;
}
impl Stored for f64 {
    const BYTES: usize = 8;
    fn write(self, to: &mut Vec<u8>) {
        to.extend(self.to_ne_bytes());
    }
    fn read(from: &[u8]) -> Self {
        Self::from_ne_bytes(from.try_into().unwrap())
    }
}
impl Stored for f32 {
    const BYTES: usize = 4;
    fn write(self, to: &mut Vec<u8>) {
        to.extend(self.to_ne_bytes());
    }
    fn read(from: &[u8]) -> Self {
        Self::from_ne_bytes(from.try_into().unwrap())
    }
}

/// A program under another name: laws of the same surface have the same one.
fn renamed(program: Program, name: &str) -> Program {
    let mut parts = program.into_parts();
    name.clone_into(&mut parts.name);
    Program::new(parts).unwrap()
}

/// The compiler, unless there is none.
fn compiler() -> Option<PathBuf> {
    let name = std::env::var_os("CXX").unwrap_or_else(|| "c++".into());
    let ran = Command::new(&name).arg("--version").output().ok()?;
    ran.status.success().then(|| name.into())
}

/// Compares a compiled program with its law at all points.
fn compare<S: Stored, M: ConstitutiveLaw>(executable: &Path, program: &Program, law: &M) {
    let mut all: Vec<[Vec<S>; 2]> = Vec::new();
    points::<S, M>(law, &mut |x, y| all.push([x.to_vec(), y.to_vec()]));
    let mut bytes = Vec::new();
    for input in 0..program.inputs().len() {
        for [x, _] in &all {
            x[input].write(&mut bytes);
        }
    }
    let folder = executable.parent().unwrap();
    let file = |ending: &str| folder.join(format!("{}.{ending}", program.name()));
    fs::write(file("in"), bytes).unwrap();
    let ran = Command::new(executable)
        .arg(program.name())
        .args([file("in"), file("out")])
        .arg(all.len().to_string())
        .status();
    assert!(ran.unwrap().success(), "{}", program.name());
    let bytes = fs::read(file("out")).unwrap();
    let different = all.iter().enumerate().filter(|(point, [_, y])| {
        let mut numbers = y.iter().enumerate();
        numbers.any(|(output, number)| {
            let place = S::BYTES * (output * all.len() + point);
            !same(*number, S::read(&bytes[place..place + S::BYTES]))
        })
    });
    assert_eq!(different.count(), 0, "{} of {}", program.name(), all.len());
}

/// A law with its programs in both precisions.
macro_rules! laws {
    ($visit:ident: $($name:literal $law:expr;)*) => { $(
        let law = $law;
        $visit!(f64 concat!($name, "_f64"), &law);
        $visit!(f32 concat!($name, "_f32"), &law);
    )* }
}

macro_rules! all_laws {
    ($visit:ident) => {
        laws! { $visit:
            "linear" LinearElastic::new(media::ROCK);
            "mohr_coulomb" ElastoPlastic::new(mohr_coulomb());
            "hoek_brown" ElastoPlastic::new(hoek_brown());
            "softening" softening(mohr_coulomb());
            "plastic_damage" presets::paper_concrete().unwrap();
            "lee_fenves" LeeFenves::new(presets::PAPER_CONCRETE_LEE_FENVES).unwrap();
            "mazars" Mazars::new(presets::PAPER_CONCRETE_MAZARS).unwrap();
            "damped" damped(ElastoPlastic::new(mohr_coulomb()), 3);
        }
    };
}

/// Programs written as CUDA C and compiled with exact arithmetic have the bits of their laws in 15,000 points and both
/// precisions; without a C++ compiler nothing is compared.
#[test]
fn compiled_programs_have_the_bits_of_their_laws() {
    let Some(compiler) = compiler() else {
        eprintln!("skipped: there is no C++ compiler, which $CXX would name");
        return;
    };
    let folder = std::env::temp_dir().join(format!("powerhouse-programs-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let mut programs = Vec::new();
    macro_rules! collect {
        ($scalar:ident $name:expr, $law:expr) => {
            programs.push(renamed(law_program::<$scalar, _>($law, 1).unwrap(), $name));
        };
    }
    all_laws!(collect);
    let mut text = EMULATION.to_owned();
    text += &cuda(&programs.iter().collect::<Vec<_>>());
    text += DRIVER;
    text += "int main(int, char **argument) {\n";
    for program in &programs {
        let real = match program.format() {
            NumberFormat::F64 => "double",
            NumberFormat::F32 => "float",
        };
        let (name, inputs) = (program.name(), program.inputs().len());
        let outputs = program.outputs().len();
        writeln!(
            text,
            "  if (!strcmp(argument[1], \"{name}\")) return drive<{real}>({name}_all, {inputs}, {outputs}, argument);"
        )
        .unwrap();
    }
    text += "  return 2;\n}\n";
    let (source, executable) = (folder.join("programs.cpp"), folder.join("programs"));
    fs::write(&source, text).unwrap();
    let compiled = Command::new(compiler)
        .args(["-O1", "-ffp-contract=off", "-o"])
        .args([&executable, &source])
        .output()
        .unwrap();
    let errors = String::from_utf8_lossy(&compiled.stderr);
    assert!(compiled.status.success(), "{errors}");
    let mut next = programs.iter();
    macro_rules! compare_one {
        ($scalar:ident $name:expr, $law:expr) => {
            compare::<$scalar, _>(&executable, next.next().unwrap(), $law);
        };
    }
    all_laws!(compare_one);
    fs::remove_dir_all(&folder).unwrap();
}

/// WGSL has single precision alone, and its text has an entry point, the bindings and a statement for every output.
#[test]
fn programs_are_written_as_wgsl() {
    let law = ElastoPlastic::new(mohr_coulomb());
    let double = law_program::<f64, _>(&law, 1).unwrap();
    assert!(wgsl(&double).unwrap_err().to_string().contains("F32"));
    let single = law_program::<f32, _>(&law, 1).unwrap();
    let text = wgsl(&single).unwrap();
    assert!(text.contains("fn mohr_coulomb("), "{text}");
    for output in 0..single.outputs().len() {
        // One for each branch.
        assert_eq!(text.matches(&format!("y[{output}u * stride")).count(), 2);
    }
}
