//! Data that copies of a mesh have in common until one of them changes it.

use core::fmt;
use core::ops::{Deref, DerefMut};
use std::sync::Arc;

/// Numbers in the memory of another owner, such as a mapped file.
pub type SharedArray<T> = Arc<dyn AsRef<[T]> + Send + Sync>;

/// A list that its copies share. The first change of one of them makes it a list of its own.
#[derive(Clone)]
pub(crate) struct CopyOnWrite<T> {
    list: Arc<Vec<T>>,
    /// The array that is used in place of the list until the first change.
    shared: Option<SharedArray<T>>,
}

impl<T> Default for CopyOnWrite<T> {
    fn default() -> Self {
        Vec::new().into()
    }
}

impl<T> From<Vec<T>> for CopyOnWrite<T> {
    fn from(list: Vec<T>) -> Self {
        let (list, shared) = (Arc::new(list), None);
        Self { list, shared }
    }
}

impl<T> From<SharedArray<T>> for CopyOnWrite<T> {
    fn from(shared: SharedArray<T>) -> Self {
        let (list, shared) = (Arc::default(), Some(shared));
        Self { list, shared }
    }
}

impl<T> FromIterator<T> for CopyOnWrite<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Self {
        Vec::from_iter(items).into()
    }
}

impl<T> Deref for CopyOnWrite<T> {
    type Target = [T];
    fn deref(&self) -> &[T] {
        match &self.shared {
            Some(array) => (**array).as_ref(),
            None => &self.list,
        }
    }
}

impl<T: Clone> DerefMut for CopyOnWrite<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        self.list_mut()
    }
}

impl<T: Clone> CopyOnWrite<T> {
    fn list_mut(&mut self) -> &mut Vec<T> {
        if let Some(array) = self.shared.take() {
            self.list = Arc::new((*array).as_ref().to_vec());
        }
        Arc::make_mut(&mut self.list)
    }
    /// Appends an entry.
    pub(crate) fn push(&mut self, entry: T) {
        self.list_mut().push(entry);
    }
    /// Appends entries.
    pub(crate) fn extend(&mut self, entries: impl IntoIterator<Item = T>) {
        self.list_mut().extend(entries);
    }
}

impl<T: PartialEq> PartialEq for CopyOnWrite<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<T: fmt::Debug> fmt::Debug for CopyOnWrite<T> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_share_until_they_change() {
        let first: CopyOnWrite<u32> = vec![1, 2, 3].into();
        let mut second = first.clone();
        assert_eq!(first.as_ptr(), second.as_ptr());
        second.push(4);
        assert_eq!((first.len(), second.len()), (3, 4));
        assert_ne!(first.as_ptr(), second.as_ptr());
    }

    #[test]
    fn a_list_of_another_owner_is_copied_at_the_first_change() {
        let owner: SharedArray<u32> = Arc::new(vec![1, 2, 3]);
        let mut list = CopyOnWrite::from(owner.clone());
        assert_eq!(list.as_ptr(), (*owner).as_ref().as_ptr());
        assert_eq!(list, vec![1, 2, 3].into());
        list[0] = 7;
        list.extend([4]);
        assert_eq!(
            (&list[..], (*owner).as_ref()),
            (&[7, 2, 3, 4][..], &[1, 2, 3][..])
        );
    }
}
