//! Direct solver: sparse Cholesky factorisation of the assembled operator.

mod dissection;
mod pattern;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
use powerhouse_model::{Operator, StaticError, Vec3};

use super::system::System;
use pattern::Pattern;

/// Number of threads for which dense parts are divided, independent of the real one so that results are bitwise
/// reproducible.
const PARALLELISM: usize = 8;

/// Sparse Cholesky factor `K = U^T U` in an elimination order by nested dissection.
///
/// Supernodal, by faer; fixed and tied directions are eliminated before, so that the matrix
/// is positive definite if the body is supported and its elements resist every deformation.
pub(super) struct Factor {
    pattern: Pattern,
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
}

impl Factor {
    /// Symbolic factorisation; no values yet.
    pub(super) fn new(system: &System) -> Result<Self, StaticError> {
        let pattern = Pattern::new(system);
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let matrix = shape(&pattern);
        let found =
            factorize_symbolic_cholesky(matrix, Side::Upper, SymmetricOrdering::Identity, params);
        let symbolic = found.map_err(|_| StaticError::NoMemory {
            unknowns: pattern.size(),
            bytes: size_of::<f64>() * pattern.indices.len(),
        })?;
        Ok(Self {
            pattern,
            symbolic,
            values: Vec::new(),
        })
    }

    /// Number of entries of the factor.
    pub(super) fn entries(&self) -> u64 {
        self.symbolic.len_val() as u64
    }

    /// Factors the symmetric part of an operator at the present state.
    pub(super) fn factor(
        &mut self,
        system: &System,
        operator: Operator,
    ) -> Result<(), StaticError> {
        let count = self.symbolic.len_val();
        let missing = |bytes| StaticError::NoMemory {
            unknowns: self.pattern.size(),
            bytes,
        };
        if self.values.is_empty() {
            let reserved = self.values.try_reserve_exact(count);
            reserved.map_err(|_| missing(size_of::<f64>() * count))?;
            self.values.resize(count, 0.0);
        }
        let entries = (self.pattern).assemble(system, operator);
        let parallel = Par::rayon(PARALLELISM);
        let request =
            (self.symbolic).factorize_numeric_llt_scratch::<f64>(parallel, Default::default());
        let memory = MemBuffer::try_new(request);
        let mut memory = memory.map_err(|_| missing(request.unaligned_bytes_required()))?;
        let found = self.symbolic.factorize_numeric_llt(
            &mut self.values,
            SparseColMatRef::new(shape(&self.pattern), &entries),
            Side::Upper,
            Default::default(),
            parallel,
            MemStack::new(&mut memory),
            Default::default(),
        );
        match found {
            Ok(_) => Ok(()),
            Err(LltError::NonPositivePivot { index }) => {
                Err(system.not_definite(self.pattern.lead_of(index)))
            }
        }
    }

    /// Solves `K x = b` for a reduced vector.
    pub(super) fn solve(&self, b: &[Vec3]) -> Result<Vec<Vec3>, StaticError> {
        let mut unknowns = self.pattern.take(b);
        let size = unknowns.len();
        let parallel = Par::rayon(PARALLELISM);
        let request = self.symbolic.solve_in_place_scratch::<f64>(1, parallel);
        let memory = MemBuffer::try_new(request);
        let mut memory = memory.map_err(|_| StaticError::NoMemory {
            unknowns: size,
            bytes: request.unaligned_bytes_required(),
        })?;
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut unknowns, size, 1),
            parallel,
            MemStack::new(&mut memory),
        );
        Ok(self.pattern.spread(&unknowns))
    }
}

fn shape(pattern: &Pattern) -> SymbolicSparseColMatRef<'_, usize> {
    let size = pattern.size();
    SymbolicSparseColMatRef::new_checked(size, size, &pattern.columns, None, &pattern.indices)
}
