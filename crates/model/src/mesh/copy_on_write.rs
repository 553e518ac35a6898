//! Data that copies of a mesh have in common until one of them changes it.

use core::ops::{Deref, DerefMut};
use std::sync::Arc;

/// A list that its copies share until one of them is changed: an engine keeps a copy of the mesh that it computes, which
/// would be a tenth of the memory of an elastic model.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CopyOnWrite<T>(Arc<Vec<T>>);

impl<T> Default for CopyOnWrite<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T> From<Vec<T>> for CopyOnWrite<T> {
    fn from(list: Vec<T>) -> Self {
        Self(Arc::new(list))
    }
}

impl<T> FromIterator<T> for CopyOnWrite<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Self {
        Vec::from_iter(items).into()
    }
}

impl<T> Deref for CopyOnWrite<T> {
    type Target = Vec<T>;
    fn deref(&self) -> &Vec<T> {
        &self.0
    }
}

impl<T: Clone> DerefMut for CopyOnWrite<T> {
    fn deref_mut(&mut self) -> &mut Vec<T> {
        Arc::make_mut(&mut self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A copy takes no memory of its own before it changes, and its change does not reach the original.
    #[test]
    fn copies_share_until_they_change() {
        let first: CopyOnWrite<u32> = vec![1, 2, 3].into();
        let mut second = first.clone();
        assert_eq!(first.as_ptr(), second.as_ptr());
        second.push(4);
        assert_eq!((first.len(), second.len()), (3, 4));
        assert_ne!(first.as_ptr(), second.as_ptr());
    }
}
