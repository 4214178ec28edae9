//! Memory for what grows with a file: too little of it is an error like others, where `push` and `collect` end the process.

use crate::error::Error;

/// Room for `more` further items, so that pushing them allocates nothing.
#[inline]
pub(crate) fn reserve<T>(list: &mut Vec<T>, more: usize) -> Result<(), Error> {
    list.try_reserve(more).map_err(|_| Error::memory())
}

/// Adds an item.
#[inline]
pub(crate) fn push<T>(list: &mut Vec<T>, item: T) -> Result<(), Error> {
    reserve(list, 1)?;
    list.push(item);
    Ok(())
}

/// An empty list with room for `count` items.
pub(crate) fn with_room<T>(count: usize) -> Result<Vec<T>, Error> {
    let mut list = Vec::new();
    list.try_reserve_exact(count).map_err(|_| Error::memory())?;
    Ok(list)
}

/// A list of `count` times the same.
pub(crate) fn filled<T: Clone>(item: T, count: usize) -> Result<Vec<T>, Error> {
    let mut list = with_room(count)?;
    list.resize(count, item);
    Ok(list)
}

/// A copy.
pub(crate) fn copy<T: Copy>(items: &[T]) -> Result<Vec<T>, Error> {
    let mut list = with_room(items.len())?;
    list.extend_from_slice(items);
    Ok(list)
}

/// Adds a copy of some bytes to a list.
pub(crate) fn append(list: &mut Vec<u8>, bytes: &[u8]) -> Result<(), Error> {
    reserve(list, bytes.len())?;
    list.extend_from_slice(bytes);
    Ok(())
}

/// Refuses where there are not so many bytes at once. Asked before code of others that ends the process where its own allocations fail.
pub(crate) fn expect(bytes: usize) -> Result<(), Error> {
    with_room::<u8>(bytes).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;

    #[test]
    fn what_does_not_fit_is_refused() {
        let refused = [
            with_room::<f64>(usize::MAX / 16).map(drop),
            filled(0u8, usize::MAX / 2).map(drop),
            reserve(&mut vec![0u8; 3], usize::MAX - 9),
            expect(usize::MAX / 2),
        ];
        for refused in refused {
            assert_eq!(refused.unwrap_err().kind, ErrorKind::Memory);
        }
        assert_eq!(copy(&[1, 2]).unwrap(), [1, 2]);
    }
}
