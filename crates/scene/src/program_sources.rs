//! Sources of the programs of a scene's elements.

use powerhouse_model::{NumberFormat, Program, ProgramError};
use powerhouse_program::{cuda, wgsl};

use crate::{Error, Simulation, file_name};

/// Greatest number of forks of a program: the first one separates elastic steps, further ones multiply its length.
const FORKS: usize = 1;

/// Sources of the programs of a scene's elements in dynamic steps of one length, for other processors.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ProgramSources {
    /// Length of the steps (s), which is in the programs of damped and time-dependent laws.
    pub step: f64,
    /// Sources.
    pub files: Vec<ProgramSource>,
    /// Reasons why other elements have no program.
    pub refused: Vec<ProgramError>,
}

/// Source of the program of the elements of a set.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ProgramSource {
    /// File name, that of the element set with `.cu` (CUDA C) or `.wgsl` (WGSL).
    pub file: String,
    /// Text.
    pub text: String,
    /// Number of operations of the program.
    pub operations: usize,
}

impl Simulation {
    /// Sources of the programs of the elements in dynamic steps of this scene: CUDA C, and WGSL of elements in single
    /// precision. Each has the arithmetic of one element, from the displacement of its nodes to their forces; the names of inputs
    /// and outputs are in its comments.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn program_sources(&mut self) -> Result<ProgramSources, Error> {
        let step = self.step()?;
        let mut sources = ProgramSources {
            step,
            files: Vec::new(),
            refused: Vec::new(),
        };
        let mut names: Vec<String> = Vec::new();
        let programs = match self.model().distributed() {
            Some(distributed) => distributed.programs(step, FORKS),
            None => vec![Err(ProgramError::None {
                name: "engine".into(),
            })],
        };
        for program in programs {
            match program {
                Ok(program) => {
                    // A set may have elements of several kernels.
                    let base = file_name(program.name());
                    let mut name = base.clone();
                    for number in 2.. {
                        if !names.contains(&name) {
                            break;
                        }
                        name = format!("{base}-{number}");
                    }
                    names.push(name.clone());
                    sources.add(&name, program);
                }
                Err(reason) => sources.refused.push(reason),
            }
        }
        Ok(sources)
    }
}

impl ProgramSources {
    fn add(&mut self, name: &str, program: Program) {
        let operations = program.operations().len();
        let mut add = |ending: &str, text: String| {
            self.files.push(ProgramSource {
                file: format!("{name}.{ending}"),
                text,
                operations,
            });
        };
        add("cu", cuda(&[&program]));
        if program.format() == NumberFormat::F32
            && let Ok(text) = wgsl(&program)
        {
            add("wgsl", text);
        }
    }
}
