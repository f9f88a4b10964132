//! Arrays in memory, or in a file that is mapped into it: of such a file the system reads what is looked at, and may forget it again.

use memmap2::Mmap;
use std::fs::File;
use std::marker::PhantomData;
use std::ops::{Deref, DerefMut, Range};
use std::sync::Arc;

/// Numbers in memory or in a file.
pub(crate) enum Array<T> {
    Memory(Vec<T>),
    File(FileArray<T>),
}

/// Numbers in a file.
pub(crate) struct FileArray<T> {
    file: MappedFile,
    bytes: Range<usize>,
    kind: PhantomData<T>,
}

/// A file that is mapped into memory, to be read.
#[derive(Clone)]
pub(crate) struct MappedFile(Arc<Mmap>);

impl MappedFile {
    /// * `file`: which nobody changes: it was renamed to its place when it was complete.
    pub(crate) fn new(file: &File) -> std::io::Result<Self> {
        #[expect(
            unsafe_code,
            reason = "files of scenes are written once, beside their place, and never changed"
        )]
        let map = unsafe { Mmap::map(file)? };
        Ok(Self(Arc::new(map)))
    }

    /// Its bytes.
    pub(crate) fn bytes(&self) -> &[u8] {
        &self.0
    }

    /// The numbers in some of its bytes; None where those are not all there, or are no whole numbers.
    pub(crate) fn array<T: bytemuck::AnyBitPattern>(&self, bytes: Range<usize>) -> Option<Array<T>> {
        bytemuck::try_cast_slice::<u8, T>(self.0.get(bytes.clone())?).ok()?;
        Some(Array::File(FileArray { file: self.clone(), bytes, kind: PhantomData }))
    }
}

impl<T: bytemuck::AnyBitPattern> Array<T> {
    /// Whether it takes no memory that the system could not have back.
    pub(crate) fn is_in_file(&self) -> bool {
        matches!(self, Self::File(_))
    }

    /// In memory from now on, to be changed.
    fn vec(&mut self) -> &mut Vec<T> {
        if let Self::File(_) = self {
            *self = Self::Memory(self.to_vec());
        }
        match self {
            Self::Memory(vec) => vec,
            Self::File(_) => unreachable!("it was just copied"),
        }
    }

    pub(crate) fn push(&mut self, value: T) {
        self.vec().push(value);
    }

    pub(crate) fn retain(&mut self, keep: impl FnMut(&T) -> bool) {
        self.vec().retain(keep);
    }
}

impl<T: bytemuck::AnyBitPattern> Deref for Array<T> {
    type Target = [T];

    #[inline(always)]
    fn deref(&self) -> &[T] {
        match self {
            Self::Memory(vec) => vec,
            // What it is cast to fits, as it did when it was made.
            Self::File(array) => bytemuck::cast_slice(&array.file.0[array.bytes.clone()]),
        }
    }
}

impl<T: bytemuck::AnyBitPattern> DerefMut for Array<T> {
    fn deref_mut(&mut self) -> &mut [T] {
        self.vec()
    }
}

impl<T> From<Vec<T>> for Array<T> {
    fn from(vec: Vec<T>) -> Self {
        Self::Memory(vec)
    }
}

impl<T> FromIterator<T> for Array<T> {
    fn from_iter<I: IntoIterator<Item = T>>(values: I) -> Self {
        Self::Memory(values.into_iter().collect())
    }
}

impl<T> Default for Array<T> {
    fn default() -> Self {
        Self::Memory(Vec::new())
    }
}

impl<T: Clone> Clone for Array<T> {
    fn clone(&self) -> Self {
        match self {
            Self::Memory(vec) => Self::Memory(vec.clone()),
            Self::File(FileArray { file, bytes, kind }) => {
                Self::File(FileArray { file: file.clone(), bytes: bytes.clone(), kind: *kind })
            }
        }
    }
}

impl<T: bytemuck::AnyBitPattern + PartialEq> PartialEq for Array<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl<T: bytemuck::AnyBitPattern> std::fmt::Debug for Array<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} numbers{}", self.len(), if self.is_in_file() { " in a file" } else { "" })
    }
}
