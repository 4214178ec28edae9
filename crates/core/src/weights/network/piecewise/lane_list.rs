//! Lists that grow by some lanes of a register at a time: a structure of arrays.

use crate::machine::simd::{Lanes, WIDTH};

/// A list of `N` numbers each, side by side in `N` planes.
pub(super) struct LaneList<const N: usize> {
    pub len: usize,
    /// Longer than the list.
    planes: [Vec<f32>; N],
}

impl<const N: usize> Default for LaneList<N> {
    fn default() -> Self {
        LaneList { len: 0, planes: std::array::from_fn(|_| Vec::new()) }
    }
}

impl<const N: usize> Clone for LaneList<N> {
    /// Without the room that is not needed.
    fn clone(&self) -> Self {
        let room = room(self.len);
        LaneList { len: self.len, planes: std::array::from_fn(|k| self.planes[k][..room].to_vec()) }
    }
}

/// Numbers in a plane: whatever is appended or loaded is a whole register.
fn room(len: usize) -> usize {
    len.next_multiple_of(WIDTH) + WIDTH
}

impl<const N: usize> LaneList<N> {
    /// An empty list, with room for `count`.
    pub(super) fn clear(&mut self, count: usize) {
        self.len = 0;
        let room = room(count);
        if self.planes[0].len() < room {
            self.planes.iter_mut().for_each(|plane| plane.resize(room, 0.0));
        }
    }

    /// One number of each.
    #[inline(always)]
    pub(super) fn plane(&self, k: usize) -> &[f32] {
        &self.planes[k][..self.len]
    }

    #[inline(always)]
    pub(super) fn plane_mut(&mut self, k: usize) -> &mut [f32] {
        &mut self.planes[k][..self.len]
    }

    /// Sixteen from `first` on; beyond the end anything.
    #[inline(always)]
    pub(super) fn load<L: Lanes>(&self, first: usize) -> [L; N] {
        let mut values = [L::splat(0.0); N];
        for k in 0..N {
            values[k] =
                L::load(self.planes[k][first..].first_chunk().expect("there is room for a register more"));
        }
        values
    }

    /// Appends the lanes whose bits are set.
    #[inline(always)]
    pub(super) fn append<L: Lanes>(&mut self, bits: u32, values: [L; N]) {
        for k in 0..N {
            let to = self.planes[k][self.len..].first_chunk_mut().expect("there is room for a register more");
            values[k].compress(bits, to);
        }
        self.len += bits.count_ones() as usize;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::simd::Portable;

    #[test]
    fn lanes_are_appended_one_after_the_other() {
        let mut list = LaneList::<2>::default();
        list.clear(20);
        let numbers: [f32; WIDTH] = std::array::from_fn(|i| i as f32);
        let (a, b) = (Portable::load(&numbers), Portable::splat(7.0));
        list.append(0b1000_0000_0000_0101, [a, b]);
        list.append(0, [a, b]);
        list.append(0b10, [b, a]);
        assert_eq!((list.plane(0), list.plane(1)), (&[0.0, 2.0, 15.0, 7.0][..], &[7.0, 7.0, 7.0, 1.0][..]));
        list.append(0xffff, [a, a]);
        assert_eq!(list.load::<Portable>(4)[1].store(), numbers);
        list.clear(3);
        assert_eq!(list.plane(0), &[0.0; 0]);
    }
}
