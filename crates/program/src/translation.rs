//! Translation of programs into languages of processors.

use powerhouse_model::{Program, ProgramOperation};

use crate::schedule::{BranchEnd, BranchSteps, LoopSteps, Step, schedule};

/// Language into which programs are translated.
pub(crate) trait Language {
    /// A constant.
    fn constant(&self, value: f64) -> String;
    /// An input, by its number.
    fn input(&self, index: u32) -> String;
    /// The result of an operation other than those that all languages write alike, on operands that are names or constants.
    fn function(&self, operation: ProgramOperation, operands: &[String]) -> String;
    /// Statement that names a result, of a mask or of a number.
    fn named(&self, name: &str, is_mask: bool, value: &str) -> String;
    /// Statement that declares a number that changes.
    fn variable(&self, name: &str, value: &str) -> String;
    /// Statement that writes an output.
    fn output(&self, index: usize, value: &str) -> String;
    /// Head of a loop of some turns at most.
    fn loop_head(&self, most: u32) -> String;
}

/// Statements of a program, indented by one level.
pub(crate) fn statements(program: &Program, language: &impl Language) -> String {
    let mut writer = Writer {
        program,
        language,
        depth: 1,
        text: String::new(),
    };
    writer.branch(&schedule(program));
    writer.text
}

struct Writer<'a, T> {
    program: &'a Program,
    language: &'a T,
    depth: usize,
    text: String,
}

impl<T: Language> Writer<'_, T> {
    fn line(&mut self, text: &str) {
        self.text.push_str(&"  ".repeat(self.depth));
        self.text.push_str(text);
        self.text.push('\n');
    }

    /// Name, or constant, of the result of an operation.
    fn name(&self, index: u32) -> String {
        match self.program.operations()[index as usize] {
            ProgramOperation::Constant(bits) => self.language.constant(f64::from_bits(bits)),
            ProgramOperation::LoopState(of, number) | ProgramOperation::LoopEnd(of, number) => {
                format!("s{of}_{number}")
            }
            _ => format!("v{index}"),
        }
    }

    fn branch(&mut self, branch: &BranchSteps) {
        self.all(&branch.steps);
        match &branch.end {
            BranchEnd::Outputs(outputs) => {
                for (index, &id) in outputs.iter().enumerate() {
                    let statement = self.language.output(index, &self.name(id));
                    self.line(&statement);
                }
            }
            BranchEnd::Fork { mask, yes, no } => {
                let head = format!("if ({}) {{", self.name(*mask));
                self.line(&head);
                self.inner(|writer| writer.branch(yes));
                self.line("} else {");
                self.inner(|writer| writer.branch(no));
                self.line("}");
            }
        }
    }

    fn inner(&mut self, write: impl FnOnce(&mut Self)) {
        self.depth += 1;
        write(self);
        self.depth -= 1;
    }

    fn all(&mut self, steps: &[Step]) {
        for step in steps {
            match step {
                Step::Compute(index) => self.compute(*index),
                Step::Loop(steps) => self.turns(steps),
            }
        }
    }

    fn compute(&mut self, index: u32) {
        let operation = self.program.operations()[index as usize];
        let value = match operation {
            ProgramOperation::Constant(_)
            | ProgramOperation::LoopState(..)
            | ProgramOperation::LoopEnd(..) => return,
            ProgramOperation::Input(input) => self.language.input(input),
            operation => {
                let operands: Vec<String> = operation.operands().map(|id| self.name(id)).collect();
                match infix(operation) {
                    Some(sign) => format!("{} {sign} {}", operands[0], operands[1]),
                    None => self.language.function(operation, &operands),
                }
            }
        };
        let named = (self.language).named(&format!("v{index}"), operation.is_mask(), &value);
        self.line(&named);
    }

    fn turns(&mut self, steps: &LoopSteps) {
        let of = steps.index;
        let parts = self.program.loops()[of as usize].clone();
        for (number, &id) in parts.start.iter().enumerate() {
            let variable = (self.language).variable(&format!("s{of}_{number}"), &self.name(id));
            self.line(&variable);
        }
        let head = self.language.loop_head(parts.most);
        self.line(&head);
        self.inner(|writer| {
            writer.all(&steps.test);
            let leave = format!("if (!({})) {{ break; }}", writer.name(parts.open));
            writer.line(&leave);
            writer.all(&steps.turn);
            // All at once: the new state depends on the old one.
            for (number, &id) in parts.next.iter().enumerate() {
                let named =
                    (writer.language).named(&format!("n{of}_{number}"), false, &writer.name(id));
                writer.line(&named);
            }
            for number in 0..parts.next.len() {
                writer.line(&format!("s{of}_{number} = n{of}_{number};"));
            }
        });
        self.line("}");
    }
}

/// Sign between the two operands of an operation that all languages write alike.
fn infix(operation: ProgramOperation) -> Option<char> {
    match operation {
        ProgramOperation::Add(..) => Some('+'),
        ProgramOperation::Sub(..) => Some('-'),
        ProgramOperation::Mul(..) => Some('*'),
        ProgramOperation::Div(..) => Some('/'),
        ProgramOperation::Less(..) => Some('<'),
        _ => None,
    }
}

/// Name of a program as an identifier: letters, digits and underscores, from a letter on.
pub(crate) fn identifier(name: &str) -> String {
    let letters = name.chars();
    let letters = letters.map(|c| if c.is_ascii_alphanumeric() { c } else { '_' });
    let text: String = letters.collect();
    match text.chars().next() {
        Some(first) if first.is_ascii_alphabetic() => text,
        _ => format!("program_{text}"),
    }
}

/// Comment lines with the numbers and names of inputs and outputs.
pub(crate) fn lists(program: &Program) -> String {
    let mut text = String::new();
    for (head, names) in [("Inputs", program.inputs()), ("Outputs", program.outputs())] {
        text.push_str(&format!("// {head}:\n"));
        for (index, name) in names.iter().enumerate() {
            // Nothing in a name ends the comment.
            let name: String = name.chars().filter(|c| !c.is_control()).collect();
            text.push_str(&format!("//   {index:3}  {name}\n"));
        }
    }
    text
}
